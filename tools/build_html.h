#pragma once

#include <string>

#include <lodestone/core/result.h>
#include <lodestone/io/scene.h>

#include "build_report.h"

namespace lodestone::tool {

/// Returns the page of `build --html`: the levels in world space, and the report's numbers without those that differ
/// from run to run; with the streams' bounds where streams are written. Pre: the build kept its levels. Errors: as
/// encode_scene_level's and html_page's.
Result<std::string> build_page(const BuildReport& report, const Scene& scene, bool with_bounds);

}  // namespace lodestone::tool
