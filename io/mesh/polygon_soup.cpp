#include "mesh/polygon_soup.h"

#include <algorithm>
#include <cstring>
#include <span>
#include <utility>

#include <lodestone/core/detail/compaction.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "mesh/polygon_split.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kMostCompared = 16;  // points of a vertex: one that has more is of no use to compare them all

Index element_of(const CornerAttribute& attribute, Index corner) {
  return attribute.elements.empty() ? corner : attribute.elements[corner];
}

/// Makes points of corners: corners of one vertex share one where their attributes and their polygons' agree. That
/// `assemble` would join them, too; but there are six times as many corners as vertices.
class CornerJoiner {
 public:
  explicit CornerJoiner(const PolygonSoup& polygons)
      : polygons_(polygons), newest_(polygons.positions.size(), kNoIndex) {
    for (const Attribute& a : polygons.vertex_attributes)
      if (a.name == "NORMAL") vertex_normals_ = &a;
    for (const CornerAttribute& a : polygons.corner_attributes)
      if (a.values.name == "NORMAL") corner_normals_ = &a;
  }

  /// Returns a corner's point.
  Index point_of(Index corner, Index polygon) {
    Index& newest = newest_[polygons_.corners[corner]];
    std::size_t compared = 0;
    for (Index point = newest; point != kNoIndex && compared < kMostCompared; point = older_[point], ++compared)
      if (agree(point, corner, polygon)) return point;
    const auto point = static_cast<Index>(corners_.size());
    corners_.push_back(corner);
    faces_.push_back(polygon);
    older_.push_back(newest);
    if (may_be_shared(corner)) newest = point;
    return point;
  }

  /// The first corner of each point, and its polygon.
  const std::vector<Index>& corners() const { return corners_; }
  const std::vector<Index>& polygons() const { return faces_; }

 private:
  static bool same_element(const Attribute& attribute, Index a, Index b) {
    const std::size_t bytes = attribute.element_bytes();
    return a == b || std::memcmp(&attribute.data[a * bytes], &attribute.data[b * bytes], bytes) == 0;
  }

  bool agree(Index point, Index corner, Index polygon) const {
    const auto corners_agree = [&](const CornerAttribute& a) {
      return same_element(a.values, element_of(a, corners_[point]), element_of(a, corner));
    };
    const auto polygons_agree = [&](const Attribute& a) { return same_element(a, faces_[point], polygon); };
    return std::all_of(polygons_.corner_attributes.begin(), polygons_.corner_attributes.end(), corners_agree) &&
           std::all_of(polygons_.face_attributes.begin(), polygons_.face_attributes.end(), polygons_agree);
  }

  /// A normal without a direction gets that of its own face.
  bool may_be_shared(Index corner) const {
    const auto has = [](const Attribute& normals, Index element) {
      return has_direction(Vec3(load<Vec3f>(normals.data, element * sizeof(Vec3f))));
    };
    return (corner_normals_ == nullptr || has(corner_normals_->values, element_of(*corner_normals_, corner))) &&
           (vertex_normals_ == nullptr || has(*vertex_normals_, polygons_.corners[corner]));
  }

  const PolygonSoup& polygons_;
  const Attribute* vertex_normals_ = nullptr;
  const CornerAttribute* corner_normals_ = nullptr;
  std::vector<Index> newest_;  ///< by vertex: its newest point that may be shared
  std::vector<Index> older_;   ///< by point: the next of its vertex
  std::vector<Index> corners_, faces_;
};

void append_picked(std::span<const Attribute> attributes, std::span<const Index> numbers, TriangleSoup& soup) {
  for (const Attribute& attribute : attributes) soup.attributes.push_back(pick_elements(attribute, numbers));
}

/// Makes points of corners with attributes.
void add_points(const PolygonSoup& polygons, const SplitPolygons& split, TriangleSoup& soup) {
  CornerJoiner joiner(polygons);
  soup.indices.reserve(split.corners.size());
  for (std::size_t i = 0; i < split.corners.size(); ++i)
    soup.indices.push_back(joiner.point_of(split.corners[i], split.polygon[i / 3]));
  const std::vector<Index> vertices = pick_entries(polygons.corners, joiner.corners());
  soup.positions = pick_entries(polygons.positions, vertices);
  append_picked(polygons.vertex_attributes, vertices, soup);
  for (const CornerAttribute& a : polygons.corner_attributes) {
    std::vector<Index> elements;
    elements.reserve(joiner.corners().size());
    for (const Index corner : joiner.corners()) elements.push_back(element_of(a, corner));
    soup.attributes.push_back(pick_elements(a.values, elements));
  }
  append_picked(polygons.face_attributes, joiner.polygons(), soup);
}

bool all_are_triangles(const PolygonSoup& polygons) {
  return std::all_of(polygons.sizes.begin(), polygons.sizes.end(), [](Index size) { return size == 3; });
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
  const bool points_are_vertices = polygons.corner_attributes.empty() && polygons.face_attributes.empty();
  TriangleSoup soup;
  if (points_are_vertices && all_are_triangles(polygons)) {
    soup.indices = std::move(polygons.corners);
    soup.face_material = std::move(polygons.face_material);
  } else {
    const SplitPolygons split = split_polygons(polygons.positions, polygons.corners, polygons.sizes);
    add_notes(split, notes);
    if (!polygons.face_material.empty()) soup.face_material = pick_entries(polygons.face_material, split.polygon);
    if (points_are_vertices)
      soup.indices = pick_entries(polygons.corners, split.corners);
    else
      add_points(polygons, split, soup);
  }
  if (!points_are_vertices) return soup;
  soup.positions = std::move(polygons.positions);
  soup.attributes = std::move(polygons.vertex_attributes);
  return soup;
}

}  // namespace lodestone::detail
