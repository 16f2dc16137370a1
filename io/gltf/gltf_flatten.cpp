#include "gltf/gltf_flatten.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <map>
#include <set>
#include <string_view>
#include <unordered_map>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "base/files_beside.h"
#include "gltf/gltf_attribute.h"
#include "gltf/gltf_primitive.h"
#include "gltf/gltf_scene.h"
#include "gltf/gltf_skin.h"
#include "gltf/morph_range.h"
#include "gltf/morph_targets.h"

namespace lodestone::detail {
namespace {

// Nodes may show one mesh any number of times, so that a scene's size is not bounded by its file's.
constexpr std::size_t kMaxCorners = 300'000'000;
constexpr std::size_t kTargetCost = 100;  // of a morph target that is looked at, in points that it moves

// Extensions that are decoded, and those that have no say in where triangles are.
constexpr std::array<std::string_view, 10> kKnownExtensions = {
    "KHR_draco_mesh_compression", "EXT_mesh_gpu_instancing", "KHR_mesh_quantization",
    "EXT_meshopt_compression",    "KHR_meshopt_compression", "MSFT_lod",
    "KHR_lights_punctual",        "KHR_animation_pointer",   "KHR_xmp_json_ld",
    "LODESTONE_removal_stream"};
constexpr std::array<std::string_view, 6> kKnownPrefixes = {"KHR_materials_", "KHR_texture_",  "EXT_texture_",
                                                            "EXT_lights_",    "MSFT_texture_", "MSFT_packing_"};

bool is_known(std::string_view name) {
  return std::find(kKnownExtensions.begin(), kKnownExtensions.end(), name) != kKnownExtensions.end() ||
         std::any_of(kKnownPrefixes.begin(), kKnownPrefixes.end(),
                     [&](auto prefix) { return name.starts_with(prefix); });
}

Attribute layout_of(const Attribute& a) { return {a.name, a.type, a.component_count, a.normalized, {}}; }

bool is_skinning(std::string_view name) { return name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_"); }

/// Which attributes the joined triangles have: empty ones that show the layout, and the names of those left out.
struct CommonAttributes {
  std::vector<Attribute> layouts;
  std::set<std::string> dropped;
};

/// Keeps what every primitive with triangles has in the same layout. Joints and weights go with their skins.
CommonAttributes find_common_attributes(const Primitives& meshes, bool has_skins) {
  std::map<std::string, std::pair<Attribute, std::size_t>> seen;  // by name: the first layout, and how many have it
  std::size_t primitive_count = 0;
  for (const auto& [mesh, primitives] : meshes)
    for (const Primitive& primitive : primitives) {
      if (primitive.indices.empty()) continue;
      ++primitive_count;
      for (const Attribute& a : primitive.attributes) {
        auto& [layout, count] = seen.try_emplace(a.name, layout_of(a), 0).first->second;
        count += same_layout(layout, a);
      }
    }
  CommonAttributes common;
  for (const auto& [name, entry] : seen) {
    if (has_skins && is_skinning(name)) continue;
    if (entry.second == primitive_count)
      common.layouts.push_back(entry.first);
    else
      common.dropped.insert(name);
  }
  return common;
}

/// Where the points of a primitive go: all with their node, or each with its joints.
class Placement {
 public:
  Placement(const Primitive& primitive, const Transform& world, std::span<const Transform> joints)
      : world_(world), joints_(joints), skinner_(primitive.attributes) {}

  bool is_identity() const { return !is_skinned() && world_.is_identity(); }
  bool mirrors() const { return !is_skinned() && world_.mirrors(); }
  Transform at(std::size_t point) const { return is_skinned() ? skinner_.pose(point, joints_) : world_; }

 private:
  bool is_skinned() const { return !joints_.empty() && !skinner_.empty(); }

  const Transform& world_;
  std::span<const Transform> joints_;
  Skinner skinner_;
};

/// Turns the vectors of a NORMAL or TANGENT with their points.
void turn(Attribute& attribute, std::size_t first_byte, const Placement& placement) {
  const std::size_t stride = attribute.element_bytes();
  const bool tangent = attribute.name == "TANGENT";
  for (std::size_t at = first_byte; at < attribute.data.size(); at += stride) {
    const Transform world = placement.at((at - first_byte) / stride);
    Vec3f vector;
    std::memcpy(&vector, attribute.data.data() + at, sizeof vector);
    vector = tangent ? world.direction(vector) : world.normal(vector);
    std::memcpy(attribute.data.data() + at, &vector, sizeof vector);
    if (!tangent || attribute.component_count < 4 || !placement.mirrors()) continue;
    float handedness;  // Of the bitangent: a mirrored surface has its mirror image.
    std::memcpy(&handedness, attribute.data.data() + at + sizeof vector, sizeof handedness);
    handedness = -handedness;
    std::memcpy(attribute.data.data() + at + sizeof vector, &handedness, sizeof handedness);
  }
}

void append_attributes(std::vector<Attribute>& attributes, const Primitive& primitive, const Placement& placement) {
  for (Attribute& attribute : attributes) {
    const auto source = std::find_if(primitive.attributes.begin(), primitive.attributes.end(),
                                     [&](const Attribute& a) { return a.name == attribute.name; });
    const std::size_t first_byte = attribute.data.size();
    append_bytes(attribute.data, source->data);
    const bool turns = (attribute.name == "NORMAL" || attribute.name == "TANGENT") && attribute.component_count >= 3;
    if (turns && !placement.is_identity()) turn(attribute, first_byte, placement);
  }
}

/// Numbers the points of a primitive by what they have beside the attributes that are kept.
std::vector<Index> number_sheets(const Primitive& primitive, const std::vector<Attribute>& kept) {
  const auto is_kept = [&](const Attribute& a) {
    return std::any_of(kept.begin(), kept.end(), [&](const Attribute& b) { return a.name == b.name; });
  };
  std::vector<const Attribute*> left_out;
  for (const Attribute& a : primitive.attributes)
    if (!is_kept(a)) left_out.push_back(&a);
  for (const Attribute& a : primitive.targets) left_out.push_back(&a);
  std::unordered_map<std::string, Index> numbers;
  std::vector<Index> sheet;
  std::string bytes;
  for (std::size_t i = 0; i < primitive.positions.size(); ++i) {
    bytes.clear();
    for (const Attribute* a : left_out)
      bytes.append(reinterpret_cast<const char*>(a->data.data()) + i * a->element_bytes(), a->element_bytes());
    sheet.push_back(numbers.try_emplace(bytes, static_cast<Index>(numbers.size())).first->second);
  }
  return sheet;
}

Result<void> append_primitive(TriangleSoup& soup, const Primitive& primitive, const Placement& placement) {
  const std::size_t first = soup.positions.size();
  if (first + primitive.positions.size() > kMaxCorners || soup.indices.size() + primitive.indices.size() > kMaxCorners)
    return fail(ErrorCode::LimitExceeded, text("gltf: the scene has more than ", kMaxCorners, " corners"));
  for (std::size_t i = 0; i < primitive.positions.size(); ++i)
    soup.positions.push_back(placement.at(i).point(primitive.positions[i]));
  append_attributes(soup.attributes, primitive, placement);
  // No other primitive or instance has these numbers.
  for (const Index number : primitive.sheet) soup.point_sheet.push_back(static_cast<Index>(first + number));
  const bool mirrored = placement.mirrors();
  for (std::size_t i = 0; i < primitive.indices.size(); i += 3) {
    const Index a = primitive.indices[i], b = primitive.indices[i + 1], c = primitive.indices[i + 2];
    for (const Index point : {a, mirrored ? c : b, mirrored ? b : c})
      soup.indices.push_back(static_cast<Index>(first + point));
    soup.face_material.push_back(primitive.material);
  }
  return {};
}

/// Moves directions as floats; those of tangents have a fourth component, which stays.
void morph_directions(Attribute& attribute, const MorphTargets& targets, std::span<const float> weights) {
  const std::size_t stride = attribute.element_bytes();
  if (attribute.component_count < 3 || targets.count_shown(weights) == 0) return;
  std::vector<Vec3> vectors;
  for (std::size_t at = 0; at < attribute.data.size(); at += stride) {
    Vec3f vector;
    std::memcpy(&vector, attribute.data.data() + at, sizeof vector);
    vectors.push_back(Vec3(vector));
  }
  targets.move(vectors, weights);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const Vec3f vector = to_float(normalized(vectors[i]));
    std::memcpy(attribute.data.data() + i * stride, &vector, sizeof vector);
  }
}

/// Returns the primitive without its targets, moved by them.
Primitive morphed(const Primitive& primitive, const MorphTargets& targets, std::span<const float> weights) {
  Primitive moved{primitive.positions, primitive.attributes, {}, primitive.indices, primitive.sheet,
                  primitive.material,  primitive.number};
  std::vector<Vec3> points;
  for (const Vec3f& p : primitive.positions) points.push_back(Vec3(p));
  targets.move(points, weights);
  for (std::size_t i = 0; i < points.size(); ++i) moved.positions[i] = to_float(points[i]);
  for (Attribute& attribute : moved.attributes)
    if (attribute.name == "NORMAL" || attribute.name == "TANGENT")
      morph_directions(attribute, MorphTargets(primitive.targets, attribute.name), weights);
  return moved;
}

/// Shows meshes at the weights of their morph targets at rest, one instance after the other.
class RestMorph {
 public:
  explicit RestMorph(const GltfDocument& document) : document_(document) {}

