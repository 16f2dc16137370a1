#pragma once

#include <cstddef>
#include <map>
#include <span>
#include <string_view>
#include <vector>

#include <lodestone/core/result.h>

#include "gltf/gltf_document.h"
#include "gltf/gltf_primitive.h"
#include "gltf/gltf_scene.h"
#include "mesh/soup_file.h"

namespace lodestone::detail {

/// Primitives by the number of their mesh.
using Primitives = std::map<std::size_t, std::vector<Primitive>>;

/// Joins the triangles of instances in world space. Pre: `meshes` has an entry for the mesh of each.
///
/// Attributes that every primitive has in the same layout are kept; NORMAL and TANGENT are floats and turn with their
/// node. Faces of one document material share a number: material + 1, 0 for none. A mirrored node's faces change their
/// winding. Skins and morph targets are as they are at rest. Faces are duplicates only of those that the same instance
/// of a primitive draws, where all attributes agree, those that are left out, too.
Result<SoupFile> flatten_instances(const GltfDocument& document, std::span<const MeshInstance> instances,
                                   Primitives meshes);

/// Joins a scene's triangles so, at one level of detail (see collect_instances). Notes say what was left out of them.
Result<SoupFile> flatten_scene(const GltfDocument& document, std::size_t level);

/// Reads the finest level of a glTF as `flatten_scene` joins it. Errors: as those of GltfDocument, and Unsupported.
Result<SoupFile> read_gltf(std::span<const std::byte> bytes, const FileFetcher& fetch);

/// Returns an error for an extension that the document requires and that we would misread it without.
Result<void> check_required_extensions(const GltfDocument& document);

}  // namespace lodestone::detail
