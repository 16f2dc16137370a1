#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/io/material.h>

#include "base/files_beside.h"
#include "mesh/soup_file.h"

namespace lodestone::detail {

/// Returns the type of an image by its content, "" for none that glTF or its extensions know.
std::string image_type(std::span<const std::byte> bytes);

/// True for a PNG or JPEG that stores no colours.
bool is_grey(const Image& image);

/// Writes a path of a material's file as paths are written here: slashes, no quotes or blanks around.
std::string tidy_path(std::string_view name);

/// Fetches the images that a mesh's materials name, each once.
class ImageLoader {
 public:
  /// What is missing or of no use is named in `file.notes`.
  ImageLoader(const FileFetcher& fetch, SoupFile& file) : fetch_(fetch), file_(file) {}

  /// Returns an image's number in the file. `folder` is what relative names start at, "" for the mesh's own.
  std::optional<std::size_t> load(std::string_view name, const std::filesystem::path& folder);

 private:
  std::optional<std::size_t> fetch(const std::string& name, const std::filesystem::path& folder);

  const FileFetcher& fetch_;
  SoupFile& file_;
  std::map<std::string, std::optional<std::size_t>> loaded_;
};

/// Fetches a file by a name from a material's file, which may lie in a folder below or name one on another machine:
/// where the name itself leads nowhere, its last part is looked for beside the mesh.
Result<std::vector<std::byte>> fetch_named(const FileFetcher& fetch, const std::string& name,
                                           const std::filesystem::path& folder);

}  // namespace lodestone::detail