  /// The result is valid until the next call.
  Result<std::span<const Primitive>> primitives_of(const MeshInstance& instance,
                                                   std::span<const Primitive> primitives) {
    const auto has_no_targets = [](const Primitive& p) { return p.targets.empty(); };
    if (std::all_of(primitives.begin(), primitives.end(), has_no_targets)) return primitives;
    const auto found = document_.element("nodes", "node", instance.node);
    const Json* node = found ? *found : nullptr;
    const std::pair shown{instance.mesh, node != nullptr && node->contains("weights") ? instance.node : kNoNode};
    if (shown != shown_) {
      shown_ = shown;
      LODESTONE_CHECK(morph(primitives, weights_at_rest(document_, node != nullptr ? *node : Json(), instance.mesh)));
    }
    return morphed_.empty() ? primitives : morphed_;
  }

 private:
  Result<void> morph(std::span<const Primitive> primitives, const TargetWeights& weights) {
    morphed_.clear();
    std::size_t moved = 0;
    for (const Primitive& primitive : primitives) {
      const MorphTargets targets(primitive.targets);
      const std::size_t shown = targets.count_shown(weights);
      moved += shown;
      spent_ += kTargetCost * primitive.targets.size() + (1 + shown) * primitive.positions.size();
      if (spent_ > kMaxCorners)
        return fail(ErrorCode::LimitExceeded, text("gltf: morph targets move more than ", kMaxCorners, " points"));
      morphed_.push_back(morphed(primitive, targets, weights));
    }
    if (moved == 0) morphed_.clear();
    return {};
  }

