#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <lodestone/core/effort.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/lod/simplify_options.h>
#include <lodestone/pipeline/importance.h>
#include <lodestone/pipeline/level_target.h>
#include <lodestone/pipeline/scene_target.h>

namespace lodestone {

/// Where a level's vertices lie.
enum class Placement {
  Optimised,  ///< fitted to the original; those of skinned and morphed meshes are a subset all the same
  Subset,     ///< a subset of the original's, as in the stream
};

/// In how many files the levels go.
enum class FileLayout {
  OneFile,       ///< all levels in one file, by MSFT_lod
  FilePerLevel,  ///< a file for each level; none has a stream
  OneLevel,      ///< the level of the only target alone, without levels or streams beside it
  Refined,       ///< one file of the coarsest level and a compact stream of every other, up to the whole mesh
  StreamAlone,   ///< a compact stream and nothing else, of a scene of one mesh; the levels are those it is measured at
};

/// Whether a layout's streams are compact ones.
inline bool is_by_compact_streams(FileLayout layout) {
  return layout == FileLayout::Refined || layout == FileLayout::StreamAlone;
}

/// SimplifyOptions::dense_rounds of compact streams: a fifth smaller than with rounds by cost alone, levels of as many
/// faces a tenth further off.
inline constexpr double kStreamDenseRounds = 1.53;

/// What is built of a scene.
struct BuildOptions {
  int effort = kDefaultEffort;  ///< 1 … 9, see core/effort.h: of simplifying, measuring, fitting and coding streams
  /// The levels after the whole scene, all of one kind; they may come in any order.
  std::vector<LevelTarget> targets = ratio_targets(0.5, 4);
  /// An error that no level goes beyond, where targets are of faces or epsilon: what stops first, stops.
  std::optional<LevelTarget> limit;
  TargetScope scope = TargetScope::Scene;  ///< whether meshes share what targets ask for
  /// Of every mesh alike. The build itself sets `effort`, `importance`, `stop`, `measure_step`, `progress` and
  /// the reach of morph targets.
  SimplifyOptions simplify;
  Importance importance;                       ///< of materials and nodes, by name
  Placement placement = Placement::Optimised;  ///< of each level but the first, and of those of a compact stream
  FileLayout layout = FileLayout::OneFile;
  bool stream = true;  ///< write each mesh's removal stream, with all levels in one file
  /// Keep the streams' floats, bit for bit, at two to four times their size; none of their levels are placed. So do
  /// streams of what needs more than 16 bits for a position and, with all levels in one file, of what is not compressed
  /// or has a grid of a given step.
  bool lossless = false;
  std::optional<CompactCoding> stream_coding;  ///< unset: by effort, fast up to 2 and small from 3 on
  bool strict = false;                         ///< stop before anything is encoded where a target cannot be met
  bool keep_levels = false;                    ///< keep the levels as the files have them: see `BuildResult::decoded`
  /// Of a stream alone: what its faces' materials are called, by number of the primitive; empty: as those.
  std::vector<Index> material_numbers;
  /// How it is stored. The build itself sets `keep_decoded` and, where levels are by error, `position_error`.
  /// With a file for each level, level i's `gltf_name` ends in "_LODi".
  AssetOptions storage;
};

/// Returns how a build codes its streams. Pre: the effort is one there is.
CompactCoding stream_coding_of(const BuildOptions& options);

}  // namespace lodestone
