#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/result.h>

#include "mesh/soup_file.h"

namespace lodestone::detail {

/// What another process has read.
struct PackedSoup {
  SoupFile file;                      ///< without images
  std::vector<std::string> textures;  ///< of each material: its base colour's image, "" for none
};

/// Writes it as bytes for another process of the same program.
std::vector<std::byte> pack(const PackedSoup& soup);

/// Reads what `pack` wrote. Errors: Malformed.
Result<PackedSoup> unpack(std::span<const std::byte> bytes);

}  // namespace lodestone::detail
