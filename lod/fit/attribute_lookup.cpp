#include "fit/attribute_lookup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <lodestone/core/detail/finite_values.h>
#include <lodestone/core/detail/grouping.h>
#include <lodestone/core/detail/position_index.h>
#include <lodestone/core/detail/texture_areas.h>

#include "distance/triangle.h"
#include "fit/constrained_edges.h"

namespace lodestone::detail {
namespace {

// How many faces are looked at without coming nearer before a search ends.
constexpr int kPatience = 48;

/// What stays with its vertex: skinning, and numbers of things, between which there is nothing.
bool stays(const Attribute& a) {
  if (a.name.starts_with("JOINTS_") || a.name.starts_with("WEIGHTS_")) return true;
  for (const char* known : {"NORMAL", "TANGENT", "TEXCOORD_", "COLOR_", "TARGET_"})
    if (a.name.starts_with(known)) return false;
  if (a.type != ComponentType::Float32) return !a.normalized;
  const std::vector<float> values = attribute_values(a);
  return std::all_of(values.begin(), values.end(), [](float value) { return value == std::floor(value); });
}

/// A place on the original: a face and the weights of its corners.
struct SurfacePlace {
  Index face = kNoIndex;
  std::array<double, 3> weights{};
};

/// The original surface, to walk on without crossing seams.
class SeamedSurface {
 public:
  explicit SeamedSurface(const Mesh& mesh)
      : mesh_(mesh),
        across_(mesh.corner_wedge.size(), kNoIndex),
        wedge_corners_(mesh.wedge_count(), mesh.corner_wedge.size(), [&](Index c) { return mesh.corner_wedge[c]; }) {
    const auto join = [&](const std::array<Index, 2>& corners) {
      across_[corners[0]] = corners[1];
      across_[corners[1]] = corners[0];
    };
    for (const MeshEdge& edge : list_edges(mesh)) {
      if (edge.constrained) continue;
      join(edge.corners);
      for (const auto& corners : edge.layers) join(corners);
    }
  }

  const Mesh& mesh() const { return mesh_; }
  std::span<const Index> corners_of(Index wedge) const { return wedge_corners_[wedge]; }
  /// Returns the face beyond the edge that faces a corner, kNoIndex where there is a seam.
  Index across(Index corner) const { return across_[corner] != kNoIndex ? face_of_corner(across_[corner]) : kNoIndex; }

 private:
  const Mesh& mesh_;
  std::vector<Index> across_;
  Grouping wedge_corners_;
};

/// Searches on a surface, one after the other, with memory of their own.
class SurfaceSearch {
 public:
  explicit SurfaceSearch(const SeamedSurface& surface) : surface_(surface), seen_in_(surface.mesh().face_count(), 0) {}

  /// Walks from the faces at a wedge towards `p`, nearest faces first, until it comes no nearer.
  SurfacePlace nearest_from(Index wedge, const Vec3& p) {
    ++search_;
    waiting_.clear();
    for (const Index corner : surface_.corners_of(wedge)) visit(p, face_of_corner(corner));
    Step best{std::numeric_limits<double>::infinity(), kNoIndex};
    for (int patience = kPatience; !waiting_.empty() && patience > 0; --patience) {
      std::pop_heap(waiting_.begin(), waiting_.end(), std::greater<>());
      const Step step = waiting_.back();
      waiting_.pop_back();
      if (step.first < best.first) {
        best = step;
        patience = kPatience;
      }
      for (Index corner = 3 * step.second; corner < 3 * step.second + 3; ++corner)
        if (const Index face = surface_.across(corner); face != kNoIndex) visit(p, face);
    }
    if (best.second == kNoIndex) return {};
    return {best.second, nearest_weights(p, triangle_of(surface_.mesh(), best.second)).weights};
  }

 private:
  using Step = std::pair<double, Index>;  // squared distance, face

  void visit(const Vec3& p, Index face) {
    if (std::exchange(seen_in_[face], search_) == search_) return;
    const Vec3 nearest = nearest_on_triangle(p, triangle_of(surface_.mesh(), face));
    waiting_.emplace_back(squared_length(p - nearest), face);
    std::push_heap(waiting_.begin(), waiting_.end(), std::greater<>());
  }

  const SeamedSurface& surface_;
  Index search_ = 0;
  std::vector<Index> seen_in_;  // by face: the last search that has come there
  std::vector<Step> waiting_;   // a heap, the nearest first
};

bool same_bytes(const Mesh& a, Index wedge_a, const Mesh& b, Index wedge_b) {
  for (std::size_t i = 0; i < a.attributes.size(); ++i) {
    const std::size_t bytes = a.attributes[i].element_bytes();
    if (std::memcmp(&a.attributes[i].data[wedge_a * bytes], &b.attributes[i].data[wedge_b * bytes], bytes) != 0)
      return false;
  }
  return true;
}

/// Finds the original's wedges by position and attributes.
class WedgeFinder {
 public:
  explicit WedgeFinder(const Mesh& original) : original_(original), places_(original.positions) {
    const std::vector<Index> place = places_.add_all();
    wedges_ = Grouping(original.vertex_count(), original.wedge_count(),
                       [&](Index wedge) { return place[original.wedge_vertex[wedge]]; });
  }
  Index find(const Mesh& mesh, Index wedge) const {
    const Index place = places_.find(mesh.positions[mesh.wedge_vertex[wedge]]);
    if (place == kNoIndex) return kNoIndex;
    for (const Index candidate : wedges_[place])
      if (same_bytes(mesh, wedge, original_, candidate)) return candidate;
    return kNoIndex;
  }

