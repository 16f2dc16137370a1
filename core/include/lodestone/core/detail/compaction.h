#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Gives numbers without gaps to those of many things that are used.
class Compaction {
 public:
  explicit Compaction(std::size_t count) : number_(count, kNoIndex) {}

  /// Returns a thing's new number: the next one where it has none yet.
  Index add(Index thing) {
    Index& number = number_[thing];
    if (number == kNoIndex) {
      number = static_cast<Index>(used_.size());
      used_.push_back(thing);
    }
    return number;
  }

  /// Returns a thing's new number; kNoIndex where it has none.
  Index number(Index thing) const { return number_[thing]; }
  /// Returns the things that have one, in the order of these.
  const std::vector<Index>& used() const { return used_; }

 private:
  std::vector<Index> number_;
  std::vector<Index> used_;
};

/// Numbers those of `count` things that are in `used`, in the order they had before.
Compaction in_old_order(std::size_t count, std::span<const Index> used);

/// Returns some entries of an array, in the order given.
template <class Array>
std::vector<typename Array::value_type> pick_entries(const Array& array, std::span<const Index> entries) {
  std::vector<typename Array::value_type> picked;
  picked.reserve(entries.size());
  for (const Index entry : entries) picked.push_back(array[entry]);
  return picked;
}

/// A mesh without attributes and materials, and where it came from.
struct CompactedMesh {
  Mesh mesh;
  std::vector<Index> source_vertex;  ///< by vertex of the mesh
  std::vector<Index> source_wedge;   ///< by wedge of the mesh
};

/// Makes a mesh of triangles: of the wedges and vertices that they use, numbered in order of first use.
CompactedMesh compacted(std::span<const Vec3f> positions, std::span<const Index> wedge_vertex,
                        std::span<const Index> corner_wedge);

}  // namespace lodestone::detail
