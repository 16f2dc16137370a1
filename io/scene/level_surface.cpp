#include <map>
#include <utility>

#include <lodestone/core/assemble.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/scene.h>

#include "gltf/gltf_flatten.h"
#include "gltf/gltf_mesh_writer.h"
#include "gltf/gltf_primitive.h"
#include "gltf/gltf_scene.h"
#include "mesh/soup_file.h"
#include "scene/scene_impl.h"
#include "scene/scene_primitives.h"

namespace lodestone {
namespace {

using namespace detail;

/// Adds an attribute of a level under the name that it has in files, as a reader of surfaces finds it there.
void add_attribute(const MeshColumn& column, Attribute attribute, Primitive& primitive) {
  const std::size_t count = primitive.positions.size();
  AccessorData data{attribute.type, attribute.component_count, attribute.normalized, count, std::move(attribute.data)};
  if (column.target) {
    const std::string name = target_attribute_name(*column.target, column.semantic);
    primitive.targets.push_back(to_attribute(name, data, PrimitiveContent::Surface));
  } else {
    primitive.attributes.push_back(to_attribute(column.semantic, data, PrimitiveContent::Surface));
  }
}

/// Splits a level into the primitives that a file would have of it.
Result<std::vector<Primitive>> primitives_of(const GltfDocument& document, const MeshSource& source, const Mesh& mesh) {
  LODESTONE_TRY(const LevelGeometry level, match_level(mesh, source));
  LODESTONE_TRY(const Json* const json, document.element("meshes", "mesh", source.mesh));
  std::vector<Primitive> primitives;
  for (const FacesOfMaterial& group : split_by_material(mesh)) {
    const SourcePrimitive& described = source.primitives[group.material];
    Mesh part = submesh(mesh, group.corner_wedge, attributes_of(level, described));
    Primitive& primitive = primitives.emplace_back();
    primitive.number = group.material;
    LODESTONE_TRY(primitive.material,
                  material_number(json->at("primitives")[group.material], document, text("mesh ", source.mesh)));
    for (const Index vertex : part.wedge_vertex) primitive.positions.push_back(part.positions[vertex]);
    for (std::size_t i = 0; i < described.columns.size(); ++i)
      add_attribute(source.columns[described.columns[i]], std::move(part.attributes[i]), primitive);
    primitive.indices = std::move(part.corner_wedge);
  }
  return primitives;
}

}  // namespace

Result<Mesh> level_surface(const Scene& scene, std::span<const LeveledMesh> meshes, std::size_t level) {
  const Scene::Impl& impl = scene.impl();
  Primitives primitives;
  for (std::size_t i = 0; i < impl.sources.size(); ++i) {
    const MeshSource& source = impl.sources[i];
    LODESTONE_TRY(primitives[source.mesh], primitives_of(impl.document, source, meshes[i].levels[level].mesh));
  }
  LODESTONE_TRY(const auto instances, collect_instances(impl.document, 0));
  for (const MeshInstance& instance : instances) primitives.try_emplace(instance.mesh);
  LODESTONE_TRY(SoupFile file, flatten_instances(impl.document, instances, std::move(primitives)));
  tidy_normals(file);
  LODESTONE_TRY(AssembledMesh assembled, assemble(file.soup));
  return std::move(assembled.mesh);
}

}  // namespace lodestone
