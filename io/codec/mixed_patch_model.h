#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "codec/bit_mixer.h"
#include "codec/patch_model.h"

namespace lodestone::detail {

/// Mixes bits of patches from many contexts.
class MixedPatchModel final : public PatchModel {
 public:
  MixedPatchModel();

  void start(const PatchWalk& walk) override;
  bool code_face(BitCoder& coder, const PatchWalk& walk, Index face, bool begins) override;
  bool code_edge(BitCoder& coder, const PatchWalk& walk, std::size_t i, bool goes_on) override;
  void decide(const PatchWalk& walk, Index face) override;
  void change_polygon(const PatchWalk& walk) override;
  void end_polygon(const PatchWalk& walk) override;

 private:
  /// What is decided around a vertex.
  struct Around {
    std::int32_t degree = 0;   // as it will be, by what is decided
    std::int32_t open = 0;     // faces that are not decided
    std::int32_t patches = 0;  // that it is a corner of
  };

  std::uint32_t age(Index face) const;
  std::uint32_t size_of(Index face) const;
  std::uint32_t flatness(Index half);
  std::uint32_t measure_flatness(Index half) const;

  BitMixer faces_;
  BitMixer edges_;

  // Of the round at hand.
  const PatchMesh* mesh_ = nullptr;
  std::span<const Vec3i> positions_;
  std::uint32_t round_ = 0;
  std::vector<Vec3i> normals_;           // by face: not longer than 2^15 or so
  std::vector<std::int16_t> face_logs_;  // by face: of the area, squared
  int mean_face_log_ = 0;
  std::vector<std::uint8_t> flat_;  // by half-edge: see flatness, plus 1; 0 where it was not asked for
  std::vector<Around> around_;      // by vertex

  // Of the patch at hand.
  Vec3i centre_;                  // sixteenths
  std::vector<Vec3i> radii_;      // from there to its corners
  std::vector<int> radius_logs_;  // squared
  int mean_radius_log_ = 0;
};

}  // namespace lodestone::detail
