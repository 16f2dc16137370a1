#include "glb_builder.h"
#include "gltf_mesh_writer.h"
#include "mesh_writers.h"

namespace lodestone::detail {

Result<std::vector<std::byte>> to_glb(const Mesh& mesh, const std::string& name) {
  GlbBuilder builder;
  const MaterialTable materials(builder, {mesh.face_material.begin(), mesh.face_material.end()});
  Json node = {{"name", name}};
  if (const auto index = add_plain_mesh(builder, mesh, name, materials)) node["mesh"] = *index;
  builder.add("nodes", std::move(node));
  builder.add("scenes", {{"nodes", Json::array({0})}});
  return builder.finish();
}

}  // namespace lodestone::detail
