#include "mesh/float_spacing.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <lodestone/core/detail/text.h>

namespace lodestone::detail {
namespace {

constexpr double kCoarse = 1e-3;  // Of the diagonal: steps that one sees, ten times the error of a fine level.

}  // namespace

std::optional<std::string> coarse_floats(const Mesh& mesh) {
  if (mesh.face_count() == 0) return std::nullopt;
  const Box box = bounding_box(mesh);
  const double farthest = std::max({std::abs(box.low.x), std::abs(box.low.y), std::abs(box.low.z), std::abs(box.high.x),
                                    std::abs(box.high.y), std::abs(box.high.z)});
  const auto largest = static_cast<float>(farthest);
  const double spacing = static_cast<double>(largest) - static_cast<double>(std::nextafter(largest, 0.0f));
  if (!(spacing > kCoarse * box.diagonal())) return std::nullopt;
  return text("floats do not hold the shape so far from the origin: they are ", spacing, " apart there, ",
              std::round(1e3 * spacing / box.diagonal()) / 10, " % of the object");
}

}  // namespace lodestone::detail
