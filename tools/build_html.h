#pragma once

#include <span>
#include <string>

#include <lodestone/core/result.h>
#include <lodestone/io/scene.h>

#include "build_report.h"
#include "scene_target.h"

namespace lodestone::tool {

/// Returns the page of `build --html`: the levels in world space, and the report's numbers without those that differ
/// from run to run. `streams`: the meshes whose bounds the page shows, none where no stream is written. Errors: as
/// encode_scene_level's and html_page's.
Result<std::string> build_page(const BuildReport& report, const Scene& scene, std::span<const LeveledMesh> levels,
                               std::span<const ScenePart> streams);

}  // namespace lodestone::tool
