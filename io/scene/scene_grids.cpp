#include "scene/scene_grids.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <optional>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "scene/meshopt_accessors.h"

namespace lodestone::detail {
namespace {

constexpr double kScaleTolerance = 1e-6;
constexpr int kDefaultPositionBits = 14;
constexpr int kMinWeightBits = 12;  // A joint's error grows with the distance of what it moves.

// Draco rounds by adding a half to a float: with more bits, that half is lost.
constexpr int kMostExactBits = 23;

// Faces only a few steps wide no longer have the directions they had: so many, on the average of the area.
constexpr double kStepsPerFace = 10;
// Nearly all edges keep so many steps; the grid need not be finer for a small share of faces, which often are slivers.
constexpr double kStepsPerEdge = 4, kSmallerShare = 0.02;

// What the exponential filter has room for, without the smallest floats, which its decoders do not make.
constexpr int kMostBinaryExponent = 100;
constexpr double kMostMultiple = (1 << 23) - 1;
constexpr int kLeastOctahedralBits = 2, kMostOctahedralBits = 16;

/// Returns the fewest bits whose grid of such a range has steps of at most `step`.
int bits_for_step(double range, double step) {
  return step > 0 ? static_cast<int>(std::ceil(std::log2(std::min(range / step, 1e9) + 1))) : kMostExactBits + 1;
}

/// Grows a box over values; components of one element lie next to each other.
class GridFitter {
 public:
  explicit GridFitter(std::size_t component_count)
      : low_(component_count, HUGE_VALF), high_(component_count, -HUGE_VALF) {}

  void add(std::span<const float> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      const std::size_t c = i % low_.size();
      finite_ &= std::isfinite(values[i]);
      low_[c] = std::min(low_[c], values[i]);
      high_[c] = std::max(high_[c], values[i]);
      if (values[i] != 0 && std::isfinite(values[i])) unit_ = std::min(unit_, lowest_digit(values[i]));
    }
  }

  /// The longest edge of the box; infinite where a value is.
  double range() const {
    double range = finite_ ? 0 : HUGE_VAL;
    for (std::size_t c = 0; c < low_.size(); ++c)
      if (low_[c] <= high_[c]) range = std::max(range, static_cast<double>(high_[c]) - static_cast<double>(low_[c]));
    return range;
  }

  /// The grid of so many bits; none where that is beyond what floats can do.
  QuantizationGrid grid(int bits) const {
    if (!(range() <= kLargestRange)) return exact();
    return {origin(), range() > 0 ? static_cast<float>(range()) : 1, bits};
  }

  /// The grid that holds every value exactly, where there is one of at most so many bits: the values are multiples of
  /// one power of two.
  std::optional<QuantizationGrid> exact_grid(int most_bits) const {
    if (!(range() <= kLargestRange)) return std::nullopt;
    if (range() == 0) return QuantizationGrid{origin(), 1, 1};
    const double step = std::ldexp(1.0, unit_);
    const int bits = std::max(1, bits_for_step(range(), step));
    if (bits > std::min(most_bits, kMostExactBits)) return std::nullopt;
    return QuantizationGrid{origin(), static_cast<float>(step * ((1 << bits) - 1)), bits};
  }

  /// The grid of steps of 2^exponent that count from 0; none where values are too many steps from there.
  QuantizationGrid binary_grid(int exponent) const {
    const double step = std::ldexp(1.0, exponent);
    if (!(range() <= kLargestRange) || std::abs(exponent) > kMostBinaryExponent || farthest() > kMostMultiple * step)
      return exact();
    const int bits = std::max(1, bits_for_step(range() + step, step));
    std::vector<float> origin = this->origin();
    for (float& x : origin) x = static_cast<float>(std::floor(static_cast<double>(x) / step) * step);
    return {std::move(origin), static_cast<float>(step * ((1 << bits) - 1)), bits};
  }

  /// The exponent of the longest such step that is no longer than that of a grid of so many bits.
  int exponent_for(int bits) const {
    return std::ilogb((range() > 0 ? range() : 1) / static_cast<double>((std::uint64_t{1} << bits) - 1));
  }

  /// The exponent of the longest step that all values are multiples of; nothing where all are 0.
  std::optional<int> exact_exponent() const {
    return unit_ == std::numeric_limits<int>::max() ? std::nullopt : std::optional(unit_);
  }

