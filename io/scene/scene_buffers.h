#pragma once

#include <vector>

#include <lodestone/core/result.h>

#include "gltf/glb_builder.h"
#include "scene/scene_impl.h"

namespace lodestone::detail {

inline constexpr const char* kDraco = "KHR_draco_mesh_compression";

/// What becomes of the document's accessors and bufferViews when its meshes are replaced by levels.
struct BufferPlan {
  GlbBuilder::FreeSlots free_slots;     ///< those that only replaced geometry uses
  std::vector<std::size_t> kept_views;  ///< all others, which keep their numbers: an unknown extension may name them
};

/// `images_leave`: images become files of their own.
BufferPlan plan_buffers(const Scene::Impl& scene, bool images_leave);

/// Copies the kept bufferViews into the new binary chunk, decompressed; ranges that overlap stay so.
/// Errors: Malformed where a view does not lie in its buffer.
Result<void> copy_kept_views(const GltfDocument& document, const BufferPlan& plan, GlbBuilder& builder);

/// Puts images into the file.
void embed_images(const std::vector<EmbeddedImage>& images, GlbBuilder& builder);

/// Takes a member out of an object's `extensions`, and those with their last member.
void erase_extension(Json& object, const char* name);

}  // namespace lodestone::detail
