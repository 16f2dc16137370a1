#include "scene_nodes.h"

#include <string>

#include "text.h"

namespace lodestone::detail {
namespace {

constexpr const char* kInstancing = "EXT_mesh_gpu_instancing";
constexpr const char* kPointer = "KHR_animation_pointer";

Json* member(Json& value, const char* key) {
  if (!value.is_object()) return nullptr;
  const auto found = value.find(key);
  return found == value.end() ? nullptr : &*found;
}

/// Returns the string of KHR_animation_pointer, or null.
Json* pointer_of(Json& target) {
  Json* extensions = member(target, "extensions");
  Json* extension = extensions != nullptr ? member(*extensions, kPointer) : nullptr;
  Json* pointer = extension != nullptr ? member(*extension, "pointer") : nullptr;
  return pointer != nullptr && pointer->is_string() ? pointer : nullptr;
}

std::string weights_pointer(std::size_t node) { return text("/nodes/", node, "/weights"); }

bool points_to_weights(const std::string& pointer, std::size_t node) {
  const std::string whole = weights_pointer(node);
  return pointer == whole || pointer.starts_with(whole + '/');
}

/// True if the channel moves the morph target weights of the node.
bool moves_weights(Json& channel, std::size_t node) {
  Json* target = member(channel, "target");
  if (target == nullptr) return false;
  if (const Json* pointer = pointer_of(*target)) return points_to_weights(pointer->get<std::string>(), node);
  const auto index = size_member(*target, "node", "");
  return index && *index == node && string_member(*target, "path") == "weights";
}

/// Pre: the channel moves the weights of `from`.
void retarget(Json& channel, std::size_t from, std::size_t to) {
  Json& target = channel["target"];
  if (Json* pointer = pointer_of(target))
    *pointer = weights_pointer(to) + pointer->get<std::string>().substr(weights_pointer(from).size());
  else
    target["node"] = to;
}

template <class Edit>
void for_each_channel_list(Json& document, const Edit& edit) {
  Json* animations = member(document, "animations");
  if (animations == nullptr) return;
  for (Json& animation : *animations)
    if (Json* channels = member(animation, "channels"); channels != nullptr && channels->is_array()) edit(*channels);
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

void retarget_weights(Json& document, std::size_t node, std::size_t finest, std::span<const std::size_t> lower) {
  for_each_channel_list(document, [&](Json& channels) {
    const std::size_t count = channels.size();
    for (std::size_t i = 0; i < count; ++i) {
      if (!moves_weights(channels[i], node)) continue;
      retarget(channels[i], node, finest);
      for (const std::size_t other : lower) {
        Json copy = channels[i];
        retarget(copy, finest, other);
        channels.push_back(std::move(copy));
      }
    }
  });
}

void drop_weights_channels(Json& document, std::size_t node) {
  for_each_channel_list(document, [&](Json& channels) {
    for (std::size_t i = channels.size(); i-- > 0;)
      if (moves_weights(channels[i], node)) channels.erase(i);
  });
}

}  // namespace lodestone::detail
