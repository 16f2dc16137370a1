#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/core/assemble.h>

// Families of seeded shapes. Points that belong together have equal coordinates, bit for bit, so that `assemble` joins
// them. Lengths are of the order of 1. Noise is an amplitude in mesh units; faces wind counter-clockwise from outside.

namespace lodestone::test {

// Flat and open.
TriangleSoup empty_soup();
TriangleSoup single_triangle();
/// n × n squares over [0, 1]², heights in ±noise.
TriangleSoup grid(int n, double noise, std::uint64_t seed);
/// n × n squares with hills on four scales.
TriangleSoup terrain(int n, std::uint64_t seed);
/// A flat ring of m × n squares with two borders.
TriangleSoup annulus(int m, int n);
/// An open tube of m × n squares with two borders.
TriangleSoup cylinder(int m, int n);
/// A disc of one vertex with n neighbours; raised to a cone by `height`.
TriangleSoup fan(int n, double height);

// Closed.
TriangleSoup tetrahedron();
/// A cube with n × n squares on each side: sharp edges, no attributes.
TriangleSoup cube(int n);
/// An icosahedron split `subdivisions` times; radii in 1 ± noise.
TriangleSoup icosphere(int subdivisions, double noise, std::uint64_t seed);
/// m × n squares around a torus of radii 1 and 0.4.
TriangleSoup torus(int m, int n);
/// Two cones on one circle: two vertices with n neighbours each.
TriangleSoup double_cone(int n);
/// `count` small spheres with different seeds, side by side.
TriangleSoup many_components(int count);

// With attributes or materials.
/// A cube with a normal and texture coordinates for each side: three wedges at a corner, two on an edge.
TriangleSoup seam_cube(int n);
/// A sphere of m × n squares with normals and texture coordinates: a seam from pole to pole, m wedges at a pole.
TriangleSoup seam_sphere(int m, int n);
/// A grid whose halves have materials 0 and 1.
TriangleSoup two_material_grid(int n);
/// A sphere whose northern and southern halves have materials 0 and 1.
TriangleSoup two_material_sphere(int subdivisions);

/// An icosphere whose faces each have their own normal: every edge splits wedges, every vertex is a corner.
TriangleSoup faceted_sphere(int subdivisions);
/// A tube of m × n squares with one normal for each of its m sides, as low-poly models have them.
TriangleSoup faceted_cylinder(int m, int n);
/// A terrain whose texture coordinates are mirrored at x = ½, n even: wedges agree across it, orientations do not.
TriangleSoup mirrored_terrain(int n);
/// A hilly grid with a seam of texture coordinates from one border to the middle, where it ends.
TriangleSoup slit_grid(int n);
/// A tube with two joints whose weights change along it.
TriangleSoup skinned_cylinder(int m, int n);
/// A flat grid with a morph target that raises a hill.
TriangleSoup morph_grid(int n);

// Not manifold.
/// A cube with a wall inside: three faces at each edge where it meets the sides; n even.
TriangleSoup walled_cube(int n);
/// Two cubes that share an edge: four faces at each of its edges.
TriangleSoup cubes_at_an_edge(int n);
/// Two spheres that share one vertex.
TriangleSoup spheres_at_a_vertex(int subdivisions);
/// A band with half a twist: its faces cannot all agree on winding.
TriangleSoup mobius_strip(int m, int n);
/// Two fans that share one vertex and no edge.
TriangleSoup bow_tie();
/// Three triangles at one edge.
TriangleSoup three_at_one_edge();
/// Two neighbours with opposite winding.
TriangleSoup disagreeing_pair();
/// Some of the squares of a cubic lattice of n³ points, cut along either diagonal and facing either way, some twice:
/// edges of many faces, folds, faces back to back.
TriangleSoup random_squares(int n, std::uint64_t seed);
/// A grid with degenerate, duplicate and non-finite triangles and an unused point added.
TriangleSoup dirty_grid(int n);

// Sheets that lie in one place, vertex by vertex, made of any shape without materials.
/// `count` times the shape: an attribute "_SHEET" tells the sheets apart.
TriangleSoup stacked(const TriangleSoup& shape, int count);
/// `count` times the shape: sheet i has material i.
TriangleSoup layered(const TriangleSoup& shape, int count);
/// The shape, and every face of it once more, turned over; both use the same points.
TriangleSoup two_sided(const TriangleSoup& shape);
/// A hilly grid of n × n squares, and its back, where the squares are cut along their other diagonals.
TriangleSoup two_sided_squares(int n);
/// The shape in material 0, and in material 1 once more what lies within `radius` of its first point.
TriangleSoup with_decal(const TriangleSoup& shape, double radius);

/// The shape with its faces in another order.
TriangleSoup shuffled(const TriangleSoup& shape, std::uint64_t seed);

/// The shape with a share of its faces turned over; the attributes stay as they are.
TriangleSoup misturned(const TriangleSoup& shape, double share, std::uint64_t seed);

/// A shape with what is known of it.
struct NamedShape {
  std::string name;
  TriangleSoup soup;
  bool manifold = true;  ///< `assemble` has nothing to cut or drop
  /// V − E + F of the joined vertices, where the shape is manifold.
  std::optional<int> euler_characteristic;
};

/// Returns every family, in sizes small enough for tests of every step.
std::vector<NamedShape> all_shapes();

/// Returns those of all_shapes() that are manifold.
std::vector<NamedShape> manifold_shapes();

}  // namespace lodestone::test
