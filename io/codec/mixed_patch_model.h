#pragma once

#include <array>
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
    std::int32_t degree_before = 0;  // of the level before the round, kDegrees at most
    std::int32_t degree = 0;         // as it will be, by what is decided
    std::int32_t open = 0;           // faces that are not decided
    std::int32_t patches = 0;        // that it is a corner of
  };
  /// A face's normal, not longer than 2^15 or so.
  struct Normal {
    std::int16_t x = 0, y = 0, z = 0;
  };
  /// What contexts say of a face and its neighbours, for as long as none of these is made anew.
  struct Look {
    bool is_known = false;
    std::uint8_t relative = 0;  // its area beside those around
    std::uint8_t shape = 0;     // how much longer its longest edge is than the mean
    std::uint8_t seams = 0;     // of its edges
    std::uint8_t uneven = 0;    // edges whose flatness differs from side to side, bit k for edge k
  };

  void look_at_faces(const PatchWalk& walk);
  void look_at_face(Index face);
  void forget(Index face);
  const Look& look_at(const PatchWalk& walk, Index face);
  std::uint32_t size_of(Index face) const;
  void measure_flatness(Index half);
  std::uint32_t flatness(const Look& look, Index face, Index k);

  BitMixer<7> faces_;
  BitMixer<8> edges_;

  // Remembered from round to round.
  std::vector<Normal> normals_;          // by face
  std::vector<std::int16_t> face_logs_;  // by face: of the area, squared
  std::int64_t sum_of_face_logs_ = 0;
  std::vector<std::uint8_t> flats_;  // by half-edge, where a look on either side is known: see measure_flatness
  std::vector<Look> looks_;          // by face
  std::uint32_t join_count_ = 0;     // of the mesh, in the round before
  bool has_seams_ = false;           // the same

  // Of the round at hand.
  const PatchMesh* mesh_ = nullptr;
  const GridPoints* positions_ = nullptr;
  int mean_face_log_ = 0;
  std::vector<std::uint8_t> asked_;  // by half-edge of uneven flatness: that, plus 1, once it was asked for
  std::vector<std::uint8_t> ages_;   // by face: 0 for those that the last round made; the oldest are alike
  std::vector<Around> around_;       // by vertex

  // Of the patch at hand.
  Vec3i centre_;                  // sixteenths
  std::vector<Vec3i> radii_;      // from there to its corners
  std::vector<int> radius_logs_;  // squared
  int mean_radius_log_ = 0;
};

}  // namespace lodestone::detail
