#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/mesh.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/simplify.h>

#include "json_text.h"
#include "level_target.h"

namespace lodestone::tool {

/// What a run of `build` did: printed as a table, written as JSON. docs/report.md describes the JSON.
struct BuildReport {
  struct Input {
    std::string path;
    std::size_t face_count = 0;
    std::size_t vertex_count = 0;
    Box box;
    AssemblyReport assembly;
    std::vector<std::string> notes;
  };
  struct Level {
    std::size_t face_count = 0;
    std::size_t vertex_count = 0;
    Deviation deviation;         ///< measured, whole mesh to level and back; before quantisation
    double deviation_bound = 0;  ///< what the stream promises for the level, mesh units
    double curvature_error = 0;  ///< the metric's own unit
    std::uint64_t bytes = 0;
    std::optional<LevelTarget> target;  ///< in absolute numbers; none for the whole mesh
    bool met = true;
    std::string stopped_by;  ///< faces, error, epsilon, stuck; whole for level 0
  };
  struct Stream {
    std::uint64_t bytes = 0;  ///< 0 where the file has none
    std::size_t record_count = 0;
    std::size_t round_count = 0;
    std::size_t base_face_count = 0;
    StopReason stop_reason = StopReason::Stuck;
    BlockedCounts blocked;
  };
  struct Timings {
    double read = 0;
    double simplify = 0;
    double levels = 0;
    double write = 0;
  };

  Input input;
  Json settings;              ///< the options as understood
  std::vector<Level> levels;  ///< finest first
  Stream stream;
  std::string output_path;
  std::uint64_t output_bytes = 0;
  double quantisation_error = 0;  ///< the farthest Draco moves a vertex, mesh units; 0 without Draco
  Timings timings_ms;
};

/// Returns the report as JSON; the peak memory is this process's so far.
Json report_json(const BuildReport& report);

/// Prints the levels, the stream and the file to standard output.
void print_table(const BuildReport& report);

}  // namespace lodestone::tool
