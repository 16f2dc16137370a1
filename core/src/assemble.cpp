#include <lodestone/core/assemble.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <span>
#include <string>
#include <utility>

#include <lodestone/core/detail/compaction.h>
#include <lodestone/core/detail/edges.h>
#include <lodestone/core/detail/finite.h>
#include <lodestone/core/detail/hash_index.h>
#include <lodestone/core/detail/index_limit.h>
#include <lodestone/core/detail/position_index.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "fans.h"
#include "winding.h"

// From triangles to a manifold mesh: points at one position become one vertex, by hashing their coordinates, with one
// wedge for each set of attributes; then faces are wound alike (winding.cpp) and what is not manifold is cut and
// stitched (fans.cpp). Positions are compared exactly, never within a distance: a tolerance would join what the file
// keeps apart.

namespace lodestone {
namespace {

using detail::compacted;
using detail::CompactedMesh;
using detail::cut_into_fans;
using detail::HalfEdge;
using detail::HashIndex;
using detail::is_finite;
using detail::make_winding_coherent;
using detail::mix_bits;
using detail::pick_entries;
using detail::PositionIndex;
using detail::sorted_edges;
using detail::text;

Result<void> check_lengths(const TriangleSoup& soup) {
  LODESTONE_CHECK(detail::check_index_limit("points", soup.positions.size()));
  LODESTONE_CHECK(detail::check_index_limit("corners", soup.indices.size()));
  if (soup.indices.size() % 3 != 0)
    return fail(ErrorCode::InvalidArgument, text("index count ", soup.indices.size(), " is not a multiple of 3"));
  if (!soup.face_material.empty() && soup.face_material.size() != soup.indices.size() / 3)
    return fail(ErrorCode::InvalidArgument, text("material count ", soup.face_material.size(),
                                                 " differs from face count ", soup.indices.size() / 3));
  if (!soup.point_sheet.empty() && soup.point_sheet.size() != soup.positions.size())
    return fail(ErrorCode::InvalidArgument,
                text("sheet count ", soup.point_sheet.size(), " differs from point count ", soup.positions.size()));
  for (const Attribute& attribute : soup.attributes)
    if (attribute.component_count == 0 || attribute.data.size() != attribute.element_bytes() * soup.positions.size())
      return fail(ErrorCode::InvalidArgument,
                  text("attribute ", attribute.name, " has ", attribute.data.size(), " bytes for ",
                       soup.positions.size(), " points of ", attribute.element_bytes()));
  Index largest = 0;
  for (const Index index : soup.indices) largest = std::max(largest, index);
  if (soup.indices.empty() || largest < soup.positions.size()) return {};
  const auto beyond = std::find_if(soup.indices.begin(), soup.indices.end(),
                                   [&](Index index) { return index >= soup.positions.size(); });
  return fail(ErrorCode::InvalidArgument, text("index ", beyond - soup.indices.begin(), " is ", *beyond,
                                               ", beyond the ", soup.positions.size(), " points"));
}

/// Maps each used point to the first used point at the same position.
std::vector<Index> weld_positions(const TriangleSoup& soup, const std::vector<Index>& corners) {
  std::vector<Index> first_point(soup.positions.size(), kNoIndex);
  PositionIndex table(soup.positions);
  for (const Index point : corners)
    if (first_point[point] == kNoIndex) first_point[point] = table.add(point);
  return first_point;
}

bool same_attributes(const TriangleSoup& soup, Index a, Index b) {
  return std::all_of(soup.attributes.begin(), soup.attributes.end(), [&](const Attribute& attribute) {
    const std::size_t bytes = attribute.element_bytes();
    return std::memcmp(&attribute.data[a * bytes], &attribute.data[b * bytes], bytes) == 0;
  });
}

std::uint64_t attribute_hash(const TriangleSoup& soup, Index point) {
  std::uint64_t hash = 0;
  for (const Attribute& attribute : soup.attributes) {
    const std::size_t bytes = attribute.element_bytes();
    for (std::size_t i = 0; i < bytes; i += sizeof(std::uint64_t)) {
      std::uint64_t word = 0;
      std::memcpy(&word, &attribute.data[point * bytes + i], std::min(sizeof word, bytes - i));
      hash = mix_bits(hash + word);
    }
  }
  return hash;
}

/// Maps each used point to the first used point with the same position and attributes.
std::vector<Index> weld_wedges(const TriangleSoup& soup, const std::vector<Index>& corners,
                               const std::vector<Index>& first_point) {
  if (soup.attributes.empty()) return first_point;
  std::vector<Index> first_wedge(soup.positions.size(), kNoIndex);
  HashIndex table(soup.positions.size());
  for (const Index point : corners) {
    if (first_wedge[point] != kNoIndex) continue;
    const std::uint64_t hash = mix_bits(attribute_hash(soup, point) + first_point[point]);
    first_wedge[point] = table.find_or_insert(hash, point, [&](Index other) {
      return first_point[other] == first_point[point] && same_attributes(soup, other, point);
    });
  }
  return first_wedge;
}

/// Maps each used point to the first used one of the same wedge and sheet.
std::vector<Index> weld_sheets(const TriangleSoup& soup, const std::vector<Index>& corners,
                               const std::vector<Index>& first_wedge) {
  if (soup.point_sheet.empty()) return first_wedge;
  std::vector<Index> first(soup.positions.size(), kNoIndex);
  HashIndex table(soup.positions.size());
  for (const Index point : corners) {
    if (first[point] != kNoIndex) continue;
    const std::uint64_t hash = mix_bits(mix_bits(first_wedge[point]) + soup.point_sheet[point]);
    first[point] = table.find_or_insert(hash, point, [&](Index other) {
      return first_wedge[other] == first_wedge[point] && soup.point_sheet[other] == soup.point_sheet[point];
    });
  }
  return first;
}

/// The triangles that remain, as points.
struct CleanFaces {
  std::vector<Index> corners;
  std::vector<Index> material;
};

CleanFaces drop_nonfinite(const TriangleSoup& soup, AssemblyReport& report) {
  if (std::all_of(soup.positions.begin(), soup.positions.end(), is_finite)) return {soup.indices, soup.face_material};
  CleanFaces faces;
  faces.corners.reserve(soup.indices.size());
  for (std::size_t i = 0; i < soup.indices.size(); i += 3) {
    const auto corner = std::span(soup.indices).subspan(i, 3);
    if (!std::all_of(corner.begin(), corner.end(), [&](Index p) { return is_finite(soup.positions[p]); })) {
      ++report.nonfinite_faces;
      continue;
    }
    faces.corners.insert(faces.corners.end(), corner.begin(), corner.end());
    if (!soup.face_material.empty()) faces.material.push_back(soup.face_material[i / 3]);
  }
  return faces;
}

std::array<Index, 3> rotated_to_smallest(const std::array<Index, 3>& face) {
  const auto [a, b, c] = face;
  const std::array<Index, 5> twice{a, b, c, a, b};
  const std::size_t first = b < a ? (c < b ? 2 : 1) : (c < a ? 2 : 0);
  return {twice[first], twice[first + 1], twice[first + 2]};
}

/// Keeps the faces for which `keep(f)` holds.
template <class Keep>
void filter_faces(CleanFaces& faces, const Keep& keep) {
  Index kept = 0;
  for (Index f = 0; f < faces.corners.size() / 3; ++f) {
    if (!keep(f)) continue;
    std::copy_n(faces.corners.begin() + 3 * std::ptrdiff_t{f}, 3, faces.corners.begin() + 3 * std::ptrdiff_t{kept});
    if (!faces.material.empty()) faces.material[kept] = faces.material[f];
    ++kept;
  }
  faces.corners.resize(3 * std::size_t{kept});
  if (!faces.material.empty()) faces.material.resize(kept);
}

void drop_degenerate(CleanFaces& faces, const std::vector<Index>& first_point, AssemblyReport& report) {
  filter_faces(faces, [&](Index f) {
    const Index* c = &faces.corners[3 * std::size_t{f}];
    const std::array<Index, 3> face{first_point[c[0]], first_point[c[1]], first_point[c[2]]};
    const bool degenerate = face[0] == face[1] || face[1] == face[2] || face[0] == face[2];
    report.degenerate_faces += degenerate ? 1 : 0;
    return !degenerate;
  });
}

/// Numbers distinct faces in order of first appearance.
class FaceIndex {
 public:
  /// Corners, the smallest first, and the material.
  using Key = std::array<Index, 4>;

