#include "scene/write_glb.h"

#include <map>
#include <span>
#include <utility>

#include <lodestone/core/detail/compaction.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "gltf/gltf_mesh_writer.h"
#include "model/write_model.h"
#include "scene/mesh_model.h"
#include "scene/scene_mesh.h"
#include "scene/scene_primitives.h"

namespace lodestone::detail {
namespace {

/// Adds geometry to a model's one buffer.
class GeometryAdder {
 public:
  explicit GeometryAdder(tinygltf::Model& model) : model_(model) { model_.buffers.resize(1); }

  int add_positions(const Mesh& mesh) {
    const std::vector<Vec3f> positions = pick_entries(mesh.positions, mesh.wedge_vertex);
    const auto bytes = std::as_bytes(std::span(positions));
    const PositionBounds bounds = bounds_of(bytes);
    tinygltf::Accessor accessor = accessor_of(ComponentType::Float32, 3, positions.size());
    accessor.bufferView = add_view(bytes, TINYGLTF_TARGET_ARRAY_BUFFER, sizeof(Vec3f));
    accessor.minValues = {bounds.low.x, bounds.low.y, bounds.low.z};
    accessor.maxValues = {bounds.high.x, bounds.high.y, bounds.high.z};
    return push(std::move(accessor));
  }

  int add_attribute(const Attribute& attribute) {
    const std::size_t size = attribute.element_bytes(), stride = padded_to_four(size);
    tinygltf::Accessor accessor = accessor_of(attribute.type, attribute.component_count, attribute.data.size() / size);
    accessor.bufferView = add_view(with_stride(attribute.data, size, stride), TINYGLTF_TARGET_ARRAY_BUFFER, stride);
    accessor.normalized = attribute.normalized && attribute.type != ComponentType::Float32;
    return push(std::move(accessor));
  }

  int add_indices(std::span<const Index> indices, std::size_t point_count) {
    const PackedIndices packed = pack_indices(indices, point_count);
    tinygltf::Accessor accessor = accessor_of(packed.type, 1, indices.size());
    accessor.bufferView = add_view(packed.bytes, TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER, 0);
    return push(std::move(accessor));
  }

  void require_extension(const char* name) {
    if (!model_.extensionsRequired.empty()) return;
    model_.extensionsUsed.push_back(name);
    model_.extensionsRequired.push_back(name);
  }

 private:
  static tinygltf::Accessor accessor_of(ComponentType type, int component_count, std::size_t count) {
    tinygltf::Accessor accessor;
    accessor.componentType = static_cast<int>(type);
    accessor.type = component_count == 1 ? TINYGLTF_TYPE_SCALAR : component_count;  // VEC2 is 2, and so on
    accessor.count = count;
    return accessor;
  }

  int push(tinygltf::Accessor accessor) {
    model_.accessors.push_back(std::move(accessor));
    return static_cast<int>(model_.accessors.size() - 1);
  }

  int add_view(std::span<const std::byte> bytes, int target, std::size_t stride) {
    std::vector<unsigned char>& data = model_.buffers[0].data;
    data.resize(padded_to_four(data.size()));
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = data.size();
    view.byteLength = bytes.size();
    view.byteStride = stride;
    view.target = target;
    const auto* first = reinterpret_cast<const unsigned char*>(bytes.data());
    data.insert(data.end(), first, first + bytes.size());
    model_.bufferViews.push_back(std::move(view));
    return static_cast<int>(model_.bufferViews.size() - 1);
  }

  tinygltf::Model& model_;
};

/// All primitives share their vertices. Pre: face_material counts the mesh's primitives.
Result<void> add_geometry(const Mesh& mesh, tinygltf::Model& model) {
  tinygltf::Mesh& out = model.meshes[0];
  const MeshSource source = source_of(mesh, out.primitives.size());
  LODESTONE_TRY(const LevelGeometry matched, match_level(mesh, source));
  const Mesh ordered = in_hardware_order(with_attributes(mesh, matched.columns));
  GeometryAdder writer(model);
  std::map<std::string, int> shared = {{"POSITION", writer.add_positions(ordered)}};
  for (std::size_t i = 0; i < source.columns.size(); ++i) {
    if (source.columns[i].needs_quantization) writer.require_extension("KHR_mesh_quantization");
    shared[source.columns[i].semantic] = writer.add_attribute(ordered.attributes[i]);
  }
  for (const FacesOfMaterial& group : split_by_material(ordered)) {
    tinygltf::Primitive& primitive = out.primitives[group.material];
    primitive.attributes = shared;
    primitive.indices = writer.add_indices(group.corner_wedge, ordered.wedge_count());
  }
  return {};
}

}  // namespace

Result<std::vector<std::byte>> to_glb(const Mesh& mesh, const std::string& name) {
  MeshFile file;
  file.mesh = mesh;
  MeshModel made = model_of_mesh(file, name);
  if (!made.model.meshes.empty()) LODESTONE_CHECK(add_geometry(file.mesh, made.model));
  return write_model(made.model);
}

}  // namespace lodestone::detail
