#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>

#include "codec/bit_coder.h"
#include "codec/fixed_point.h"
#include "codec/grid_points.h"
#include "codec/patch_mesh.h"

namespace lodestone::detail {

/// Faces that are not what they were in the round before.
struct ChangedFaces {
  std::span<const Index> made;
  std::span<const Index> moved;  ///< those that had a corner moved
  bool are_all = false;
};

/// A walk over the faces of a level: what it has decided, and the patch at hand.
struct PatchWalk {
  enum State : std::uint8_t { kOpen, kPlain, kPatch };
  // Besides, in a face's state: that it was seen, and that no patch goes on across its half-edges, from the first on.
  static constexpr std::uint8_t kStateBits = 3, kIsSeen = 4, kIsDecided = 8;

  const PatchMesh* mesh = nullptr;
  const GridPoints* positions = nullptr;
  std::uint32_t round = 0;
  bool has_seams = false;
  ChangedFaces changed;
  std::vector<std::uint8_t> states;  // by face

  std::vector<Index> polygon;  // half-edges around the patch
  std::vector<Index> corners;  // the vertices that they leave
  std::vector<Index> faces;    // of the patch
  std::uint32_t crossed = 0;   // seams
  int lengths = 0;             // of the polygon's edges: logarithms

  std::uint32_t state(Index face) const { return std::uint32_t{states[face]} & kStateBits; }
  /// Of the face beyond a half-edge; kPlain at a border.
  std::uint32_t state_of(Index half) const {
    const Index twin = mesh->twin(half);
    return twin == kNoIndex ? std::uint32_t{kPlain} : state(face_of_corner(twin));
  }
  bool is_seam(Index half) const { return has_seams && mesh->is_seam(half); }
};

/// The models of a walk's bits.
class PatchModel {
 public:
  PatchModel() = default;
  PatchModel(const PatchModel&) = delete;
  PatchModel& operator=(const PatchModel&) = delete;
  virtual ~PatchModel() = default;

  /// Looks at the level before a round.
  virtual void start(const PatchWalk& walk) = 0;
  /// Codes whether a patch begins with a face.
  virtual bool code_face(BitCoder& coder, const PatchWalk& walk, Index face, bool begins) = 0;
  /// Codes whether a patch goes on beyond the i-th edge of its polygon.
  virtual bool code_edge(BitCoder& coder, const PatchWalk& walk, std::size_t i, bool goes_on) = 0;

  /// Hears that a face's state was decided; that the polygon has changed, by a corner that came to it or by all that it
  /// has; and that it is whole.
  virtual void decide(const PatchWalk& walk, Index face) = 0;
  virtual void change_polygon(const PatchWalk& walk) = 0;
  virtual void end_polygon(const PatchWalk& walk) = 0;

  static std::unique_ptr<PatchModel> make(bool is_fast);
};

}  // namespace lodestone::detail
