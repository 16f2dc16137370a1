#include <lodestone/io/read_mesh.h>

#include <algorithm>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/lod/cursor.h>

#include "base/bytes.h"
#include "base/files_beside.h"
#include "formats/read_mesh_bytes.h"
#include "gltf/gltf_container.h"
#include "gltf/gltf_flatten.h"
#include "mesh/float_spacing.h"
#include "mesh/soup_file.h"

namespace lodestone {
namespace {

using namespace detail;

enum class Format { Gltf, Obj, Off, Ply, Stl, Stream, Other };

/// Nothing in a binary STL says what it is but that its size fits its count, 50 bytes for each triangle.
bool has_size_of_stl(std::span<const std::byte> bytes) {
  return bytes.size() > 84 && (bytes.size() - 84) / 50 == load_u32(bytes, 80) && (bytes.size() - 84) % 50 == 0;
}

/// Goes by content where that is certain, then by extension, then by what the text looks like.
Format detect_format(std::span<const std::byte> bytes, std::string_view extension) {
  const std::string_view start = without_byte_order_mark(as_text(bytes));
  if (is_glb(bytes)) return Format::Gltf;
  if (is_stream(bytes)) return Format::Stream;
  if (start.starts_with("ply\n") || start.starts_with("ply\r")) return Format::Ply;
  if (extension == "gltf" || extension == "glb") return Format::Gltf;
  if (extension == "obj") return Format::Obj;
  if (extension == "off") return Format::Off;
  if (extension == "ply") return Format::Ply;
  if (extension == "stl") return Format::Stl;
  if (!extension.empty()) return Format::Other;
  if (has_size_of_stl(bytes)) return Format::Stl;
  if (start.starts_with("solid")) return Format::Stl;
  if (start.starts_with("OFF")) return Format::Off;
  const std::size_t first = start.find_first_not_of(" \t\r\n");
  if (first != start.npos && start[first] == '{') return Format::Gltf;
  return Format::Obj;
}

/// Text of two bytes a character begins with a mark, or has a zero among its first bytes.
bool is_wide_text(std::span<const std::byte> bytes) {
  const std::string_view start = as_text(bytes.first(std::min<std::size_t>(bytes.size(), 4)));
  return start.starts_with("\xfe\xff") || start.starts_with("\xff\xfe") || start.find('\0') != start.npos;
}

/// Reads the finest level that a stream has. Its materials name nothing in it.
Result<SoupFile> soup_of_stream(std::span<const std::byte> bytes) {
  StreamReader reader;
  LODESTONE_CHECK(reader.append(bytes));
  LODESTONE_CHECK(reader.finish());
  SoupFile file;
  file.soup = to_soup(extract_level(reader.mesh(), kNoIndex));
  file.soup.face_material.clear();
  if (!reader.done())
    file.notes.push_back(
        text("the stream ends early, with chunk ", reader.chunk_count(), " of ", reader.chunks().size()));
  return file;
}

Result<SoupFile> read_soup(std::span<const std::byte> bytes, const std::string& extension, const FileFetcher& fetch) {
  const Format format = detect_format(bytes, extension);
  const bool may_be_binary =
      is_glb(bytes) || format == Format::Stl || format == Format::Stream || format == Format::Other;
  if (!may_be_binary && is_wide_text(bytes))
    return fail(ErrorCode::Unsupported, "the text is UTF-16 or UTF-32: save it as UTF-8");
  switch (format) {
    case Format::Gltf:
      return read_gltf(bytes, fetch);
    case Format::Obj:
      return read_obj(bytes, fetch);
    case Format::Off:
      return read_off(bytes);
    case Format::Ply:
      return read_ply(bytes, fetch);
    case Format::Stl:
      return read_stl(bytes);
    case Format::Stream:
      return soup_of_stream(bytes);
    case Format::Other:
      break;
  }
  return read_with_assimp(bytes, extension, fetch);
}

}  // namespace

bool detail::is_gltf(std::span<const std::byte> bytes, std::string_view extension) {
  return detect_format(bytes, extension) == Format::Gltf;
}

Result<MeshFile> detail::read_mesh_bytes(std::span<const std::byte> bytes, const std::string& extension,
                                         const FileFetcher& fetch) {
  LODESTONE_TRY(SoupFile file, read_soup(bytes, extension, fetch));
  tidy_normals(file);
  // Which side a face shows is the material's matter in glTF alone.
  LODESTONE_TRY(AssembledMesh assembled, assemble(file.soup, {.turn_faces = !is_gltf(bytes, extension)}));
  if (auto note = coarse_floats(assembled.mesh)) file.notes.push_back(std::move(*note));
  return MeshFile{std::move(assembled.mesh), assembled.report, std::move(file.materials), std::move(file.images),
                  std::move(file.notes)};
}

Result<MeshFile> read_mesh(const std::filesystem::path& path) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_file(path));
  auto file = detail::read_mesh_bytes(bytes, extension_of(path), files_beside(path));
  return std::move(file).map_error([&](Error error) { return with_path(std::move(error), path); });
}

Result<MeshFile> read_mesh_bytes(std::span<const std::byte> bytes, const std::string& extension) {
  return detail::read_mesh_bytes(bytes, extension, nothing_beside);
}

}  // namespace lodestone
