#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>
#include <lodestone/core/removal.h>

namespace lodestone::detail {

/// What a removal did to the faces of a mesh.
struct FaceChange {
  std::span<const Index> gone;    ///< the faces that were there before it
  std::size_t fresh_count = 0;    ///< so many of these, from the first on, stand for new faces now
  std::span<const Index> beside;  ///< faces that were there before it, too, at whose edges some have vanished
  float moved = 0;                ///< no point of the surface moved farther, mesh units
  bool is_vanished = false;       ///< a piece has gone, and what is left has not moved

  std::span<const Index> fresh() const { return gone.first(fresh_count); }
};

/// A list of them, in order. Cost: 16 bytes each, and 4 for each of their faces.
class FaceChanges {
 public:
  void add(const FaceChange& change);
  /// Adds what a record did, which was just done and moved the surface no farther than `displacement`.
  FaceChange add(const RemovalRecord& record, double displacement);
  /// Adds that a piece has vanished: all of it lies within `reach` of `face`, which is one of the faces left.
  FaceChange add_vanished(std::span<const RemovalRecord> records, Index face, double reach);
  void clear();

  std::size_t size() const { return entries_.size(); }
  FaceChange operator[](std::size_t i) const;
  /// How many numbers of faces it holds.
  std::size_t face_count() const { return faces_.size(); }

 private:
  struct Entry {
    Index first, fresh, gone;  // of faces_: where they begin, and how many there are; fresh is kVanished of a piece
    float moved;
  };

  std::vector<Entry> entries_;
  std::vector<Index> faces_;  // of each: gone, and beside
};

/// By face, how far points are from a surface that does not change, or points of that from the face: at most, mesh
/// units. Faces that take others' places have these points, too, as far as they were moved.
struct FaceReach {
  std::vector<float> of;
  float largest = 0;  ///< of all so far

  explicit FaceReach(std::size_t face_count) : of(face_count, 0) {}
  void add(const FaceChange& change);
  void reset() {
    std::fill(of.begin(), of.end(), 0.0F);
    largest = 0;
  }
};

}  // namespace lodestone::detail
