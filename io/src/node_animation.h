#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "gltf_document.h"
#include "gltf_scene.h"

namespace lodestone::detail {

/// Values of one property of a node, by time.
struct AnimationCurve {
  enum class Property { Translation, Rotation, Scale };
  enum class Interpolation { Step, Linear, Cubic };

  std::size_t node = kNoNode;
  Property property = Property::Translation;
  Interpolation interpolation = Interpolation::Linear;
  std::vector<float> times;   ///< ascending
  std::size_t width = 0;      ///< numbers of a value: 3, or 4 for rotations
  std::vector<float> values;  ///< a value for each time; with Cubic between its tangents before and after it

  /// The value at a key frame.
  std::span<const float> key(std::size_t i) const {
    const bool cubic = interpolation == Interpolation::Cubic;
    return std::span(values).subspan((cubic ? 3 * i + 1 : i) * width, width);
  }
};

/// Reads what an animation moves of nodes, also by KHR_animation_pointer. Channels that are broken or move anything
/// else are passed over: they stay in the document as they are; and so are those that need more numbers than
/// `most_numbers`, which goes down by what is read.
std::vector<AnimationCurve> read_animation(const GltfDocument& document, std::size_t index, std::size_t& most_numbers);

/// Chooses key frames, at most `most` of them: those at which a node's scale is largest, where it grows, and with what
/// is left an even choice of all.
std::vector<float> choose_key_frames(std::span<const AnimationCurve> curves, std::span<const LocalPlace> at_rest,
                                     std::size_t most);

/// Puts nodes where an animation has them at a time.
void apply(std::span<const AnimationCurve> curves, float time, std::span<LocalPlace> nodes);

}  // namespace lodestone::detail
