#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Makes COLOR_0 of colours as a screen shows them, three components or four, [0, 1], one after the other.
///
/// glTF's colours are linear light, those of other formats sRGB as a rule. Linear, eight bits cannot tell dark tones
/// apart, so the result has 16: every byte of sRGB keeps a value of its own. Alpha is a share in both.
Attribute color_attribute(std::span<const float> srgb, std::uint8_t component_count);

/// Returns what a colour's component is to be divided by: formats do not say whether it ends at 1 or at 255, but no
/// file has colours that are all as good as black.
float color_range(std::span<const float> components);

/// Returns the byte of sRGB for linear light, [0, 1].
std::uint8_t srgb_byte(float linear);

/// Returns the byte for a share, [0, 1], such as alpha.
std::uint8_t share_byte(float share);

}  // namespace lodestone::detail
