// The readers of OBJ, STL, PLY and OFF. Those that read in pieces say the same of small ones as of the whole.

#include <cstdlib>
#include <string>

#include <lodestone/io/read_mesh.h>

#include "base/files_beside.h"
#include "mesh/soup_file.h"
#include "support/fuzz.h"

namespace {

using lodestone::Result;
using lodestone::detail::SoupFile;

bool same(const Result<SoupFile>& a, const Result<SoupFile>& b) {
  if (!a || !b) return !a && !b && a.error().message == b.error().message;
  return a->soup.indices == b->soup.indices && a->soup.face_material == b->soup.face_material &&
         a->soup.positions.size() == b->soup.positions.size() && a->notes == b->notes;
}

template <class Reader>
void check_pieces(std::span<const std::byte> bytes, const Reader& read) {
  constexpr std::size_t kWhole = std::size_t{1} << 40, kSmall = 16;
  const auto nothing = lodestone::detail::nothing_beside;
  if (!same(read(bytes, nothing, kWhole), read(bytes, nothing, kSmall))) std::abort();
}

}  // namespace

std::vector<lodestone::test::Bytes> lodestone::test::fuzz_seeds() {
  std::vector<Bytes> seeds;
  for (const std::string& source :
       {std::string("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 1\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3//1 -1\nl 1 2\n"),
        std::string(
            "#MRGB ff0000ff\nv 0 0 0 1 0 .5\nv 3 0 0\nv 3 3 0\nv 1 1 0\nv 0 3 0\nf 1 2 3 4 5\nmtllib a.mtl b.mtl\n"),
        std::string(
            "STNCOFF\n3 2 0 # c\n0 0 0 0 0 1 255 0 0 255 0 0\n1 0 0 0 0 1 0 9 0 255 1 0\n0 1 0 0 0 1 0 0 9 255 0 1\n"
            "3 0 1 2 0.5 1 0\n3 0 2 1 7\n"),
        std::string("OFF 4 1 0\n0 0 0\n3 0 0\n0 3 0\n1 1 0\n4 0 1 3 2\n"),
        std::string(
            "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 3\nproperty float x\nproperty float y\n"
            "property float z\nelement face 1\nproperty list uchar int vertex_indices\n"
            "property list uchar float texcoord\nproperty int texnumber\nproperty uchar red\nproperty uchar green\n"
            "property uchar blue\nelement tristrips 1\nproperty list int int vertex_indices\nend_header\n"
            "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1 0 9 8 7\n5 0 1 2 -1 0\n"),
        std::string(
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"),
        std::string(
            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty double z\n"
            "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n"
            "property list uchar int vertex_indices\nend_header\n0 0 0 1 2 3\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n")})
    seeds.emplace_back(source.begin(), source.end());
  return seeds;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  for (const char* extension : {"obj", "stl", "ply", "off"}) {
    const auto file = lodestone::read_mesh_bytes(bytes, extension);
    if (!file && file.error().message.empty()) std::abort();
  }
  check_pieces(bytes, lodestone::detail::read_obj);
  check_pieces(bytes, lodestone::detail::read_ply);
  return 0;
}
