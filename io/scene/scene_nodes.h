#pragma once

#include <cstddef>

#include "base/json.h"

namespace lodestone::detail {

/// The members of a node that show its mesh: they belong to the node that shows the mesh's finest level.
/// Moves them from one to the other.
void move_mesh_members(Json& from, Json& to);

/// Copies to a coarser level's node what the finest has beside its mesh: skin, weights, instancing.
void copy_instance_members(const Json& finest, Json& node);

/// True if a node itself can be the finest level: where a skinned mesh is a root it must stay one, and its node's
/// transform has no effect. Not where something below the node would vanish with the level.
bool stays_in_place(const Json& document, std::size_t node);

}  // namespace lodestone::detail
