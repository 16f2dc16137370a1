#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "codec/attribute_coder.h"
#include "codec/base_coder.h"
#include "codec/bit_coder.h"
#include "codec/bit_mixer.h"
#include "codec/loose_coder.h"
#include "codec/patch_coder.h"
#include "codec/patch_mesh.h"
#include "codec/shape_coder.h"
#include "codec/star.h"
#include "codec/wedge_coder.h"
#include "codec/wedge_table.h"

namespace lodestone::detail {

/// What all levels have in common, and what the next ones may have. What a stream says of chunks that are yet to come
/// counts for nothing: a reader sets these for each chunk.
struct LevelLimits {
  int grid_bits = 14;
  bool is_fast = false;  ///< CompactCoding::Fast
  Index group_count = 1;
  std::uint64_t most_vertices = kNoIndex;
  std::uint64_t most_wedges = kNoIndex;
  std::uint64_t most_faces = kNoIndex;
};

/// Stars of a round, in the order in which their places are coded: ears, then patches, then loose ones.
struct NewStars {
  struct Star {
    Index vertex = 0;
    Index face_end = 0;    ///< in `faces`; it begins where the one before ends
    Index coarse_end = 0;  ///< in `coarse`
    bool closed = true;
    bool is_loose = false;  ///< its faces need not lie side by side
  };
  /// A face that is replaced, as it was.
  struct Coarse {
    Index face = 0;
    Index group = 0;
    std::array<Index, 3> wedges{};  ///< of its corners
  };
  std::vector<Star> stars;
  std::vector<Index> faces;  ///< the new vertex stands first in each, its ring in order in the others
  std::vector<Coarse> coarse;

  Index face_begin(std::size_t i) const { return i == 0 ? 0 : stars[i - 1].face_end; }
  std::span<const Index> star(std::size_t i) const {
    return std::span(faces).subspan(face_begin(i), stars[i].face_end - face_begin(i));
  }
  std::span<const Coarse> coarse_of(std::size_t i) const {
    const Index begin = i == 0 ? 0 : stars[i - 1].coarse_end;
    return std::span(coarse).subspan(begin, stars[i].coarse_end - begin);
  }
};

/// The vertices of a round: each has a star, or several where sheets meet in it, and the sectors of a record.
struct NewVertices {
  std::vector<Index> stars;       ///< by vertex, in order: numbers of stars
  std::vector<Index> star_end;    ///< by vertex: in `stars`
  std::vector<Index> sector_end;  ///< by vertex: in the round's sectors

  std::size_t count() const { return star_end.size(); }
  std::span<const Index> stars_of(std::size_t i) const {
    const Index begin = i == 0 ? 0 : star_end[i - 1];
    return std::span(stars).subspan(begin, star_end[i] - begin);
  }
};

/// What a writer wants of the wedges of a round's patches and ears.
struct WedgePlan {
  std::vector<Star::Spoke> faces;  ///< as NewStars::faces; centres are numbered within their vertex
  std::vector<Index> extra;        ///< by vertex: its wedges that no face uses yet
};

/// What a writer wants of a loose vertex.
struct LooseVertex {
  LooseRecord record;
  Index extra = 0;  ///< its wedges that no face uses yet
  Vec3i position;
};

/// Where a vertex of the level goes in a round.
struct CodedMove {
  Index star = 0;  ///< of the round: the move belongs to its vertex; kNoIndex: to the round's last one
  Index vertex = 0;
  Vec3i from, to;
};

/// The level that the rounds so far lead to, and the models that code the next: the same for writer and reader. A round
/// is coded by the functions from `code_patches` on, in their order.
class LevelCoder {
 public:
  LevelCoder(const LevelLimits& limits, std::span<const AttributeSpec> attributes);

  /// What the next round is taken to cost: how many faces, vertices, wedges and groups the level has, and one more.
  std::uint64_t size() const {
    return mesh_.face_count() + positions_.size() + wedges_.size() + limits_.group_count + 1;
  }
  /// Lets levels from now on have so many more vertices, wedges and faces than this one has, and no more.
  void allow(std::uint64_t vertices, std::uint64_t wedges, std::uint64_t faces);
  /// Whether the polygons so far have no more corners, and there were no more moves, than a reader allows at the end of
  /// a chunk that ends here.
  bool may_end_chunk() const;

  const PatchMesh& mesh() const { return mesh_; }
  const WedgeTable& wedges() const { return wedges_; }
  const GridPoints& positions() const { return positions_; }
  /// Of the last round.
  const RoundPatches& patches() const { return patches_; }
  const NewStars& stars() const { return stars_; }
  const NewVertices& vertices() const { return vertices_; }
  const SectorList& sectors() const { return sectors_; }
  const AttributeCoder& attributes() const { return attributes_; }
  /// Has attributes counted by what they take.
  void count_attributes() { attributes_.counts = true; }

