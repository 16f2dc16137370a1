#include <lodestone/lod/attribute_deviation.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string_view>
#include <utility>

#include <lodestone/core/detail/finite_values.h>
#include <lodestone/lod/deviation.h>

#include "distance/coincident_faces.h"
#include "distance/triangle.h"

namespace lodestone {
namespace {

using namespace detail;

constexpr std::size_t kFacesOfStep = 16;  // between two words about the progress

/// An attribute that both meshes have.
struct Shared {
  std::size_t width = 0;
  bool is_direction = false;
  std::vector<float> original;
  std::vector<float> level;
  AttributeDeviation deviation;
};

std::vector<Shared> shared_attributes(const Mesh& original, const Mesh& level) {
  std::vector<Shared> shared;
  for (const Attribute& a : original.attributes) {
    if (a.name.starts_with("JOINTS_") || a.name.starts_with("WEIGHTS_")) continue;
    const auto b = std::find_if(level.attributes.begin(), level.attributes.end(), [&](const Attribute& other) {
      return other.name == a.name && other.component_count == a.component_count;
    });
    if (b == level.attributes.end()) continue;
    shared.push_back({a.component_count, a.name == "NORMAL", finite_values(a), finite_values(*b), {a.name}});
  }
  return shared;
}

/// The faces of one material, to look for the nearest among them.
struct MaterialFaces {
  std::vector<Index> source_face;
  std::optional<SurfaceIndex> surface;
  std::optional<CoincidentFaces> coincident;
};

std::map<Index, MaterialFaces> split(const Mesh& level) {
  std::map<Index, MaterialFaces> parts;
  for (Index f = 0; f < level.face_count(); ++f) parts[level.material_of(f)].source_face.push_back(f);
  for (auto& [material, part] : parts) {
    const Mesh faces = pick_faces(level, part.source_face);
    part.surface.emplace(faces);
    part.coincident.emplace(faces, *part.surface);
  }
  return parts;
}

std::array<double, 4> blend(const std::vector<float>& values, std::size_t width, const Mesh& mesh, Index face,
                            const std::array<double, 3>& weights) {
  std::array<double, 4> sum{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < std::min<std::size_t>(width, 4); ++i)
      sum[i] += weights[k] * static_cast<double>(values[mesh.corner_wedge[3 * face + k] * width + i]);
  return sum;
}

double difference(const Shared& shared, const std::array<double, 4>& a, const std::array<double, 4>& b) {
  if (shared.is_direction) return angle_between({a[0], a[1], a[2]}, {b[0], b[1], b[2]});
  double squares = 0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(squares);
}

/// What the attributes of both meshes are at a place, and by how much each differs.
std::vector<double> differences(const std::vector<Shared>& shared, const Mesh& original, Index face,
                                const std::array<double, 3>& weights, const Mesh& level, Index there, const Vec3& p) {
  const Barycentric at = nearest_weights(p, triangle_of(level, there));
  std::vector<double> result;
  for (const Shared& s : shared)
    result.push_back(difference(s, blend(s.original, s.width, original, face, weights),
                                blend(s.level, s.width, level, there, at.weights)));
  return result;
}

/// Calls `visit(face, weights, area)` for points spread evenly over every face: the centroids of its n² parts.
template <class Visit>
void for_each_sample(const Mesh& mesh, std::size_t sample_count, const Progress& progress, const Visit& visit) {
  ProgressSteps steps(progress, mesh.face_count(), kFacesOfStep);
  const double per_face = static_cast<double>(sample_count) / static_cast<double>(mesh.face_count());
  const auto n = static_cast<int>(std::clamp(std::sqrt(per_face), 1.0, 16.0));
  for (Index f = 0; f < mesh.face_count() && steps.next(); ++f) {
    const double area = 0.5 * length(area_vector(mesh, f));
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j)
        for (int down = 0; down <= (i + j + 1 < n ? 1 : 0); ++down) {
          const double u = (i + (down + 1) / 3.0) / n;
          const double v = (j + (down + 1) / 3.0) / n;
          visit(f, std::array{1 - u - v, u, v}, area / (n * n));
        }
  }
}

}  // namespace

std::vector<AttributeDeviation> measure_attributes(const Mesh& original, const Mesh& level, std::size_t sample_count,
                                                   const Progress& progress) {
  std::vector<Shared> shared = shared_attributes(original, level);
  std::vector<AttributeDeviation> result;
  if (shared.empty() || original.face_count() == 0) return result;
  std::map<Index, MaterialFaces> parts = split(level);
  double total = 0;
  for_each_sample(original, sample_count, progress, [&](Index face, const std::array<double, 3>& weights, double area) {
    const auto part = parts.find(original.material_of(face));
    if (part == parts.end()) return;  // all of its material is gone: there is nothing to compare with
    Vec3 p;
    for (Index k = 0; k < 3; ++k) p += original.corner_position(3 * face + k) * weights[k];
    const SurfaceIndex::Hit hit = part->second.surface->nearest(p, std::numeric_limits<double>::infinity());
    if (hit.face == kNoIndex) return;
    std::vector<double> least;
    const auto sum = [](const std::vector<double>& d) { return std::accumulate(d.begin(), d.end(), 0.0); };
    for (const Index near : part->second.coincident->as_near_as(hit)) {
      const Index there = part->second.source_face[near];
      std::vector<double> found = differences(shared, original, face, weights, level, there, hit.point);
      if (least.empty() || sum(found) < sum(least)) least = std::move(found);
    }
    total += area;
    for (std::size_t i = 0; i < shared.size(); ++i) {
      AttributeDeviation& deviation = shared[i].deviation;
      deviation.mean += area * least[i];
      deviation.rms += area * least[i] * least[i];
      deviation.maximum = std::max(deviation.maximum, least[i]);
    }
  });
  for (Shared& s : shared) {
    if (total > 0) s.deviation.mean /= total, s.deviation.rms = std::sqrt(s.deviation.rms / total);
    result.push_back(std::move(s.deviation));
  }
  return result;
}

}  // namespace lodestone
