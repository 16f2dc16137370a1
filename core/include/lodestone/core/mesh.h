#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/ids.h>
#include <lodestone/core/vec.h>

namespace lodestone {

/// How one component of an attribute is stored; the values are glTF's component types.
enum class ComponentType : std::uint16_t {
  Int8 = 5120,
  UInt8 = 5121,
  Int16 = 5122,
  UInt16 = 5123,
  UInt32 = 5125,
  Float32 = 5126,
};

/// Returns the bytes one component takes: 1, 2 or 4.
std::size_t component_bytes(ComponentType type);

/// One attribute of every wedge, kept as the bytes it came in: attributes are moved and compared, never interpolated.
struct Attribute {
  std::string name;  ///< glTF semantic, e.g. NORMAL, TEXCOORD_0, COLOR_0
  ComponentType type = ComponentType::Float32;
  std::uint8_t component_count = 0;  ///< 1 to 16
  bool normalized = false;           ///< integers stand for [0, 1] or [−1, 1]
  std::vector<std::byte> data;       ///< element_bytes() for each wedge, tightly packed

  std::size_t element_bytes() const { return component_bytes(type) * component_count; }
};

/// Returns what an integer component of value 1 or −1 is stored as where it is normalized; 1 for floats.
double largest_component(ComponentType type);

/// Returns stored components as floats; normalized integers in [0, 1] or [−1, 1]: of a signed type the two smallest
/// stand for −1, as in glTF.
std::vector<float> component_values(ComponentType type, bool normalized, std::span<const std::byte> data);

/// Stores a number as a component, at `out`: the nearest that the type has, of a normalized integer the nearest to the
/// number times the largest. Pre: it is a number.
void store_component(ComponentType type, bool normalized, double value, std::byte* out);

/// Returns an attribute's components as floats, element after element, as component_values does.
std::vector<float> attribute_values(const Attribute& attribute);

/// Returns an attribute with some of another's elements, in the order given.
Attribute pick_elements(const Attribute& attribute, std::span<const Index> elements);

/// An indexed triangle mesh in flat arrays.
///
/// A *vertex* is a position. A *wedge* is one attribute set at a vertex: a vertex on a seam has several. A *corner* is
/// 3·face + i; it names a wedge, which names a vertex. Faces wind counter-clockwise seen from outside.
struct Mesh {
  std::vector<Vec3f> positions;       ///< one per vertex
  std::vector<Index> wedge_vertex;    ///< one per wedge: its vertex, < vertex_count()
  std::vector<Index> corner_wedge;    ///< three per face: the wedges, < wedge_count()
  std::vector<Index> face_material;   ///< one per face, or empty: every face has material 0
  std::vector<Attribute> attributes;  ///< any number; each with one element per wedge

  std::size_t vertex_count() const { return positions.size(); }
  std::size_t wedge_count() const { return wedge_vertex.size(); }
  std::size_t face_count() const { return corner_wedge.size() / 3; }
  Index corner_vertex(Index corner) const { return wedge_vertex[corner_wedge[corner]]; }
  Index material_of(Index face) const { return face_material.empty() ? 0 : face_material[face]; }
  Vec3 corner_position(Index corner) const { return Vec3(positions[corner_vertex(corner)]); }
};

/// An axis-aligned box in mesh units.
struct Box {
  Vec3 low;
  Vec3 high;
  double diagonal() const { return length(high - low); }
};

/// Returns the bounding box of the vertices that faces use; a box of size 0 at the origin where there are none.
Box bounding_box(const Mesh& mesh);

/// Returns a face's normal, twice as long as its area.
Vec3 area_vector(const Mesh& mesh, Index face);

/// Returns some faces as a mesh of their own, in the order given. The vertices and wedges they use are numbered in
/// order of first use; `source_vertex`, if wanted, gets the vertices' numbers in `mesh`.
Mesh pick_faces(const Mesh& mesh, std::span<const Index> faces, std::vector<Index>* source_vertex = nullptr);

/// Returns the total area of the faces, in squared mesh units.
double surface_area(const Mesh& mesh);

}  // namespace lodestone
