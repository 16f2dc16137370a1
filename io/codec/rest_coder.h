#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <lodestone/core/vec.h>

#include "codec/attribute_spec.h"
#include "codec/bit_coder.h"
#include "codec/bit_mixer.h"
#include "codec/fixed_point.h"
#include "codec/number_coder.h"

namespace lodestone::detail {

/// Codes what rounding took from floats: by how many floats each lies from the one that its whole number gives.
class RestCoder {
 public:
  /// `step`: of the grid of positions.
  RestCoder(float step, std::span<const AttributeSpec> attributes);

  /// Codes a position; it holds what the whole numbers give, and `given` what a writer has. False where what is read is
  /// no float, or not finite.
  bool code_position(BitCoder& coder, const Vec3i& numbers, const Vec3f& given, Vec3f& position);
  /// The same of an element of an attribute of floats; `given` is empty for a reader. False where it is no float.
  bool code_element(BitCoder& coder, std::size_t attribute, std::span<const std::int32_t> numbers,
                    std::span<const std::byte> given, std::span<std::byte> element);

 private:
  static constexpr std::size_t kRemembered = 1024;

  /// A number, and the float that last had it.
  struct Remembered {
    std::int64_t number = std::numeric_limits<std::int64_t>::min();  // none
    float value = 0;
  };
  struct Component {
    int ratio = 0;           // how large rests are, over what is usual, sixteenths of the logarithm
    std::uint32_t past = 0;  // whether the last three floats were those remembered, the last in the lowest bit
    std::vector<Remembered> remembered = std::vector<Remembered>(kRemembered);  // by the number's lowest bits
  };
  /// Floats of one kind, rounded by one grid.
  struct Kind {
    float step = 0;  // of the grid
    std::vector<Component> components;
    NumberCoder rests;
    BitMixer<1> is_same;
    Kind();
  };
  static bool code(BitCoder& coder, Kind& kind, std::size_t component, std::int64_t number, float given, float& value);

  Kind positions_;
  std::vector<Kind> attributes_;
};

}  // namespace lodestone::detail
