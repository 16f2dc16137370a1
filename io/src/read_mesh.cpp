#include <lodestone/io/read_mesh.h>

#include <algorithm>
#include <cctype>
#include <exception>

#include <lodestone/io/file.h>

#include "bytes.h"
#include "gltf_container.h"
#include "soup_file.h"
#include "text.h"
#include "try.h"

namespace lodestone {
namespace {

using namespace detail;

enum class Format { Gltf, Obj, Ply, Stl, Other };

/// Goes by content where that is certain, then by extension, then by what the text looks like.
Format detect_format(std::span<const std::byte> bytes, std::string_view extension) {
  const std::string_view start = as_text(bytes);
  if (is_glb(bytes)) return Format::Gltf;
  if (start.starts_with("ply\n") || start.starts_with("ply\r")) return Format::Ply;
  if (extension == "gltf" || extension == "glb") return Format::Gltf;
  if (extension == "obj") return Format::Obj;
  if (extension == "ply") return Format::Ply;
  if (extension == "stl") return Format::Stl;
  if (!extension.empty()) return Format::Other;
  if (start.starts_with("solid")) return Format::Stl;
  const std::size_t first = start.find_first_not_of(" \t\r\n");
  if (first != start.npos && start[first] == '{') return Format::Gltf;
  return Format::Obj;
}

Result<SoupFile> read_soup(std::span<const std::byte> bytes, const std::string& extension, const FileFetcher& fetch) {
  switch (detect_format(bytes, extension)) {
    case Format::Gltf:
      return read_gltf(bytes, fetch);
    case Format::Obj:
      return read_obj(bytes);
    case Format::Ply:
      return read_ply(bytes);
    case Format::Stl:
      return read_stl(bytes);
    case Format::Other:
      break;
  }
  return read_with_assimp(bytes, extension);
}

Result<MeshFile> read(std::span<const std::byte> bytes, const std::string& extension, const FileFetcher& fetch) {
  LODESTONE_TRY(SoupFile file, read_soup(bytes, extension, fetch));
  tidy_normals(file);
  LODESTONE_TRY(AssembledMesh assembled, assemble(file.soup));
  return MeshFile{std::move(assembled.mesh), assembled.report, std::move(file.notes)};
}

}  // namespace

std::string detail::extension_of(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

bool detail::is_gltf(std::span<const std::byte> bytes, std::string_view extension) {
  return detect_format(bytes, extension) == Format::Gltf;
}

Result<MeshFile> read_mesh(const std::filesystem::path& path) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_file(path));
  const auto fetch = [&](const std::filesystem::path& relative) { return read_file(path.parent_path() / relative); };
  auto file = read(bytes, extension_of(path), fetch);
  if (!file) file.error().message = text('\'', path, "': ", file.error().message);
  return file;
}

Result<MeshFile> read_mesh_bytes(std::span<const std::byte> bytes, const std::string& extension) {
  return read(bytes, extension, [](const std::filesystem::path& relative) -> Result<std::vector<std::byte>> {
    return fail(ErrorCode::Unreadable, text("'", relative, "' lies outside the bytes given"));
  });
}

}  // namespace lodestone
