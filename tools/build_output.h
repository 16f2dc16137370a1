#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <lodestone/core/result.h>

#include "build_command.h"
#include "build_report.h"

namespace lodestone::tool {

/// Returns the files that `build` writes beside its report: OUT.glb, or OUT_LOD0.glb … and the index OUT.json;
/// what lies beside a .gltf is not among them.
std::vector<std::filesystem::path> output_paths(const BuildCommand& options, std::size_t level_count);

/// Checks, before the long work starts, that all files can be written, each to a place of its own.
/// Errors: InvalidArgument, NotWritten.
Result<void> check_paths(const BuildCommand& options, std::size_t level_count);

/// Puts the triangles of the level in the place of its glTF, where a .obj or .ply is asked for. Pre: the build is done
/// and has kept its levels. Errors: Malformed, LimitExceeded, as `level_surface`.
Result<void> make_mesh_file(const BuildCommand& options, const Scene& scene, BuildReport& report);

/// Enters the encoded files in the report, under the paths that they will have. Pre: the build
/// is done.
void list_files(const BuildCommand& options, BuildReport& report);

/// Returns a sentence that names levels of an earlier run with `--profile files` that lie beside those of this one, or
/// none. Pre: the report has all levels.
std::vector<std::string> leftover_levels(const BuildCommand& options, const BuildReport& report);

/// Writes the encoded files, the index, the page and the report, all of them or none; the last three where the options
/// ask for them. Pre: as above. Errors: NotWritten.
Result<void> write_outputs(const BuildCommand& options, const BuildReport& report, const std::string& page);

}  // namespace lodestone::tool
