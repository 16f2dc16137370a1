#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/bit_coder.h"
#include "codec/bit_mixer.h"
#include "codec/patch_mesh.h"
#include "codec/star.h"
#include "codec/wedge_table.h"

namespace lodestone::detail {

/// Codes which wedges the faces of new stars have. Most are as foretold: those of the faces that had a star's outer
/// edges, and in its middle one wedge between any two seams that end there.
class WedgeCoder {
 public:
  explicit WedgeCoder(Index group_count) : group_count_(group_count) {}

  /// Codes the wedges of a star of the last vertex, and adds those that are new. `plan`: what a writer wants, by face;
  /// centres are numbered within the vertex. Without seams in the level before none are looked for. False where what is
  /// read names none.
  bool code(BitCoder& coder, PatchMesh& mesh, bool has_seams, std::span<const Index> star, bool closed, bool is_ear,
            const Star::Spoke* plan, WedgeTable& wedges);
  /// Codes how many further wedges the last vertex has, which no face uses yet, up to `most`; adds them.
  bool code_extra(BitCoder& coder, Index count, Index most, WedgeTable& wedges);

 private:
  struct Foretold {
    std::uint32_t context = 0;
    std::vector<Index> centres;  // by face, within the vertex
  };
  void foretell(const PatchMesh& mesh, bool has_seams, std::span<const Index> star, bool closed, bool is_ear,
                Index used);
  bool is_foretold(const PatchMesh& mesh, std::span<const Index> star, const Star::Spoke* plan) const;
  bool code_side(BitCoder& coder, PatchMesh& mesh, Index face, bool is_ear, const Star::Spoke* plan,
                 const WedgeTable& wedges);
  bool code_named(BitCoder& coder, PatchMesh& mesh, Index face, const Star::Spoke* plan, const WedgeTable& wedges);
  bool code_centre(BitCoder& coder, PatchMesh& mesh, std::span<const Index> star, std::size_t i,
                   const Star::Spoke* plan, WedgeTable& wedges);
  int code_bit(BitCoder& coder, std::uint32_t context, bool bit);

  Index group_count_;
  BitMixer<1> bits_{{kContexts}, 1};
  Foretold foretold_;

  static constexpr std::uint32_t kContexts = 128;
};

}  // namespace lodestone::detail
