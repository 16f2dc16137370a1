#include "simplify/removal_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone::detail {
namespace {

constexpr double kLeastHeight = 4;   // of a face whose normal says something, over the rounding of coordinates
constexpr double kFreeDistance = 8;  // what rounding of coordinates, and of distances from them, may pretend

/// How far rounding to floats may have moved the points of a mesh, each way.
double rounding_of(const Mesh& mesh) {
  float largest = 0;
  for (const Vec3f& p : mesh.positions) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return 0.5 * static_cast<double>(largest) * static_cast<double>(std::numeric_limits<float>::epsilon());
}

}  // namespace

FaceRules::FaceRules(const Mesh& mesh) {
  const double rounding = rounding_of(mesh);
  least_height_squared_ = kLeastHeight * kLeastHeight * rounding * rounding;
  rounded_square_ = kFreeDistance * kFreeDistance * rounding * rounding;
}

bool FaceRules::relax_angles(bool beyond) {
  if (turn_limit_ == TurnLimit::None || (turn_limit_ == TurnLimit::Right && !beyond)) return false;
  turn_limit_ = turn_limit_ == TurnLimit::Acute ? TurnLimit::Right : TurnLimit::None;
  return true;
}

}  // namespace lodestone::detail
