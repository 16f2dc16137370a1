#pragma once

#include <cstddef>
#include <map>

#include "gltf/glb_builder.h"
#include "scene/scene_channels.h"

namespace lodestone::detail {

/// Gives each coarser level copies of the materials that its primitives name, the same textures in them. Clients that
/// replace one level by the next (Babylon.js, into an asset container) throw the materials of the first away, which the
/// others must not need; a texture object is each material's own there.
class LevelMaterials {
 public:
  explicit LevelMaterials(GlbBuilder& builder) : builder_(builder) {}

  /// Lets primitives of a level name copies that are this level's. Those without a material get one that says the same.
  void separate(Json& primitives, std::size_t level);

  /// Says which materials have become several.
  void describe(ChannelMap& channels) const;

 private:
  std::size_t copy_of(std::size_t material, std::size_t level);
  std::size_t plain_of(std::size_t level);
  void separate_member(Json& holder, std::size_t level);

  GlbBuilder& builder_;
  std::map<std::size_t, std::map<std::size_t, std::size_t>> copies_;  // by material and level
  std::map<std::size_t, std::size_t> plain_;                          // by level
};

/// Calls `visit` with every object of a primitive that names a material: itself, and its variants' mappings.
template <class Value, class Visit>
void for_each_material_holder(Value& primitive, const Visit& visit) {
  visit(primitive);
  if (!primitive.is_object() || !primitive.contains("extensions")) return;
  auto& extensions = primitive["extensions"];
  if (!extensions.is_object() || !extensions.contains("KHR_materials_variants")) return;
  auto& variants = extensions["KHR_materials_variants"];
  if (!variants.is_object() || !variants.contains("mappings") || !variants["mappings"].is_array()) return;
  for (auto& mapping : variants["mappings"]) visit(mapping);
}

}  // namespace lodestone::detail
