#include <lodestone/lod/attribute_deviation.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include <lodestone/core/detail/finite_values.h>
#include <lodestone/lod/deviation.h>

#include "distance/coincident_faces.h"
#include "distance/even_steps.h"
#include "distance/triangle.h"

namespace lodestone {
namespace {

using namespace detail;

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

/// A point of the original.
struct Sample {
  Vec3 position;
  Index face;
};

/// The faces of one material, to look for the nearest among them.
struct MaterialFaces {
  std::vector<Index> source_face;  // of each face of the index; empty: its own
  std::optional<SurfaceIndex> made;
  const SurfaceIndex* surface = nullptr;
  std::optional<CoincidentFaces> coincident;

  Index source(Index face) const { return source_face.empty() ? face : source_face[face]; }
};

/// `whole` is the level's index, where there is one already.
std::map<Index, MaterialFaces> split(const Mesh& level, const SurfaceIndex* whole) {
  std::map<Index, MaterialFaces> parts;
  for (Index f = 0; f < level.face_count(); ++f) parts[level.material_of(f)].source_face.push_back(f);
  for (auto& [material, part] : parts) {
    const bool is_all = parts.size() == 1;
    const Mesh picked = is_all ? Mesh() : pick_faces(level, part.source_face);
    const Mesh& faces = is_all ? level : picked;
    if (is_all) part.source_face.clear();
    part.surface = is_all && whole != nullptr ? whole : &part.made.emplace(faces);
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

/// By how much each attribute differs between a point of the original and one of the level.
void find_differences(const std::vector<Shared>& shared, const Mesh& original, const Sample& sample, const Mesh& level,
                      Index face, const Vec3& point, std::vector<double>& found) {
  const Barycentric from = nearest_weights(sample.position, triangle_of(original, sample.face));
  const Barycentric to = nearest_weights(point, triangle_of(level, face));
  found.clear();
  for (const Shared& s : shared)
    found.push_back(difference(s, blend(s.original, s.width, original, sample.face, from.weights),
                               blend(s.level, s.width, level, face, to.weights)));
}

/// Points at equal steps of the area, by the material of their faces. A surface without area has none.
std::map<Index, std::vector<Sample>> spread_samples(const Mesh& mesh, std::size_t count) {
  std::map<Index, std::vector<Sample>> samples;
  std::vector<double> until;
  for (Index f = 0; f < mesh.face_count(); ++f) until.push_back(length(area_vector(mesh, f)));
  if (!(add_up(until) > 0)) return samples;
  step_through(until, count, [&](std::size_t element, double, std::size_t k) {
    const auto face = static_cast<Index>(element);
    samples[mesh.material_of(face)].push_back({point_on_face(mesh, face, k), face});
  });
  return samples;
}

/// Adds up how attributes differ over samples of one material.
class Comparison {
 public:
  Comparison(const Mesh& original, const Mesh& level, std::vector<Shared>& shared)
      : original_(original), level_(level), shared_(shared) {}

  void add(std::span<const Sample> samples, MaterialFaces& part, ProgressSteps& steps) {
    std::vector<Vec3> points;
    std::vector<SurfaceIndex::Hit> hits;
    for (std::size_t first = 0; first < samples.size(); first += points.size()) {
      const auto together = samples.subspan(first, std::min(kSamplesOfStep, samples.size() - first));
      points.clear();
      for (const Sample& sample : together) points.push_back(sample.position);
      hits.assign(points.size(), {0, {}, kNoIndex, 0});
      part.surface->nearest(points, hits);
      for (std::size_t i = 0; i < hits.size(); ++i) {
        if (!steps.next()) return;
        add(together[i], hits[i], part);
      }
    }
  }

  void finish() {
    const auto count = static_cast<double>(std::max<std::size_t>(count_, 1));
    for (Shared& s : shared_) s.deviation.mean /= count, s.deviation.rms = std::sqrt(s.deviation.rms / count);
  }

 private:
  void add(const Sample& sample, const SurfaceIndex::Hit& hit, MaterialFaces& part) {
    double least = std::numeric_limits<double>::infinity();
    for (const Index near : part.coincident->as_near_as(hit)) {
      find_differences(shared_, original_, sample, level_, part.source(near), hit.point, found_);
      const double sum = std::accumulate(found_.begin(), found_.end(), 0.0);
      if (sum < least) least = sum, least_.swap(found_);
    }
    if (!(least < std::numeric_limits<double>::infinity())) return;
    ++count_;
    for (std::size_t i = 0; i < shared_.size(); ++i) {
      AttributeDeviation& deviation = shared_[i].deviation;
      deviation.mean += least_[i];
      deviation.rms += least_[i] * least_[i];
      deviation.maximum = std::max(deviation.maximum, least_[i]);
    }
  }

  const Mesh& original_;
  const Mesh& level_;
  std::vector<Shared>& shared_;
  std::size_t count_ = 0;
  std::vector<double> found_, least_;
};

std::vector<AttributeDeviation> compare_attributes(const Mesh& original, const Mesh& level, const SurfaceIndex* index,
                                                   std::size_t sample_count, const Progress& progress) {
  std::vector<Shared> shared = shared_attributes(original, level);
  std::vector<AttributeDeviation> result;
  if (shared.empty() || original.face_count() == 0) return result;
  std::map<Index, MaterialFaces> parts = split(level, index);
  ProgressSteps steps(progress, sample_count, kSamplesOfStep);
  Comparison comparison(original, level, shared);
  for (const auto& [material, samples] : spread_samples(original, sample_count)) {
    const auto part = parts.find(material);
    // Where all of a material is gone there is nothing to compare with.
    if (part != parts.end()) comparison.add(samples, part->second, steps);
  }
  comparison.finish();
  for (Shared& s : shared) result.push_back(std::move(s.deviation));
  return result;
}

}  // namespace

std::vector<AttributeDeviation> measure_attributes(const Mesh& original, const Mesh& level, std::size_t sample_count,
                                                   const Progress& progress) {
  return compare_attributes(original, level, nullptr, sample_count, progress);
}

std::vector<AttributeDeviation> measure_attributes(const Mesh& original, const MeasuredSurface& level,
                                                   std::size_t sample_count, const Progress& progress) {
  return compare_attributes(original, level.mesh(), &level.index(), sample_count, progress);
}

}  // namespace lodestone
