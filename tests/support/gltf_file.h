#pragma once

#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <lodestone/io/file.h>

#include "support/catch.h"

// glTF files as tests see them: plain JSON and bytes, read and made without the library.

namespace lodestone::test {

using GltfJson = nlohmann::ordered_json;
using ByteVector = std::vector<std::byte>;

inline ByteVector decode_base64(const std::string& text) {
  static const std::string kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  ByteVector bytes;
  unsigned bits = 0, count = 0;
  for (const char c : text) {
    if (c == '=') break;
    bits = bits << 6 | static_cast<unsigned>(kDigits.find(c));
    count += 6;
    if (count < 8) continue;
    count -= 8;
    bytes.push_back(static_cast<std::byte>(bits >> count));
  }
  return bytes;
}

/// A .glb or .gltf with all its buffers.
struct GltfFile {
  GltfJson json;
  std::vector<ByteVector> buffers;
  std::filesystem::path folder;

  static GltfFile from_glb(std::span<const std::byte> bytes) {
    GltfFile file;
    std::uint32_t size = 0;
    std::memcpy(&size, bytes.data() + 12, sizeof size);
    const auto* text = reinterpret_cast<const char*>(bytes.data()) + 20;
    file.json = GltfJson::parse(text, text + size);
    file.buffers.resize(1);
    if (bytes.size() > 20 + size) file.buffers[0].assign(bytes.begin() + 28 + size, bytes.end());
    return file;
  }

  static GltfFile read(const std::filesystem::path& path) {
    const ByteVector bytes = read_file(path).value();
    if (path.extension() == ".glb") return from_glb(bytes);
    GltfFile file;
    const auto* text = reinterpret_cast<const char*>(bytes.data());
    file.json = GltfJson::parse(text, text + bytes.size());
    file.folder = path.parent_path();
    for (const GltfJson& buffer : file.json["buffers"]) file.buffers.push_back(file.uri_bytes(buffer["uri"]));
    return file;
  }

  ByteVector uri_bytes(const std::string& uri) const {
    if (uri.starts_with("data:")) return decode_base64(uri.substr(uri.find(',') + 1));
    return read_file(folder / uri).value();
  }

  ByteVector view_bytes(std::size_t index) const {
    const GltfJson& view = json["bufferViews"][index];
    const ByteVector& buffer = buffers.at(view["buffer"].get<std::size_t>());
    const auto begin = buffer.begin() + view.value("byteOffset", std::ptrdiff_t{0});
    REQUIRE(begin + view["byteLength"].get<std::ptrdiff_t>() <= buffer.end());
    return {begin, begin + view["byteLength"].get<std::ptrdiff_t>()};
  }

  /// The elements of an accessor without sparse values, tightly packed.
  ByteVector accessor_bytes(std::size_t index) const {
    const GltfJson& accessor = json["accessors"][index];
    const std::string type = accessor["type"];
    const std::size_t component = accessor["componentType"].get<int>() < 5122   ? 1
                                  : accessor["componentType"].get<int>() < 5125 ? 2
                                                                                : 4;
    const std::size_t components = type == "SCALAR" ? 1 : type == "MAT4" ? 16 : std::size_t(type[3] - '0');
    const std::size_t size = component * components, count = accessor["count"];
    if (!accessor.contains("bufferView")) return ByteVector(size * count);
    const GltfJson& view = json["bufferViews"][accessor["bufferView"].get<std::size_t>()];
    const ByteVector bytes = view_bytes(accessor["bufferView"]);
    const std::size_t stride = view.value("byteStride", size), offset = accessor.value("byteOffset", std::size_t{0});
    ByteVector out;
    for (std::size_t i = 0; i < count; ++i) {
      REQUIRE(offset + i * stride + size <= bytes.size());
      const auto first = bytes.begin() + static_cast<std::ptrdiff_t>(offset + i * stride);
      out.insert(out.end(), first, first + static_cast<std::ptrdiff_t>(size));
    }
    return out;
  }

  ByteVector image_bytes(std::size_t index) const {
    const GltfJson& image = json["images"][index];
    return image.contains("uri") ? uri_bytes(image["uri"]) : view_bytes(image["bufferView"]);
  }
};

/// Puts a small .glb together.
struct GltfMaker {
  GltfJson json = {{"asset", {{"version", "2.0"}}}};
  ByteVector binary;

  std::size_t add(const char* array, GltfJson object) {
    json[array].push_back(std::move(object));
    return json[array].size() - 1;
  }
  template <class T>
  std::size_t add_view(const std::vector<T>& values) {
    binary.resize((binary.size() + 3) / 4 * 4);
    const auto bytes = std::as_bytes(std::span(values));
    const std::size_t offset = binary.size();
    binary.insert(binary.end(), bytes.begin(), bytes.end());
    return add("bufferViews", {{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
  }
  template <class T>
  std::size_t add_accessor(const std::vector<T>& values, int component_type, const std::string& type,
                           std::size_t components) {
    GltfJson accessor = {{"bufferView", add_view(values)},
                         {"componentType", component_type},
                         {"count", values.size() / components},
                         {"type", type}};
    return add("accessors", std::move(accessor));
  }
  std::size_t add_floats(const std::vector<float>& values, const std::string& type, std::size_t components) {
    return add_accessor(values, 5126, type, components);
  }

  ByteVector glb() {
    json["buffers"] = GltfJson::array({{{"byteLength", binary.size()}}});
    std::string text = json.dump();
    text.resize((text.size() + 3) / 4 * 4, ' ');
    ByteVector chunk = binary, out;
    chunk.resize((chunk.size() + 3) / 4 * 4);
    const auto put = [&](std::uint32_t value) {
      const auto* first = reinterpret_cast<const std::byte*>(&value);
      out.insert(out.end(), first, first + 4);
    };
    put(0x46546C67);
    put(2);
    put(static_cast<std::uint32_t>(12 + 8 + text.size() + 8 + chunk.size()));
    put(static_cast<std::uint32_t>(text.size()));
    put(0x4E4F534A);
    const auto characters = std::as_bytes(std::span(text));
    out.insert(out.end(), characters.begin(), characters.end());
    put(static_cast<std::uint32_t>(chunk.size()));
    put(0x004E4942);
    out.insert(out.end(), chunk.begin(), chunk.end());
    return out;
  }
};

}  // namespace lodestone::test