  FaceIndex(std::size_t point_count, std::size_t face_count)
      : newest_(point_count, kNoIndex), length_(point_count, 0), face_count_(face_count) {
    faces_.reserve(face_count);
    older_.reserve(face_count);
  }

  /// Returns whether the face is new.
  bool add(const Key& key) {
    for (Index face = newest_[key[0]]; face != kNoIndex; face = older_[face])
      if (same(faces_[face], key)) return false;
    const auto candidate = static_cast<Index>(faces_.size());
    if (length_[key[0]] == kMostInList) return add_to_table(key);
    ++length_[key[0]];
    faces_.push_back(key);
    older_.push_back(std::exchange(newest_[key[0]], candidate));
    return true;
  }

 private:
  static constexpr std::uint8_t kMostInList = 32;  // beyond, comparing them all costs too much

  /// What == of arrays calls a function for.
  static bool same(const Key& a, const Key& b) { return a[0] == b[0] && a[1] == b[1] && a[2] == b[2] && a[3] == b[3]; }

  bool add_to_table(const Key& key) {
    if (!table_) table_ = std::make_unique<HashIndex>(face_count_);
    const std::uint64_t hash = mix_bits(mix_bits(mix_bits(mix_bits(key[0]) + key[1]) + key[2]) + key[3]);
    const auto candidate = static_cast<Index>(faces_.size());
    if (table_->find_or_insert(hash, candidate, [&](Index other) { return same(faces_[other], key); }) != candidate)
      return false;
    faces_.push_back(key);
    older_.push_back(kNoIndex);
    return true;
  }

