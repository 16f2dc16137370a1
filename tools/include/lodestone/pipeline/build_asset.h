#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/result.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/scene.h>
#include <lodestone/lod/attribute_deviation.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/simplify.h>
#include <lodestone/pipeline/build_options.h>

namespace lodestone {

/// The stages of a build. The last two take turns: what is measured is what was encoded.
enum class BuildStage { Simplifying, MakingLevels, MeasuringLevels, Writing };

/// Is told how a build goes on. Calls come from any thread, one at a time.
class BuildObserver {
 public:
  virtual ~BuildObserver() = default;
  /// Says how much of a stage is done, 0 to 1, never less than before. Return false to cancel the build, which ends
  /// within a tenth of a second, but for a mesh of millions of faces. About a thousand calls a second: be quick.
  virtual bool progress(BuildStage, double /*done*/) { return true; }
  /// Says what is otherwise than one would think, in one sentence.
  virtual void note(const std::string& /*sentence*/) {}
};

/// What a build made.
struct BuildResult {
  /// One level of the whole scene; lengths in world units.
  struct Level {
    std::size_t face_count = 0;         ///< drawn: all instances counted
    std::size_t vertex_count = 0;       ///< drawn
    Deviation deviation;                ///< measured, whole scene to level as decoded and back
    double deviation_bound = 0;         ///< what the streams promise for the level
    double curvature_error = 0;         ///< the largest of all meshes, in the metric's own unit
    std::uint64_t bytes = 0;            ///< of its geometry; of a stream alone those up to it
    std::optional<LevelTarget> target;  ///< in absolute numbers; none for the whole mesh
    bool met = true;
    std::string stopped_by;       ///< faces, error, epsilon, stuck; whole for level 0
    double deviation_beyond = 0;  ///< where an error stopped what faces were asked for: the bound of what comes nearest
  };
  /// A target that has no level of its own: the level would repeat another.
  struct LeftOut {
    LevelTarget target;
    bool met = true;
    std::string stopped_by;
    double deviation_beyond = 0;  ///< as above
    std::size_t level = 0;        ///< the one it would repeat
  };
  /// A removal stream, or all of a scene together.
  struct Stream {
    std::uint64_t bytes = 0;  ///< 0 where the file has none
    std::size_t record_count = 0;
    std::size_t round_count = 0;
    std::size_t base_face_count = 0;
    StopReason stop_reason = StopReason::Stuck;
    BlockedCounts blocked;
  };
  /// One mesh of the scene; lengths in mesh units.
  struct MeshPart {
    /// One level of it.
    struct Level {
      std::size_t face_count = 0;
      std::size_t vertex_count = 0;
      Deviation deviation;  ///< of the level as decoded
      double deviation_bound = 0;
      std::vector<AttributeDeviation> attributes;  ///< of the level as decoded; none of a whole mesh that is as it was
    };
    std::string name;
    std::size_t instance_count = 0;
    double scale = 1;  ///< world units per mesh unit
    AssemblyReport assembly;
    Stream stream;
    std::vector<Level> levels;
  };
  /// Wall clock of the stages, milliseconds.
  struct Timings {
    double simplify = 0;
    double levels = 0;
    double write = 0;
  };

  bool met = true;            ///< all targets
  std::vector<Level> levels;  ///< finest first
  std::vector<LeftOut> left_out;
  Stream stream;                   ///< of all meshes together
  std::vector<MeshPart> meshes;    ///< in the document's order
  std::vector<std::string> notes;  ///< as the observer was told
  double grid_error = 0;           ///< the farthest that the grid of positions alone may move a vertex, world units
  double quantisation_error = 0;   ///< the farthest it did
  int position_bits = 0;           ///< of Draco's finest grid; 0 where positions are exact
  Timings timings_ms;

  std::vector<EncodedAsset> files;         ///< one, or one for each level; none where `strict` stopped the build
  std::vector<SimplifyResult> simplified;  ///< by mesh, as the next
  std::vector<LeveledMesh> decoded;        ///< the levels as the files have them, where the options keep them
};

/// Simplifies a scene's meshes, chooses and fits levels that answer the targets, and encodes and measures them.
/// Deterministic, timings apart, for any number of threads (see `with_threads`).
///
/// Errors: InvalidArgument, also for targets of several kinds, for names that nothing in the scene has, and for bits of
/// positions that streams do not have; Cancelled; those of `simplify`, `encode_stream`, `encode_compact` and
/// `encode_scene`. Pre: the scene has a mesh.
Result<BuildResult> build_asset(const Scene& scene, const BuildOptions& options, BuildObserver& observer);

/// The same, unobserved.
Result<BuildResult> build_asset(const Scene& scene, const BuildOptions& options = {});

}  // namespace lodestone
