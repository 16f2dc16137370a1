#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

namespace lodestone::detail {

/// The cube that an attribute's values are quantised in: equal for everything that must not come apart.
struct QuantizationGrid {
  std::vector<float> origin;  ///< one per component
  float range = 1;            ///< the edge of the cube, > 0
  int bits = 14;              ///< 1 to 30

  /// The distance of neighbouring values.
  double step() const { return static_cast<double>(range) / static_cast<double>((std::uint64_t{1} << bits) - 1); }
};

/// Grids by attribute name, "POSITION" included. NORMAL has its own octahedral form and only uses `bits`.
using QuantizationGrids = std::map<std::string, QuantizationGrid>;

/// What a primitive's Draco data holds.
struct DracoPrimitive {
  std::vector<std::byte> bytes;
  std::uint32_t position_id = 0;             ///< unique id of POSITION
  std::vector<std::uint32_t> attribute_ids;  ///< unique ids, one per attribute of the mesh
};

/// Compresses some faces of a mesh. Float attributes are quantised in their grids, integers are kept exactly.
/// `compression_level` is 0 to 10. Pre: corner_wedge is not empty. Errors: InvalidArgument with Draco's reason.
Result<DracoPrimitive> encode_draco(const Mesh& mesh, std::span<const Index> corner_wedge,
                                    const QuantizationGrids& grids, int compression_level);

}  // namespace lodestone::detail
