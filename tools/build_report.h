#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/mesh.h>
#include <lodestone/lod/attribute_deviation.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/simplify.h>

#include "json_text.h"
#include "level_target.h"

namespace lodestone::tool {

/// What a run of `build` did: printed as a table, written as JSON. docs/report.md describes the JSON.
struct BuildReport {
  struct Input {
    std::string path;
    std::size_t face_count = 0;    ///< drawn: all instances counted
    std::size_t vertex_count = 0;  ///< drawn
    Box box;                       ///< of the scene
    double area = 0;               ///< drawn, squared world units
    AssemblyReport assembly;       ///< of all meshes
    std::vector<std::string> notes;
    std::vector<std::filesystem::path> files;  ///< that it needs beside it, relative to its folder
  };
  struct Level {
    std::size_t face_count = 0;    ///< drawn
    std::size_t vertex_count = 0;  ///< drawn
    Deviation deviation;           ///< measured, whole scene to level as decoded and back, world units
    double deviation_bound = 0;    ///< what the streams promise for the level, world units
    double curvature_error = 0;    ///< the largest of all meshes, in the metric's own unit
    std::uint64_t bytes = 0;
    std::optional<LevelTarget> target;  ///< in absolute numbers; none for the whole mesh
    bool met = true;
    std::string stopped_by;  ///< faces, error, epsilon, stuck; whole for level 0
    double deviation_beyond = 0;  ///< where an error stopped what faces were asked for: the bound of what comes nearest
  };
  /// A target that has no level of its own: the level would repeat another.
  struct LeftOut {
    LevelTarget target;
    bool met = true;
    std::string stopped_by;
    double deviation_beyond = 0;  ///< as above
    std::size_t level = 0;  ///< the one it would repeat
  };
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
  struct OutputFile {
    std::string path;
    std::uint64_t bytes = 0;
  };
  struct Timings {
    double read = 0;
    double simplify = 0;
    double levels = 0;
    double write = 0;
  };

  Input input;
  Json settings;                   ///< the options as understood
  std::vector<Level> levels;       ///< finest first
  std::vector<LeftOut> left_out;
  Stream stream;                   ///< of all meshes together
  std::vector<MeshPart> meshes;    ///< in the document's order
  std::string output_path;         ///< as given
  std::uint64_t output_bytes = 0;  ///< of all files together
  std::vector<OutputFile> files;   ///< more than one with `--profile files`
  double quantisation_error = 0;   ///< the farthest Draco moves a vertex, world units; 0 without Draco
  int position_bits = 0;           ///< of Draco's finest grid; 0 where positions are exact
  Timings timings_ms;
};

/// Returns the report as JSON; the peak memory is this process's so far.
Json report_json(const BuildReport& report);

/// Prints the levels, the stream and the file to standard output.
void print_table(const BuildReport& report);

}  // namespace lodestone::tool
