#pragma once

#include <cstddef>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

namespace lodestone {

/// Triangles as a file gives them: attributes belong to points, positions may repeat, anything may be broken.
struct TriangleSoup {
  std::vector<Vec3f> positions;       ///< one per point
  std::vector<Attribute> attributes;  ///< each with one element per point
  std::vector<Index> indices;         ///< three per triangle: points, < positions.size()
  std::vector<Index> face_material;   ///< one per triangle, or empty
  /// One per point, or empty: faces of points that differ in it are no duplicates, though all else agrees.
  std::vector<Index> point_sheet;
};

/// At an edge of more faces than these nobody drew sheets: all are cut apart.
inline constexpr std::size_t kMostFacesAtEdge = 32;

/// What `assemble` may do beyond the least.
struct AssemblyOptions {
  /// Whether faces may be turned so that neighbours wind alike. What cannot be seen from behind then looks another way:
  /// for files whose winding means nothing.
  bool turn_faces = false;
};

/// What `assemble` changed on the way from triangles to a manifold mesh; all zero for a clean file.
struct AssemblyReport {
  std::size_t nonfinite_faces = 0;    ///< dropped: a corner is NaN or infinite
  std::size_t degenerate_faces = 0;   ///< dropped: two corners at one position
  std::size_t duplicate_faces = 0;    ///< dropped: corners, winding, material and attributes of an earlier one
  std::size_t unused_points = 0;      ///< dropped: no triangle uses them
  std::size_t turned_faces = 0;       ///< turned to wind as their neighbours do, if allowed
  std::size_t nonmanifold_edges = 0;  ///< cut: more than two triangles, or two that disagree on winding
  std::size_t cut_vertices = 0;       ///< vertices that became several, one for each sheet
};

/// Adds up what became of several meshes.
AssemblyReport operator+(const AssemblyReport& a, const AssemblyReport& b);

/// A manifold mesh, and what had to be changed for it.
struct AssembledMesh {
  Mesh mesh;
  AssemblyReport report;
};

/// Builds a mesh whose vertices each have one fan of faces.
///
/// Points with equal coordinates become one vertex; points that also agree in every attribute byte become one wedge.
/// Edges of more than two triangles and bow-tie vertices are cut: each sheet gets a vertex of its own, at the same
/// position. Sheets that lie on one another stay whole: at their edges triangles are neighbours as material, attributes
/// and angles say. `Connectivity` recognises the copies of a vertex by their equal positions; they are removed
/// together, so no crack opens.
///
/// Where faces may be turned, all that two-face edges join winds alike afterwards, as far as a surface has two sides.
/// Nothing is turned that winds alike already, nor against normals. Which side is the front normals say, where there
/// are any; else nine tenths of the faces, or the shape, looking outwards, or most of the faces.
///
/// Pre: array lengths agree. Errors: InvalidArgument where an index or a length is out of range, LimitExceeded where
/// 32-bit indices cannot number all points or corners. Cost: O(n log n).
Result<AssembledMesh> assemble(const TriangleSoup& soup, const AssemblyOptions& options = {});

/// Returns the soup with one point for each wedge: the inverse of `assemble`, up to order and what it dropped.
TriangleSoup to_soup(const Mesh& mesh);

}  // namespace lodestone
