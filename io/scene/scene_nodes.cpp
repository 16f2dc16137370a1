#include "scene/scene_nodes.h"

namespace lodestone::detail {
namespace {

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";

Json* member(Json& value, const char* key) {
  if (!value.is_object()) return nullptr;
  const auto found = value.find(key);
  return found == value.end() ? nullptr : &*found;
}

bool is_root(const Json& nodes, std::size_t node) {
  for (const Json& other : nodes)
    if (const Json* children = find_member(other, "children"))
      for (const Json& child : *children)
        if (child == node) return false;
  return true;
}

/// True if anything below a node can be seen, or sees: joints cannot.
bool children_show(const Json& nodes, std::size_t node) {
  const Json* children = find_member(nodes[node], "children");
  if (children == nullptr) return false;
  for (const Json& child : *children) {
    const Json& below = nodes[child.get<std::size_t>()];
    for (const char* key : {"mesh", "camera", "extensions"})
      if (find_member(below, key) != nullptr) return true;
    if (children_show(nodes, child.get<std::size_t>())) return true;
  }
  return false;
}

}  // namespace

void move_mesh_members(Json& from, Json& to) {
  for (const char* key : {"mesh", "skin", "weights"}) {
    if (!from.contains(key)) continue;
    to[key] = std::move(from[key]);
    from.erase(key);
  }
  Json* extensions = member(from, "extensions");
  if (extensions == nullptr || !extensions->is_object() || !extensions->contains(kInstancing)) return;
  to["extensions"][kInstancing] = std::move((*extensions)[kInstancing]);
  extensions->erase(kInstancing);
  if (extensions->empty()) from.erase("extensions");
}

void copy_instance_members(const Json& finest, Json& node) {
  for (const char* key : {"skin", "weights"})
    if (const Json* value = find_member(finest, key)) node[key] = *value;
  const Json* extensions = find_member(finest, "extensions");
  const Json* instancing = extensions != nullptr ? find_member(*extensions, kInstancing) : nullptr;
  if (instancing != nullptr) node["extensions"][kInstancing] = *instancing;
}

bool stays_in_place(const Json& document, std::size_t node) {
  const Json& nodes = document["nodes"];
  for (const char* key : {"extensions", "extras"})
    if (const Json* value = find_member(nodes[node], key); value != nullptr && !value->is_object()) return false;
  // Hidden or shown by its extension, a node takes only its children along.
  const Json* extensions = find_member(nodes[node], "extensions");
  if (extensions != nullptr && extensions->contains("KHR_node_visibility")) return false;
  return find_member(nodes[node], "skin") != nullptr && is_root(nodes, node) && !children_show(nodes, node);
}

}  // namespace lodestone::detail
