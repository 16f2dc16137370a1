#include "codec/patch_model.h"

#include <algorithm>

#include "codec/bit_counter.h"
#include "codec/mixed_patch_model.h"

namespace lodestone::detail {
namespace {

/// Counts bits of patches, each by one context: what is decided around a face, and how much longer its longest edge is
/// than its mean; how many corners the patch has, and how long the edge is beside those around.
class CountedPatchModel final : public PatchModel {
 public:
  void start(const PatchWalk&) override {}
  void decide(const PatchWalk&, Index) override {}
  void change_polygon(const PatchWalk&) override {}
  void end_polygon(const PatchWalk&) override {}

  bool code_face(BitCoder& coder, const PatchWalk& walk, Index face, bool begins) override {
    std::uint32_t states = 0;
    int longest = 0, lengths = 0;
    for (Index h = 3 * face; h < 3 * face + 3; ++h) {
      states += kStateSteps[walk.state_of(h)];
      const int length = walk.mesh->edge_log(h);
      lengths += length;
      longest = std::max(longest, length);
    }
    const std::uint32_t shape = bucket(longest - lengths / 3, 0, 4, kShapes);
    return faces_[states * kShapes + shape].code(coder, begins ? 1 : 0) != 0;
  }

  bool code_edge(BitCoder& coder, const PatchWalk& walk, std::size_t i, bool goes_on) override {
    const Index half = walk.polygon[i], twin = walk.mesh->twin(half);
    const int size = static_cast<int>(walk.polygon.size()), length = walk.mesh->edge_log(half);
    const int lengths =
        walk.lengths - length + walk.mesh->edge_log(next_corner(twin)) + walk.mesh->edge_log(previous_corner(twin));
    const std::uint32_t relative = bucket(length - lengths / (size + 1), -32, 5, kRatios);
    const auto corners = static_cast<std::uint32_t>(std::min(size - 3, kCorners - 1));
    return edges_[corners * kRatios + relative].code(coder, goes_on ? 1 : 0) != 0;
  }

 private:
  static constexpr std::array<std::uint32_t, 3> kStateSteps = {0, 1, 4};  // by state, of each of three neighbours
  static constexpr std::uint32_t kStates = 3 * 4 + 1, kShapes = 12, kRatios = 16;
  static constexpr int kCorners = 8;

  std::array<BitCounter, kStates * kShapes> faces_;
  std::array<BitCounter, kCorners * kRatios> edges_;
};

}  // namespace

std::unique_ptr<PatchModel> PatchModel::make(bool is_fast) {
  if (is_fast) return std::make_unique<CountedPatchModel>();
  return std::make_unique<MixedPatchModel>();
}

}  // namespace lodestone::detail
