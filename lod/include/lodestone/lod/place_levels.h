#pragma once

#include <vector>

#include <lodestone/lod/deviation.h>
#include <lodestone/lod/placed_level.h>
#include <lodestone/lod/placement.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone {

/// Fits some levels of a progressive mesh to the full one, for a stream whose levels then are closer to it: those with
/// a quarter of its vertices, a sixteenth and so on, as far as there is much to gain. Vertices move along their
/// normals, and the coarser the level the more aside, too; a stream has to say where they go from there. Where
/// `options.fixed` has vertices that stay, levels have no precision, so that they stay exactly.
///
/// Pre: the fitter, the surface and the mesh are of the same original. Deterministic. Cancelled, no levels are
/// returned. Cost: that of fitting and measuring these levels.
std::vector<PlacedLevel> place_levels(const LevelFitter& fitter, const MeasuredSurface& original,
                                      const ProgressiveMesh& mesh, const PlacementOptions& options = {});

}  // namespace lodestone
