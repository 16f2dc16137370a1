#pragma once

#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// What morph targets add to a mesh's vectors of one kind ("TARGET_<i>:POSITION"), to show it at any weights.
class MorphTargets {
 public:
  /// Pre: the attributes live as long.
  explicit MorphTargets(std::span<const Attribute> attributes, std::string_view semantic = "POSITION");

  /// One more than the highest number of a target.
  std::size_t count() const { return count_; }
  /// How many of them some weights show.
  std::size_t count_shown(std::span<const float> weights) const;
  /// Moves points, or directions, one for each of the attributes' elements, but for those that would be nowhere then.
  void move(std::span<Vec3> points, std::span<const float> weights) const;

 private:
  struct Target {
    std::size_t number = 0;
    const Attribute* displacements = nullptr;
  };
  std::vector<Target> targets_;
  std::size_t count_ = 0;
};

}  // namespace lodestone::detail
