#include <lodestone/io/write_mesh.h>

#include <lodestone/io/file.h>

#include "mesh_writers.h"
#include "text.h"
#include "try.h"

namespace lodestone {

Result<void> write_mesh(const std::filesystem::path& path, const Mesh& mesh) {
  const std::string extension = path.extension().string();
  if (extension == ".obj" || extension == ".OBJ") return write_file(path, detail::to_obj(mesh));
  if (extension == ".ply" || extension == ".PLY") return write_file(path, detail::to_ply(mesh));
  if (extension != ".glb" && extension != ".GLB")
    return fail(ErrorCode::Unsupported, detail::text("cannot write '", path, "': the extension '", extension,
                                                     "' is none of .obj, .ply and .glb"));
  LODESTONE_TRY(const std::vector<std::byte> glb, detail::to_glb(mesh, path.stem().string()));
  return write_file(path, glb);
}

}  // namespace lodestone
