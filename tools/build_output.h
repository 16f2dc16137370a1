#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/asset.h>

#include "build_command.h"
#include "build_report.h"

namespace lodestone::tool {

/// Returns the files that `build` writes beside its report: OUT.glb, or OUT_LOD0.glb … and the index OUT.json.
std::vector<std::filesystem::path> output_paths(const BuildCommand& options, std::size_t level_count);

/// Checks, before the long work starts, that all files can be written, each to a place of its own.
/// Errors: InvalidArgument, NotWritten.
Result<void> check_paths(const BuildCommand& options, std::size_t level_count);

/// Writes the encoded files, the index and the report, all of them or none. Pre: one asset for each level of the
/// report with `--profile files`, otherwise one. Errors: NotWritten.
Result<void> write_outputs(const BuildCommand& options, std::span<const EncodedAsset> assets, BuildReport& report);

}  // namespace lodestone::tool
