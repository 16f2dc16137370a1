#include "simplify/plain_star.h"

#include <algorithm>
#include <bit>

#include "simplify/site_walk.h"

namespace lodestone::detail {

bool PlainStar::gather(const Mesh& mesh, const Connectivity& connectivity, const FaceRules& rules, Index of_vertex) {
  vertex = of_vertex;
  if (!gather_ring(connectivity)) return false;
  center = Vec3(mesh.positions[vertex]);
  gather_shapes(mesh, rules);
  return true;
}

bool PlainStar::gather_ring(const Connectivity& connectivity) {
  const Index start = connectivity.corner_at(vertex);
  wedge = connectivity.wedge(start);
  size = 0;
  site_filter = 0;
  Index at_last_spoke = kNoIndex;  // the ring's wedge there, as the face before sees it
  const Index material = connectivity.material(face_of_corner(start));
  for (Index c = start;;) {
    const Index at_spoke = connectivity.wedge(next_corner(c));
    if (size == kMaxSize || connectivity.wedge(c) != wedge || connectivity.is_crease(previous_corner(c)) ||
        connectivity.material(face_of_corner(c)) != material || (size > 0 && at_spoke != at_last_spoke))
      return false;
    corner[size] = c;
    ring_wedge[size] = at_spoke;
    ring_vertex[size] = connectivity.vertex_of_wedge(at_spoke);
    ring_site[size] = connectivity.site(ring_vertex[size]);
    site_filter |= std::uint64_t{1} << (ring_site[size] % 64);
    ++size;
    at_last_spoke = connectivity.wedge(previous_corner(c));
    c = connectivity.swing_left(c);
    if (c == kNoIndex) return false;
    if (c == start) return size >= 3 && at_last_spoke == ring_wedge[0];
  }
}

void PlainStar::gather_shapes(const Mesh& mesh, const FaceRules& rules) {
  for (std::size_t i = 0; i < size; ++i) spoke[i] = Vec3(mesh.positions[ring_vertex[i]]) - center;
  Ring<double> square;  // of spokes
  for (std::size_t i = 0; i < size; ++i) square[i] = squared_length(spoke[i]);
  faces = {};
  for (std::size_t i = 0; i < size; ++i) {
    const std::size_t next = after(i);
    normal[i] = cross(spoke[i], spoke[next]);
    squared_normal[i] = squared_length(normal[i]);
    const double longest = std::max({square[i], squared_length(spoke[next] - spoke[i]), square[next]});
    has_direction[i] = rules.has_direction(squared_normal[i], longest);
    rules.add(normal[i], squared_normal[i], longest, faces);
  }
}

bool is_simple(const PlainStar& star, const Connectivity& mesh) {
  const PlainStar::Ring<Index>& site = star.ring_site;
  // As many bits as sites: all differ.
  if (static_cast<std::size_t>(std::popcount(star.site_filter)) < star.size)
    for (std::size_t i = 0; i < star.size; ++i)
      for (std::size_t j = i + 1; j < star.size; ++j)
        if (site[i] == site[j]) return false;
  return star.size > 3 || !(has_face(mesh, star.ring_vertex[0], site[1], site[2]) ||
                            has_face(mesh, star.ring_vertex[0], site[2], site[1]));
}

std::uint32_t linked_ring(const PlainStar& star, const Connectivity& mesh, std::size_t to) {
  std::uint32_t linked = 0;
  for_each_neighbour(mesh, star.ring_vertex[to], [&](Index, Index neighbour) {
    const Index site = mesh.site(neighbour);
    if (!star.may_be_on_ring(site)) return;
    for (std::size_t k = 0; k < star.size; ++k)
      if (star.ring_site[k] == site) linked |= std::uint32_t{1} << k;
  });
  return linked;
}

}  // namespace lodestone::detail
