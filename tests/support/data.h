#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "support/catch.h"

namespace lodestone::test {

/// True in sanitized builds: heavy cases then take smaller inputs or fewer steps.
#ifdef LODESTONE_TEST_REDUCED
inline constexpr bool kReduced = true;
#else
inline constexpr bool kReduced = false;
#endif

/// Returns the folder of models: $LODESTONE_DATA, else ../shared/data beside the source; nothing where it is absent.
std::optional<std::filesystem::path> models_directory();

/// Returns a model's path, e.g. model("paper/fandisk.obj"); nothing where it is absent.
std::optional<std::filesystem::path> model(const std::string& relative_path);

/// Returns the files under a folder of the models ("" for all), sorted; empty where the folder is absent.
std::vector<std::filesystem::path> model_files(const std::string& relative_folder);

/// Returns the models with an extension of a mesh (obj, ply, stl, gltf, glb), sorted, under a folder ("" for all).
std::vector<std::filesystem::path> mesh_files(const std::string& relative_folder);

/// Returns the model that the repository ships, so that every machine has one real mesh.
std::filesystem::path demo_model();

/// Makes a new empty folder for a test's files, and removes it with everything in it at the end.
class ScratchDirectory {
 public:
  ScratchDirectory();
  ~ScratchDirectory();
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  std::filesystem::path path_;
};

/// Prints why a test does nothing here, in words that a person finds in the log.
void print_skipped(const std::string& reason);

}  // namespace lodestone::test

/// Ends the test as passed, with a SKIPPED line, unless `condition` holds.
#define LODESTONE_SKIP_UNLESS(condition, reason) \
  if (!(condition)) {                            \
    lodestone::test::print_skipped(reason);      \
    SUCCEED("skipped");                          \
    return;                                      \
  }                                              \
  static_assert(true)

/// Ends the test as passed, with a SKIPPED line, on a machine without the models.
#define LODESTONE_SKIP_WITHOUT_MODELS() \
  LODESTONE_SKIP_UNLESS(lodestone::test::models_directory(), "no models: set LODESTONE_DATA to their folder")
