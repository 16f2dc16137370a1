#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// How an attribute is predicted.
enum class AttributeCoding : std::uint8_t {
  Numbers,     ///< component by component
  Directions,  ///< unit vectors, as points of an octahedron; a fourth component is 1 or −1
  Texture,     ///< two components that are close to a linear map of the surface; of 24 bits at most
  Weights,     ///< floats of joints; those of a wedge add up to 1, over all attributes that are coded so
  kCount
};

/// What a stream says of an attribute. Coded are whole numbers, one for each component.
struct AttributeSpec {
  std::string name;
  ComponentType type = ComponentType::Float32;
  std::uint8_t component_count = 0;  ///< 1 to 16
  bool normalized = false;
  AttributeCoding coding = AttributeCoding::Numbers;
  std::uint8_t bits = 0;   ///< of what floats are rounded to, 2 to 24; 0 for integers, which stay as they are
  std::vector<float> low;  ///< the least corner of the grid of floats; empty for integers and directions
  float range = 0;         ///< the grid's edge

  bool is_exact() const { return bits == 0; }
  /// What numbers may be. Those of directions add up, without their signs, to the largest.
  std::int64_t lowest() const;
  std::int64_t highest() const;
};

/// Appends a wedge's element as it is in a mesh. Pre: the numbers are within the limits.
void append_element(const AttributeSpec& spec, std::span<const std::int32_t> numbers, std::vector<std::byte>& out);

}  // namespace lodestone::detail
