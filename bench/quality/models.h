#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "peers/surface.h"

namespace lodestone::bench {

/// A mesh to compare simplifiers on.
struct Model {
  std::string name;
  Mesh mesh;                              ///< manifold, positions alone: what every simplifier gets
  Mesh attributed;                        ///< the same with its attributes and materials
  std::vector<std::size_t> paper_counts;  ///< face counts of published tables, descending
};

struct Models {
  std::vector<Model> found;
  std::vector<std::string> missing;  ///< names of files that are not there or not readable
};

/// Loads the models whose names contain one of `wanted`; where it is empty, all but those of engineering, "cad-…".
/// Files come from `data` (the layout of shared/data), then generated surfaces whose vertices lie on a known one.
Models load_models(const std::string& data, const std::vector<std::string>& wanted);

}  // namespace lodestone::bench
