#include "models.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <optional>
#include <set>
#include <utility>

#include <lodestone/core/assemble.h>
#include <lodestone/io/read_mesh.h>

#include "support/cad_shapes.h"
#include "support/soup_building.h"

namespace lodestone::bench {
namespace {

using test::kTurn;

constexpr int kCadDetail = 4;  // about 1,000 faces each

struct FileOfModel {
  const char* name;
  const char* path;
  std::vector<std::size_t> paper_counts;
  bool parts = false;  ///< one model for each material
};

const std::vector<FileOfModel>& files() {
  static const std::vector<FileOfModel> list = {
      {"bunny", "paper/stanford-bunny.obj", {6945, 855}},
      {"fandisk", "paper/fandisk.obj", {1295, 258}},
      {"rocker-arm", "mesh/rocker-arm.obj", {2009, 402}},
      {"cow", "mesh/cow.obj", {}},
      {"homer", "mesh/homer.obj", {}},
      {"cheburashka", "mesh/cheburashka.obj", {}},
      {"beast", "mesh/beast.obj", {}},
      {"spot", "mesh/spot/spot_triangulated.obj", {}},
      {"helmet", "gltf/FlightHelmet/FlightHelmet.gltf", {}, true},
      {"cad-part", "field/cad-part.obj", {}},
      {"cad-field-rod", "field/rod-64-sides.obj", {}},
  };
  return list;
}

TriangleSoup part_of(const TriangleSoup& soup, Index material) {
  TriangleSoup part = soup;
  part.indices.clear();
  part.face_material.clear();
  for (std::size_t f = 0; f < soup.face_material.size(); ++f) {
    if (soup.face_material[f] != material) continue;
    part.indices.insert(part.indices.end(), soup.indices.begin() + 3 * f, soup.indices.begin() + 3 * f + 3);
  }
  return part;
}

Model model_of(std::string name, const TriangleSoup& soup, std::vector<std::size_t> paper_counts) {
  auto attributed = assemble(soup);
  return {std::move(name), positions_of(soup), attributed ? std::move(attributed->mesh) : Mesh{},
          std::move(paper_counts)};
}

// Generated surfaces. Vertices lie on the surface wherever the parameters fall; those are shifted at random by a third
// of a step, because on a regular grid everything ties.

/// Returns the same number in [−1, 1] for the same pair everywhere.
double jitter(std::uint64_t i, std::uint64_t salt) {
  std::uint64_t x = i * 0x9E3779B97F4A7C15U + salt * 0xD1B54A32D192ED03U + 1;  // splitmix64
  x = (x ^ (x >> 30U)) * 0xBF58476D1CE4E5B9U;
  x = (x ^ (x >> 27U)) * 0x94D049BB133111EBU;
  x ^= x >> 31U;
  return static_cast<double>(x >> 11U) * 0x1p-52 - 1;
}

using SurfacePoint = std::function<Vec3(double u, double v)>;

/// Makes columns × rows squares over parameters in [0, 1]²; where `closed`, both directions run around.
TriangleSoup parametric(int columns, int rows, bool closed, const SurfacePoint& point) {
  TriangleSoup soup;
  const int width = closed ? columns : columns + 1;
  const int height = closed ? rows : rows + 1;
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const auto id = static_cast<std::uint64_t>(j * width + i);
      // Along an open border points stay on it.
      const double du = closed || (i > 0 && i < columns) ? jitter(id, 1) / 3 : 0;
      const double dv = closed || (j > 0 && j < rows) ? jitter(id, 2) / 3 : 0;
      const Vec3 p = point((i + du) / columns, (j + dv) / rows);
      soup.positions.push_back(to_float(p));
    }
  }
  const auto at = [&](int i, int j) { return static_cast<Index>((j % height) * width + i % width); };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const Index a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      soup.indices.insert(soup.indices.end(), {a, b, c, a, c, d});
    }
  }
  return soup;
}

/// A cube's six sides as grids of n × n squares, blown up to the unit sphere.
TriangleSoup sphere(int n) {
  return test::box_of_squares(n, [&](const std::array<int, 3>& at, Index number) {
    std::array<double, 3> p{};
    for (int k = 0; k < 3; ++k) p[k] = std::tan((2.0 * at[k] / n - 1) * kTurn / 8) + jitter(number, k) * 0.6 / n;
    const Vec3 s = normalized({p[0], p[1], p[2]});
    return std::array{s.x, s.y, s.z};
  });
}

Vec3 torus_point(double u, double v) {
  const double radius = 1 + 0.4 * std::cos(kTurn * v);
  return {radius * std::cos(kTurn * u), radius * std::sin(kTurn * u), 0.4 * std::sin(kTurn * v)};
}

Vec3 saddle_point(double u, double v) {
  const double x = 2 * u - 1, y = 2 * v - 1;
  return {x, y, 0.5 * (x * x - y * y)};
}

/// Hills on four scales.
Vec3 terrain_point(double u, double v) {
  double height = 0;
  for (int octave = 0; octave < 4; ++octave) {
    const double f = std::exp2(octave);
    height += 0.08 / f * std::sin(kTurn * f * (u + 0.3 * octave)) * std::cos(kTurn * f * (v - 0.2 * u * octave));
  }
  return {u, v, height};
}

/// Models of engineering are compared by themselves, only where asked for.
bool is_wanted(const std::string& name, const std::vector<std::string>& wanted) {
  if (wanted.empty()) return !name.starts_with("cad-");
  return std::any_of(wanted.begin(), wanted.end(), [&](const auto& w) { return name.find(w) != std::string::npos; });
}

void load_file(const FileOfModel& file, const std::string& data, const std::vector<std::string>& wanted,
               Models& models) {
  if (!file.parts && !is_wanted(file.name, wanted)) return;
  const Result<MeshFile> read = read_mesh(std::filesystem::path(data) / file.path);
  if (!read) {
    models.missing.emplace_back(file.name);
    return;
  }
  const TriangleSoup soup = to_soup(read->mesh);
  if (!file.parts) {
    models.found.push_back(model_of(file.name, soup, file.paper_counts));
    return;
  }
  for (const Index material : std::set<Index>(soup.face_material.begin(), soup.face_material.end())) {
    const std::string name = std::string(file.name) + "-" + std::to_string(material);
    if (is_wanted(name, wanted)) models.found.push_back(model_of(name, part_of(soup, material), {}));
  }
}

}  // namespace

Models load_models(const std::string& data, const std::vector<std::string>& wanted) {
  Models models;
  for (const FileOfModel& file : files()) load_file(file, data, wanted, models);
  const auto generated = [&](const char* name, const std::function<TriangleSoup()>& make) {
    if (is_wanted(name, wanted)) models.found.push_back(model_of(name, make(), {}));
  };
  generated("sphere", [] { return sphere(40); });
  generated("torus", [] { return parametric(160, 64, true, torus_point); });
  generated("saddle", [] { return parametric(100, 100, false, saddle_point); });
  generated("terrain", [] { return parametric(120, 120, false, terrain_point); });
  for (const test::CadShape& shape : test::cad_shapes(kCadDetail)) {
    const std::string name = "cad-" + shape.name;
    if (is_wanted(name, wanted)) models.found.push_back(model_of(name, shape.soup, {}));
  }
  return models;
}

}  // namespace lodestone::bench
