#include "scene/scene_materials.h"

#include <optional>
#include <utility>
#include <vector>

namespace lodestone::detail {

std::size_t LevelMaterials::copy_of(std::size_t material, std::size_t level) {
  const auto [entry, is_new] = copies_[material].try_emplace(level);
  if (is_new) entry->second = builder_.add("materials", Json(builder_.at("materials", material)));
  return entry->second;
}

std::size_t LevelMaterials::plain_of(std::size_t level) {
  const auto [entry, is_new] = plain_.try_emplace(level);
  if (is_new) entry->second = builder_.add("materials", Json::object());
  return entry->second;
}

/// What names no material of the document is left alone.
void LevelMaterials::separate_member(Json& holder, std::size_t level) {
  const Json* member = find_member(holder, "material");
  const auto material = member != nullptr ? as_size(*member) : std::nullopt;
  const Json* materials = find_member(builder_.document(), "materials");
  if (material && materials != nullptr && materials->is_array() && *material < materials->size())
    holder["material"] = copy_of(*material, level);
}

void LevelMaterials::separate(Json& primitives, std::size_t level) {
  for (Json& primitive : primitives) {
    const bool is_plain = find_member(primitive, "material") == nullptr;
    for_each_material_holder(primitive, [&](Json& holder) { separate_member(holder, level); });
    if (is_plain) primitive["material"] = plain_of(level);
  }
}

void LevelMaterials::describe(ChannelMap& channels) const {
  for (const auto& [material, by_level] : copies_) {
    std::vector<std::size_t> all{material};
    for (const auto& [level, copy] : by_level) all.push_back(copy);
    channels.move_material(material, std::move(all));
  }
}

}  // namespace lodestone::detail
