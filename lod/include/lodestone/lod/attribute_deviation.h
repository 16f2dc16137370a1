#pragma once

#include <string>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/progress.h>
#include <lodestone/lod/deviation.h>

namespace lodestone {

/// How an attribute of a level differs from the original's, over the original's area.
///
/// Units: NORMAL: radians between directions. TEXCOORD_n: texture widths. TARGET_i:POSITION (morph targets): mesh
/// units. Others: the length of the difference of their components, normalized integers in [0, 1].
struct AttributeDeviation {
  std::string name;
  double mean = 0;
  double rms = 0;
  double maximum = 0;  ///< of the samples
};

/// Compares the attributes that two meshes share (same name, width) at points spread evenly over the original with
/// those at the nearest points of the level's faces of the same material. Joints and weights are left out: they have no
/// meaning one by one. Deterministic. Cancelled, it ends with what it has seen. Cost: one nearest-point query for each
/// of about `sample_count` points.
std::vector<AttributeDeviation> measure_attributes(const Mesh& original, const Mesh& level,
                                                   std::size_t sample_count = 20'000, const Progress& progress = {});
std::vector<AttributeDeviation> measure_attributes(const Mesh& original, const MeasuredSurface& level,
                                                   std::size_t sample_count = 20'000, const Progress& progress = {});

}  // namespace lodestone
