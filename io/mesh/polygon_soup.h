#pragma once

#include <string>
#include <vector>

#include <lodestone/core/assemble.h>

namespace lodestone::detail {

/// An attribute of polygons' corners.
struct CornerAttribute {
  Attribute values;
  std::vector<Index> elements;  ///< which of the values each corner has; empty: as many values as corners, in order
};

/// Polygons as a file gives them, with attributes of its vertices, of the polygons' corners and of whole polygons.
struct PolygonSoup {
  std::vector<Vec3f> positions;
  std::vector<Index> corners;                ///< positions, one polygon after the other; < positions.size()
  std::vector<Index> sizes;                  ///< of each polygon: its number of corners
  std::vector<Index> face_material;          ///< one per polygon, or empty
  std::vector<Attribute> vertex_attributes;  ///< one element per position
  std::vector<CornerAttribute> corner_attributes;
  std::vector<Attribute> face_attributes;  ///< one element per polygon
};

/// Splits the polygons into triangles. Where corners or polygons have attributes, points are made of corners: those of
/// one vertex that agree mostly share one. Appends a sentence to `notes` for what is left out or in doubt.
/// Errors: LimitExceeded.
Result<TriangleSoup> to_triangles(PolygonSoup polygons, std::vector<std::string>& notes);

}  // namespace lodestone::detail
