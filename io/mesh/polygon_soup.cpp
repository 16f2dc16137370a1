#include "mesh/polygon_soup.h"

#include <utility>

#include <lodestone/core/detail/compaction.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "mesh/polygon_split.h"

namespace lodestone::detail {
namespace {

void append_picked(std::span<const Attribute> attributes, std::span<const Index> numbers, TriangleSoup& soup) {
  for (const Attribute& attribute : attributes) soup.attributes.push_back(pick_elements(attribute, numbers));
}

/// Makes a point of every corner of every triangle.
TriangleSoup expanded(const PolygonSoup& polygons, const SplitPolygons& split) {
  TriangleSoup soup;
  const std::vector<Index> vertices = pick_entries(polygons.corners, split.corners);
  std::vector<Index> faces;
  faces.reserve(split.corners.size());
  for (const Index polygon : split.polygon) faces.insert(faces.end(), 3, polygon);
  soup.positions = pick_entries(polygons.positions, vertices);
  append_picked(polygons.vertex_attributes, vertices, soup);
  append_picked(polygons.corner_attributes, split.corners, soup);
  append_picked(polygons.face_attributes, faces, soup);
  for (std::size_t i = 0; i < soup.positions.size(); ++i) soup.indices.push_back(static_cast<Index>(i));
  return soup;
}

void add_notes(const SplitPolygons& split, std::vector<std::string>& notes) {
  if (split.short_count > 0)
    notes.push_back(text(split.short_count, " faces with fewer than three corners are left out"));
  if (split.crossed_count > 0)
    notes.push_back(text(split.crossed_count, " polygons cross themselves or are too long to split well: made fans"));
}

}  // namespace

Result<TriangleSoup> to_triangles(PolygonSoup polygons, std::vector<std::string>& notes) {
  if (polygons.positions.size() >= kNoIndex || 3 * polygons.corners.size() >= kNoIndex)  // 3 a triangle, at most
    return fail(ErrorCode::LimitExceeded, text(polygons.positions.size(), " vertices and ", polygons.corners.size(),
                                               " corners are more than 32 bits can number"));
  const SplitPolygons split = split_polygons(pick_entries(polygons.positions, polygons.corners), polygons.sizes);
  add_notes(split, notes);
  TriangleSoup soup;
  if (!polygons.corner_attributes.empty() || !polygons.face_attributes.empty()) {
    soup = expanded(polygons, split);
  } else {
    soup.indices = pick_entries(polygons.corners, split.corners);
    soup.positions = std::move(polygons.positions);
    soup.attributes = std::move(polygons.vertex_attributes);
  }
  if (!polygons.face_material.empty()) soup.face_material = pick_entries(polygons.face_material, split.polygon);
  return soup;
}

}  // namespace lodestone::detail
