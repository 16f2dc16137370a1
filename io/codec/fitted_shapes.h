#pragma once

#include "codec/move_coder.h"
#include "codec/point_coder.h"
#include "codec/shape_coder.h"

namespace lodestone::detail {

/// Positions by predictions, and sizes of their errors, that are fitted to those that went by.
class FittedShapes final : public ShapeCoder {
 public:
  explicit FittedShapes(int grid_bits) : ShapeCoder(grid_bits) {}

  void start_round(const PatchMesh& mesh, const GridPoints& positions) override {
    look_at_normals(
        mesh, positions, mesh.vertex_count(), [&](Index half) { return mesh.from(half); }, normals_);
  }

 private:
  void add_base() override { points_.add_base(); }
  void add_loose() override { points_.add_loose(); }
  void forget_moves(std::size_t vertex_count) override { moves_.start(vertex_count); }

  bool code_new(BitCoder& coder, const Around& around, Vec3i& position) override {
    ring_.look(around.mesh, around.outer, around.closed, around.positions, normals_);
    points_.code(coder, ring_, around.closed, step(), position);
    if (!is_on_grid(position)) return false;
    points_.learn(position, ring_, around.closed);
    return true;
  }
  bool code_moved(BitCoder& coder, const Around& around, Index vertex, Vec3i& position) override {
    ring_.look(around.mesh, around.outer, around.closed, around.positions, normals_);
    moves_.code(coder, ring_, around.closed, around.positions[vertex], from(), step(), position);
    if (!is_on_grid(position)) return false;
    moves_.learn(vertex, position, ring_);
    return true;
  }

  PointCoder points_;
  MoveCoder moves_;
  std::vector<Vec3i> normals_;  // by vertex of the level before the round
  Ring ring_;                   // of the vertex at hand
};

}  // namespace lodestone::detail
