// The readers of OBJ, STL and PLY.

#include <cstdlib>
#include <string>

#include <lodestone/io/read_mesh.h>

#include "support/fuzz.h"

std::vector<lodestone::test::Bytes> lodestone::test::fuzz_seeds() {
  std::vector<Bytes> seeds;
  for (const std::string& source :
       {std::string("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 1\nvn 0 0 1\nusemtl a\nf 1/1/1 2/1/1 3//1 -1\nl 1 2\n"),
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
  for (const char* extension : {"obj", "stl", "ply"}) {
    const auto file = lodestone::read_mesh_bytes(bytes, extension);
    if (!file && file.error().message.empty()) std::abort();
  }
  return 0;
}