  static QuantizationGrid exact() { return {{}, 1, 0}; }

 private:
  static constexpr double kLargestRange = std::numeric_limits<float>::max() / 4;  // Draco computes beyond it.

  /// From 0.
  double farthest() const {
    float farthest = 0;
    for (std::size_t c = 0; c < low_.size(); ++c)
      if (low_[c] <= high_[c]) farthest = std::max({farthest, std::abs(low_[c]), std::abs(high_[c])});
    return static_cast<double>(farthest);
  }

  /// The exponent of the last binary digit that is set.
  static int lowest_digit(float value) {
    int exponent;
    auto digits = static_cast<std::uint32_t>(std::ldexp(std::frexp(std::abs(value), &exponent), 24));
    return exponent - 24 + std::countr_zero(digits);
  }

  std::vector<float> origin() const {
    std::vector<float> origin = low_;
    for (std::size_t c = 0; c < origin.size(); ++c)
      if (low_[c] > high_[c]) origin[c] = 0;  // no values at all
    return origin;
  }

  std::vector<float> low_, high_;
  int unit_ = std::numeric_limits<int>::max();
  bool finite_ = true;
};

/// How finely values of an attribute are kept.
struct Fineness {
  int bits = 0;             ///< 0: they are data, which nobody knows how to round
  bool of_the_unit = true;  ///< and not of their range: steps are no longer where values lie far apart
};

Fineness fineness_of(const std::string& name, const AssetOptions& options) {
  if (name.starts_with("TEXCOORD_")) return {options.texcoord_bits, true};
  if (name.starts_with("COLOR_")) return {options.generic_bits, true};
  if (name.starts_with("WEIGHTS_")) return {std::max(options.generic_bits, kMinWeightBits), true};
  if (name == "TANGENT") return {options.generic_bits, false};
  return {};
}

QuantizationGrid column_grid(const GridFitter& fitter, const Fineness& fineness) {
  if (const auto exact = fitter.exact_grid(fineness.bits == 0 ? kMostExactBits : fineness.bits)) return *exact;
  if (fineness.bits == 0) return GridFitter::exact();
  int bits = fineness.bits;
  if (fineness.of_the_unit && fitter.range() > 1) bits += static_cast<int>(std::lround(std::log2(fitter.range())));
  return bits > std::max(fineness.bits, kMostExactBits) ? GridFitter::exact() : fitter.grid(bits);
}

/// A grid of meshopt's, of the longest step that keeps values as they are, or of one that divides the unit in as many
/// as are wanted.
QuantizationGrid binary_column_grid(const GridFitter& fitter, int bits) {
  const auto exact = fitter.exact_exponent();
  if (exact && (bits == 0 || *exact >= -bits)) return fitter.binary_grid(*exact);
  return bits == 0 ? GridFitter::exact() : fitter.binary_grid(-bits);
}

QuantizationGrid fit_column(const GridFitter& fitter, const Attribute& layout, const AssetOptions& options) {
  const Fineness fineness = fineness_of(layout.name, options);
  if (options.compression == Compression::Meshopt) {
    if (!is_packed_direction(layout)) return binary_column_grid(fitter, fineness.bits);
    const int bits = layout.name == "NORMAL" ? options.normal_bits : fineness.bits;
    return fitter.grid(std::clamp(bits, kLeastOctahedralBits, kMostOctahedralBits));
  }
  return layout.name == "NORMAL" ? fitter.grid(options.normal_bits) : column_grid(fitter, fineness);
}

std::vector<QuantizationGrid> fit_columns(std::span<const LevelGeometry> levels, const AssetOptions& options) {
  std::vector<QuantizationGrid> grids;
  for (std::size_t c = 0; c < levels[0].columns.size(); ++c) {
    const Attribute& layout = *levels[0].columns[c];
    GridFitter fitter(layout.component_count);
    if (layout.type == ComponentType::Float32)
      for (const LevelGeometry& level : levels) fitter.add(as_floats(level.columns[c]->data));
    grids.push_back(fit_column(fitter, layout, options));
  }
  return grids;
}

/// The longest difference of two positions along an axis: from one step on, they stay apart.
double axis_distance(const Vec3& a, const Vec3& b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

/// A grid of so many bits that its range is the step times a power of two: Draco divides without an error. Meshopt has
/// the next shorter step that is a power of two, whose multiples count from 0.
QuantizationGrid given_grid(const PositionGrid& given, Compression compression) {
  constexpr int kBits = 30;
  if (compression == Compression::Meshopt)
    return {{0, 0, 0}, std::ldexp(static_cast<float>(kMostMultiple), std::ilogb(given.step)), kMostExactBits};
  return {{given.origin.x, given.origin.y, given.origin.z}, std::ldexp(given.step, kBits), kBits};
}

/// Differences of positions must stay within 32 bits; meshopt's multiples of its own step within 24.
Result<void> check_reach(const PositionGrid& given, Compression compression,
                         std::span<const std::vector<LevelGeometry>> levels) {
  const bool binary = compression == Compression::Meshopt;
  const double most_steps = binary ? kMostMultiple : 1 << 29;
  const double step = binary ? std::ldexp(1.0, std::ilogb(given.step)) : static_cast<double>(given.step);
  double farthest = 0;
  for (const std::vector<LevelGeometry>& mesh : levels)
    for (const LevelGeometry& level : mesh)
      for (const Vec3f& p : level.mesh->positions)
        farthest = std::max(farthest, axis_distance(Vec3(p), Vec3(given.origin)) / step);
  if (farthest <= most_steps) return {};
  return fail(ErrorCode::InvalidArgument, text("positions lie up to ", farthest, " steps of ", step,
                                               " from the grid's origin, more than ", most_steps));
}

/// Returns the longest step that a mesh keeps its shape on.
double step_for_shape(const Mesh& mesh) {
  std::vector<double> shortest;
  double lengths = 0, doubled_area = 0;
  for (Index face = 0; face < mesh.face_count(); ++face) {
    const Vec3 a = mesh.corner_position(3 * face), b = mesh.corner_position(3 * face + 1),
               c = mesh.corner_position(3 * face + 2);
    const double edge = std::min({axis_distance(a, b), axis_distance(b, c), axis_distance(c, a)});
    if (edge > 0) shortest.push_back(edge);
    lengths += std::max({length(b - a), length(c - b), length(a - c)});
    doubled_area += length(area_vector(mesh, face));
  }
  double step = HUGE_VAL;
  if (doubled_area > 0) step = doubled_area / lengths / kStepsPerFace;
  if (shortest.empty()) return step;
  const auto rank =
      shortest.begin() + static_cast<std::ptrdiff_t>(kSmallerShare * static_cast<double>(shortest.size()));
  std::nth_element(shortest.begin(), rank, shortest.end());
  return std::min(step, *rank / kStepsPerEdge);
}

/// Returns the meshes' numbers by ascending scale.
std::vector<std::size_t> by_scale(const std::vector<SceneMesh>& meshes) {
  std::vector<std::size_t> order(meshes.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return meshes[a].scale < meshes[b].scale; });
  return order;
}

/// The grid of positions that meshes of one scale share.
class SharedGrid {
 public:
  explicit SharedGrid(const AssetOptions& options) : options_(options) {}

