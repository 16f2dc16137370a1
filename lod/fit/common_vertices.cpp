#include "fit/common_vertices.h"

#include <lodestone/core/detail/grouping.h>

namespace lodestone::detail {

CommonVertices::CommonVertices(const Mesh& original)
    : original_(original), index_(original.positions), place_(index_.add_all()) {}

std::vector<Index> CommonVertices::faces_near(const Mesh& level) const {
  std::vector<Index> near(original_.vertex_count(), kNoIndex);
  for (Index c = 0; c < level.corner_wedge.size(); ++c) {
    const Index place = index_.find(level.positions[level.corner_vertex(c)]);
    if (place != kNoIndex && near[place] == kNoIndex) near[place] = face_of_corner(c);
  }
  spread(near);
  for (Index v = 0; v < near.size(); ++v) near[v] = near[place_[v]];
  return near;
}

std::vector<Index> CommonVertices::faces_at(const Mesh& level) const {
  std::vector<Index> of_place(original_.vertex_count(), kNoIndex);
  for (Index c = static_cast<Index>(original_.corner_wedge.size()); c-- > 0;)
    of_place[place_[original_.corner_vertex(c)]] = face_of_corner(c);
  std::vector<Index> faces(level.face_count(), kNoIndex);
  for (Index f = 0; f < faces.size(); ++f) {
    const Index place = index_.find(level.positions[level.corner_vertex(3 * f)]);
    if (place != kNoIndex) faces[f] = of_place[place];
  }
  return faces;
}

/// Gives all places what those that have something have, along the fewest edges.
void CommonVertices::spread(std::vector<Index>& of_place) const {
  const auto place_at = [&](Index corner) { return place_[original_.corner_vertex(corner)]; };
  const Grouping corners(of_place.size(), original_.corner_wedge.size(), place_at);
  std::vector<Index> reached;
  for (Index place = 0; place < of_place.size(); ++place)
    if (of_place[place] != kNoIndex) reached.push_back(place);
  for (std::size_t i = 0; i < reached.size(); ++i)
    for (const Index corner : corners[reached[i]])
      for (const Index other : {place_at(next_corner(corner)), place_at(previous_corner(corner))}) {
        if (of_place[other] != kNoIndex) continue;
        of_place[other] = of_place[reached[i]];
        reached.push_back(other);
      }
}

}  // namespace lodestone::detail
