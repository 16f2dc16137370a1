#pragma once

#include <cstdint>
#include <filesystem>

#include "base/json.h"

namespace lodestone::detail {

/// Returns the bytes of the files that a glTF names beside it, each once, without those that are not there.
std::uint64_t bytes_beside(const Json& document, const std::filesystem::path& path);

}  // namespace lodestone::detail
