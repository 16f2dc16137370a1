#pragma once

#include <vector>

#include <lodestone/core/result.h>
#include <lodestone/io/asset.h>
#include <lodestone/lod/simplify.h>

#include "build_command.h"
#include "json_text.h"
#include "level_target.h"

namespace lodestone::tool {

/// True with `--profile files`: one file for each level.
bool has_file_per_level(const BuildCommand& options);

/// Returns the targets of the levels after the whole scene, as the options ask for them.
Result<std::vector<LevelTarget>> requested_levels(const BuildCommand& options);

/// Sorts targets of one kind: finest first, by what they come to for the whole scene.
void sort_finest_first(std::vector<LevelTarget>& targets, const FullSize& scene);

/// Returns what the options say of every mesh alike. Errors: InvalidArgument for a weight that is none.
Result<SimplifyOptions> simplify_options(const BuildCommand& options);

/// Returns how geometry is stored.
AssetOptions asset_options(const BuildCommand& options);

/// Returns the options as understood, for the report; `weights` are those of simplify_options.
Json settings_json(const BuildCommand& options, const AttributeWeights& weights, std::size_t level_count);

}  // namespace lodestone::tool
