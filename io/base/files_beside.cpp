#include "base/files_beside.h"

#include <algorithm>
#include <cctype>
#include <system_error>
#include <utility>

#include <lodestone/io/file.h>

namespace lodestone::detail {
namespace {

std::string lower(std::string word) {
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return word;
}

/// Returns the path with each part spelled as it is in the file system; the path itself where a part is not there.
std::filesystem::path in_any_case(const std::filesystem::path& folder, const std::filesystem::path& relative) {
  std::filesystem::path found = folder.empty() ? "." : folder;
  for (const std::filesystem::path& part : relative) {
    std::error_code error;
    std::filesystem::path next = found / part;
    if (!std::filesystem::exists(next, error))
      for (std::filesystem::directory_iterator entry(found, error), end; !error && entry != end; entry.increment(error))
        if (lower(entry->path().filename().string()) == lower(part.string())) next = entry->path();
    found = std::move(next);
  }
  return found;
}

}  // namespace

std::string extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  return lower(std::move(extension));
}

FileFetcher files_beside(const std::filesystem::path& path) {
  return [folder = path.parent_path()](const std::filesystem::path& relative) {
    auto bytes = read_file(folder / relative);
    return bytes ? std::move(bytes) : read_file(in_any_case(folder, relative));
  };
}

}  // namespace lodestone::detail
