#include "scene_grids.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "text.h"
#include "try.h"

namespace lodestone::detail {
namespace {

constexpr double kScaleTolerance = 1e-6;
constexpr int kMinWeightBits = 12;  // A joint's error grows with the distance of what it moves.

/// Grows a box over values; components of one element lie next to each other.
class GridFitter {
 public:
  explicit GridFitter(std::size_t component_count)
      : low_(component_count, HUGE_VALF), high_(component_count, -HUGE_VALF) {}

  void add(std::span<const float> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) continue;
      low_[i % low_.size()] = std::min(low_[i % low_.size()], values[i]);
      high_[i % low_.size()] = std::max(high_[i % low_.size()], values[i]);
    }
  }

  QuantizationGrid grid(int bits) const {
    QuantizationGrid grid{low_, 0, bits};
    for (std::size_t i = 0; i < low_.size(); ++i) {
      if (low_[i] > high_[i])
        grid.origin[i] = 0;  // no values at all
      else
        grid.range = std::max(grid.range, high_[i] - low_[i]);
    }
    if (grid.range == 0) grid.range = 1;
    grid.range = std::min(grid.range, std::numeric_limits<float>::max());
    return grid;
  }

 private:
  std::vector<float> low_, high_;
};

std::span<const float> as_floats(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const float*>(bytes.data()), bytes.size() / sizeof(float)};
}

int bits_for(const std::string& name, const AssetOptions& options) {
  if (name == "NORMAL") return options.draco_normal_bits;
  if (name.starts_with("WEIGHTS_")) return std::max(options.draco_generic_bits, kMinWeightBits);
  return name.starts_with("TEXCOORD_") ? options.draco_texcoord_bits : options.draco_generic_bits;
}

std::vector<QuantizationGrid> fit_columns(std::span<const LevelGeometry> levels, const AssetOptions& options) {
  std::vector<QuantizationGrid> grids;
  for (std::size_t c = 0; c < levels[0].columns.size(); ++c) {
    const Attribute& layout = *levels[0].columns[c];
    GridFitter fitter(layout.component_count);
    if (layout.type == ComponentType::Float32)
      for (const LevelGeometry& level : levels) fitter.add(as_floats(level.columns[c]->data));
    grids.push_back(fitter.grid(bits_for(layout.name, options)));
  }
  return grids;
}

/// A grid of so many bits that its range is the step times a power of two: Draco divides without an error.
Result<QuantizationGrid> given_grid(const PositionGrid& given, std::span<const std::vector<LevelGeometry>> levels) {
  constexpr int kBits = 30;
  constexpr double kMostSteps = 1 << 29;  // differences of positions stay within 32 bits
  const float origin[3] = {given.origin.x, given.origin.y, given.origin.z};
  double farthest = 0;
  for (const std::vector<LevelGeometry>& mesh : levels)
    for (const LevelGeometry& level : mesh)
      for (const Vec3f& p : level.mesh->positions)
        for (const double d : {p.x - origin[0], p.y - origin[1], p.z - origin[2]})
          farthest = std::max(farthest, std::abs(d) / static_cast<double>(given.step));
  if (farthest > kMostSteps)
    return fail(ErrorCode::InvalidArgument, text("positions lie up to ", farthest, " steps of ", given.step,
                                                 " from the grid's origin, more than ", kMostSteps));
  return QuantizationGrid{{origin, origin + 3}, std::ldexp(given.step, kBits), kBits};
}

/// Returns the meshes' numbers by ascending scale.
std::vector<std::size_t> by_scale(const std::vector<SceneMesh>& meshes) {
  std::vector<std::size_t> order(meshes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return meshes[a].scale < meshes[b].scale; });
  return order;
}

/// Fits one grid to the levels of all meshes of a scale.
void fit_positions(const Scene& scene, std::span<const std::vector<LevelGeometry>> levels, const AssetOptions& options,
                   std::vector<QuantizationGrids>& grids) {
  const std::vector<std::size_t> order = by_scale(scene.meshes());
  for (std::size_t first = 0; first < order.size();) {
    const double scale = scene.meshes()[order[first]].scale;
    GridFitter fitter(3);
    std::size_t end = first;
    for (; end < order.size() && scene.meshes()[order[end]].scale <= scale * (1 + kScaleTolerance); ++end)
      for (const LevelGeometry& level : levels[order[end]])
        fitter.add(as_floats(std::as_bytes(std::span(level.mesh->positions))));
    for (; first < end; ++first) grids[order[first]].position = fitter.grid(options.draco_position_bits);
  }
}

}  // namespace

Result<std::vector<QuantizationGrids>> fit_grids(const Scene& scene, std::span<const std::vector<LevelGeometry>> levels,
                                                 const AssetOptions& options) {
  std::vector<QuantizationGrids> grids(levels.size());
  if (options.draco_position_grid) {
    LODESTONE_TRY(const QuantizationGrid grid, given_grid(*options.draco_position_grid, levels));
    for (QuantizationGrids& of_mesh : grids) of_mesh.position = grid;
  } else {
    fit_positions(scene, levels, options, grids);
  }
  for (std::size_t i = 0; i < levels.size(); ++i) grids[i].attributes = fit_columns(levels[i], options);
  return grids;
}

}  // namespace lodestone::detail
