#pragma once

#include <cstddef>

#include <lodestone/core/result.h>
#include <lodestone/lod/simplify_options.h>
#include <lodestone/pipeline/build_options.h>

#include "build_command.h"
#include "json_text.h"

namespace lodestone::tool {

/// True with `--profile files`: one file for each level.
bool has_file_per_level(const BuildCommand& options);

/// True with `--profile stream`: one coarse level in the file, all others in its stream.
bool shows_one_level(const BuildCommand& options);

/// True for `simplify`: one level in the file, and nothing else.
bool has_one_level(const BuildCommand& options);

/// True where triangles alone are written, as a .obj or .ply.
bool writes_mesh_file(const BuildCommand& command);

/// True where a stream alone is written, as a .lods.
bool writes_stream_file(const BuildCommand& command);

/// True where each mesh's removal stream is written.
bool writes_stream(const BuildCommand& command);

/// Returns what the options mean, the settings file read. Errors: InvalidArgument, Unreadable, Malformed.
Result<BuildOptions> build_options(const BuildCommand& command);

/// Returns the options as understood, for the report; `understood`: what build_options returns of them.
Json settings_json(const BuildCommand& options, const BuildOptions& understood);

}  // namespace lodestone::tool
