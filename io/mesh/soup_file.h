#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/result.h>
#include <lodestone/io/material.h>

#include "base/files_beside.h"
#include "mesh/text_pieces.h"

namespace lodestone::detail {

/// What a format's reader returns: triangles, and one sentence for each thing that was left out or changed.
struct SoupFile {
  TriangleSoup soup;
  std::vector<Material> materials;  ///< as those of `MeshFile`
  std::vector<Image> images;
  std::vector<std::string> notes;
};

/// Texts are read in pieces of about so many bytes, side by side. Pre: piece_bytes > 0.
Result<SoupFile> read_obj(std::span<const std::byte> bytes, const FileFetcher& fetch,
                          std::size_t piece_bytes = kPieceBytes);
Result<SoupFile> read_off(std::span<const std::byte> bytes);
Result<SoupFile> read_ply(std::span<const std::byte> bytes, const FileFetcher& fetch,
                          std::size_t piece_bytes = kPieceBytes);
Result<SoupFile> read_stl(std::span<const std::byte> bytes);
/// Reads any other format Assimp knows; `extension` is without the dot.
Result<SoupFile> read_with_assimp(std::span<const std::byte> bytes, const std::string& extension,
                                  const FileFetcher& fetch);

/// Gives float normals length 1 where they miss it by more than rounding, and a direction where they have none:
/// writers may then rely on the rule of glTF that normals are unit vectors. Pre: indices are in range.
void tidy_normals(SoupFile& file);

/// Makes an attribute of floats from values that lie one after the other.
Attribute float_attribute(std::string name, std::uint8_t component_count, std::span<const float> values);

}  // namespace lodestone::detail
