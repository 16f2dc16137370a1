#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>

#include "codec/bit_coder.h"
#include "codec/bit_mixer.h"
#include "codec/fixed_point.h"
#include "codec/grid_points.h"
#include "codec/number_coder.h"
#include "codec/patch_mesh.h"
#include "codec/patch_model.h"

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
  explicit PatchCoder(bool is_fast);

  /// Codes a round's patches; a reader passes no plan. Without seams none are looked for. False where what is read is
  /// no round. Rounds are numbered from 1 on; what faces look like is remembered from one to the next, but of those
  /// that have changed.
  bool code(BitCoder& coder, const PatchMesh& mesh, bool has_seams, const GridPoints& positions, std::uint32_t round,
            const ChangedFaces& changed, const PatchPlan* plan, RoundPatches& patches);

 private:
  const PatchMesh& mesh() const { return *walk_.mesh; }
  void walk(BitCoder& coder, const PatchPlan* plan, Index count, RoundPatches& patches);
  void grow(BitCoder& coder, Index seed, const PatchPlan* plan, RoundPatches& patches);
  void go_on(std::size_t i);
  void ask_beyond(Index half);
  void end_patch(std::size_t closing, RoundPatches& patches);
  void code_ears(BitCoder& coder, const PatchPlan* plan, RoundPatches& patches);
  bool code_border(BitCoder& coder, std::uint32_t what, bool yes);
  void decide(Index face, PatchWalk::State state);
  void close(Index half);
  bool is_closed(Index half) const;
  bool has_corner(Index vertex) const;

  std::unique_ptr<PatchModel> model_;
  BitMixer<1> borders_;
  NumberCoder counts_;

  // Of the round at hand.
  PatchWalk walk_;
  std::vector<Index> queue_;
};

}  // namespace lodestone::detail
