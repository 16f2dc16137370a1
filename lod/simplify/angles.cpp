// The arc tangent of t in 0 … 1 as t·P(t²), with P of degree 10 through the arc tangent's values at Chebyshev's nodes.

#include "simplify/angles.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "distance/wide_vectors.h"

namespace lodestone::detail {

LODESTONE_WIDE_VECTORS
void angles(std::size_t count, const double* cosine, const double* sine, double* angle) {
  for (std::size_t i = 0; i < count; ++i) {
    const double x = std::abs(cosine[i]);
    const double y = sine[i];
    const double t = std::min(x, y) / std::max(std::max(x, y), std::numeric_limits<double>::min());
    const double s = t * t;
    double p = 0.001057607438057242;
    p = p * s - 0.007030669470424213;
    p = p * s + 0.021912945865448393;
    p = p * s - 0.04392841073326746;
    p = p * s + 0.06685281517877424;
    p = p * s - 0.08785043282362845;
    p = p * s + 0.1105077127584966;
    p = p * s - 0.14278576024807985;
    p = p * s + 0.19999558100363982;
    p = p * s - 0.33333322488911593;
    p = p * s + 0.9999999995535376;
    const double below = t * p;
    const double acute = y > x ? std::numbers::pi / 2 - below : below;
    angle[i] = cosine[i] < 0 ? std::numbers::pi - acute : acute;
  }
}

}  // namespace lodestone::detail
