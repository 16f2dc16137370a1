#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <vector>

#include <lodestone/core/result.h>

namespace lodestone::tool {

/// Whether a path, as users write it, means the standard input (where something is read) or output (where it is
/// written): `-`, or its device. A file of that name is `./-`.
bool is_standard_stream(const std::filesystem::path& path);

/// Reads all of the standard input. Errors: Unreadable.
Result<std::vector<std::byte>> read_standard_input();

/// Writes to the standard output. Errors: NotWritten.
Result<void> write_standard_output(std::span<const std::byte> bytes);

/// Whether the standard output is a terminal, where bytes that are no text do harm.
bool standard_output_is_terminal();

}  // namespace lodestone::tool
