#pragma once

#include <cstdint>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// What the evaluation of a removal found, what says more first. `Turn`: a face would turn too far, which may be let
/// pass; `Link`: an edge would be doubled; `Shape`: a face would be a worse sliver than those that go; `Texture`: it
/// would turn a texture over; `Ring`: too many neighbours.
enum class Verdict : std::uint8_t { Legal, Locked, Turn, Link, Shape, Texture, Ring };

inline bool rejects(Verdict verdict) { return verdict != Verdict::Legal; }

double squared_longest_edge(const Vec3& a, const Vec3& b, const Vec3& c);

/// What the faces that fill a hole must be like. Normals are twice their faces' area long.
class FaceRules {
 public:
  explicit FaceRules(const Mesh& mesh);

  /// From now on lets new faces turn further: at first up to a right angle; then, if `beyond`, by any angle, where a
  /// worse shape is better than too many faces. Returns whether there was further to go.
  bool relax_angles(bool beyond);
  bool limits_turns() const { return turn_limit_ != TurnLimit::None; }
  /// Whether a face turns by more than the angle allowed, from one normal to another, both of any length.
  bool turns_too_far(const Vec3& to, const Vec3& from) const;

  /// Whether a face with such a normal and longest edge is so high that rounding its corners leaves the normal what it
  /// is.
  bool has_direction(double squared_normal, double squared_longest) const {
    return squared_normal > least_height_squared_ * squared_longest;
  }
  /// The height over the longest edge that a new face must exceed: what was a sliver may stay one, as long as it gets
  /// no worse. Where the worst of the faces that go is one, that is the limit.
  class LeastShape {
   public:
    void add(double squared_normal, double squared_longest);
    bool is_met(double squared_normal, double squared_longest) const {
      return squared_normal > least_ * least_ * squared_longest * squared_longest;
    }

   private:
    double least_ = kMinShape;
  };

  /// Rounding takes points off planes and lines; that must not make a removal dearer than one next to it.
  float beyond_rounding(float squared_distance) const {
    return squared_distance > static_cast<float>(rounded_square_) ? squared_distance : 0;
  }
  double rounded_square() const { return rounded_square_; }

 private:
  enum class TurnLimit : std::uint8_t { Acute, Right, None };
  static constexpr double kMinShape =
      1e-3;  // a new face's height over its longest edge, where there are no slivers yet

  TurnLimit turn_limit_ = TurnLimit::Acute;
  double least_height_squared_ = 0;  // of a face whose normal says something
  double rounded_square_ = 0;        // a squared distance that may be rounding alone
};

}  // namespace lodestone::detail
