#pragma once

#include <string>
#include <vector>

#include <lodestone/core/assemble.h>

// What programs for engineering write: closed solids of flat sides, cylinders and fillets, whose points lie on outlines
// alone, in faces as long and thin as these leave them. Points that belong together have equal coordinates, bit for
// bit. Lengths are of the order of 1 to 10; faces wind counter-clockwise from outside.

namespace lodestone::test {

struct CadShape {
  std::string name;
  TriangleSoup soup;
};

/// A box of 3 × 2 × 1 with n points along each edge of two opposite sides, which are cut into slivers.
TriangleSoup cut_box(int n);
/// A box whose sides are n × n squares that crowd towards one corner, down to faces a thousand times as long as wide.
TriangleSoup crowded_box(int n);
/// A plate with rounded corners of `arc` steps each, and n points along each of its straight sides, none of which its
/// shape needs.
TriangleSoup rounded_plate(int arc, int n);
/// A long cylinder of two triangles for each side, its ends fans of slivers.
TriangleSoup rod(int sides);
/// A disc of the same, wide and thin.
TriangleSoup disc(int sides);
/// A plate with columns × rows round holes.
TriangleSoup drilled_plate(int columns, int rows, int sides);
/// A box with all edges and corners rounded, in n steps.
TriangleSoup rounded_box(int n);
/// A shaft with flanges, chamfers and fillets, turned about its axis.
TriangleSoup turned_shaft(int sides);
/// A toothed wheel with a bore; each flank has n points.
TriangleSoup gear(int teeth, int n);
/// A hollow pipe with two elbows.
TriangleSoup bent_pipe(int sides, int elbow_steps);
/// A threaded rod with a hexagonal head.
TriangleSoup screw(int turns, int sides);

/// The same shape at an angle to all axes, so that rounding takes points off their planes.
TriangleSoup askew(TriangleSoup soup);

/// Returns every family, straight and askew; about 300 faces each where `detail` is 1, 1,000 where it is 4.
std::vector<CadShape> cad_shapes(int detail);

}  // namespace lodestone::test
