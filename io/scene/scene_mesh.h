#pragma once

#include <cstddef>
#include <optional>

#include <lodestone/core/result.h>

#include "scene/scene_impl.h"

namespace lodestone::detail {

/// A mesh of the document with its primitives joined, and which of them can be told apart again.
struct JoinedMesh {
  SceneMesh mesh;
  MeshSource source;
  std::vector<std::string> left_out;  ///< names of attributes of types that glTF vertices may not have
};

/// Joins the triangles of a mesh's primitives; nothing for a mesh without any.
/// Errors: Malformed, Unsupported; LimitExceeded where the attributes of all primitives together are out of proportion.
Result<std::optional<JoinedMesh>> join_primitives(const GltfDocument& document, std::size_t mesh);

/// Gives a soup all of the source's attributes, zero for points that lack them. Pre: what there is of a column's data
/// stands at its number and begins with the first point.
void complete_attributes(const MeshSource& source, TriangleSoup& soup);

/// Describes a mesh that is no document's: every primitive has all attributes that glTF has a place for.
MeshSource source_of(const Mesh& mesh, std::size_t primitive_count);

}  // namespace lodestone::detail
