#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/result.h>

#include "gltf/gltf_document.h"

namespace lodestone::detail {

// The glTF extension that holds a mesh's stream, of any version; docs/stream-format.md describes it.
inline constexpr const char* kStreamExtension = "LODESTONE_removal_stream";

/// Returns the version that a stream says it has, as "3.0". Pre: its beginning is there.
std::string version_text(std::span<const std::byte> stream);

/// Returns the stream that a mesh of the document has; empty for none. Errors: Malformed.
Result<std::vector<std::byte>> stored_stream(const GltfDocument& document, std::size_t mesh);

}  // namespace lodestone::detail
