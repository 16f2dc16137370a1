#pragma once

#include <optional>
#include <span>

#include <lodestone/io/scene.h>

#include "base/json.h"
#include "scene/scene_primitives.h"

namespace lodestone::detail {

/// True if two levels have the same faces, attributes and all, in the same order.
bool same_mesh(const Mesh& a, const Mesh& b);

/// Returns a level's numbers for its node's extras; `position_step` only with Draco.
Json level_numbers(const AssetLevel& level, const WrittenLevel& written, const SceneMesh& mesh, std::size_t node_count,
                   std::optional<double> position_step);

/// Adds the numbers of a level that a mesh shows, of which its stream leads to others, to the stream's extension.
void add_shown_numbers(const AssetLevel& level, const SceneMesh& mesh, Json& extension);

}  // namespace lodestone::detail
