#include "gltf/gltf_primitive.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <set>

#include <lodestone/core/detail/compaction.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "gltf/draco_decode.h"

namespace lodestone::detail {
namespace {

// How often a mesh may have all that its file can hold.
constexpr std::size_t kMostCopies = 8;

enum Mode : std::size_t { kTriangles = 4, kTriangleStrip = 5, kTriangleFan = 6 };

const Json* draco_extension(const Json& primitive) {
  return GltfDocument::extension(primitive, "KHR_draco_mesh_compression");
}

/// Returns the members of a primitive's `attributes` with their accessors; POSITION must be there.
Result<std::map<std::string, std::size_t>> attribute_accessors(const Json& primitive, const std::string& where) {
  std::map<std::string, std::size_t> accessors;
  const Json* attributes = find_member(primitive, "attributes");
  if (attributes == nullptr || !attributes->is_object() || !attributes->contains("POSITION"))
    return fail(ErrorCode::Malformed, where + ": has no POSITION");
  for (const auto& [name, unused] : attributes->items()) {
    LODESTONE_TRY(accessors[name], size_member(*attributes, name.c_str(), where));
  }
  return accessors;
}

Result<std::vector<Vec3f>> to_positions(const AccessorData& data, const std::string& where) {
  if (data.component_count != 3)
    return fail(ErrorCode::Malformed, text(where, ": POSITION has ", int{data.component_count}, " components"));
  const std::vector<float> values = to_floats(data);
  std::vector<Vec3f> positions(data.count);
  if (!positions.empty())
    std::memcpy(static_cast<void*>(positions.data()), values.data(), values.size() * sizeof(float));
  return positions;
}

std::vector<Index> all_in_order(std::size_t count) {
  std::vector<Index> indices(count);
  for (std::size_t i = 0; i < count; ++i) indices[i] = static_cast<Index>(i);
  return indices;
}

Index restart_value(ComponentType type) {
  return type == ComponentType::UInt8 ? 0xff : type == ComponentType::UInt16 ? 0xffff : 0xffffffff;
}

Result<void> check_indices(std::span<const Index> indices, std::size_t point_count, ComponentType type,
                           const std::string& where) {
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (indices[i] == restart_value(type))
      return fail(ErrorCode::Malformed,
                  text(where, ": index ", i, " is ", indices[i], ", the primitive restart value"));
    if (indices[i] >= point_count)
      return fail(ErrorCode::Malformed,
                  text(where, ": index ", i, " is ", indices[i], ": there are ", point_count, " vertices"));
  }
  return {};
}

/// Turns strips and fans into separate triangles, with glTF's winding; drops what is left over at the end. Where a
/// strip has a position twice in a triangle it is stitched to the next: no face is meant. Pre: corners are in range.
std::vector<Index> to_triangles(std::vector<Index> corners, std::size_t mode, const std::vector<Vec3f>& positions) {
  if (mode == kTriangles) {
    corners.resize(corners.size() / 3 * 3);
    return corners;
  }
  std::vector<Index> triangles;
  for (std::size_t i = 0; i + 2 < corners.size(); ++i) {
    if (mode == kTriangleFan) {
      triangles.insert(triangles.end(), {corners[i + 1], corners[i + 2], corners[0]});
      continue;
    }
    const Vec3f &a = positions[corners[i]], &b = positions[corners[i + 1]], &c = positions[corners[i + 2]];
    if (a != b && b != c && a != c)
      triangles.insert(triangles.end(), {corners[i], corners[i + 1 + i % 2], corners[i + 2 - i % 2]});
  }
  return triangles;
}

/// Drops the points that no triangle uses: primitives often share the buffers of a whole mesh.
void drop_unused_points(Primitive& primitive) {
  const Compaction points = in_old_order(primitive.positions.size(), primitive.indices);
  if (points.used().size() == primitive.positions.size()) return;
  for (Index& point : primitive.indices) point = points.number(point);
  for (Attribute& attribute : primitive.attributes) attribute = pick_elements(attribute, points.used());
  for (Attribute& target : primitive.targets) target = pick_elements(target, points.used());
  primitive.positions = pick_entries(primitive.positions, points.used());
}

Result<void> check_attribute(const Primitive& primitive, const std::string& name, const AccessorData& data,
                             const std::string& where) {
  if (data.component_count > 4)
    return fail(ErrorCode::Unsupported, text(where, ": ", name, " has ", int{data.component_count}, " components"));
  if (data.count == primitive.positions.size()) return {};
  return fail(ErrorCode::Malformed,
              text(where, ": ", name, " has ", data.count, " elements for ", primitive.positions.size(), " positions"));
}

}  // namespace

Attribute to_attribute(const std::string& name, const AccessorData& data, PrimitiveContent content) {
  const bool turns = content == PrimitiveContent::Surface && (name == "NORMAL" || name == "TANGENT");
  if (turns) return float_attribute(name, data.component_count, to_floats(data));
  return {name, data.type, data.component_count, data.normalized, data.bytes};
}

