#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>

#include "codec/bit_coder.h"
#include "codec/bit_mixer.h"
#include "codec/fixed_point.h"
#include "codec/number_coder.h"
#include "codec/patch_mesh.h"

namespace lodestone::detail {

/// Corners that a patch's polygon has at most.
inline constexpr std::size_t kMostPatchCorners = 256;

/// Where vertices appear in a round: patches of faces, each to become the star of one, and ears.
struct RoundPatches {
  struct Patch {
    Index polygon_end = 0;  ///< in `polygons`; it begins where the one before ends
    Index face_end = 0;     ///< in `faces`
    bool closed = true;     ///< else the closing edge, which is not listed, runs from the last corner to the first
  };
  std::vector<Patch> patches;
  std::vector<Index> polygons;  ///< half-edges of the patches' faces
  std::vector<Index> faces;
  std::vector<Index> ears;  ///< border half-edges that get a face with a new vertex
};

/// What a writer wants of a round.
struct PatchPlan {
  std::vector<Index> patch_of;       ///< by face: its patch, or kNoIndex
  std::vector<Index> closing_edge;   ///< by patch: a half-edge, or kNoIndex where it is closed
  std::vector<std::uint8_t> is_ear;  ///< by half-edge
  Index ear_count = 0;
};

/// Codes the patches of rounds: a walk over the faces asks of each whether a patch begins there, and of each edge
/// around a patch whether it goes on beyond.
class PatchCoder {
 public:
  PatchCoder();

  /// Codes a round's patches; a reader passes no plan. Without seams none are looked for. False where what is read is
  /// no round.
  bool code(BitCoder& coder, const PatchMesh& mesh, bool has_seams, std::span<const Vec3i> positions,
            std::uint32_t round, const PatchPlan* plan, RoundPatches& patches);

 private:
  enum State : std::uint8_t { kOpen, kPlain, kPatch };

  /// What is decided around a vertex.
  struct Around {
    std::int32_t degree = 0;   // as it will be, by what is decided
    std::int32_t open = 0;     // faces that are not decided
    std::int32_t patches = 0;  // that it is a corner of
  };

  void start(const PatchMesh& mesh, std::span<const Vec3i> positions, std::uint32_t round);
  void walk(BitCoder& coder, const PatchPlan* plan, Index count, RoundPatches& patches);
  void grow(BitCoder& coder, Index seed, const PatchPlan* plan, RoundPatches& patches);
  void end_patch(std::size_t closing, RoundPatches& patches);
  void code_ears(BitCoder& coder, const PatchPlan* plan, RoundPatches& patches);
  bool code_face(BitCoder& coder, Index face, bool begins);
  bool code_edge(BitCoder& coder, std::size_t i, bool goes_on);
  bool code_border(BitCoder& coder, std::uint32_t what, bool yes);

  void decide(Index face, State state);
  void measure_polygon();
  bool has_corner(Index vertex) const;
  std::uint32_t state_of(Index half) const;  // of the face beyond it; kPlain at a border
  std::uint32_t age(Index face) const;
  std::uint32_t size_of(Index face) const;
  std::uint32_t flatness(Index half);
  std::uint32_t measure_flatness(Index half) const;
  bool is_seam(Index half) const { return has_seams_ && mesh_->is_seam(half); }
  int edge_log(Index half) const { return edge_logs_[half]; }

  BitMixer faces_;
  BitMixer edges_;
  BitMixer borders_;
  NumberCoder counts_;

  // Of the round at hand.
  const PatchMesh* mesh_ = nullptr;
  std::span<const Vec3i> positions_;
  std::uint32_t round_ = 0;
  std::vector<Vec3i> normals_;           // by face: not longer than 2^15 or so
  std::vector<std::int16_t> face_logs_;  // by face: of the area, squared
  int mean_face_log_ = 0;
  bool has_seams_ = false;
  std::vector<std::int16_t> edge_logs_;  // by half-edge: of the length, squared
  std::vector<std::uint8_t> flat_;       // by half-edge: see flatness, plus 1; 0 where it was not asked for
  std::vector<std::uint8_t> state_;      // by face
  std::vector<std::uint8_t> decided_;    // by half-edge: that no patch goes on across it
  std::vector<Around> around_;           // by vertex
  std::vector<Index> queue_;

  // Of the patch at hand.
  std::vector<Index> polygon_;
  std::vector<Index> patch_faces_;
  std::uint32_t crossed_ = 0;     // seams
  Vec3i sum_;                     // of its corners
  int lengths_ = 0;               // of its edges: logarithms
  Vec3i centre_;                  // sixteenths
  std::vector<Vec3i> radii_;      // from there to its corners
  std::vector<int> radius_logs_;  // squared
  int mean_radius_log_ = 0;
};

}  // namespace lodestone::detail
