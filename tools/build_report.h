#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/mesh.h>
#include <lodestone/pipeline/build_asset.h>

#include "json_text.h"

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
  struct OutputFile {
    std::string path;
    std::uint64_t bytes = 0;
  };
  Input input;
  Json settings;  ///< the options as understood
  BuildResult build;
  std::string output_path;         ///< as given
  std::uint64_t output_bytes = 0;  ///< of all files together
  std::vector<OutputFile> files;   ///< more than one with `--profile files`
  double reading_ms = 0;
};

/// Returns the report as JSON; the peak memory is this process's so far.
Json report_json(const BuildReport& report);

/// Prints the levels, the stream and the file to standard output.
void print_table(const BuildReport& report);

}  // namespace lodestone::tool
