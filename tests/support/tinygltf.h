#pragma once

// tinygltf as tests see it: models that it has loaded, their triangles read by nothing of the library.

#define TINYGLTF_NO_STB_IMAGE
#define TINYGLTF_NO_STB_IMAGE_WRITE
#define TINYGLTF_NO_EXTERNAL_IMAGE
#define TINYGLTF_NO_FS
#include <tiny_gltf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <set>
#include <stdexcept>
#include <vector>

#include <lodestone/io/asset.h>
#include <lodestone/io/file.h>

#include "support/gltf_file.h"
#include "support/mesh_properties.h"

namespace lodestone::test {

/// A triangle's corners, rotated so that the least comes first.
using PlacedTriangle = std::array<Place, 3>;
using PlacedTriangles = std::set<PlacedTriangle>;

/// Adds a triangle unless it has no area that could be drawn, as readers do.
inline void add_triangle(PlacedTriangles& triangles, PlacedTriangle t) {
  for (const Place& place : t)
    for (const float x : place)
      if (!std::isfinite(x)) return;
  if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) return;
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  triangles.insert(t);
}

inline PlacedTriangles placed_triangles(const Mesh& mesh) {
  PlacedTriangles triangles;
  for (Index c = 0; c < mesh.corner_wedge.size(); c += 3)
    add_triangle(triangles, {place_of(mesh, mesh.corner_vertex(c)), place_of(mesh, mesh.corner_vertex(c + 1)),
                             place_of(mesh, mesh.corner_vertex(c + 2))});
  return triangles;
}

/// The elements of an accessor as numbers, integers as they are. Throws std::out_of_range where there is no such one.
class AccessorReader {
 public:
  AccessorReader(const tinygltf::Model& model, int number) : model_(model), accessor_(model.accessors.at(number)) {
    components_ = tinygltf::GetNumComponentsInType(static_cast<unsigned>(accessor_.type));
    values_.resize(accessor_.count * static_cast<std::size_t>(components_));
    if (accessor_.bufferView >= 0) {
      const tinygltf::BufferView& view = model.bufferViews.at(accessor_.bufferView);
      const int stride = accessor_.ByteStride(view);
      for (std::size_t i = 0; i < accessor_.count; ++i)
        read_element(accessor_.bufferView, accessor_.byteOffset + i * static_cast<std::size_t>(stride), i);
    }
    if (accessor_.sparse.isSparse) read_sparse();
  }

  std::size_t count() const { return accessor_.count; }
  double at(std::size_t element, int component) const {
    return values_.at(element * static_cast<std::size_t>(components_) + static_cast<std::size_t>(component));
  }
  /// The largest that a normalized component can be; 1 for others.
  double unit() const {
    if (!accessor_.normalized) return 1;
    switch (accessor_.componentType) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return 127;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 255;
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return 32767;
      default:
        return 65535;
    }
  }

 private:
  template <class T>
  double load_as(const unsigned char* from) const {
    T value;
    std::memcpy(&value, from, sizeof value);
    return static_cast<double>(value);
  }

  double read_component(int type, int view_number, std::size_t offset) const {
    const tinygltf::BufferView& view = model_.bufferViews.at(view_number);
    const std::vector<unsigned char>& data = model_.buffers.at(view.buffer).data;
    const std::size_t at = view.byteOffset + offset;
    if (at + static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<unsigned>(type))) > data.size())
      throw std::out_of_range("a buffer ends before an element");
    switch (type) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return load_as<std::int8_t>(&data[at]);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return load_as<std::uint8_t>(&data[at]);
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return load_as<std::int16_t>(&data[at]);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return load_as<std::uint16_t>(&data[at]);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return load_as<std::uint32_t>(&data[at]);
      default:
        return load_as<float>(&data[at]);
    }
  }

  void read_element(int view, std::size_t offset, std::size_t element) {
    const auto size =
        static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<unsigned>(accessor_.componentType)));
    for (std::size_t c = 0; c < static_cast<std::size_t>(components_); ++c)
      values_.at(element * static_cast<std::size_t>(components_) + c) =
          read_component(accessor_.componentType, view, offset + c * size);
  }

  void read_sparse() {
    const auto& sparse = accessor_.sparse;
    const auto index_size = static_cast<std::size_t>(
        tinygltf::GetComponentSizeInBytes(static_cast<unsigned>(sparse.indices.componentType)));
    const auto size = static_cast<std::size_t>(
        tinygltf::GetComponentSizeInBytes(static_cast<unsigned>(accessor_.componentType)) * components_);
    for (std::size_t i = 0; i < static_cast<std::size_t>(sparse.count); ++i) {
      const double element = read_component(sparse.indices.componentType, sparse.indices.bufferView,
                                            static_cast<std::size_t>(sparse.indices.byteOffset) + i * index_size);
      read_element(sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset) + i * size,
                   static_cast<std::size_t>(element));
    }
  }

  const tinygltf::Model& model_;
  const tinygltf::Accessor& accessor_;
  int components_ = 0;
  std::vector<double> values_;
};

