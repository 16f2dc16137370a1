#include "support/data.h"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <iostream>
#include <random>
#include <system_error>

namespace lodestone::test {
namespace {

namespace fs = std::filesystem;

fs::path models_candidate() {
  if (const char* from_environment = std::getenv("LODESTONE_DATA")) return from_environment;
  return fs::path(LODESTONE_SOURCE_DIR) / ".." / "shared" / "data";
}

bool has_mesh_extension(const fs::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  static const std::vector<std::string> kKnown = {".obj", ".ply", ".stl", ".gltf", ".glb"};
  return std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end();
}

}  // namespace

std::optional<fs::path> models_directory() {
  std::error_code error;
  const fs::path candidate = fs::weakly_canonical(models_candidate(), error);
  if (error || !fs::is_directory(candidate, error)) return std::nullopt;
  return candidate;
}

std::optional<fs::path> model(const std::string& relative_path) {
  const auto directory = models_directory();
  std::error_code error;
  if (!directory || !fs::is_regular_file(*directory / relative_path, error)) return std::nullopt;
  return *directory / relative_path;
}

std::vector<fs::path> model_files(const std::string& relative_folder) {
  std::vector<fs::path> files;
  const auto directory = models_directory();
  if (!directory || !fs::is_directory(*directory / relative_folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(*directory / relative_folder)) {
    if (entry.is_regular_file()) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<fs::path> mesh_files(const std::string& relative_folder) {
  std::vector<fs::path> files = model_files(relative_folder);
  files.erase(std::remove_if(files.begin(), files.end(), [](const fs::path& p) { return !has_mesh_extension(p); }),
              files.end());
  return files;
}

fs::path demo_model() { return fs::path(LODESTONE_SOURCE_DIR) / "demo" / "suzi.glb"; }

ScratchDirectory::ScratchDirectory() {
  // Tests run at the same time in processes of their own: the name needs more than a counter.
  std::random_device random;
  do {
    path_ = fs::temp_directory_path() / ("lodestone-test-" + std::to_string(random()));
  } while (!fs::create_directory(path_));
}

ScratchDirectory::~ScratchDirectory() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void print_skipped(const std::string& reason) { std::cout << "SKIPPED: " << reason << std::endl; }

}  // namespace lodestone::test