  /// Adds a mesh, which says how fine the grid must be.
  void add(const SceneMesh& mesh) {
    if (options_.position_bits || options_.position_grid) return;
    const double step = 2 / std::sqrt(3.0) * options_.position_error / mesh.scale;
    step_ = std::min({step_, step, step_for_shape(mesh.mesh)});
  }

  /// Adds a level of a mesh, which must lie in the grid.
  void add(const Mesh& level) { fitter_.add(as_floats(std::as_bytes(std::span(level.positions)))); }

  QuantizationGrid grid() const {
    if (options_.position_grid) return given_grid(*options_.position_grid, options_.compression);
    if (options_.position_bits) return grid(*options_.position_bits);
    const int bits = std::max(kDefaultPositionBits, bits_for_step(fitter_.range(), step_));
    return bits > kMostExactBits ? GridFitter::exact() : grid(bits);
  }

 private:
  QuantizationGrid grid(int bits) const {
    const bool binary = options_.compression == Compression::Meshopt;
    return binary ? fitter_.binary_grid(fitter_.exponent_for(bits)) : fitter_.grid(bits);
  }

  const AssetOptions& options_;
  GridFitter fitter_{3};
  double step_ = HUGE_VAL;
};

/// Fits the grid of each of a scene's meshes over the levels that `visit(mesh, add)` calls `add` with.
template <class Visit>
std::vector<QuantizationGrid> fit_positions(const Scene& scene, const AssetOptions& options, const Visit& visit) {
  std::vector<QuantizationGrid> grids(scene.meshes().size());
  const std::vector<std::size_t> order = by_scale(scene.meshes());
  for (std::size_t first = 0; first < order.size();) {
    const double scale = scene.meshes()[order[first]].scale;
    SharedGrid shared(options);
    std::size_t end = first;
    for (; end < order.size() && scene.meshes()[order[end]].scale <= scale * (1 + kScaleTolerance); ++end) {
      shared.add(scene.meshes()[order[end]]);
      visit(order[end], [&](const Mesh& level) { shared.add(level); });
    }
    for (; first < end; ++first) grids[order[first]] = shared.grid();
  }
  return grids;
}

}  // namespace