  /// Codes the base mesh; a reader gives one with arrays of the right lengths. False where what is read is none.
  bool code_base(BitCoder& coder, BaseMesh& base);
  /// Codes the attributes of the base mesh. `given`: by attribute, the numbers of all wedges, of a writer.
  bool code_base_attributes(BitCoder& coder, std::span<const std::vector<std::int32_t>> given);

  /// Codes how fine positions are from now on: multiples of 2^step. False where what is read is no step.
  bool code_step(BitCoder& coder, int& step);

  /// Codes where a round's patches and ears are.
  bool code_patches(BitCoder& coder, const PatchPlan* plan);
  /// Codes where the vertices around them go that have not gone there yet. `targets`: by vertex, of a writer.
  bool code_moves(BitCoder& coder, std::span<const Vec3i> targets);
  /// Codes which of them belong to one vertex, and puts their stars there. `joins`: by star, the first of its vertex.
  bool code_places(BitCoder& coder, std::span<const Index> joins);
  bool code_wedges(BitCoder& coder, const WedgePlan* plan);
  /// Codes the positions of these vertices; a writer gives them. False where what is read lies off the grid.
  bool code_points(BitCoder& coder, std::span<const Vec3i> given);
  /// Codes how many loose vertices the round has besides, and after that each of them. False where a round has none at
  /// all, or more than there may be.
  /// Codes whether vertices go elsewhere from the next round on, and if so where those go that this round and those
  /// before have not moved.
  bool code_stage_end(BitCoder& coder, bool& ends, std::span<const Vec3i> targets);
  const std::vector<CodedMove>& moves() const { return moves_; }
  /// Whether a vertex lies where it stays up to the end of the stage.
  bool is_placed(Index vertex) const { return vertex >= moved_.size() || moved_[vertex] != 0; }
  bool code_loose_count(BitCoder& coder, Index& count);
  bool code_loose_vertex(BitCoder& coder, LooseVertex& vertex);
  /// Codes the attributes of the round's wedges that have none yet. `given`: by attribute, their numbers, of a writer.
  bool code_attributes(BitCoder& coder, std::span<const std::vector<std::int32_t>> given);

 private:
  void add_stars();
  void end_star(Index vertex, bool closed, bool is_loose);
  void order_stars(std::size_t count);
  Star::Spoke spoke(Index face) const {
    const Index c = 3 * face;
    return {face, mesh_.group(face), mesh_.wedge(c), mesh_.wedge(c + 1), mesh_.wedge(c + 2)};
  }
  bool split(std::size_t star);
  bool split_cut(std::size_t star);
  bool end_vertex();
  bool code_extra(BitCoder& coder, Index count);
  bool code_flag(BitCoder& coder, std::uint32_t which, bool is);
  std::uint64_t corners_left() const;
  Vec3i guess_loose(std::span<const Index> fine) const;
  void measure_edge(Index half);
  void measure_edges();
  void measure_spokes(std::size_t i);
  bool move(BitCoder& coder, Index vertex, Index half, Index star, std::span<const Vec3i> targets);

  LevelLimits limits_;
  PatchMesh mesh_;
  WedgeTable wedges_;
  GridPoints positions_;
  BaseCoder base_coder_;
  PatchCoder patch_coder_;
  WedgeCoder wedge_coder_;
  LooseCoder loose_coder_;
  std::unique_ptr<ShapeCoder> shapes_;
  AttributeCoder attributes_;
  BitMixer<1> flags_;
  std::uint32_t round_number_ = 0;
  bool has_seams_ = false;     // in the level before the round
  std::uint64_t corners_ = 0;  // of the polygons of all sectors

  int step_ = 0;                     // positions are multiples of 2^this
  std::vector<std::uint8_t> moved_;  // by vertex: whether it lies where it stays up to the end of the stage
  std::size_t unmoved_count_ = 0;
  std::uint64_t move_count_ = 0;
  std::vector<Index> moved_faces_;  // that have had a corner moved since the last round's patches
  bool are_all_changed_ = true;     // since then

  RoundPatches patches_;
  std::vector<CodedMove> moves_;
  NewStars stars_;
  NewVertices vertices_;
  SectorList sectors_;
  std::size_t vertices_done_ = 0;  // those of the round that have attributes
  std::vector<Index> joined_, vertex_faces_;
  // By vertex, or by wedge: which corner it is of the ring that was looked at last, if it is one. Rings of more corners
  // than this counts are refused.
  std::vector<std::uint16_t> places_;
  Star split_;
};

}  // namespace lodestone::detail
