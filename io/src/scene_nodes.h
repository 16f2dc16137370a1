#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "json.h"

namespace lodestone::detail {

/// The members of a node that show its mesh: they belong to the node that shows the mesh's finest level.
/// Moves them from one to the other.
void move_mesh_members(Json& from, Json& to);

/// Copies to a coarser level's node what the finest has beside its mesh: skin, weights, instancing.
void copy_instance_members(const Json& finest, Json& node);

/// Lets the animations of morph target weights of `node` move `finest` instead, and adds a channel for each of `lower`.
void retarget_weights(Json& document, std::size_t node, std::size_t finest, std::span<const std::size_t> lower);

/// Drops the animation channels of morph target weights that move `node`.
void drop_weights_channels(Json& document, std::size_t node);

}  // namespace lodestone::detail
