#include "simplify/removal_rules.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone::detail {
namespace {

constexpr double kMinCosine = 0.2;   // of the angle that faces may turn, at first
constexpr double kLeastHeight = 4;   // of a face whose normal says something, over the rounding of coordinates
constexpr double kFreeDistance = 8;  // what rounding of coordinates, and of distances from them, may pretend
constexpr double kSameShape = 1e-6;  // relative; shapes that differ by less are the same

/// How far rounding to floats may have moved the points of a mesh, each way.
double rounding_of(const Mesh& mesh) {
  float largest = 0;
  for (const Vec3f& p : mesh.positions) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return 0.5 * static_cast<double>(largest) * static_cast<double>(std::numeric_limits<float>::epsilon());
}

}  // namespace

double squared_longest_edge(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::max({squared_length(b - a), squared_length(c - b), squared_length(a - c)});
}

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

bool FaceRules::turns_too_far(const Vec3& to, const Vec3& from) const {
  if (turn_limit_ == TurnLimit::None) return false;
  const double cosine = dot(to, from);
  return cosine < 0 || (turn_limit_ == TurnLimit::Acute &&
                        cosine * cosine < kMinCosine * kMinCosine * squared_length(to) * squared_length(from));
}

void FaceRules::add(const Vec3& normal, double squared_longest, Replaced& faces) const {
  const double square = squared_length(normal);
  if (!(square > kMinShape * kMinShape * squared_longest * squared_longest))
    faces.least_shape = std::min(faces.least_shape, (1 - kSameShape) * std::sqrt(square) / squared_longest);
  faces.have_directions = faces.have_directions && has_direction(square, squared_longest);
  faces.normal += normal;
}

}  // namespace lodestone::detail