  // By smallest corner the first faces, in a list: points and faces that lie together in the mesh do so here, too.
  std::vector<Index> newest_;
  std::vector<std::uint8_t> length_;
  std::vector<Key> faces_;
  std::vector<Index> older_;
  std::size_t face_count_;
  std::unique_ptr<HashIndex> table_;  ///< of all others
};

/// A face that differs from another in any attribute, or in its material, is a sheet of its own on the same place.
void drop_duplicates(CleanFaces& faces, const std::vector<Index>& first_same, AssemblyReport& report) {
  FaceIndex seen(first_same.size(), faces.corners.size() / 3);
  filter_faces(faces, [&](Index f) {
    const Index* c = &faces.corners[3 * std::size_t{f}];
    const auto face = rotated_to_smallest({first_same[c[0]], first_same[c[1]], first_same[c[2]]});
    const bool is_new = seen.add({face[0], face[1], face[2], faces.material.empty() ? 0 : faces.material[f]});
    report.duplicate_faces += is_new ? 0 : 1;
    return is_new;
  });
}

/// Copies the welded points into a mesh, vertices and wedges numbered by first use.
Mesh number_by_first_use(const TriangleSoup& soup, const CleanFaces& faces, const std::vector<Index>& first_point,
                         const std::vector<Index>& first_wedge) {
  CompactedMesh result = compacted(soup.positions, first_point, pick_entries(first_wedge, faces.corners));
  result.mesh.face_material = faces.material;
  for (const Attribute& attribute : soup.attributes)
    result.mesh.attributes.push_back(pick_elements(attribute, result.source_wedge));
  return std::move(result.mesh);
}

}  // namespace

AssemblyReport operator+(const AssemblyReport& a, const AssemblyReport& b) {
  return {a.nonfinite_faces + b.nonfinite_faces, a.degenerate_faces + b.degenerate_faces,
          a.duplicate_faces + b.duplicate_faces, a.unused_points + b.unused_points,
          a.turned_faces + b.turned_faces,       a.nonmanifold_edges + b.nonmanifold_edges,
          a.cut_vertices + b.cut_vertices};
}

Result<AssembledMesh> assemble(const TriangleSoup& soup, const AssemblyOptions& options) {
  LODESTONE_CHECK(check_lengths(soup));
  AssembledMesh result;
  AssemblyReport& report = result.report;
  CleanFaces faces = drop_nonfinite(soup, report);
  const std::vector<Index> first_point = weld_positions(soup, faces.corners);
  drop_degenerate(faces, first_point, report);
  const std::vector<Index> first_wedge = weld_wedges(soup, faces.corners, first_point);
  drop_duplicates(faces, weld_sheets(soup, faces.corners, first_wedge), report);
  result.mesh = number_by_first_use(soup, faces, first_point, first_wedge);

  std::vector<std::uint8_t> used(soup.positions.size(), 0);
  for (const Index point : soup.indices) used[point] = 1;
  report.unused_points = static_cast<std::size_t>(std::count(used.begin(), used.end(), 0));
  std::vector<HalfEdge> halves = sorted_edges(result.mesh);
  if (options.turn_faces) report.turned_faces = make_winding_coherent(result.mesh, halves);
  if (report.turned_faces > 0) halves = sorted_edges(result.mesh);
  cut_into_fans(result.mesh, halves, report);
  return result;
}

TriangleSoup to_soup(const Mesh& mesh) {
  TriangleSoup soup;
  soup.positions = pick_entries(mesh.positions, mesh.wedge_vertex);
  soup.attributes = mesh.attributes;
  soup.indices = mesh.corner_wedge;
  soup.face_material = mesh.face_material;
  return soup;
}

}  // namespace lodestone
