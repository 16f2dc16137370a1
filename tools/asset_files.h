#pragma once

#include <filesystem>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/asset.h>

#include "staged_file.h"

namespace lodestone::tool {

/// An input and the files beside it that it consists of, relative to its folder.
struct InputFiles {
  std::filesystem::path path;
  std::vector<std::filesystem::path> beside;
};

/// Adds an asset as the file `path`, and what it has beside that. A file that lies there already, byte for byte, stays
/// as it is, as images do where input and output share a folder; so does one added before.
/// Errors: NotWritten, also where a different file would take the place of one that the input consists of.
Result<void> add_asset(const EncodedAsset& asset, const std::filesystem::path& path, const InputFiles& input,
                       StagedFiles& files);

}  // namespace lodestone::tool
