#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace lodestone {

/// An image file, byte for byte.
struct Image {
  std::string name;       ///< as the mesh's file names it
  std::string mime_type;  ///< image/png or image/jpeg
  std::vector<std::byte> bytes;
};

/// What a material takes from an image, at texture coordinates scale · TEXCOORD_0 + offset.
struct Texture {
  std::size_t image = 0;  ///< its number in the file
  std::array<float, 2> scale{1, 1};
  std::array<float, 2> offset{0, 0};
  bool clamp = false;  ///< does not repeat outside the unit square
};

/// A surface's look in glTF's metallic-roughness model.
struct Material {
  std::string name;
  std::array<float, 4> base_color{1, 1, 1, 1};  ///< red, green, blue, alpha; linear, [0, 1]
  float metallic = 0;                           ///< [0, 1]
  float roughness = 0.8F;                       ///< [0, 1]
  std::array<float, 3> emissive{0, 0, 0};       ///< linear, not negative; may exceed 1
  float normal_scale = 1;
  bool translucent = false;                   ///< alpha blends with what lies behind; else it counts for nothing
  std::optional<Texture> base_color_texture;  ///< sRGB, multiplied with base_color
  std::optional<Texture>
      metallic_roughness_texture;           ///< green: roughness, blue: metallic; each multiplied with its number
  std::optional<Texture> normal_texture;    ///< tangent space
  std::optional<Texture> emissive_texture;  ///< sRGB, multiplied with emissive
};

}  // namespace lodestone
