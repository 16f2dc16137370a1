#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <lodestone/core/ids.h>

namespace lodestone::detail {

/// What names a face: its three corners in some numbering of vertices, ascending.
using FaceName = std::array<Index, 3>;

/// Finds faces by their names. It keeps these, to look them up fast in meshes of millions of faces: 12 bytes a face and
/// 4 a vertex, since where a name is kept and two of its numbers say what the third is.
class FaceNames {
 public:
  /// Vertices and faces are numbered below these counts; without any nothing is found.
  explicit FaceNames(std::size_t vertex_count = 0, std::size_t face_count = 0)
      : first_(vertex_count, kNoIndex), entries_(face_count) {}

  /// Returns the face that has a name, or kNoIndex.
  Index find(const FaceName& name) const {
    Index face = first_.empty() ? kNoIndex : first_[list_of(name)];
    while (face != kNoIndex && !entries_[face].is(name)) face = entries_[face].next;
    return face;
  }

  /// Gives a face its name, once, unless another one has it; returns the one that has.
  Index insert(const FaceName& name, Index face) {
    Index* link = &first_[list_of(name)];
    while (*link != kNoIndex) {
      Entry& entry = entries_[*link];
      if (entry.is(name)) return *link;
      link = &entry.next;
    }
    entries_[face] = {name[1], name[2], kNoIndex};
    return *link = face;
  }

 private:
  struct Entry {
    Index middle = kNoIndex, high = kNoIndex;
    Index next = kNoIndex;  // of the same list

    bool is(const FaceName& name) const { return middle == name[1] && high == name[2]; }
  };

  /// The lowest number, moved on by what the other two say: no two names with the same two are in one list.
  std::size_t list_of(const FaceName& name) const {
    const std::uint64_t mixed = (std::uint64_t{name[1]} << 32 | name[2]) * 0x9e3779b97f4a7c15ULL;
    const std::size_t list = name[0] + static_cast<std::size_t>((mixed >> 32) * first_.size() >> 32);
    return list < first_.size() ? list : list - first_.size();
  }

  std::vector<Index> first_;    // of each list; there are as many as vertices
  std::vector<Entry> entries_;  // by face
};

}  // namespace lodestone::detail
