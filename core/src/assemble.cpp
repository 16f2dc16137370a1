#include <lodestone/core/assemble.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>
#include <span>
#include <string>

#include "hash_index.h"

namespace lodestone {
namespace {

using detail::HashIndex;
using detail::mix_bits;

std::uint64_t position_hash(const Vec3f& p) {
  // Adding zero turns −0 into +0: the two are equal and have to hash alike.
  const auto bits = [](float f) { return std::uint64_t{std::bit_cast<std::uint32_t>(f + 0.0F)}; };
  return mix_bits(mix_bits(mix_bits(bits(p.x)) + bits(p.y)) + bits(p.z));
}

bool is_finite(const Vec3f& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

Result<void> check_lengths(const TriangleSoup& soup) {
  if (soup.positions.size() >= kNoIndex || soup.indices.size() >= kNoIndex)
    return fail(ErrorCode::InvalidArgument, "mesh of " + std::to_string(soup.positions.size()) + " points and " +
                                                std::to_string(soup.indices.size()) + " indices exceeds 32 bits");
  if (soup.indices.size() % 3 != 0)
    return fail(ErrorCode::InvalidArgument,
                "index count " + std::to_string(soup.indices.size()) + " is not a multiple of 3");
  if (!soup.face_material.empty() && soup.face_material.size() != soup.indices.size() / 3)
    return fail(ErrorCode::InvalidArgument, "material count " + std::to_string(soup.face_material.size()) +
                                                " differs from face count " + std::to_string(soup.indices.size() / 3));
  for (const Attribute& attribute : soup.attributes)
    if (attribute.component_count == 0 || attribute.data.size() != attribute.element_bytes() * soup.positions.size())
      return fail(ErrorCode::InvalidArgument, "attribute " + attribute.name + " has " +
                                                  std::to_string(attribute.data.size()) + " bytes for " +
                                                  std::to_string(soup.positions.size()) + " points of " +
                                                  std::to_string(attribute.element_bytes()));
  for (std::size_t i = 0; i < soup.indices.size(); ++i)
    if (soup.indices[i] >= soup.positions.size())
      return fail(ErrorCode::InvalidArgument, "index " + std::to_string(i) + " is " + std::to_string(soup.indices[i]) +
                                                  ", beyond the " + std::to_string(soup.positions.size()) + " points");
  return {};
}

/// Maps each used point to the first used point at the same position.
std::vector<Index> weld_positions(const TriangleSoup& soup, const std::vector<Index>& corners) {
  std::vector<Index> first_point(soup.positions.size(), kNoIndex);
  HashIndex table(soup.positions.size());
  for (const Index point : corners) {
    if (first_point[point] != kNoIndex) continue;
    const Vec3f& p = soup.positions[point];
    first_point[point] =
        table.find_or_insert(position_hash(p), point, [&](Index other) { return soup.positions[other] == p; });
  }
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
    for (std::size_t i = 0; i < bytes; ++i)
      hash = hash * 1099511628211ULL + std::to_integer<std::uint64_t>(attribute.data[point * bytes + i]);
  }
  return mix_bits(hash);
}

/// Maps each used point to the first used point with the same position and attributes.
std::vector<Index> weld_wedges(const TriangleSoup& soup, const std::vector<Index>& corners,
                               const std::vector<Index>& first_point) {
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

/// The triangles that remain, as points.
struct CleanFaces {
  std::vector<Index> corners;
  std::vector<Index> material;
};

CleanFaces drop_nonfinite(const TriangleSoup& soup, AssemblyReport& report) {
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

std::array<Index, 3> rotated_to_smallest(std::array<Index, 3> face) {
  std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
  return face;
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

/// A face that differs from another in any attribute, or in its material, is a sheet of its own on the same place.
void drop_duplicates(CleanFaces& faces, const std::vector<Index>& first_wedge, AssemblyReport& report) {
  std::vector<std::array<Index, 4>> seen;  // wedges and material
  HashIndex table(faces.corners.size() / 3);
  filter_faces(faces, [&](Index f) {
    const Index* c = &faces.corners[3 * std::size_t{f}];
    const auto face = rotated_to_smallest({first_wedge[c[0]], first_wedge[c[1]], first_wedge[c[2]]});
    const std::array<Index, 4> key{face[0], face[1], face[2], faces.material.empty() ? 0 : faces.material[f]};
    const std::uint64_t hash = mix_bits(mix_bits(mix_bits(mix_bits(key[0]) + key[1]) + key[2]) + key[3]);
    const auto candidate = static_cast<Index>(seen.size());
    const bool is_new =
        table.find_or_insert(hash, candidate, [&](Index other) { return seen[other] == key; }) == candidate;
    if (is_new) seen.push_back(key);
    report.duplicate_faces += is_new ? 0 : 1;
    return is_new;
  });
}

/// Copies the welded points into a mesh, vertices and wedges numbered by first use.
Mesh number_by_first_use(const TriangleSoup& soup, const CleanFaces& faces, const std::vector<Index>& first_point,
                         const std::vector<Index>& first_wedge) {
  Mesh mesh;
  std::vector<Index> vertex_of(soup.positions.size(), kNoIndex);
  std::vector<Index> wedge_of(soup.positions.size(), kNoIndex);
  std::vector<Index> source;
  mesh.corner_wedge.reserve(faces.corners.size());
  for (const Index point : faces.corners) {
    Index& vertex = vertex_of[first_point[point]];
    if (vertex == kNoIndex) {
      vertex = static_cast<Index>(mesh.positions.size());
      mesh.positions.push_back(soup.positions[first_point[point]]);
    }
    Index& wedge = wedge_of[first_wedge[point]];
    if (wedge == kNoIndex) {
      wedge = static_cast<Index>(mesh.wedge_vertex.size());
      mesh.wedge_vertex.push_back(vertex);
      source.push_back(first_wedge[point]);
    }
    mesh.corner_wedge.push_back(wedge);
  }
  mesh.face_material = faces.material;
  for (const Attribute& attribute : soup.attributes) mesh.attributes.push_back(pick_elements(attribute, source));
  return mesh;
}

/// Groups the corners of each vertex into fans: connected across the edges that two faces share with opposite winding.
class FanFinder {
 public:
  explicit FanFinder(const Mesh& mesh) : parent_(mesh.corner_wedge.size()) {
    std::iota(parent_.begin(), parent_.end(), Index{0});
    join_across_edges(mesh);
  }
  std::size_t nonmanifold_edges() const { return nonmanifold_edges_; }
  Index fan_of(Index corner) {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }

 private:
  struct HalfEdge {
    std::uint64_t key;  // the smaller vertex in the high half
    Index corner;       // the edge leaves this corner
    bool forward;       // from the smaller to the larger vertex
  };

  void join_across_edges(const Mesh& mesh) {
    std::vector<HalfEdge> edges(mesh.corner_wedge.size());
    for (Index c = 0; c < edges.size(); ++c) {
      const std::uint64_t a = mesh.corner_vertex(c);
      const std::uint64_t b = mesh.corner_vertex(next_corner(c));
      edges[c] = {a < b ? a << 32 | b : b << 32 | a, c, a < b};
    }
    std::sort(edges.begin(), edges.end(), [](const HalfEdge& a, const HalfEdge& b) {
      return a.key != b.key ? a.key < b.key : a.corner < b.corner;
    });
    for (std::size_t i = 0, j = 0; i < edges.size(); i = j) {
      while (j < edges.size() && edges[j].key == edges[i].key) ++j;
      if (j - i == 2 && edges[i].forward != edges[i + 1].forward)
        join_faces(edges[i].corner, edges[i + 1].corner);
      else if (j - i > 1)
        ++nonmanifold_edges_;
    }
  }
  /// Joins two faces across an edge that leaves `a` in the one and `b` in the other.
  void join_faces(Index a, Index b) {
    join(a, next_corner(b));
    join(next_corner(a), b);
  }
  void join(Index a, Index b) {
    a = fan_of(a);
    b = fan_of(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  std::vector<Index> parent_;
  std::size_t nonmanifold_edges_ = 0;
};

/// Gives every fan but the first of a vertex a vertex of its own, at the same position, and copies of its wedges.
void cut_into_fans(Mesh& mesh, AssemblyReport& report) {
  FanFinder fans(mesh);
  report.nonmanifold_edges = fans.nonmanifold_edges();
  const std::size_t vertex_count = mesh.vertex_count();
  std::vector<Index> first_fan(vertex_count, kNoIndex);
  std::vector<Index> fan_vertex(mesh.corner_wedge.size(), kNoIndex);
  std::vector<bool> is_cut(vertex_count, false);
  for (Index c = 0; c < mesh.corner_wedge.size(); ++c) {
    const Index vertex = mesh.corner_vertex(c);
    const Index fan = fans.fan_of(c);
    if (first_fan[vertex] == kNoIndex) first_fan[vertex] = fan;
    if (fan_vertex[fan] != kNoIndex) continue;
    fan_vertex[fan] = vertex;
    if (first_fan[vertex] == fan) continue;
    fan_vertex[fan] = static_cast<Index>(mesh.positions.size());
    mesh.positions.push_back(mesh.positions[vertex]);
    report.cut_vertices += is_cut[vertex] ? 0 : 1;
    is_cut[vertex] = true;
  }
  if (report.cut_vertices == 0) return;

  std::vector<std::uint64_t> copies;  // (wedge, vertex) pairs that need a copy of the wedge, in order of first use
  HashIndex table(mesh.corner_wedge.size());
  const std::size_t wedge_count = mesh.wedge_count();
  for (Index c = 0; c < mesh.corner_wedge.size(); ++c) {
    const Index vertex = fan_vertex[fans.fan_of(c)];
    const Index wedge = mesh.corner_wedge[c];
    if (mesh.wedge_vertex[wedge] == vertex) continue;
    const std::uint64_t pair = std::uint64_t{wedge} << 32 | vertex;
    const auto candidate = static_cast<Index>(copies.size());
    const Index copy = table.find_or_insert(mix_bits(pair), candidate, [&](Index i) { return copies[i] == pair; });
    if (copy == candidate) {
      copies.push_back(pair);
      mesh.wedge_vertex.push_back(vertex);
    }
    mesh.corner_wedge[c] = static_cast<Index>(wedge_count) + copy;
  }
  for (Attribute& attribute : mesh.attributes) {
    const std::size_t bytes = attribute.element_bytes();
    attribute.data.resize(bytes * mesh.wedge_count());
    for (std::size_t i = 0; i < copies.size(); ++i)
      std::memcpy(&attribute.data[(wedge_count + i) * bytes], &attribute.data[(copies[i] >> 32) * bytes], bytes);
  }
}

}  // namespace

Result<AssembledMesh> assemble(const TriangleSoup& soup) {
  if (auto checked = check_lengths(soup); !checked) return tl::unexpected(checked.error());
  AssembledMesh result;
  AssemblyReport& report = result.report;
  CleanFaces faces = drop_nonfinite(soup, report);
  const std::vector<Index> first_point = weld_positions(soup, faces.corners);
  drop_degenerate(faces, first_point, report);
  const std::vector<Index> first_wedge = weld_wedges(soup, faces.corners, first_point);
  drop_duplicates(faces, first_wedge, report);
  result.mesh = number_by_first_use(soup, faces, first_point, first_wedge);

  std::vector<bool> used(soup.positions.size(), false);
  for (const Index point : soup.indices) used[point] = true;
  report.unused_points = static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
  cut_into_fans(result.mesh, report);
  return result;
}

TriangleSoup to_soup(const Mesh& mesh) {
  TriangleSoup soup;
  soup.positions.reserve(mesh.wedge_count());
  for (const Index vertex : mesh.wedge_vertex) soup.positions.push_back(mesh.positions[vertex]);
  soup.attributes = mesh.attributes;
  soup.indices = mesh.corner_wedge;
  soup.face_material = mesh.face_material;
  return soup;
}

}  // namespace lodestone
