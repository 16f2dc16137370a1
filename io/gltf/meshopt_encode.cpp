// The encodings and filters of EXT_meshopt_compression (Khronos, vendor extensions of glTF 2.0), by meshoptimizer. The
// exponential form is made here: meshoptimizer chooses an exponent for each vector, ours is that of a grid which levels
// share.

#include "gltf/meshopt_encode.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include <meshoptimizer.h>

#include <lodestone/core/mesh.h>

#include "base/bytes.h"
#include "gltf/gltf_mesh_writer.h"

namespace lodestone::detail {
namespace {

/// The versions that the extension allows, whatever the library writes of itself.
void choose_versions() {
  static std::once_flag once;
  std::call_once(once, [] {
    meshopt_encodeVertexVersion(0);
    meshopt_encodeIndexVersion(1);
  });
}

unsigned char* raw(std::vector<std::byte>& bytes) { return reinterpret_cast<unsigned char*>(bytes.data()); }

}  // namespace

MeshoptView pack_elements(std::span<const std::byte> elements, std::size_t stride, MeshoptFilter filter) {
  choose_versions();
  MeshoptView view{{}, MeshoptMode::Attributes, filter, elements.size() / stride, stride};
  view.bytes.resize(meshopt_encodeVertexBufferBound(view.count, stride));
  view.bytes.resize(
      meshopt_encodeVertexBuffer(raw(view.bytes), view.bytes.size(), elements.data(), view.count, stride));
  return view;
}

MeshoptView pack_triangles(std::span<const Index> indices, std::size_t point_count) {
  choose_versions();
  const std::size_t stride = component_bytes(index_type(point_count));
  MeshoptView view{{}, MeshoptMode::Triangles, MeshoptFilter::None, indices.size(), stride};
  view.bytes.resize(meshopt_encodeIndexBufferBound(indices.size(), point_count));
  view.bytes.resize(meshopt_encodeIndexBuffer(raw(view.bytes), view.bytes.size(), indices.data(), indices.size()));
  return view;
}

std::vector<std::byte> exponential_form(std::span<const float> values, int exponent) {
  std::vector<std::byte> form;
  form.reserve(values.size() * sizeof(std::uint32_t));
  for (const float value : values) {
    const auto multiple = static_cast<std::int32_t>(std::lround(std::ldexp(static_cast<double>(value), -exponent)));
    const auto low = static_cast<std::uint32_t>(multiple) & 0xFFFFFFU;
    append(form, low | static_cast<std::uint32_t>(exponent) << 24);
  }
  return form;
}

std::vector<std::byte> octahedral_form(std::span<const float> values, std::size_t component_count, int bits) {
  const std::size_t count = values.size() / component_count;
  std::vector<float> fours(4 * count);
  for (std::size_t i = 0; i < count; ++i) {
    float* four = fours.data() + 4 * i;
    for (std::size_t c = 0; c < component_count; ++c) {
      const float value = values[i * component_count + c];
      four[c] = std::isfinite(value) ? std::clamp(value, -1.0F, 1.0F) : 0;
    }
  }
  std::vector<std::byte> form(count * octahedral_stride(bits));
  meshopt_encodeFilterOct(form.data(), count, octahedral_stride(bits), bits, fours.data());
  return form;
}

std::vector<float> octahedral_values(std::span<const std::byte> form, std::size_t component_count, int bits) {
  const std::size_t stride = octahedral_stride(bits), count = form.size() / stride;
  std::vector<std::byte> decoded(form.begin(), form.end());
  meshopt_decodeFilterOct(decoded.data(), count, stride);
  const std::vector<float> fours = component_values(octahedral_type(bits), true, decoded);
  std::vector<float> values;
  values.reserve(count * component_count);
  for (std::size_t i = 0; i < count; ++i)
    values.insert(values.end(), fours.begin() + static_cast<std::ptrdiff_t>(4 * i),
                  fours.begin() + static_cast<std::ptrdiff_t>(4 * i + component_count));
  return values;
}

}  // namespace lodestone::detail
