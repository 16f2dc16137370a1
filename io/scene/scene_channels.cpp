#include "scene/scene_channels.h"

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include <lodestone/core/detail/text.h>

namespace lodestone::detail {
namespace {

constexpr const char* kPointer = "KHR_animation_pointer";
constexpr const char* kNodes = "nodes";
constexpr const char* kMeshes = "meshes";
constexpr const char* kMaterials = "materials";

/// What a channel moves: "/nodes/3/weights/0", taken apart. A target that names a node and "weights" says the same.
struct Pointer {
  std::string array;
  std::size_t index = 0;
  std::string rest;  ///< with its slash
};

/// Reads digits up to a slash or the end.
std::optional<std::size_t> leading_number(std::string_view& text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string_view rest = text.substr(static_cast<std::size_t>(end - text.data()));
  if (error != std::errc() || !(rest.empty() || rest.starts_with('/'))) return std::nullopt;
  text = rest;
  return value;
}

std::optional<Pointer> split_pointer(std::string_view text) {
  if (!text.starts_with('/')) return std::nullopt;
  const std::size_t slash = text.find('/', 1);
  if (slash == std::string_view::npos) return std::nullopt;
  Pointer pointer{std::string(text.substr(1, slash - 1)), 0, ""};
  text.remove_prefix(slash + 1);
  const auto index = leading_number(text);
  if (!index) return std::nullopt;
  pointer.index = *index;
  pointer.rest = text;
  return pointer;
}

/// Returns the extension's text, or null where the target has none.
const Json* pointer_of(const Json& target) {
  const Json* extensions = find_member(target, "extensions");
  const Json* extension = extensions != nullptr ? find_member(*extensions, kPointer) : nullptr;
  const Json* pointer = extension != nullptr ? find_member(*extension, "pointer") : nullptr;
  return pointer != nullptr && pointer->is_string() ? pointer : nullptr;
}

std::optional<Pointer> target_of(const Json& channel) {
  const Json* target = find_member(channel, "target");
  if (target == nullptr) return std::nullopt;
  if (const Json* text = pointer_of(*target)) return split_pointer(text->get_ref<const std::string&>());
  const auto node = size_member(*target, "node", "");
  if (!node) return std::nullopt;
  return Pointer{kNodes, *node, '/' + string_member(*target, "path")};
}

bool points_into(const Pointer& pointer, std::string_view member) {
  return pointer.rest == member || pointer.rest.starts_with(std::string(member) + '/');
}

/// Turns "/primitives/2/…" into what that primitive's number is now; nothing where it is gone.
std::optional<std::string> renumber_primitive(const std::string& rest, const std::vector<std::size_t>& primitives) {
  constexpr std::string_view kPrefix = "/primitives/";
  if (!rest.starts_with(kPrefix)) return rest;
  std::string_view tail = std::string_view(rest).substr(kPrefix.size());
  const auto number = leading_number(tail);
  const auto found = number ? std::find(primitives.begin(), primitives.end(), *number) : primitives.end();
  if (found == primitives.end()) return std::nullopt;
  return text(kPrefix, found - primitives.begin(), tail);
}

Json retargeted(const Json& channel, const Pointer& pointer) {
  Json copy = channel;
  Json& target = copy["target"];
  if (pointer_of(target) != nullptr)
    target["extensions"][kPointer]["pointer"] = text('/', pointer.array, '/', pointer.index, pointer.rest);
  else
    target["node"] = pointer.index;
  return copy;
}

std::vector<ChannelMap::Place> places_at(const std::vector<std::size_t>& indices) {
  std::vector<ChannelMap::Place> places;
  for (const std::size_t index : indices) places.push_back({index, {}});
  return places;
}

}  // namespace

void ChannelMap::move_weights(std::size_t node, const std::vector<std::size_t>& nodes) {
  places_[{kNodes, node}] = places_at(nodes);
}

void ChannelMap::move_mesh(std::size_t mesh, std::vector<Place> meshes) {
  places_[{kMeshes, mesh}] = std::move(meshes);
}

void ChannelMap::move_material(std::size_t material, const std::vector<std::size_t>& materials) {
  places_[{kMaterials, material}] = places_at(materials);
}

/// Returns what a channel becomes: itself where nothing moved.
std::vector<Json> ChannelMap::channels_of(const Json& channel) const {
  const auto pointer = target_of(channel);
  if (!pointer || (pointer->array == kNodes && !points_into(*pointer, "/weights"))) return {channel};
  const auto found = places_.find({pointer->array, pointer->index});
  if (found == places_.end()) return {channel};
  std::vector<Json> channels;
  for (const Place& place : found->second) {
    auto rest = pointer->array == kMeshes ? renumber_primitive(pointer->rest, place.primitives) : pointer->rest;
    if (rest) channels.push_back(retargeted(channel, {pointer->array, place.index, std::move(*rest)}));
  }
  return channels;
}

void ChannelMap::apply(Json& document) const {
  if (find_member(document, "animations") == nullptr || !document["animations"].is_array()) return;
  for (Json& animation : document["animations"]) {
    const Json* list = find_member(animation, "channels");
    if (list == nullptr || !list->is_array()) continue;
    Json channels = Json::array(), copies = Json::array();
    for (const Json& channel : *list) {
      std::vector<Json> now = channels_of(channel);
      for (std::size_t i = 0; i < now.size(); ++i) (i == 0 ? channels : copies).push_back(std::move(now[i]));
    }
    for (Json& copy : copies) channels.push_back(std::move(copy));
    animation["channels"] = std::move(channels);
  }
}

}  // namespace lodestone::detail
