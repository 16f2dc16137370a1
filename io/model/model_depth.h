#pragma once

#include <cstddef>

#include "model/tinygltf.h"

namespace lodestone::detail {

/// True where any extras or extensions of a model nest deeper: tinygltf writes them by recursion.
bool nests_deeper(const tinygltf::Model& model, std::size_t depth);

}  // namespace lodestone::detail
