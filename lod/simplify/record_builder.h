#pragma once

#include <deque>
#include <span>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/removal.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone::detail {

/// Collects removals as they happen and turns them into a progressive mesh, renumbered in order of creation.
class RecordBuilder {
 public:
  /// `connectivity` tells which vertices are copies of one another; both outlive the builder.
  RecordBuilder(const Mesh& mesh, const Connectivity& connectivity);

  /// Adds the removal of a vertex: one record for each of its copies.
  void add(std::span<const RemovalRecord> copies, double curvature_error);
  /// Ends the round that the removals since the last call belong to.
  void end_round();
  std::size_t size() const { return vertex_.size(); }

  /// Builds the result, with what the removals left as its base; `deviation` holds one entry for each removal, in
  /// order.
  ProgressiveMesh finish(const std::vector<float>& deviation);

 private:
  struct Numbering;
  Index group_of(Index face) const;
  void number_base(ProgressiveMesh& result, Numbering& numbers) const;
  void number_record(std::size_t removal, ProgressiveMesh& result, Numbering& numbers) const;
  void write_record(std::size_t removal, ProgressiveMesh& result, const Numbering& numbers) const;
  void write_errors(ProgressiveMesh& result, const std::vector<float>& deviation) const;

  const Mesh* mesh_;
  const Connectivity* connectivity_;
  std::vector<Index> materials_;  // of the groups, ascending

  // In order of removal, with the numbers of the full mesh; they grow without being copied.
  std::deque<Index> vertex_;
  std::deque<float> curvature_error_;
  std::vector<std::size_t> round_end_;
  std::deque<Index> sector_begin_{0};
  std::deque<Index> center_;
  std::deque<SectorShape> shape_;
  std::deque<Index> polygon_begin_{0};
  std::deque<Index> polygons_;
  std::deque<Index> face_begin_{0};
  std::deque<Index> faces_;
  std::deque<PolygonTriangle> triangles_;
};

}  // namespace lodestone::detail
