#pragma once

#include <optional>
#include <span>

#include <lodestone/core/mesh.h>
#include <lodestone/lod/surface_index.h>

#include "distance/face_boxes.h"

namespace lodestone::detail {

/// The surface that distances are measured to: by its neighbours where a face nearby is known, by a search elsewhere.
class TargetSurface {
 public:
  /// `opposite` are the mesh's opposite_corners; `index` is the mesh's, too. All outlive the object.
  TargetSurface(const Mesh& mesh, std::span<const Index> opposite, const SurfaceIndex& index)
      : mesh_(mesh), opposite_(opposite), given_(&index) {}
  /// Searches by boxes of its own, made for the first search.
  TargetSurface(const Mesh& mesh, std::span<const Index> opposite) : mesh_(mesh), opposite_(opposite) {}

  double distance_to_face(const Vec3& p, Index face) const;
  /// Goes from face to face, from `start` on, over the edge or around the corner where a face's nearest point lies, for
  /// as long as the next one is nearer: mostly to the nearest where `start` lies near p.
  NearFace near(const Vec3& p, Index start) const;
  /// Returns the nearest face; `hint` is one likely near p, or kNoIndex.
  NearFace nearest(const Vec3& p, Index hint);

 private:
  /// A face, and its nearest point.
  struct Place {
    Index face = kNoIndex;
    unsigned corners = 0;  // Between which the point lies: bit k stands for corner k.
    double squared_distance = 0;
  };

  Place look_at(const Vec3& p, Index face) const;
  bool step_to(const Vec3& p, Index face, Place& place) const;
  bool step_across(const Vec3& p, Place& place) const;
  bool step_around(const Vec3& p, Place& place) const;

  const Mesh& mesh_;
  std::span<const Index> opposite_;
  const SurfaceIndex* given_ = nullptr;
  std::optional<FaceBoxes> made_;
};

}  // namespace lodestone::detail
