#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// What the evaluation of a removal found, what says more first. `Turn`: a face would turn too far, which may be let
/// pass; `Link`: an edge would be doubled; `Shape`: a face would be a worse sliver than those that go; `Texture`: it
/// would turn a texture over; `Ring`: too many neighbours.
enum class Verdict : std::uint8_t { Legal, Locked, Turn, Link, Shape, Texture, Ring };

inline bool rejects(Verdict verdict) { return verdict != Verdict::Legal; }

inline double squared_longest_edge(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::max(std::max(squared_length(b - a), squared_length(c - b)), squared_length(a - c));
}

/// What the faces that fill a hole must be like. Normals are twice their faces' area long.
class FaceRules {
 public:
  explicit FaceRules(const Mesh& mesh);

  /// From now on lets new faces turn further: at first up to a right angle; then, if `beyond`, by any angle, where a
  /// worse shape is better than too many faces. Returns whether there was further to go.
  bool relax_angles(bool beyond);
  /// Whether a face turns by more than the angle allowed, from one normal to another, both of any length.
  bool turns_too_far(const Vec3& to, const Vec3& from) const {
    if (turn_limit_ == TurnLimit::None) return false;
    const double cosine = dot(to, from);
    return cosine < 0 || (turn_limit_ == TurnLimit::Acute &&
                          cosine * cosine < kMinCosine * kMinCosine * squared_length(to) * squared_length(from));
  }

  /// Whether a face with such a normal and longest edge is so high that rounding its corners leaves the normal what it
  /// is.
  bool has_direction(double squared_normal, double squared_longest) const {
    return squared_normal > least_height_squared_ * squared_longest;
  }
  /// What the faces that go ask of those that come. What was a sliver may stay one, as long as it gets no worse: where
  /// the worst of the faces is one, that is the limit.
  struct Replaced {
    double least_shape = kMinShape;  ///< height over longest edge that a new face must exceed
    bool have_directions = true;     ///< whether the normals of all are more than rounding
    Vec3 normal;                     ///< sum of theirs
  };
  /// Adds a face that goes.
  void add(const Vec3& normal, double squared_normal, double squared_longest, Replaced& faces) const {
    if (!(squared_normal > kMinShape * kMinShape * squared_longest * squared_longest))
      faces.least_shape = std::min(faces.least_shape, (1 - kSameShape) * std::sqrt(squared_normal) / squared_longest);
    faces.have_directions = faces.have_directions && has_direction(squared_normal, squared_longest);
    faces.normal += normal;
  }
  /// Whether a new face would be too thin.
  bool is_too_thin(double squared_normal, double squared_longest, const Replaced& faces) const {
    const double least = faces.least_shape * squared_longest;
    return !(squared_normal > least * least) ||
           (faces.have_directions && !has_direction(squared_normal, squared_longest));
  }
  /// Whether a new face looks away from where all those did that go: what is asked where it lies beside none of them
  /// that has a direction.
  bool looks_away(const Vec3& normal, const Replaced& faces) const {
    return turn_limit_ != TurnLimit::None && dot(normal, faces.normal) <= 0;
  }

  /// Rounding takes points off planes and lines; that must not make a removal dearer than one next to it.
  float beyond_rounding(float squared_distance) const {
    return squared_distance > static_cast<float>(rounded_square_) ? squared_distance : 0;
  }
  double rounded_square() const { return rounded_square_; }

 private:
  enum class TurnLimit : std::uint8_t { Acute, Right, None };
  static constexpr double kMinCosine = 0.2;   // of the angle that faces may turn, at first
  static constexpr double kSameShape = 1e-6;  // relative; shapes that differ by less are the same
  static constexpr double kMinShape =
      1e-3;  // a new face's height over its longest edge, where there are no slivers yet

  TurnLimit turn_limit_ = TurnLimit::Acute;
  double least_height_squared_ = 0;  // of a face whose normal says something
  double rounded_square_ = 0;        // a squared distance that may be rounding alone
};

}  // namespace lodestone::detail
