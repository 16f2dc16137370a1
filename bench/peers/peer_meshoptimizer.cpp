#include <meshoptimizer.h>

#include "simplifier.h"

namespace lodestone::bench {

std::vector<Level> run_meshoptimizer(const Mesh& mesh, std::span<const std::size_t> face_counts) {
  constexpr float kNoErrorLimit = 1e10F;
  const Surface full = surface_of(mesh);
  std::vector<unsigned> indices;
  for (const auto& face : full.faces) indices.insert(indices.end(), face.begin(), face.end());

  std::vector<Level> levels;
  for (const std::size_t faces : face_counts) {
    std::vector<unsigned> simplified(indices.size());
    const Clock clock;
    const std::size_t count =
        meshopt_simplify(simplified.data(), indices.data(), indices.size(), &mesh.positions.front().x,
                         mesh.vertex_count(), sizeof(Vec3f), faces * 3, kNoErrorLimit, 0, nullptr);
    Level level{{full.points, {}}, clock.seconds()};
    for (std::size_t i = 0; i < count; i += 3) {
      level.surface.faces.push_back({simplified[i], simplified[i + 1], simplified[i + 2]});
    }
    levels.push_back(std::move(level));
  }
  return levels;
}

}  // namespace lodestone::bench
