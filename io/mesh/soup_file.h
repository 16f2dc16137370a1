#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/result.h>
#include <lodestone/io/read_mesh.h>

namespace lodestone::detail {

/// What a format's reader returns: triangles, and one sentence for each thing that was left out or changed.
struct SoupFile {
  TriangleSoup soup;
  std::vector<Material> materials;  ///< as those of `MeshFile`
  std::vector<Image> images;
  std::vector<std::string> notes;
};

/// Fetches a file that lies beside or below the one being read, by its relative path.
using FileFetcher = std::function<Result<std::vector<std::byte>>(const std::filesystem::path& relative)>;

/// Returns what fetches files beside or below a file; it goes by names in any case where the exact one is not there.
FileFetcher files_beside(const std::filesystem::path& path);

Result<SoupFile> read_obj(std::span<const std::byte> bytes, const FileFetcher& fetch);
Result<SoupFile> read_off(std::span<const std::byte> bytes);
Result<SoupFile> read_ply(std::span<const std::byte> bytes, const FileFetcher& fetch);
Result<SoupFile> read_stl(std::span<const std::byte> bytes);
Result<SoupFile> read_gltf(std::span<const std::byte> bytes, const FileFetcher& fetch);
/// Reads any other format Assimp knows; `extension` is without the dot.
Result<SoupFile> read_with_assimp(std::span<const std::byte> bytes, const std::string& extension,
                                  const FileFetcher& fetch);

/// Reads a mesh from memory, files beside it through `fetch`; as `read_mesh`.
Result<MeshFile> read_mesh_bytes(std::span<const std::byte> bytes, const std::string& extension,
                                 const FileFetcher& fetch);

/// True for what `read_mesh` takes for glTF: by content, then by extension (lower case, without the dot).
bool is_gltf(std::span<const std::byte> bytes, std::string_view extension);

/// Returns a path's extension in lower case, without the dot.
std::string extension_of(const std::filesystem::path& path);

/// Gives float normals length 1 where they miss it by more than rounding, and a direction where they have none:
/// writers may then rely on the rule of glTF that normals are unit vectors. Pre: indices are in range.
void tidy_normals(SoupFile& file);

/// Returns the bytes as text, unchecked.
inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns the text without UTF-8's byte order mark, where it begins with one.
inline std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return text.substr(text.starts_with(kMark) ? kMark.size() : 0);
}

/// Makes an attribute of floats from values that lie one after the other.
Attribute float_attribute(std::string name, std::uint8_t component_count, std::span<const float> values);

}  // namespace lodestone::detail
