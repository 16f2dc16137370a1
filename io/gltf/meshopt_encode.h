#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// What decoders do to elements after they are unpacked.
enum class MeshoptFilter { None, Octahedral, Exponential };

/// How the bytes of a view are packed.
enum class MeshoptMode { Attributes, Triangles };

/// Elements or indices packed for EXT_meshopt_compression, version 0 of both encodings.
struct MeshoptView {
  std::vector<std::byte> bytes;
  MeshoptMode mode = MeshoptMode::Attributes;
  MeshoptFilter filter = MeshoptFilter::None;
  std::size_t count = 0;   ///< elements or indices
  std::size_t stride = 0;  ///< bytes of one once unpacked

  std::size_t unpacked_bytes() const { return count * stride; }
};

/// Packs elements of `stride` bytes, to which the filter has been applied. Pre: the stride is a multiple of 4, at most
/// 256.
MeshoptView pack_elements(std::span<const std::byte> elements, std::size_t stride,
                          MeshoptFilter filter = MeshoptFilter::None);

/// Packs triangles, whose corners may come out rotated. Indices take 2 bytes where `point_count` allows.
MeshoptView pack_triangles(std::span<const Index> indices, std::size_t point_count);

/// Numbers as multiples of 2^exponent, nearest first, as the exponential filter wants them: four bytes each.
/// Pre: none is farther from 0 than 2²³ − 1 multiples.
std::vector<std::byte> exponential_form(std::span<const float> values, int exponent);

/// Directions of three components, or of three and a sign, as the octahedral filter wants them: 8 bytes each, from
/// `bits` 9 on, 4 below; the filter gives normalized Int16 or Int8 components back.
std::vector<std::byte> octahedral_form(std::span<const float> values, std::size_t component_count, int bits);

/// What decoders make of it: the components of the directions as floats, `component_count` each.
std::vector<float> octahedral_values(std::span<const std::byte> form, std::size_t component_count, int bits);

/// The bytes of one direction in octahedral form, and the type of its components.
constexpr std::size_t octahedral_stride(int bits) { return bits > 8 ? 8 : 4; }
constexpr ComponentType octahedral_type(int bits) { return bits > 8 ? ComponentType::Int16 : ComponentType::Int8; }

}  // namespace lodestone::detail