Result<std::vector<QuantizationGrids>> fit_grids(const Scene& scene, std::span<const std::vector<LevelGeometry>> levels,
                                                 const AssetOptions& options) {
  if (options.position_grid) LODESTONE_CHECK(check_reach(*options.position_grid, options.compression, levels));
  const auto positions = fit_positions(scene, options, [&](std::size_t mesh, const auto& add) {
    for (const LevelGeometry& level : levels[mesh]) add(*level.mesh);
  });
  std::vector<QuantizationGrids> grids(levels.size());
  for (std::size_t i = 0; i < levels.size(); ++i) grids[i] = {positions[i], fit_columns(levels[i], options)};
  return grids;
}

}  // namespace lodestone::detail

namespace lodestone {

namespace {

/// The grids that files without a stream would have for the whole meshes.
std::vector<detail::QuantizationGrid> grids_of_whole(const Scene& scene, AssetOptions options) {
  options.compression = Compression::Draco;
  options.position_grid.reset();
  return detail::fit_positions(scene, options,
                               [&](std::size_t mesh, const auto& add) { add(scene.meshes()[mesh].mesh); });
}

}  // namespace

std::vector<bool> fit_compact_streams(const Scene& scene, const AssetOptions& options) {
  std::vector<bool> fit;
  for (const detail::QuantizationGrid& grid : grids_of_whole(scene, options))
    fit.push_back(!grid.is_exact() && grid.bits <= kMostGridBits);
  return fit;
}

std::vector<CompactOptions> compact_options(const Scene& scene, const AssetOptions& options) {
  constexpr int kMostOtherBits = 24;
  std::vector<CompactOptions> compact;
  for (const detail::QuantizationGrid& grid : grids_of_whole(scene, options)) {
    CompactOptions& mesh = compact.emplace_back();
    mesh.grid_bits = grid.is_exact() ? kMostGridBits : std::clamp(grid.bits, kLeastGridBits, kMostGridBits);
    mesh.normal_bits = std::min(options.normal_bits, kMostOtherBits);
    mesh.texture_bits = std::clamp(options.texcoord_bits, 2, kMostOtherBits);
    mesh.other_bits = std::clamp(std::max(options.generic_bits, detail::kMinWeightBits), 2, kMostOtherBits);
  }
  AssetOptions finest = options;
  finest.position_bits = kMostGridBits;  // boxes do not hang on it
  const std::vector<detail::QuantizationGrid> boxes = grids_of_whole(scene, finest);
  for (std::size_t i = 0; i < compact.size(); ++i)
    if (const auto& o = boxes[i].origin; o.size() == 3)
      compact[i].grid = CompactGrid{{o[0], o[1], o[2]}, boxes[i].range};
  return compact;
}

std::vector<double> quantisation_errors(const Scene& scene, const AssetOptions& options) {
  std::vector<double> errors(scene.meshes().size());
  if (options.compression == Compression::None) return errors;
  const auto grids =
      detail::fit_positions(scene, options, [&](std::size_t mesh, const auto& add) { add(scene.meshes()[mesh].mesh); });
  for (std::size_t i = 0; i < errors.size(); ++i) errors[i] = grids[i].point_error();
  return errors;
}

}  // namespace lodestone