Result<Index> material_number(const Json& primitive, const GltfDocument& document, const std::string& where) {
  if (find_member(primitive, "material") == nullptr) return Index{0};
  LODESTONE_TRY(const std::size_t material, size_member(primitive, "material", where));
  LODESTONE_CHECK(document.element("materials", (where + ": material").c_str(), material));
  return static_cast<Index>(material + 1);
}

std::string target_attribute_name(std::size_t target, const std::string& semantic) {
  return text("TARGET_", target, ':', semantic);
}

Result<std::vector<Primitive>> PrimitiveReader::read_mesh(std::size_t mesh) {
  accessors_.clear();
  bytes_ = 0;
  LODESTONE_TRY(const Json* const json, document_.element("meshes", "mesh", mesh));
  const Json* list = find_member(*json, "primitives");
  if (list == nullptr || !list->is_array())
    return fail(ErrorCode::Malformed, text("mesh ", mesh, ": has no primitives"));

  std::vector<Primitive> primitives;
  for (std::size_t i = 0; i < list->size(); ++i) {
    const Json& item = (*list)[i];
    const std::string where = text("mesh ", mesh, " primitive ", i);
    LODESTONE_TRY(const std::size_t mode, size_member_or(item, "mode", kTriangles, where));
    if (mode > kTriangleFan) return fail(ErrorCode::Malformed, text(where, ": mode ", mode));
    if (mode < kTriangles) {
      ++omissions_.points_and_lines;
      continue;
    }
    const Json* draco = draco_extension(item);
    LODESTONE_TRY(Primitive primitive,
                  draco != nullptr ? read_draco(item, *draco, mode, where) : read_plain(item, mode, where));
    LODESTONE_TRY(primitive.material, material_number(item, document_, where));
    LODESTONE_CHECK(add_targets(primitive, item, where));
    primitive.number = i;
    drop_unused_points(primitive);
    primitives.push_back(std::move(primitive));
  }
  return primitives;
}

Result<void> PrimitiveReader::add_attribute(Primitive& primitive, const std::string& name, const AccessorData& data,
                                            const std::string& where) {
  if (name == "POSITION") return {};
  LODESTONE_CHECK(check_attribute(primitive, name, data, where));
  LODESTONE_CHECK(spend(data.bytes.size(), where));
  primitive.attributes.push_back(to_attribute(name, data, content_));
  return {};
}

Result<void> PrimitiveReader::add_targets(Primitive& primitive, const Json& json, const std::string& where) {
  const Json* targets = find_member(json, "targets");
  if (targets == nullptr) return {};
  if (!targets->is_array()) return fail(ErrorCode::Malformed, where + ": targets is not an array");
  omissions_.morph_targets += targets->size();
  for (std::size_t i = 0; i < targets->size(); ++i) {
    const Json& target = (*targets)[i];
    const std::string target_where = text(where, " target ", i);
    if (!target.is_object()) return fail(ErrorCode::Malformed, target_where + ": is not an object");
    for (const auto& [semantic, unused] : target.items()) {
      LODESTONE_TRY(const std::size_t index, size_member(target, semantic.c_str(), target_where));
      LODESTONE_TRY(const AccessorData* const data, accessor(index));
      LODESTONE_CHECK(check_attribute(primitive, semantic, *data, target_where));
      LODESTONE_CHECK(spend(data->count * data->component_count * sizeof(float), where));
      primitive.targets.push_back(
          float_attribute(target_attribute_name(i, semantic), data->component_count, to_floats(*data)));
    }
  }
  return {};
}

Result<const AccessorData*> PrimitiveReader::accessor(std::size_t index) {
  const auto known = accessors_.find(index);
  if (known != accessors_.end()) return &known->second;
  LODESTONE_TRY(AccessorData data, document_.accessor(index));
  return &accessors_.emplace(index, std::move(data)).first->second;
}

Result<void> PrimitiveReader::spend(std::size_t bytes, const std::string& where) {
  bytes_ += bytes;
  const std::size_t limit = kMostCopies * document_.expansion_limit();
  if (bytes_ <= limit) return {};
  return fail(ErrorCode::LimitExceeded, text(where, ": attributes and morph targets of more than ", limit,
                                             " bytes are more than can come from this file"));
}

Result<Primitive> PrimitiveReader::read_plain(const Json& json, std::size_t mode, const std::string& where) {
  Primitive primitive;
  LODESTONE_TRY(const auto names, attribute_accessors(json, where));
  LODESTONE_TRY(const AccessorData* const positions, accessor(names.at("POSITION")));
  LODESTONE_TRY(primitive.positions, to_positions(*positions, where));
  for (const auto& [name, index] : names) {
    LODESTONE_TRY(const AccessorData* const data, accessor(index));
    LODESTONE_CHECK(add_attribute(primitive, name, *data, where));
  }
  std::vector<Index> corners;
  if (find_member(json, "indices") == nullptr) {
    corners = all_in_order(primitive.positions.size());
  } else {
    LODESTONE_TRY(const std::size_t index, size_member(json, "indices", where));
    LODESTONE_TRY(const AccessorData* const data, accessor(index));
    LODESTONE_TRY(corners, to_indices(*data, where));
    LODESTONE_CHECK(check_indices(corners, primitive.positions.size(), data->type, where));
  }
  primitive.indices = to_triangles(std::move(corners), mode, primitive.positions);
  return primitive;
}

