#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/io/scene.h>

#include "gltf/gltf_document.h"

namespace lodestone::detail {

/// One attribute of a joined mesh, and what its primitives call it.
struct MeshColumn {
  Attribute layout;                   ///< without data; the name is that of the mesh's attribute
  std::string semantic;               ///< the member of `attributes`, or of the morph target
  std::optional<std::size_t> target;  ///< the morph target it belongs to
  bool needs_quantization = false;    ///< only legal with KHR_mesh_quantization
};

/// A primitive of a mesh in the document.
struct SourcePrimitive {
  bool replaced = false;             ///< it has triangles, which levels replace; others stay as they are
  std::vector<std::size_t> columns;  ///< which of the mesh's columns it has
  std::size_t target_count = 0;      ///< morph targets
};

/// How a node shows its mesh.
struct NodePresence {
  Box box;                         ///< in the world; of its largest instance
  double scale = 0;                ///< the largest stretch of its instances: world units per mesh unit
  double area = 0;                 ///< of all its instances, squared world units
  std::size_t instance_count = 0;  ///< 1, but for EXT_mesh_gpu_instancing
};

/// Where a scene mesh comes from.
struct MeshSource {
  std::size_t mesh = 0;                     ///< its number in the document
  std::vector<MeshColumn> columns;          ///< of all primitives together
  std::vector<SourcePrimitive> primitives;  ///< as many as the document's mesh has
  std::vector<std::size_t> nodes;           ///< that show it in a scene, ascending
  std::vector<NodePresence> presence;       ///< one for each of the nodes
};

/// An image that gets a bufferView of its own.
struct EmbeddedImage {
  std::size_t image = 0;
  std::string mime_type;
  std::vector<std::byte> bytes;
};

}  // namespace lodestone::detail

namespace lodestone {

struct Scene::Impl {
  detail::GltfDocument document;
  std::vector<SceneMesh> meshes;
  std::vector<detail::MeshSource> sources;  ///< one for each of the meshes
  std::vector<detail::EmbeddedImage> images;
  std::vector<detail::Json> dropped_meshes;  ///< coarser levels that were taken out of the document
  std::vector<AssemblyReport> dropped;       ///< of meshes without a usable triangle
  std::vector<std::string> notes;
  std::vector<std::filesystem::path> files;
  bool in_metres = false;
  Box box;
};

}  // namespace lodestone
