// Uses each installed module once: makes a mesh, simplifies it, writes and reads a level.

#include <cstdio>
#include <cstdlib>

#include <lodestone/core/assemble.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/write_mesh.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "square.h"

namespace {

template <class T>
T value_or_exit(lodestone::Result<T> result) {
  if (result) return *std::move(result);
  std::fprintf(stderr, "%s\n", result.error().message.c_str());
  std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  const auto assembled = value_or_exit(lodestone::assemble(square_soup()));
  const auto simplified = value_or_exit(lodestone::simplify(assembled.mesh));
  lodestone::Cursor level(simplified.mesh);
  level.seek(static_cast<lodestone::Index>(simplified.mesh.record_count() / 2));
  if (!lodestone::write_mesh(argv[1], lodestone::extract_level(simplified.mesh, level))) return 1;
  const auto read = value_or_exit(lodestone::read_mesh(argv[1]));
  std::printf("%zu faces, the level %zu\n", assembled.mesh.face_count(), read.mesh.face_count());
  return read.mesh.face_count() == level.face_count() && level.face_count() < assembled.mesh.face_count() ? 0 : 1;
}
