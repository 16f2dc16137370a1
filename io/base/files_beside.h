#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <vector>

#include <lodestone/core/result.h>

namespace lodestone::detail {

/// Fetches a file that lies beside or below the one being read, by its relative path.
using FileFetcher = std::function<Result<std::vector<std::byte>>(const std::filesystem::path& relative)>;

/// Returns what fetches files beside or below a file; it goes by names in any case where the exact one is not there.
FileFetcher files_beside(const std::filesystem::path& path);

/// Fetches nothing: for what is read from memory. Its error is Unreadable.
Result<std::vector<std::byte>> nothing_beside(const std::filesystem::path& relative);

/// Returns an error of a file's content with the file's name before its message.
Error with_path(Error error, const std::filesystem::path& path);

}  // namespace lodestone::detail
