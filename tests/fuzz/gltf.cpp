// The glTF readers: the flattened mesh, and the asset with its levels.

#include <cstdlib>

#include <lodestone/io/asset.h>
#include <lodestone/io/read_mesh.h>

#include "support/fuzz.h"
#include "support/shapes.h"

std::vector<lodestone::test::Bytes> lodestone::test::fuzz_seeds() {
  std::vector<Bytes> seeds;
  for (const bool draco : {false, true}) {
    std::vector<AssetLevel> levels(2);
    levels[0].mesh = assemble(seam_cube(2))->mesh;
    levels[1].mesh = assemble(seam_cube(1))->mesh;
    AssetOptions options;
    options.draco = draco;
    const auto asset = encode_asset(levels, {}, options);
    if (!asset) continue;
    const auto* first = reinterpret_cast<const std::uint8_t*>(asset->glb.data());
    seeds.emplace_back(first, first + asset->glb.size());
  }
  return seeds;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  const auto file = lodestone::read_mesh_bytes(bytes, "gltf");
  const auto asset = lodestone::read_asset_bytes(bytes);
  if ((!file && file.error().message.empty()) || (!asset && asset.error().message.empty())) std::abort();
  return 0;
}
