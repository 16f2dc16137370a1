#pragma once

#include <lodestone/core/result.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/scene.h>

// A program links tinygltf's code of its own, or else takes that in lodestone::io, which is without stb: it then
// defines TINYGLTF_NO_STB_IMAGE and TINYGLTF_NO_STB_IMAGE_WRITE before it includes tiny_gltf.h.

namespace tinygltf {
class Model;
}

namespace lodestone {

/// Reads a scene from a model that a program holds, as if from a file that tinygltf wrote of it: with its own checks of
/// what the model says, and without what tinygltf leaves out (docs/decisions.md has a list). Images are the files they
/// were: in a bufferView, or in `Image::image` where `as_is` is set; where only the uri is known, a note says so.
/// Errors: as `Scene::read`; Unsupported where of an image there are only pixels.
Result<Scene> scene_from_model(const tinygltf::Model& model);

/// Has tinygltf load an asset as written, from a .glb, or a .gltf with its files. Images keep their files' bytes
/// (`Image::as_is`). Errors: Malformed, also with tinygltf's own reason; Unsupported for geometry in Draco: build with
/// `AssetOptions::draco` off.
Result<tinygltf::Model> model_from_asset(const EncodedAsset& asset);

}  // namespace lodestone