/// The points of a primitive in the order in which it draws them.
inline std::vector<Place> drawn_points(const tinygltf::Model& model, const tinygltf::Primitive& primitive) {
  const AccessorReader positions(model, primitive.attributes.at("POSITION"));
  const auto place = [&](std::size_t point) {
    Place out;
    for (int c = 0; c < 3; ++c) {
      const auto unit = static_cast<float>(positions.unit());
      out[static_cast<std::size_t>(c)] = std::max(static_cast<float>(positions.at(point, c)) / unit,
                                                  unit == 1 ? std::numeric_limits<float>::lowest() : -1.0F) +
                                         0.0F;
    }
    return out;
  };
  std::vector<Place> points;
  if (primitive.indices < 0) {
    for (std::size_t i = 0; i < positions.count(); ++i) points.push_back(place(i));
    return points;
  }
  const AccessorReader indices(model, primitive.indices);
  for (std::size_t i = 0; i < indices.count(); ++i) points.push_back(place(static_cast<std::size_t>(indices.at(i, 0))));
  return points;
}

/// The triangles of a mesh as tinygltf has loaded it.
inline PlacedTriangles placed_triangles(const tinygltf::Model& model, const tinygltf::Mesh& mesh) {
  PlacedTriangles triangles;
  for (const tinygltf::Primitive& primitive : mesh.primitives) {
    if (!primitive.attributes.contains("POSITION")) continue;
    if (primitive.mode < TINYGLTF_MODE_TRIANGLES && primitive.mode >= 0) continue;
    const std::vector<Place> p = drawn_points(model, primitive);
    if (primitive.mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
      for (std::size_t i = 0; i + 2 < p.size(); ++i)
        add_triangle(triangles,
                     i % 2 == 0 ? PlacedTriangle{p[i], p[i + 1], p[i + 2]} : PlacedTriangle{p[i + 1], p[i], p[i + 2]});
    } else if (primitive.mode == TINYGLTF_MODE_TRIANGLE_FAN) {
      for (std::size_t i = 1; i + 1 < p.size(); ++i) add_triangle(triangles, {p[0], p[i], p[i + 1]});
    } else {
      for (std::size_t i = 0; i + 2 < p.size(); i += 3) add_triangle(triangles, {p[i], p[i + 1], p[i + 2]});
    }
  }
  return triangles;
}

/// The meshes that nodes of scenes show; those of all nodes where there is no scene.
inline std::set<int> shown_meshes(const tinygltf::Model& model) {
  std::set<int> meshes, seen;
  std::vector<int> open;
  for (const tinygltf::Scene& scene : model.scenes) open.insert(open.end(), scene.nodes.begin(), scene.nodes.end());
  for (int i = 0; model.scenes.empty() && i < static_cast<int>(model.nodes.size()); ++i) open.push_back(i);
  while (!open.empty()) {
    const int number = open.back();
    open.pop_back();
    if (!seen.insert(number).second) continue;
    const tinygltf::Node& node = model.nodes.at(static_cast<std::size_t>(number));
    if (node.mesh >= 0) meshes.insert(node.mesh);
    open.insert(open.end(), node.children.begin(), node.children.end());
  }
  return meshes;
}

/// The triangles of each mesh that is shown and has any, in the document's order.
inline std::vector<PlacedTriangles> placed_triangles(const tinygltf::Model& model) {
  std::vector<PlacedTriangles> meshes;
  for (const int number : shown_meshes(model))
    if (auto triangles = placed_triangles(model, model.meshes.at(static_cast<std::size_t>(number))); !triangles.empty())
      meshes.push_back(std::move(triangles));
  return meshes;
}

/// A file as an asset, with the files that it refers to.
inline EncodedAsset asset_of(const std::filesystem::path& path) {
  EncodedAsset asset;
  asset.glb = read_file(path).value();
  if (path.extension() == ".glb") return asset;
  const auto* text = reinterpret_cast<const char*>(asset.glb.data());
  const GltfJson json = GltfJson::parse(text, text + asset.glb.size(), nullptr, false);
  for (const char* list : {"buffers", "images"}) {
    if (!json.is_object() || !json.contains(list)) continue;
    for (const GltfJson& item : json[list]) {
      const std::string uri = item.value("uri", "");
      if (uri.empty() || uri.starts_with("data:")) continue;
      if (auto bytes = read_file(path.parent_path() / uri)) asset.beside.push_back({uri, std::move(*bytes)});
    }
  }
  return asset;
}

}  // namespace lodestone::test
