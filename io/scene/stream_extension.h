#pragma once

#include <cstddef>
#include <vector>

#include <lodestone/core/result.h>

#include "gltf/gltf_document.h"

namespace lodestone::detail {

// The glTF extension that holds the removal stream; docs/stream-format.md describes it.
inline constexpr const char* kStreamExtension = "LODESTONE_removal_stream";
inline constexpr const char* kStreamExtensionVersion = "2.0";

/// Returns the stream that a mesh of the document has; empty for none. Errors: Malformed.
Result<std::vector<std::byte>> stored_stream(const GltfDocument& document, std::size_t mesh);

}  // namespace lodestone::detail
