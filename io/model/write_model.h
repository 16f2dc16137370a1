#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <lodestone/core/result.h>

#include "model/tinygltf.h"

namespace lodestone::detail {

/// Has tinygltf write a model as a .glb, all its buffers inside. An image that has neither a bufferView nor a uri gets
/// the uri "data:,".
/// Errors: LimitExceeded beyond 4 GiB, and where extras or extensions nest deeper than a document may; Malformed with
/// tinygltf's reason, e.g. a name that is not UTF-8.
Result<std::vector<std::byte>> write_model(const tinygltf::Model& model);

/// Returns the text with what is not UTF-8 in it replaced by U+FFFD.
std::string as_utf8(std::string_view text);

}  // namespace lodestone::detail
