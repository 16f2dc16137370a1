#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lodestone/core/result.h>

namespace lodestone {

/// Reads a whole file. Errors: Unreadable, naming the path and the system's reason.
Result<std::vector<std::byte>> read_file(const std::filesystem::path& path);

/// Writes a file whole or not at all: to a temporary name beside it, flushed, then renamed over what `path` leads to.
/// Errors: NotWritten, naming the path and the system's reason; an existing file is then left as it was.
Result<void> write_file(const std::filesystem::path& path, std::span<const std::byte> bytes);

/// Returns what a chain of symbolic links at `path` leads to, whether that exists or not; `path` itself where it is no
/// link. Errors: NotWritten where the chain has no end.
Result<std::filesystem::path> follow_links(const std::filesystem::path& path);

/// Returns a path's extension in small letters, without the dot.
std::string extension_of(const std::filesystem::path& path);

/// Returns a hidden name beside `path` for a file that is to take its place. It ends in `tag` and is short enough
/// wherever the name of `path` is, however long that may be. Pre: `tag` has at most 40 bytes.
std::filesystem::path stand_in_name(const std::filesystem::path& path, std::string_view tag);

}  // namespace lodestone
