#include "pipeline/deviation_total.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone::detail {

void DeviationTotal::OneSided::add(const OneSidedDeviation& other, double scale, double area) {
  largest.maximum = std::max(largest.maximum, other.maximum * scale);
  largest.maximum_bound = std::max(largest.maximum_bound, other.maximum_bound * scale);
  largest.sample_count += other.sample_count;
  mean += other.mean * scale * area;
  squares += other.rms * other.rms * scale * scale * area;
}

OneSidedDeviation DeviationTotal::OneSided::result(double area) const {
  OneSidedDeviation out = largest;
  out.mean = mean / area;
  out.rms = std::sqrt(squares / area);
  return out;
}

void DeviationTotal::add(const Deviation& deviation, double scale, double area) {
  // A mesh without any area counts as a very small one.
  const double weight = area > 0 && std::isfinite(area) ? area : std::numeric_limits<double>::min();
  forward_.add(deviation.forward, scale, weight);
  backward_.add(deviation.backward, scale, weight);
  angle_ += deviation.mean_normal_angle * weight;
  area_ += weight;
}

Deviation DeviationTotal::result() const {
  if (!(area_ > 0)) return {};
  return {forward_.result(area_), backward_.result(area_), angle_ / area_};
}

}  // namespace lodestone::detail
