#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include <lodestone/core/result.h>

namespace lodestone {

/// Reads a whole file. Errors: Unreadable, naming the path and the system's reason.
Result<std::vector<std::byte>> read_file(const std::filesystem::path& path);

/// Writes a file whole or not at all: to a temporary name beside it, flushed, then renamed over `path`.
/// Errors: NotWritten, naming the path and the system's reason; an existing file is then left as it was.
Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

}  // namespace lodestone
