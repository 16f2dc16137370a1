#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "gltf/gltf_document.h"
#include "gltf/gltf_scene.h"

namespace lodestone::detail {

/// Values of one property, by time.
struct AnimationCurve {
  enum class Property { Translation, Rotation, Scale, Weights };
  enum class Interpolation { Step, Linear, Cubic };

  Property property = Property::Translation;
  std::size_t node = kNoNode;  ///< whose property it is
  std::size_t mesh = kNoNode;  ///< whose weights they are, where they are no node's
  std::size_t target = 0;      ///< the morph target that has the first of a value's weights
  Interpolation interpolation = Interpolation::Linear;
  std::vector<float> times;   ///< ascending
  std::size_t width = 0;      ///< numbers of a value: 3, 4 for rotations, one for each of the weights
  std::vector<float> values;  ///< a value for each time; with Cubic between its tangents before and after it

  /// The value at a key frame.
  std::span<const float> key(std::size_t i) const {
    const bool cubic = interpolation == Interpolation::Cubic;
    return std::span(values).subspan((cubic ? 3 * i + 1 : i) * width, width);
  }
};

/// What one animation moves.
struct Animation {
  std::vector<AnimationCurve> places;   ///< translations, rotations, scales of nodes
  std::vector<AnimationCurve> weights;  ///< of morph targets
};

/// Reads what an animation moves of nodes and of morph targets, also by KHR_animation_pointer. Channels that are broken
/// or move anything else are passed over: they stay in the document as they are; and so are those that need more
/// numbers than `most_numbers`, which goes down by what is read.
Animation read_animation(const GltfDocument& document, std::size_t index, std::size_t& most_numbers);

/// The value of a curve that is farthest from 0, of one of its numbers, and when it is reached: between key frames,
/// too.
struct CurvePeak {
  double value = 0;  ///< without its sign
  float time = 0;
};
CurvePeak find_peak(const AnimationCurve& curve, std::size_t number);

/// Returns one number of a curve's value at a time.
double value_at(const AnimationCurve& curve, float time, std::size_t number);

/// Chooses key frames, at most `most` of them: those at which a node's scale is largest, where it grows, and with what
/// is left an even choice of all.
std::vector<float> choose_key_frames(std::span<const AnimationCurve> curves, std::span<const LocalPlace> at_rest,
                                     std::size_t most);

/// Puts nodes where an animation's curves have them at a time.
void apply(std::span<const AnimationCurve> curves, float time, std::span<LocalPlace> nodes);

}  // namespace lodestone::detail
