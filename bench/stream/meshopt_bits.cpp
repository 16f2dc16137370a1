#include "meshopt_bits.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <meshoptimizer.h>
#include <zstd.h>

namespace lodestone::bench {
namespace {

constexpr int kZstdLevel = 19;
constexpr std::size_t kAlignment = 4;  // of the codec's elements

/// Elements of equal size, wedge by wedge.
struct Elements {
  std::size_t stride = 0;
  std::vector<unsigned char> bytes;
};

template <class T>
Elements pack(std::span<const T> numbers, std::size_t count) {
  const std::size_t size = numbers.size() / count, used = size * sizeof(T);
  Elements elements{(used + kAlignment - 1) / kAlignment * kAlignment, {}};
  elements.bytes.assign(count * elements.stride, 0);
  for (std::size_t i = 0; i < count; ++i) std::memcpy(&elements.bytes[i * elements.stride], &numbers[i * size], used);
  return elements;
}

/// Floats as whole numbers of so many bits over a range.
std::vector<std::uint32_t> rounded(std::span<const float> values, std::span<const float> low, double range, int bits) {
  const double top = std::ldexp(1.0, bits) - 1;
  std::vector<std::uint32_t> numbers;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double share = (static_cast<double>(values[i]) - static_cast<double>(low[i % low.size()])) / range;
    numbers.push_back(static_cast<std::uint32_t>(std::lround(std::clamp(share, 0.0, 1.0) * top)));
  }
  return numbers;
}

Elements pack_rounded(const std::vector<std::uint32_t>& numbers, std::size_t count, int bits) {
  if (bits > 16) return pack<std::uint32_t>(numbers, count);
  return pack<std::uint16_t>(std::vector<std::uint16_t>(numbers.begin(), numbers.end()), count);
}

/// Directions as points of an octahedron, by meshoptimizer's filter; a fourth component is a sign.
Elements pack_directions(std::span<const float> values, std::size_t size, std::size_t count, int bits) {
  std::vector<float> four(4 * count, 0);
  for (std::size_t i = 0; i < values.size(); ++i) four[i / size * 4 + i % size] = values[i];
  const std::size_t stride = bits > 8 ? 8 : 4;
  Elements elements{stride, std::vector<unsigned char>(stride * count)};
  meshopt_encodeFilterOct(elements.bytes.data(), count, stride, bits, four.data());
  return elements;
}

Elements pack_attribute(const Attribute& attribute, std::size_t count, const CompactOptions& options) {
  const std::size_t size = attribute.component_count;
  if (attribute.type != ComponentType::Float32) return pack<std::byte>(std::span(attribute.data), count);
  const std::vector<float> values = attribute_values(attribute);
  if (attribute.name == "NORMAL" || attribute.name == "TANGENT")
    return pack_directions(values, size, count, options.normal_bits);
  if (attribute.name.starts_with("WEIGHTS_")) {
    const std::vector<float> none(size, 0);
    return pack_rounded(rounded(values, none, 1, options.weight_bits), count, options.weight_bits);
  }
  std::vector<float> low(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(size)), high = low;
  for (std::size_t i = 0; i < values.size(); ++i) {
    low[i % size] = std::min(low[i % size], values[i]);
    high[i % size] = std::max(high[i % size], values[i]);
  }
  double range = 0;
  for (std::size_t c = 0; c < size; ++c) range = std::max(range, static_cast<double>(high[c] - low[c]));
  const int bits = attribute.name.starts_with("TEXCOORD_") ? options.texture_bits : options.other_bits;
  return pack_rounded(rounded(values, low, range > 0 ? range : 1, bits), count, bits);
}

std::vector<Elements> pack_wedges(const Mesh& mesh, const CompactOptions& options) {
  const std::size_t count = mesh.wedge_count();
  std::vector<float> positions;
  for (const Index vertex : mesh.wedge_vertex)
    for (const float value : {mesh.positions[vertex].x, mesh.positions[vertex].y, mesh.positions[vertex].z})
      positions.push_back(value);
  const CompactGrid& grid = *options.grid;
  const std::vector<float> origin = {grid.origin.x, grid.origin.y, grid.origin.z};
  std::vector<Elements> all;
  all.push_back(pack_rounded(rounded(positions, origin, static_cast<double>(grid.range), options.grid_bits), count,
                             options.grid_bits));
  for (const Attribute& attribute : mesh.attributes) all.push_back(pack_attribute(attribute, count, options));
  return all;
}

void append_encoded(const Elements& elements, std::size_t count, std::vector<unsigned char>& out) {
  std::vector<unsigned char> encoded(meshopt_encodeVertexBufferBound(count, elements.stride));
  encoded.resize(
      meshopt_encodeVertexBuffer(encoded.data(), encoded.size(), elements.bytes.data(), count, elements.stride));
  out.insert(out.end(), encoded.begin(), encoded.end());
}

}  // namespace

double meshopt_bits(const Mesh& mesh, const CompactOptions& options) {
  const std::size_t count = mesh.wedge_count();
  std::vector<unsigned int> corners(mesh.corner_wedge.begin(), mesh.corner_wedge.end());
  meshopt_optimizeVertexCache(corners.data(), corners.data(), corners.size(), count);
  std::vector<unsigned int> places(count);
  const std::size_t used = meshopt_optimizeVertexFetchRemap(places.data(), corners.data(), corners.size(), count);
  meshopt_remapIndexBuffer(corners.data(), corners.data(), corners.size(), places.data());
  std::vector<unsigned char> bytes;
  for (const Elements& elements : pack_wedges(mesh, options)) {
    Elements ordered{elements.stride, std::vector<unsigned char>(elements.stride * count)};
    meshopt_remapVertexBuffer(ordered.bytes.data(), elements.bytes.data(), count, elements.stride, places.data());
    append_encoded(ordered, used, bytes);
  }
  std::vector<unsigned char> encoded(meshopt_encodeIndexBufferBound(corners.size(), used));
  encoded.resize(meshopt_encodeIndexBuffer(encoded.data(), encoded.size(), corners.data(), corners.size()));
  bytes.insert(bytes.end(), encoded.begin(), encoded.end());
  std::vector<unsigned char> packed(ZSTD_compressBound(bytes.size()));
  return 8 * static_cast<double>(ZSTD_compress(packed.data(), packed.size(), bytes.data(), bytes.size(), kZstdLevel));
}

}  // namespace lodestone::bench
