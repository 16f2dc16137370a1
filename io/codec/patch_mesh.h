#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>

namespace lodestone::detail {

/// The faces of a level while rounds are coded, and what lies across their edges. Half-edge 3f + i runs from corner i
/// of face f to the next corner.
class PatchMesh {
 public:
  std::size_t face_count() const { return corners_.size() / 3; }
  std::size_t vertex_count() const { return degree_.size(); }
  Index from(Index half) const { return corners_[half]; }
  Index to(Index half) const { return corners_[next_corner(half)]; }
  Index apex(Index half) const { return corners_[previous_corner(half)]; }
  /// The half-edge the other way round, or kNoIndex at a border.
  Index twin(Index half) const { return twins_[half]; }
  /// How many faces a vertex has.
  Index degree(Index vertex) const { return degree_[vertex]; }
  /// In which round a face was made last.
  std::uint32_t made_in(Index face) const { return made_in_[face]; }
  const std::vector<Index>& corners() const { return corners_; }

  /// Starts with base faces: two half-edges with the same ends in opposite directions are twins. False where a face has
  /// a vertex twice, or an edge more than two faces, or two that disagree on its direction.
  bool start(std::vector<Index> corners, std::size_t vertex_count);

  /// Replaces a patch by the star of a new vertex: `polygon` is its outer half-edges in order; those of an open patch
  /// begin behind the closing edge, which is not among them. `faces`: its faces, as many as the star needs are
  /// appended. The star's faces go to `star`.
  void refine(std::span<const Index> polygon, std::span<const Index> faces, bool closed, std::uint32_t round,
              std::vector<Index>& star);
  /// Puts a face with a new vertex onto a border half-edge.
  void add_ear(Index half, std::uint32_t round, std::vector<Index>& star);

 private:
  struct Outer {
    Index from, to, twin;
  };
  void place_star(bool closed, std::span<const Index> faces, std::uint32_t round, std::vector<Index>& star);

  std::vector<Index> corners_;
  std::vector<Index> twins_;
  std::vector<Index> degree_;
  std::vector<std::uint32_t> made_in_;
  std::vector<Outer> outer_;
};

}  // namespace lodestone::detail
