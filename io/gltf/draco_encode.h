#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

namespace lodestone::detail {

/// The cube that an attribute's values are quantised in: equal for everything that must not come apart.
struct QuantizationGrid {
  std::vector<float> origin;  ///< one per component
  float range = 1;            ///< the edge of the cube, > 0
  int bits = 14;              ///< 1 to 30; 0: none, values stay as they are

  bool is_exact() const { return bits == 0; }
  /// The distance of neighbouring values; 0 without a grid.
  double step() const {
    return is_exact() ? 0 : static_cast<double>(range) / static_cast<double>((std::uint64_t{1} << bits) - 1);
  }
  /// The farthest that a point of three components is moved.
  double point_error() const { return std::sqrt(3.0) / 2 * step(); }
};

/// The grids of a mesh. NORMAL has its own octahedral form and only uses `bits`; integers use none.
struct QuantizationGrids {
  QuantizationGrid position;
  std::vector<QuantizationGrid> attributes;  ///< one for each attribute
};

/// How connectivity is coded.
enum class DracoMethod {
  Edgebreaker,  ///< small, in an order of points of its own
  Sequential,   ///< keeps the order of points, for data that lies outside
};

/// What texture coordinates are predicted from.
enum class DracoPrediction {
  Positions,   ///< smallest; fails for some charts
  Neighbours,  ///< the coordinates of the face beside
};

/// One of the ways to encode a mesh.
struct DracoCoding {
  DracoMethod method = DracoMethod::Edgebreaker;
  DracoPrediction prediction = DracoPrediction::Positions;
};

/// What a primitive's Draco data holds.
struct DracoPrimitive {
  std::vector<std::byte> bytes;
  std::uint32_t position_id = 0;             ///< unique id of POSITION
  std::vector<std::uint32_t> attribute_ids;  ///< unique ids, one per attribute of the mesh
};

/// Compresses a mesh. Float attributes are quantised in their grids, integers are kept exactly.
/// `compression_level` is 0 to 10. Pre: values on a grid are finite; there are faces; wedges and vertices stand in the
/// order of their first use. Errors: Unsupported with Draco's reason.
Result<DracoPrimitive> encode_draco(const Mesh& mesh, const QuantizationGrids& grids, const DracoCoding& coding,
                                    int compression_level);

}  // namespace lodestone::detail
