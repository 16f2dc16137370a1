#include "scene/scene_objects.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <span>
#include <utility>

namespace lodestone::detail {
namespace {

constexpr double kDwarfs = 16;      // times as long in the diagonal
constexpr double kTouchGap = 0.01;  // of the smaller one's diagonal

std::vector<std::size_t> find_roots(const Json& nodes) {
  std::vector<std::size_t> parent(nodes.size());
  std::iota(parent.begin(), parent.end(), std::size_t{0});
  for (std::size_t i = 0; i < nodes.size(); ++i)
    if (const Json* children = find_member(nodes[i], "children"))
      for (const Json& child : *children) parent[child.get<std::size_t>()] = i;
  // Chains may be long: each is walked once, and then as long as one step.
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    std::size_t root = i;
    while (parent[root] != root) root = parent[root];
    for (std::size_t node = i; node != root;) node = std::exchange(parent[node], root);
  }
  return parent;
}

void grow(Box& box, const Box& other) {
  for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
    box.low.*axis = std::min(box.low.*axis, other.low.*axis);
    box.high.*axis = std::max(box.high.*axis, other.high.*axis);
  }
}

std::vector<SceneObject> objects_of_roots(const Scene::Impl& scene) {
  const std::vector<std::size_t> roots = find_roots(scene.document.list("nodes"));
  std::map<std::size_t, std::size_t> object_of;
  std::vector<SceneObject> objects;
  for (std::size_t mesh = 0; mesh < scene.sources.size(); ++mesh)
    for (std::size_t node = 0; node < scene.sources[mesh].nodes.size(); ++node) {
      const Box& box = scene.sources[mesh].presence[node].box;
      const auto [found, is_new] = object_of.try_emplace(roots[scene.sources[mesh].nodes[node]], objects.size());
      if (is_new) objects.push_back({{}, box});
      SceneObject& object = objects[found->second];
      object.parts.push_back({mesh, node});
      grow(object.box, box);
    }
  return objects;
}

bool belong_together(const Box& a, const Box& b) {
  const double smaller = std::min(a.diagonal(), b.diagonal()), larger = std::max(a.diagonal(), b.diagonal());
  if (larger > kDwarfs * smaller) return false;
  const double gap = kTouchGap * smaller;
  for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z})
    if (a.low.*axis > b.high.*axis + gap || b.low.*axis > a.high.*axis + gap) return false;
  return true;
}

std::size_t find_group(std::vector<std::size_t>& group, std::size_t i) {
  while (group[i] != i) i = group[i] = group[group[i]];
  return i;
}

/// Joins what belongs together. By their beginnings along x, so that only those are compared that can touch.
std::vector<std::size_t> group_objects(std::span<const SceneObject> objects) {
  std::vector<std::size_t> order(objects.size()), group(objects.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::iota(group.begin(), group.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return objects[a].box.low.x < objects[b].box.low.x; });
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Box& box = objects[order[i]].box;
    const double end = box.high.x + kTouchGap * box.diagonal();
    for (std::size_t k = i + 1; k < order.size() && objects[order[k]].box.low.x <= end; ++k)
      if (belong_together(box, objects[order[k]].box)) group[find_group(group, order[k])] = find_group(group, order[i]);
  }
  for (std::size_t i = 0; i < group.size(); ++i) group[i] = find_group(group, i);
  return group;
}

}  // namespace

std::vector<SceneObject> find_objects(const Scene::Impl& scene) {
  const std::vector<SceneObject> single = objects_of_roots(scene);
  const std::vector<std::size_t> group = group_objects(single);
  std::map<std::size_t, std::size_t> object_of;
  std::vector<SceneObject> objects;
  for (std::size_t i = 0; i < single.size(); ++i) {
    const auto [found, is_new] = object_of.try_emplace(group[i], objects.size());
    if (is_new) objects.push_back({{}, single[i].box});
    SceneObject& object = objects[found->second];
    object.parts.insert(object.parts.end(), single[i].parts.begin(), single[i].parts.end());
    grow(object.box, single[i].box);
  }
  return objects;
}

}  // namespace lodestone::detail
