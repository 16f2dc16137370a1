// Material libraries of OBJ: the input is one, and, after its first zero byte, the image that its textures name. What
// is read of them can be written as glTF and read again.

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

#include <lodestone/io/asset.h>
#include <lodestone/io/scene.h>

#include "support/data.h"
#include "support/fuzz.h"

namespace {

constexpr std::string_view kObj =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 1\n"
    "usemtl a\nf 1/1 2/1 3/1\nusemtl b\nf 1 3 4\nusemtl c\nf 4 2 1\n";

/// A folder for the files, which goes when the run ends.
const lodestone::test::ScratchDirectory& folder() {
  static const lodestone::test::ScratchDirectory kFolder;
  return kFolder;
}

/// A new file each time: unlike a replaced one, nobody waits until the disk has it.
void write(const char* name, std::span<const std::byte> bytes) {
  std::filesystem::remove(folder() / name);
  std::ofstream file(folder() / name, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

void check(const lodestone::Scene& scene) {
  std::vector<lodestone::LeveledMesh> meshes;
  for (const lodestone::SceneMesh& mesh : scene.meshes()) meshes.push_back({{{mesh.mesh, {}, 0, "whole"}}, {}});
  lodestone::AssetOptions options;
  options.compression = lodestone::Compression::None;
  const auto asset = encode_scene(scene, meshes, options);
  if (!asset || !lodestone::Scene::read_bytes(asset->glb, "glb")) std::abort();
}

}  // namespace

std::vector<lodestone::test::Bytes> lodestone::test::fuzz_seeds() {
  std::vector<Bytes> seeds;
  for (const std::string& source :
       {std::string(
            "newmtl a\nKa 1 1 1\nKd .8 .8 .8\nKs 0 0 0\nNs 96\nNi 1\nd 1\nillum 2\nmap_Kd -s 2 2 1 -o .5 0 0 a.png\n"
            "newmtl b\nKd spectral x.rfl 1\nTr .5\nmap_d a.png\nmap_Bump -bm 0.3 a.png\nnewmtl c\nTf 1 1 1\n")
            .append("\0\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\x08\2\0\0\0", 30),
        std::string(
            "# c\nnewmtl a\r\nPr 0.3\r\nPm 1\r\nmap_Pr a.png\r\nmap_Pm a.png\r\nKe 9 0 0\r\nmap_Ke -clamp on a.png\r\n"
            "newmtl b\nnorm a.png -mm 0 1\nPc 1\nPcr .2\nd -halo .5\nnewmtl c\nmap_Ka a.png\nbump \"a.png\" -bm 2\n")
            .append("\0\xff\xd8\xff\xe0\0\4ab\xff\xc0\0\x0b\x08\0\1\0\1\1\1\x11\0", 22)})
    seeds.emplace_back(source.begin(), source.end());
  return seeds;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  write("a.obj", std::as_bytes(std::span(kObj)));
  const auto zero = static_cast<std::size_t>(std::find(bytes.begin(), bytes.end(), std::byte{0}) - bytes.begin());
  write("a.mtl", bytes.first(zero));
  write("a.png", bytes.subspan(std::min(zero + 1, size)));
  const auto scene = lodestone::Scene::read(folder() / "a.obj");
  if (!scene) std::abort();  // whatever its library says, the mesh is there
  check(*scene);
  return 0;
}
