#include <lodestone/io/write_mesh.h>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>

#include "mesh/mesh_writers.h"
#include "scene/write_glb.h"

namespace lodestone {

Result<std::vector<std::byte>> write_mesh_bytes(const Mesh& mesh, const std::filesystem::path& path) {
  const std::string extension = extension_of(path);
  if (extension == "obj") return detail::to_obj(mesh);
  if (extension == "ply") return detail::to_ply(mesh);
  if (extension == "glb") return detail::to_glb(mesh, path.stem().string());
  return fail(ErrorCode::Unsupported,
              detail::text("cannot write '", path, "': the extension '", extension, "' is none of obj, ply and glb"));
}

Result<void> write_mesh(const std::filesystem::path& path, const Mesh& mesh) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, write_mesh_bytes(mesh, path));
  return write_file(path, bytes);
}

}  // namespace lodestone
