#pragma once

#include <vector>

#include <lodestone/io/scene.h>
#include <lodestone/lod/deviation.h>

#include "pipeline/on_first_use.h"

namespace lodestone::detail {

/// A scene's meshes, prepared for being measured against their levels, each when the first of these comes; from several
/// threads if wanted.
class MeasuredScene {
 public:
  /// Pre: `scene` outlives it.
  explicit MeasuredScene(const Scene& scene) : scene_(scene), surfaces_(scene.meshes().size()) {}

  const Scene& scene() const { return scene_; }
  const MeasuredSurface& original(std::size_t mesh) {
    return surfaces_[mesh].get([&] { return MeasuredSurface(scene_.meshes()[mesh].mesh); });
  }

 private:
  const Scene& scene_;
  std::vector<OnFirstUse<MeasuredSurface>> surfaces_;  // by mesh
};

}  // namespace lodestone::detail
