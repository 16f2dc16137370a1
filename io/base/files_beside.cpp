#include "base/files_beside.h"

#include <system_error>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/io/file.h>

namespace lodestone::detail {
namespace {

/// Returns the path with each part spelled as it is in the file system; the path itself where a part is not there.
std::filesystem::path in_any_case(const std::filesystem::path& folder, const std::filesystem::path& relative) {
  std::filesystem::path found = folder.empty() ? "." : folder;
  for (const std::filesystem::path& part : relative) {
    std::error_code error;
    std::filesystem::path next = found / part;
    if (!std::filesystem::exists(next, error))
      for (std::filesystem::directory_iterator entry(found, error), end; !error && entry != end; entry.increment(error))
        if (lower_case(entry->path().filename().string()) == lower_case(part.string())) next = entry->path();
    found = std::move(next);
  }
  return found;
}

}  // namespace

FileFetcher files_beside(const std::filesystem::path& path) {
  return [folder = path.parent_path()](const std::filesystem::path& relative) {
    auto bytes = read_file(folder / relative);
    return bytes ? std::move(bytes) : read_file(in_any_case(folder, relative));
  };
}

Result<std::vector<std::byte>> nothing_beside(const std::filesystem::path& relative) {
  return fail(ErrorCode::Unreadable, text("'", relative, "' lies outside the bytes given"));
}

Error with_path(Error error, const std::filesystem::path& path) {
  error.message = text('\'', path, "': ", error.message);
  return error;
}

}  // namespace lodestone::detail
