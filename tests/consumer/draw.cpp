// Draws from a removal stream with lodestone::stream alone: reads it, goes to levels of it, and prints their faces.
//
//   draw STREAM

#include <cstddef>
#include <cstdio>
#include <vector>

#include <lodestone/io/stream_format.h>
#include <lodestone/lod/cursor.h>

namespace {

std::vector<std::byte> read_all(std::FILE* file) {
  std::vector<std::byte> bytes;
  std::byte part[4096];
  while (const std::size_t count = std::fread(part, 1, sizeof part, file))
    bytes.insert(bytes.end(), part, part + count);
  return bytes;
}

std::size_t faces_drawn(const lodestone::ProgressiveMesh& mesh, const lodestone::Cursor& cursor) {
  std::size_t corners = 0;
  for (std::size_t group = 0; group < mesh.groups.size(); ++group) corners += cursor.corners(group).size();
  return corners / 3;
}

}  // namespace

int main(int argc, char** argv) {
  std::FILE* const file = argc == 2 ? std::fopen(argv[1], "rb") : nullptr;
  if (file == nullptr) return 2;
  const std::vector<std::byte> bytes = read_all(file);
  std::fclose(file);
  const lodestone::Result<lodestone::ProgressiveMesh> mesh = lodestone::decode_stream(bytes);
  if (!mesh) {
    std::fprintf(stderr, "%s\n", mesh.error().message.c_str());
    return 1;
  }
  lodestone::Cursor cursor(*mesh);
  const std::size_t base = faces_drawn(*mesh, cursor);
  cursor.seek(static_cast<lodestone::Index>(mesh->record_count()));
  const std::size_t whole = faces_drawn(*mesh, cursor);
  cursor.seek(0);
  std::printf("%zu faces, base mesh %zu\n", whole, base);
  return base == faces_drawn(*mesh, cursor) && base < whole ? 0 : 1;
}
