#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/result.h>

#include "base/files_beside.h"
#include "gltf/gltf_document.h"

namespace lodestone::detail {

/// Whether a stream is a compact one.
bool is_compact(std::span<const std::byte> stream);

/// Returns the version that a stream says it has, as "3.0"; "0.0" for bytes that are none.
std::string version_text(std::span<const std::byte> stream);

/// Returns the stream that a mesh of the document has, in the file or beside it; empty for none. Errors: Malformed,
/// those of `fetch`.
Result<std::vector<std::byte>> stored_stream(const GltfDocument& document, std::size_t mesh, const FileFetcher& fetch);

/// Whether what a mesh of the document shows is only a level of what its stream, a compact one, leads to.
bool shows_level_of_stream(const Json& mesh);

}  // namespace lodestone::detail
