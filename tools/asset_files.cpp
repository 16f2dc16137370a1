#include "asset_files.h"

#include <algorithm>
#include <system_error>

#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>

#include "messages.h"

namespace lodestone::tool {
namespace {

namespace fs = std::filesystem;

bool consists_of(const InputFiles& input, const fs::path& path) {
  return std::any_of(input.beside.begin(), input.beside.end(), [&](const fs::path& file) {
    std::error_code ignored;
    return fs::equivalent(input.path.parent_path() / file, path, ignored);
  });
}

bool lies_there(const AssetFile& file, const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_regular_file(path, ignored)) return false;
  const Result<std::vector<std::byte>> there = read_file(path);
  return there && *there == file.bytes;
}

}  // namespace

Result<void> add_asset(const EncodedAsset& asset, const fs::path& path, const InputFiles& input, StagedFiles& files) {
  LODESTONE_CHECK(files.add(path, asset.glb));
  for (const AssetFile& file : asset.beside) {
    const fs::path place = path.parent_path() / file.path;
    if (files.has(place) || lies_there(file, place)) continue;
    if (consists_of(input, place))
      return fail(ErrorCode::NotWritten, "cannot write " + quoted(place) + ": the input needs it; name another output");
    LODESTONE_CHECK(files.add_with_folder(place, file.bytes));
  }
  return {};
}

}  // namespace lodestone::tool
