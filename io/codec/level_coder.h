#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "codec/bit_coder.h"
#include "codec/bit_mixer.h"
#include "codec/patch_coder.h"
#include "codec/patch_mesh.h"
#include "codec/point_coder.h"

namespace lodestone::detail {

/// A base mesh by its points: where the mesh has several sheets, points of one vertex may be several.
struct BaseMesh {
  std::vector<Index> corners;    ///< three points for each face; given in the order of first use, left canonical
  std::vector<Vec3i> positions;  ///< by point
  std::vector<Index> same_as;    ///< by point: an earlier point of its vertex, or itself
};

/// Vertices of a round, in the order in which they are coded.
struct NewVertices {
  struct Vertex {
    Index star_end = 0;      ///< in `stars`; it begins where the one before ends
    Index replaced_end = 0;  ///< in `replaced`
    bool closed = true;
  };
  std::vector<Vertex> vertices;
  std::vector<Index> stars;     ///< faces; the new vertex stands first in each, its ring in order in the others
  std::vector<Index> replaced;  ///< faces that the first of its star took the places of …
  std::vector<std::array<Index, 3>> replaced_corners;  ///< … and what corners they had

  std::span<const Index> star(std::size_t i) const {
    const Index begin = i == 0 ? 0 : vertices[i - 1].star_end;
    return std::span(stars).subspan(begin, vertices[i].star_end - begin);
  }
};

/// The level that the rounds so far lead to, and the models that code the next: the same for writer and reader.
class LevelCoder {
 public:
  explicit LevelCoder(int grid_bits) : points_(grid_bits) {}

  const PatchMesh& mesh() const { return mesh_; }
  std::span<const Vec3i> positions() const { return positions_; }
  /// The vertices of the last round.
  const NewVertices& round() const { return round_; }
  /// The patches of the last round: first its ears are vertices, then its patches.
  const RoundPatches& patches() const { return patches_; }

  /// Codes the base mesh; a reader gives one with arrays of the right lengths. False where what is read is none.
  bool code_base(BitCoder& coder, BaseMesh& base);
  /// Codes where a round's vertices go, and puts them there. False where what is read is no round.
  bool code_places(BitCoder& coder, const PatchPlan* plan);
  /// Codes the positions of the round's vertices; a writer gives them. False where what is read lies off the grid.
  bool code_points(BitCoder& coder, std::span<const Vec3i> given);

 private:
  bool code_corners(BitCoder& coder, BaseMesh& base);
  bool code_sheets(BitCoder& coder, BaseMesh& base);
  void add_vertices();
  void note_vertex(bool closed);

  PatchMesh mesh_;
  std::vector<Vec3i> positions_;
  BitMixer base_bits_{std::array<std::uint32_t, 1>{2}, 1};
  PatchCoder patch_coder_;
  PointCoder points_;
  std::uint32_t round_number_ = 0;
  RoundPatches patches_;
  NewVertices round_;
  std::vector<Index> star_;
};

}  // namespace lodestone::detail
