#include "pipeline/first_picture.h"

#include <algorithm>
#include <utility>

#include <lodestone/core/detail/try.h>
#include <lodestone/lod/cursor.h>

#include "pipeline/make_levels.h"
#include "pipeline/shown_level.h"

namespace lodestone::detail {
namespace {

constexpr std::uint64_t kLeastLimit = 4096;
constexpr std::uint64_t kFilesShare = 100;      // a hundredth of the file
constexpr double kLeastShareOfPlanned = 0.125;  // of the faces that were planned: with fewer, it had better be late
constexpr double kMargin = 0.97;                // bytes do not fall quite as faces do
constexpr std::uint64_t kNumberBytes = 80;      // of a mesh's measured numbers, which are not there yet

// Of the records that a first chunk has room for, as its bytes are spread over it: what is tried first, and last.
constexpr double kFirstShare = 0.8, kLastShare = 0.3;

/// A level of each mesh in place of the last that is planned.
struct ShownLevel {
  SceneChoice choice;
  std::vector<AssetLevel> levels;  ///< by mesh
};

void swap_last(ShownLevel& shown, LevelPlan& plan, std::vector<LeveledMesh>& levels) {
  std::swap(shown.choice, plan.choices.back());
  for (std::size_t i = 0; i < levels.size(); ++i) std::swap(shown.levels[i], levels[i].levels.back());
}

/// The file as it would be, but for the numbers that are measured.
Result<EncodedAsset> encode_shown(const Scene& scene, const std::vector<LeveledMesh>& levels,
                                  const BuildOptions& options) {
  FileContent content;
  content.level = levels[0].levels.size() - 1;
  LODESTONE_TRY(EncodedGeometry geometry, encode_geometry(scene, levels, storage_of(scene, options), content));
  return write_asset(std::move(geometry));
}

/// Makes the level of a share of the faces that the options ask for; without levels where there is none.
Result<ShownLevel> make_shown(MeasuredScene& measured, const std::vector<SimplifyResult>& simplified,
                              BuildOptions options, double share, SceneFitter& fitter, const Progress& progress) {
  options.targets[0].value *= share;
  LevelPlan plan = plan_levels(measured, simplified, options, fitter, progress);
  if (plan.level_count() < 2 || !plan.choices[1].met) return ShownLevel{};
  plan.choices.erase(plan.choices.begin());
  LODESTONE_TRY(std::vector<LeveledMesh> made, make_levels(measured, simplified, plan, fitter, progress));
  ShownLevel shown{std::move(plan.choices[0]), {}};
  for (std::size_t i = 0; i < made.size(); ++i) {
    keep_every_material(measured.scene().meshes()[i].mesh, made[i].levels[0].mesh);
    shown.levels.push_back(std::move(made[i].levels[0]));
  }
  return shown;
}

/// A level on the way to the first that is placed, or to the full mesh where none is: none of its vertices moves there.
PlacedLevel level_on_the_way(const ProgressiveMesh& mesh, Index position, const PlacedLevel* first,
                             const MeasuredSurface* original) {
  Mesh level = extract_level(mesh, position);
  if (first == nullptr || original == nullptr) return {position, level.positions, mesh.deviation[position], 0};
  std::copy_n(first->positions.begin(), level.positions.size(), level.positions.begin());
  const double bound = measure_maximum(MeasuredSurface(level), *original, {}).maximum_bound();
  return {position, std::move(level.positions), static_cast<float>(bound), first->precision};
}

}  // namespace

std::uint64_t first_picture_limit(std::uint64_t file_bytes) { return std::max(kLeastLimit, file_bytes / kFilesShare); }

Result<bool> fit_first_picture(MeasuredScene& measured, const std::vector<SimplifyResult>& simplified,
                               const BuildOptions& options, SceneFitter& fitter, const Progress& progress,
                               LevelPlan& plan, std::vector<LeveledMesh>& levels) {
  if (levels.empty() || plan.level_count() < 2) return false;
  ShownLevel planned;  // once it is not among the levels any more
  for (double share = 1;;) {
    LODESTONE_TRY(const EncodedAsset asset, encode_shown(measured.scene(), levels, options));
    const std::uint64_t limit = first_picture_limit(asset.layout.total_bytes);
    const std::uint64_t bytes = asset.layout.first_picture_bytes + kNumberBytes * levels.size();
    const std::uint64_t geometry = asset.layout.levels[0].geometry_bytes;
    if (bytes <= limit) return share < 1;
    const double room = static_cast<double>(limit) - static_cast<double>(bytes - geometry);
    share *= kMargin * std::min(room / static_cast<double>(geometry), 1.0);
    ShownLevel shown;
    if (share >= kLeastShareOfPlanned) {
      LODESTONE_TRY(shown, make_shown(measured, simplified, options, share, fitter, progress));
    }
    if (shown.levels.empty()) break;
    swap_last(shown, plan, levels);
    if (planned.levels.empty()) planned = std::move(shown);
  }
  if (!planned.levels.empty()) swap_last(planned, plan, levels);
  return false;
}

Result<CompactStream> encode_early_picture(const ProgressiveMesh& mesh, const CompactOptions& options,
                                           std::vector<PlacedLevel> placed, const MeasuredSurface* original) {
  LODESTONE_TRY(CompactStream stream, encode_compact(mesh, options, placed));
  CompactOptions again = options;
  again.progress = options.progress.part(0);
  const std::size_t placed_count = placed.size();
  for (double share = kFirstShare; share > kLastShare; share *= kFirstShare) {
    LODESTONE_TRY(const std::vector<CompactChunk> chunks, read_compact_chunks(stream.bytes));
    const CompactChunk& first = chunks[0];
    const std::uint64_t limit = first_picture_limit(stream.bytes.size());
    if (first.byte_offset + first.byte_length <= limit || limit <= first.byte_offset) break;
    const double room = static_cast<double>(limit - first.byte_offset) / static_cast<double>(first.byte_length);
    auto position = static_cast<Index>(share * std::min(room, 1.0) * first.record_count);
    while (position > 0 && !is_whole(mesh, position)) --position;
    if (position == 0) break;
    if (placed.size() > placed_count) placed.erase(placed.begin());
    placed.insert(placed.begin(),
                  level_on_the_way(mesh, position, placed.empty() ? nullptr : &placed.front(), original));
    LODESTONE_TRY(stream, encode_compact(mesh, again, placed));
  }
  return stream;
}

}  // namespace lodestone::detail
