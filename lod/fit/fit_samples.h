#pragma once

#include <array>
#include <cmath>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>

#include "distance/triangle.h"
#include "fit/constrained_edges.h"

namespace lodestone::detail {

/// A point of the original surface, and where on the level it belongs at present.
struct SurfaceSample {
  Vec3 position;
  double weight = 0;        ///< the area it stands for
  Index vertex = kNoIndex;  ///< of the original: a corner of the face that it is a point of
  Index face = kNoIndex;
  std::array<double, 3> weights{};
  double squared_distance = 0;

  /// Takes a point of a face, given by the weights of its corners, for its place.
  void place_at(Index on_face, const Barycentric& point) {
    face = on_face;
    weights = point.weights;
    squared_distance = point.squared_distance;
  }
  /// Takes the nearest point of a face for its place.
  void place_on(const Mesh& level, Index on_face) {
    place_at(on_face, nearest_weights(position, triangle_of(level, on_face)));
  }
};

/// What is summed over samples: squares of distances, or distances, of which those far below `softening` count by their
/// squares, too.
struct SampleNorm {
  double softening = 0;  ///< mesh units; 0: squares

  double error(double squared_distance) const { return softening > 0 ? softened(squared_distance) : squared_distance; }
  /// What a square counts for where the sum is found by iteratively reweighted least squares.
  double weight(double squared_distance) const { return softening > 0 ? softening / softened(squared_distance) : 1; }

 private:
  double softened(double squared_distance) const { return std::sqrt(squared_distance + softening * softening); }
};

/// Points of the original: its vertices and its faces' centroids, or an even choice of about `most` of them, in the
/// order of the faces given, so that those that follow each other lie together if these do.
class SurfaceSamples {
 public:
  SurfaceSamples(const Mesh& original, std::span<const Index> face_order, std::size_t most);
  std::vector<SurfaceSample>& all() { return samples_; }
  const std::vector<SurfaceSample>& all() const { return samples_; }

 private:
  std::vector<SurfaceSample> samples_;
};

/// A point of one of the original's constrained lines.
struct LineSample {
  Vec3 position;
  double length = 0;  ///< that it stands for
};

class LineSamples {
 public:
  /// `edges` are the original's.
  LineSamples(const Mesh& original, std::span<const MeshEdge> edges);
  const std::vector<LineSample>& all() const { return samples_; }

 private:
  std::vector<LineSample> samples_;
};

}  // namespace lodestone::detail
