#include "scene/scene_places.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "base/transform.h"
#include "gltf/gltf_instancing.h"
#include "gltf/gltf_scene.h"
#include "gltf/gltf_skin.h"
#include "gltf/largest_pose.h"
#include "gltf/morph_targets.h"

namespace lodestone::detail {
namespace {

// Nodes may show one mesh any number of times, so that the work is not bounded by the file's size.
constexpr std::size_t kMaxPlacedPoints = 300'000'000;

// What is larger by rounding alone stays at rest.
constexpr double kLarger = 1.001;

const Box kNowhere{Vec3(HUGE_VAL, HUGE_VAL, HUGE_VAL), Vec3(-HUGE_VAL, -HUGE_VAL, -HUGE_VAL)};

void grow(Box& box, const Vec3& p) {
  box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z)};
  box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z)};
}

double area_of(const Mesh& mesh, std::span<const Vec3> points) {
  double area = 0;
  for (std::size_t i = 0; i < mesh.corner_wedge.size(); i += 3) {
    const Vec3& a = points[mesh.corner_wedge[i]];
    area += length(cross(points[mesh.corner_wedge[i + 1]] - a, points[mesh.corner_wedge[i + 2]] - a)) / 2;
  }
  return area;
}

/// How much longer the edges of faces are than those of the mesh, in the mean of their squares.
double growth_of(const Mesh& mesh, std::span<const Vec3> points) {
  double before = 0, now = 0;
  for (std::size_t i = 0; i < mesh.corner_wedge.size(); ++i) {
    const Index a = mesh.corner_wedge[i], b = mesh.corner_wedge[i % 3 == 2 ? i - 2 : i + 1];
    before += squared_length(Vec3(mesh.positions[mesh.wedge_vertex[a]]) - Vec3(mesh.positions[mesh.wedge_vertex[b]]));
    now += squared_length(points[a] - points[b]);
  }
  const double growth = std::sqrt(now / before);
  return std::isfinite(growth) ? growth : 1;
}

Box box_of(std::span<const Vec3> points) {
  Box box = kNowhere;
  for (const Vec3& p : points) grow(box, p);
  return box;
}

/// A mesh by its wedges, as morph targets have it when it is largest.
struct MorphedMesh {
  std::vector<Vec3> points;
  double growth = 1;  // of its lengths, at least 1
};

/// Measures the instances of one mesh after the other.
class InstanceMeasure {
 public:
  InstanceMeasure(Scene::Impl& scene, const LargestPoses& poses) : scene_(scene), poses_(poses) {}

  Result<void> add_mesh(std::size_t number) {
    SceneMesh& mesh = scene_.meshes[number];
    mesh.scale = 0;
    const Skinner skinner(mesh.mesh.attributes);
    const MorphTargets targets(mesh.mesh.attributes);
    mesh.target_reach.assign(targets.count(), 0);
    for (const std::size_t node : scene_.sources[number].nodes) {
      here_ = NodePresence{};
      const std::vector<const MorphRange*> ranges = poses_.morphs.of(node);
      LODESTONE_TRY(shown_, morph(mesh.mesh, targets, ranges));
      LODESTONE_CHECK(add_node(mesh, skinner, node));
      note_reach(ranges, mesh.target_reach);
      here_.scale *= shown_.growth;
      mesh.scale = std::max(mesh.scale, here_.scale);
      mesh.area += here_.area;
      mesh.instance_count += here_.instance_count;
      scene_.sources[number].presence.push_back(here_);
    }
    // What is drawn as a point everywhere has no size in the world, but errors must not vanish by it.
    if (!(mesh.scale > 0) || !std::isfinite(mesh.scale)) mesh.scale = 1;
    for (double& reach : mesh.target_reach) reach = reach > 0 && std::isfinite(reach) ? reach / mesh.scale : 1;
    return {};
  }

  Box box() const { return box_.low.x <= box_.high.x ? box_ : Box{}; }

 private:
  Result<void> count_points(std::size_t points) {
    placed_ += points;
    if (placed_ <= kMaxPlacedPoints) return {};
    return fail(ErrorCode::LimitExceeded, text("gltf: the scene has more than ", kMaxPlacedPoints, " points"));
  }

