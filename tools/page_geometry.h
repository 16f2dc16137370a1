#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::tool {

/// A mesh's positions and faces in few bytes, as tools/html/geometry.js reads them.
struct PageGeometry {
  std::vector<std::byte> bytes;  ///< deflated
  std::vector<Index> vertices;   ///< the mesh's vertices in the order of the page
};

/// Encodes a mesh with 16 bits for each coordinate within `box`; the format is described in the .cpp.
PageGeometry encode_geometry(const Mesh& mesh, const Box& box);

/// Encodes one byte for each of `errors`, in the order of `vertices`: 255 · √(error / maximum), as differences,
/// deflated.
std::vector<std::byte> encode_errors(std::span<const float> errors, double maximum, std::span<const Index> vertices);

/// Returns the bytes as text that needs no escaping anywhere in HTML.
std::string base64(std::span<const std::byte> bytes);

}  // namespace lodestone::tool