Result<Primitive> PrimitiveReader::read_draco(const Json& json, const Json& extension, std::size_t mode,
                                              const std::string& where) {
  if (mode == kTriangleFan) return fail(ErrorCode::Malformed, where + ": Draco data cannot be a triangle fan");
  LODESTONE_TRY(const auto names, attribute_accessors(json, where));
  LODESTONE_TRY(const auto ids, attribute_accessors(extension, where + " Draco"));
  std::vector<DracoRequest> requests;
  for (const auto& [name, id] : ids) {
    const auto declared = names.find(name);
    if (declared == names.end())
      return fail(ErrorCode::Malformed, text(where, ": Draco attribute ", name, " is not declared"));
    LODESTONE_TRY(const AccessorData type, document_.accessor_type(declared->second));
    requests.push_back({static_cast<std::uint32_t>(id), type.type, type.component_count, type.normalized});
  }
  LODESTONE_TRY(const std::size_t view_index, size_member(extension, "bufferView", where));
  LODESTONE_TRY(const BufferView view, document_.buffer_view(view_index));
  LODESTONE_TRY(DracoGeometry geometry, decode_draco(view.bytes, requests, where));

  Primitive primitive;
  const auto position = static_cast<std::size_t>(std::distance(ids.begin(), ids.find("POSITION")));
  LODESTONE_TRY(primitive.positions, to_positions(geometry.attributes[position], where));
  for (const auto& [name, index] : names) {
    const auto compressed = ids.find(name);
    if (compressed != ids.end()) {
      const auto& data = geometry.attributes[static_cast<std::size_t>(std::distance(ids.begin(), compressed))];
      LODESTONE_CHECK(add_attribute(primitive, name, data, where));
    } else {
      LODESTONE_TRY(const AccessorData* const data, accessor(index));
      LODESTONE_CHECK(add_attribute(primitive, name, *data, where));
    }
  }
  primitive.indices = std::move(geometry.indices);  // Draco stores triangles, whatever the mode says.
  return primitive;
}

namespace {

Result<std::vector<std::size_t>> target_accessors(const Json& primitive, const std::string& where) {
  std::vector<std::size_t> accessors;
  const Json* targets = find_member(primitive, "targets");
  if (targets == nullptr || !targets->is_array()) return accessors;
  for (const Json& target : *targets) {
    if (!target.is_object()) continue;
    for (const auto& [name, unused] : target.items()) {
      LODESTONE_TRY(const std::size_t index, size_member(target, name.c_str(), where));
      accessors.push_back(index);
    }
  }
  return accessors;
}

/// Lists the objects of a primitive that name a bufferView: its accessors and its Draco data.
Result<std::vector<const Json*>> view_holders(const GltfDocument& document, const Json& primitive,
                                              const std::string& where) {
  std::vector<const Json*> holders;
  LODESTONE_TRY(auto accessors, attribute_accessors(primitive, where));
  if (find_member(primitive, "indices") != nullptr) {
    LODESTONE_TRY(accessors["indices"], size_member(primitive, "indices", where));
  }
  for (const auto& [name, index] : accessors) {
    LODESTONE_TRY(const Json* const accessor, document.element("accessors", "accessor", index));
    holders.push_back(accessor);
  }
  LODESTONE_TRY(const auto targets, target_accessors(primitive, where));
  for (const std::size_t index : targets) {
    LODESTONE_TRY(const Json* const accessor, document.element("accessors", "accessor", index));
    holders.push_back(accessor);
  }
  if (const Json* draco = draco_extension(primitive)) holders.push_back(draco);
  return holders;
}

}  // namespace

Result<std::vector<std::size_t>> geometry_views(const GltfDocument& document, std::size_t mesh) {
  const std::string where = text("mesh ", mesh);
  LODESTONE_TRY(const Json* const json, document.element("meshes", "mesh", mesh));
  const Json* list = find_member(*json, "primitives");
  if (list == nullptr || !list->is_array()) return fail(ErrorCode::Malformed, where + ": has no primitives");
  std::set<std::size_t> views;
  for (const Json& primitive : *list) {
    LODESTONE_TRY(const auto holders, view_holders(document, primitive, where));
    for (const Json* holder : holders) {
      if (find_member(*holder, "bufferView") == nullptr) continue;
      LODESTONE_TRY(const std::size_t view, size_member(*holder, "bufferView", where));
      views.insert(view);
    }
  }
  return std::vector<std::size_t>(views.begin(), views.end());
}

bool uses_draco(const GltfDocument& document, std::size_t mesh) {
  const auto json = document.element("meshes", "mesh", mesh);
  const Json* list = json ? find_member(**json, "primitives") : nullptr;
  return list != nullptr && list->is_array() &&
         std::any_of(list->begin(), list->end(), [](const Json& item) { return draco_extension(item) != nullptr; });
}

}  // namespace lodestone::detail