  /// Returns the mesh at rest, or at one of its animations' peaks where it is larger. No more of those are looked at
  /// than there may be points.
  Result<MorphedMesh> morph(const Mesh& mesh, const MorphTargets& targets, std::span<const MorphRange* const> ranges) {
    MorphedMesh largest;
    for (const Index vertex : mesh.wedge_vertex) largest.points.push_back(Vec3(mesh.positions[vertex]));
    if (ranges.empty() || targets.count() == 0) return largest;
    const std::vector<Vec3> base = largest.points;
    LODESTONE_CHECK(count_points(base.size() * targets.count_shown(ranges[0]->at_rest)));
    targets.move(largest.points, ranges[0]->at_rest);
    largest.growth = std::max(1.0, growth_of(mesh, largest.points));
    for (const MorphRange* range : ranges)
      for (const TargetWeights& weights : range->peaks) {
        const std::size_t cost = base.size() * (1 + targets.count_shown(weights));
        if (cost > kMaxPlacedPoints - placed_) return largest;
        placed_ += cost;
        std::vector<Vec3> points = base;
        targets.move(points, weights);
        largest.growth = std::max(largest.growth, growth_of(mesh, points));
        if (box_of(points).diagonal() > kLarger * box_of(largest.points).diagonal()) largest.points = std::move(points);
      }
    return largest;
  }

  /// Notes how far the node at hand moves points by the displacements of each target, in the world.
  void note_reach(std::span<const MorphRange* const> ranges, std::vector<double>& reach) const {
    for (std::size_t i = 0; i < reach.size(); ++i) {
      double weight = 1;
      for (const MorphRange* range : ranges)
        if (i < range->largest.size()) weight = std::max(weight, double{range->largest[i]});
      reach[i] = std::max(reach[i], here_.scale * weight);
    }
  }

  Result<void> add_node(SceneMesh& mesh, const Skinner& skinner, std::size_t index) {
    const std::string where = text("node ", index);
    LODESTONE_TRY(const Json* const node, scene_.document.element("nodes", "node", index));
    mesh.nodes.push_back(string_member(*node, "name"));
    const ShownPlace& place = poses_.nodes.at(index);
    if (place.skin != kNoSkin) return add_skinned(mesh, skinner, poses_.skins.at(place.skin));
    LODESTONE_TRY(const auto copies, read_copies(scene_.document, *node, where));
    for (const Transform& copy : copies) {
      const Transform world = place.world * copy;
      here_.scale = std::max(here_.scale, world.stretch());
      LODESTONE_CHECK(add_points(mesh, [&](std::size_t, const Vec3& p) { return world.exact_point(p); }));
    }
    return {};
  }

  Result<void> add_skinned(SceneMesh& mesh, const Skinner& skinner, const PosedSkin& skin) {
    mesh.skinned = true;
    here_.scale = std::max(here_.scale, skin.stretch);
    return add_points(mesh, [&](std::size_t wedge, const Vec3& p) {
      return skinner.empty() ? p : skinner.pose(wedge, skin.joints).exact_point(p);
    });
  }

  template <class Place>
  Result<void> add_points(SceneMesh& mesh, const Place& place) {
    ++here_.instance_count;
    LODESTONE_CHECK(count_points(mesh.mesh.wedge_count()));
    points_.clear();
    for (std::size_t wedge = 0; wedge < mesh.mesh.wedge_count(); ++wedge)
      points_.push_back(place(wedge, shown_.points[wedge]));
    const Box box = box_of(points_);
    for (const Vec3& corner : {box.low, box.high}) grow(box_, corner);
    if (!(here_.box.diagonal() > box.diagonal())) here_.box = box;
    here_.area += area_of(mesh.mesh, points_);
    return {};
  }

  Scene::Impl& scene_;
  const LargestPoses& poses_;
  MorphedMesh shown_;  // by the node at hand, in the mesh's own units
  std::vector<Vec3> points_;
  std::size_t placed_ = 0;
  NodePresence here_;  // of the node at hand
  Box box_ = kNowhere;
};

}  // namespace

Result<void> measure_instances(Scene::Impl& scene) {
  std::vector<std::size_t> nodes;
  for (const MeshSource& source : scene.sources) nodes.insert(nodes.end(), source.nodes.begin(), source.nodes.end());
  LODESTONE_TRY(const LargestPoses poses, find_largest_poses(scene.document, nodes));
  InstanceMeasure measure(scene, poses);
  for (std::size_t i = 0; i < scene.meshes.size(); ++i) LODESTONE_CHECK(measure.add_mesh(i));
  scene.box = measure.box();
  return {};
}

}  // namespace lodestone::detail
