#include "pipeline/encode_streams.h"

#include <utility>

#include <lodestone/core/detail/cancelled.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/core/parallel.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/stream_format.h>

#include "pipeline/first_picture.h"
#include "pipeline/level_plan.h"
#include "pipeline/simplify_scene.h"

namespace lodestone::detail {
namespace {

constexpr double kPlacingShare = 0.7;  // of the work on a compact stream; the rest is encoding

/// `placer`: null where the vertices of levels stay where they are. `is_alone`: it is all that shows a picture.
Result<std::vector<std::byte>> encode(std::size_t i, const ProgressiveMesh& mesh, CompactOptions options,
                                      const StreamPlacer* placer, bool is_alone, const Progress& progress) {
  std::vector<PlacedLevel> placed;
  const double placing = placer != nullptr && !options.lossless ? kPlacingShare : 0;
  if (placing > 0) placed = placer->fitter.placed(i, placer->measured.original(i), progress.part(placing));
  if (!progress.reach(placing)) return cancelled();
  options.progress = progress.part(1 - placing);
  const MeasuredSurface* const original = placing > 0 ? &placer->measured.original(i) : nullptr;
  LODESTONE_TRY(CompactStream stream, is_alone && !options.lossless
                                          ? encode_early_picture(mesh, options, std::move(placed), original)
                                          : encode_compact(mesh, options, placed));
  return std::move(stream.bytes);
}

Result<std::vector<std::byte>> encode(const ProgressiveMesh& mesh, const Progress& progress) {
  StreamOptions options;
  options.progress = progress;
  return encode_stream(mesh, options);
}

}  // namespace

std::vector<CompactOptions> stream_options(const Scene& scene, const BuildOptions& build) {
  const bool is_drawn = is_by_compact_streams(build.layout);
  const AssetOptions storage = is_drawn ? build.storage : storage_of(scene, build);
  const bool is_rounded = is_drawn || (!storage.position_grid && storage.compression != Compression::None);
  std::vector<CompactOptions> options = compact_options(scene, storage);
  const std::vector<bool> fit = fit_compact_streams(scene, storage);
  for (std::size_t i = 0; i < options.size(); ++i) {
    options[i].coding = stream_coding_of(build);
    options[i].lossless = build.lossless || !is_rounded || !fit[i];
  }
  return options;
}

Result<MeshStreams> encode_streams(const Scene& scene, const std::vector<SimplifyResult>& simplified,
                                   const BuildOptions& build, const StreamPlacer* placer, const Progress& progress) {
  const std::vector<CompactOptions> options = stream_options(scene, build);
  MeshStreams streams(simplified.size());
  for_each_in_parallel(streams.size(), [&](std::size_t i) {
    const Progress part = progress.part(1 / static_cast<double>(streams.size()));
    if (part.is_cancelled()) return;
    const ProgressiveMesh& mesh = simplified[i].mesh;
    streams[i] = encode(i, mesh, options[i], placer, build.layout == FileLayout::StreamAlone, part);
    const bool is_held = streams[i] || streams[i].error().code == ErrorCode::Cancelled;
    if (!is_held && !is_by_compact_streams(build.layout)) streams[i] = encode(mesh, part);
  });
  if (!progress.reach(1)) return cancelled();
  return streams;
}

}  // namespace lodestone::detail