  const GltfDocument& document_;
  std::pair<std::size_t, std::size_t> shown_{kNoNode, kNoNode};  // a mesh, and the node whose own weights it has
  std::vector<Primitive> morphed_;
  std::size_t spent_ = 0;
};

using Joints = std::map<std::size_t, std::vector<Transform>>;  // by skin

Result<Joints> read_skins(const GltfDocument& document, std::span<const MeshInstance> instances) {
  Joints joints;
  std::vector<NodePlace> places;
  for (const MeshInstance& instance : instances) {
    if (instance.skin == kNoSkin || joints.contains(instance.skin)) continue;
    if (places.empty()) {
      LODESTONE_TRY(places, place_nodes(document));
    }
    LODESTONE_TRY(const Skin skin, read_skin(document, instance.skin));
    joints[instance.skin] = skin.pose(places);
  }
  return joints;
}

std::string join(const std::set<std::string>& names) {
  std::string out;
  for (const std::string& name : names) out += (out.empty() ? "" : ", ") + name;
  return out;
}

/// Says what the document holds beside triangles.
std::vector<std::string> note_left_out(const GltfDocument& document, const PrimitiveOmissions& omissions) {
  std::vector<std::string> notes;
  const auto note = [&](std::size_t count, const char* one, const char* many, const char* rest = "") {
    if (count > 0)
      notes.push_back(text(count, ' ', count == 1 ? one : many, count == 1 ? " is" : " are", " left out", rest));
  };
  note(omissions.points_and_lines, "primitive of points or lines", "primitives of points or lines");
  note(omissions.morph_targets, "morph target", "morph targets", "; meshes are as their weights at rest have them");
  note(document.count("skins"), "skin", "skins",
       ", with joints and weights; skinned meshes stand in the pose of their nodes");
  note(document.count("animations"), "animation", "animations");
  note(document.count("textures"), "texture", "textures");
  note(document.count("materials"), "material", "materials", "; faces keep apart by material");
  note(document.count("cameras"), "camera", "cameras");
  if (document.count("meshes") == 0)
    notes.push_back("the file has no meshes");
  else if (document.count("nodes") == 0)
    notes.push_back("the file has no nodes: all its meshes are read as they are stored");
  return notes;
}

}  // namespace

Result<SoupFile> flatten_instances(const GltfDocument& document, std::span<const MeshInstance> instances,
                                   Primitives meshes) {
  LODESTONE_TRY(Joints joints, read_skins(document, instances));
  CommonAttributes common = find_common_attributes(meshes, document.count("skins") > 0);

  for (auto& [mesh, primitives] : meshes)
    for (Primitive& primitive : primitives) primitive.sheet = number_sheets(primitive, common.layouts);

  SoupFile file;
  file.soup.attributes = std::move(common.layouts);
  RestMorph morph(document);
  for (const MeshInstance& instance : instances) {
    LODESTONE_TRY(const auto primitives, morph.primitives_of(instance, meshes[instance.mesh]));
    for (const Primitive& primitive : primitives) {
      if (primitive.indices.empty()) continue;
      LODESTONE_CHECK(append_primitive(file.soup, primitive, {primitive, instance.world, joints[instance.skin]}));
    }
  }
  auto& materials = file.soup.face_material;
  if (std::all_of(materials.begin(), materials.end(), [](Index m) { return m == 0; })) materials.clear();
  if (!common.dropped.empty())
    file.notes.push_back(
        text("attributes that not all primitives have in one layout are left out: ", join(common.dropped)));
  return file;
}

Result<SoupFile> flatten_scene(const GltfDocument& document, std::size_t level) {
  LODESTONE_TRY(const auto instances, collect_instances(document, level));
  PrimitiveReader reader(document);
  Primitives meshes;
  for (const MeshInstance& instance : instances) {
    if (meshes.contains(instance.mesh)) continue;
    LODESTONE_TRY(meshes[instance.mesh], reader.read_mesh(instance.mesh));
  }
  LODESTONE_TRY(SoupFile file, flatten_instances(document, instances, std::move(meshes)));
  const std::vector<std::string> left_out = note_left_out(document, reader.omissions());
  file.notes.insert(file.notes.begin(), left_out.begin(), left_out.end());
  return file;
}

Result<void> check_required_extensions(const GltfDocument& document) {
  const Json* required = find_member(document.json(), "extensionsRequired");
  if (required == nullptr) return {};
  if (!required->is_array()) return fail(ErrorCode::Malformed, "gltf: extensionsRequired is not an array");
  std::string unknown;
  for (const Json& item : *required) {
    const std::string name = item.is_string() ? item.get<std::string>() : "?";
    if (!is_known(name)) unknown += (unknown.empty() ? "" : ", ") + name;
  }
  if (unknown.empty()) return {};
  return fail(ErrorCode::Unsupported, text("gltf: requires extensions that are not supported: ", unknown));
}

Result<SoupFile> read_gltf(std::span<const std::byte> bytes, const FileFetcher& fetch) {
  LODESTONE_TRY(const GltfDocument document, GltfDocument::parse(bytes, fetch));
  LODESTONE_CHECK(check_required_extensions(document));
  return flatten_scene(document, 0);
}

}  // namespace lodestone::detail
