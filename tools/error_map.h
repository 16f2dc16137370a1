#pragma once

#include <array>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/lod/deviation.h>

namespace lodestone::tool {

/// Returns the distance from each vertex to the nearest point of a surface, mesh units.
std::vector<float> vertex_errors(const Mesh& mesh, const SurfaceIndex& surface);

/// How the distances from one surface to another are spread over its area, mesh units.
struct ErrorSpread {
  static constexpr std::size_t kBinCount = 256;

  double maximum = 0;                           ///< the largest distance found
  double median = 0, most = 0, nearly_all = 0;  ///< 50 %, 90 % and 99 % of the area lie no farther than these
  /// Shares of the area, finer towards 0: bin i begins at maximum · (i / kBinCount)².
  std::array<double, kBinCount> bins{};
};

/// Measures the spread at points spread evenly over the faces. Deterministic. `at_least` is a distance that is known to
/// occur, such as that of a vertex.
ErrorSpread measure_spread(const Mesh& mesh, const SurfaceIndex& surface, double at_least);

}  // namespace lodestone::tool