 private:
  const Mesh& original_;
  PositionIndex places_;
  Grouping wedges_;  // by place
};

/// Blends one attribute of the original at a place into a wedge of the level.
void blend(const Mesh& original, const std::vector<float>& values, const SurfacePlace& place, Attribute& attribute,
           Index wedge) {
  const std::size_t width = attribute.component_count;
  std::array<double, 16> sum{};
  for (Index k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < width; ++i)
      sum[i] += place.weights[k] * static_cast<double>(values[original.corner_wedge[3 * place.face + k] * width + i]);
  const bool is_direction = (attribute.name == "NORMAL" || attribute.name == "TANGENT") && width >= 3;
  if (is_direction) {
    const double norm = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    if (!(norm > 0)) return;  // opposite directions: keep the vertex's own
    for (std::size_t i = 0; i < 3; ++i) sum[i] /= norm;
  }
  const std::size_t kept = attribute.name == "TANGENT" ? 3 : width;  // a tangent's sign is no number to blend
  const std::size_t size = component_bytes(attribute.type);
  for (std::size_t i = 0; i < kept; ++i)
    store_component(attribute.type, attribute.normalized, sum[i], &attribute.data[(wedge * width + i) * size]);
}

void copy_wedge(const Mesh& from, Mesh& to, Index wedge) {
  for (std::size_t i = 0; i < to.attributes.size(); ++i) {
    const std::size_t bytes = to.attributes[i].element_bytes();
    std::memcpy(&to.attributes[i].data[wedge * bytes], &from.attributes[i].data[wedge * bytes], bytes);
  }
}

/// Puts vertices back at whose faces a texture has turned over; returns whether there were any.
bool put_back_turned(const Mesh& before, const std::vector<std::vector<int>>& orientation, Mesh& level) {
  const TextureAreas textures(level);
  std::vector<std::uint8_t> back(level.vertex_count(), 0);
  bool any = false;
  for (std::size_t t = 0; t < textures.count(); ++t)
    for (Index f = 0; f < level.face_count(); ++f) {
      if (textures.area(t, level, f) * orientation[t][f] >= 0) continue;
      for (Index k = 0; k < 3; ++k) {
        const Index v = level.corner_vertex(3 * f + k);
        if (level.positions[v] == before.positions[v]) continue;
        back[v] = 1;
        any = true;
      }
    }
  for (Index v = 0; v < level.vertex_count(); ++v)
    if (back[v] != 0) level.positions[v] = before.positions[v];
  for (Index w = 0; w < level.wedge_count(); ++w)
    if (back[level.wedge_vertex[w]] != 0) copy_wedge(before, level, w);
  return any;
}

/// The sign of every face's area in every texture, with the attributes of `before` on the faces of `level`.
std::vector<std::vector<int>> orientations(const Mesh& before, const Mesh& level) {
  const TextureAreas textures(before);
  std::vector<std::vector<int>> signs(textures.count());
  for (std::size_t t = 0; t < signs.size(); ++t)
    for (Index f = 0; f < level.face_count(); ++f) {
      const double area = textures.area(t, level, f);
      signs[t].push_back(area > 0 ? 1 : area < 0 ? -1 : 0);
    }
  return signs;
}

}  // namespace

struct AttributeLookup::Impl {
  explicit Impl(const Mesh& mesh) : original(mesh), surface(mesh), finder(mesh) {
    for (const Attribute& a : mesh.attributes) values.push_back(stays(a) ? std::vector<float>() : finite_values(a));
  }

  const Mesh& original;
  SeamedSurface surface;
  WedgeFinder finder;
  std::vector<std::vector<float>> values;  // by attribute; empty where it stays with its vertex
};

AttributeLookup::AttributeLookup(const Mesh& original)
    : impl_(original.attributes.empty() ? nullptr : std::make_unique<Impl>(original)) {}
AttributeLookup::~AttributeLookup() = default;

void AttributeLookup::look_up(const Mesh& before, Mesh& level) const {
  if (impl_ == nullptr) return;
  SurfaceSearch search(impl_->surface);
  for (Index w = 0; w < level.wedge_count(); ++w) {
    const Index v = level.wedge_vertex[w];
    if (level.positions[v] == before.positions[v]) continue;
    const Index source = impl_->finder.find(before, w);
    if (source == kNoIndex) continue;
    const SurfacePlace place = search.nearest_from(source, Vec3(level.positions[v]));
    for (std::size_t i = 0; i < level.attributes.size() && place.face != kNoIndex; ++i)
      if (!impl_->values[i].empty()) blend(impl_->original, impl_->values[i], place, level.attributes[i], w);
  }
  const std::vector<std::vector<int>> signs = orientations(before, level);
  while (put_back_turned(before, signs, level)) {
  }
}

}  // namespace lodestone::detail
