#include "gltf/gltf_scene.h"

#include <algorithm>
#include <string>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "gltf/gltf_instancing.h"

namespace lodestone::detail {
namespace {

// Nodes may share the numbers that say where their copies are.
constexpr std::size_t kMaxInstances = 4'000'000;

Result<std::vector<std::size_t>> lower_levels(const Json& node, std::string_view where) {
  const Json* extension = GltfDocument::extension(node, "MSFT_lod");
  if (extension == nullptr) return std::vector<std::size_t>{};
  return size_array_member(*extension, "ids", where);
}

/// What the nodes say of each other, checked once.
struct NodeGraph {
  std::vector<std::vector<std::size_t>> children;
  std::vector<std::vector<std::size_t>> lower_levels;  ///< MSFT_lod
  std::vector<std::size_t> parent;                     ///< kNoNode for roots
  std::vector<bool> is_lower_level;
};

Result<void> check_node(std::size_t index, std::size_t node_count, std::string_view where) {
  if (index < node_count) return {};
  return fail(ErrorCode::Malformed, text(where, ": node ", index, " does not exist: the file has ", node_count));
}

/// With at most one parent each, a walk up from any node ends at a root or runs in a circle.
Result<void> check_no_cycle(const NodeGraph& graph) {
  std::vector<std::size_t> walk_of(graph.parent.size(), kNoNode);
  for (std::size_t start = 0; start < graph.parent.size(); ++start)
    for (std::size_t node = start; node != kNoNode; node = graph.parent[node]) {
      if (walk_of[node] == start) return fail(ErrorCode::Malformed, text("node ", node, ": is its own ancestor"));
      if (walk_of[node] != kNoNode) break;
      walk_of[node] = start;
    }
  return {};
}

Result<NodeGraph> read_graph(const GltfDocument& document) {
  const std::size_t count = document.count("nodes");
  NodeGraph graph{{}, {}, std::vector<std::size_t>(count, kNoNode), std::vector<bool>(count)};
  for (std::size_t i = 0; i < count; ++i) {
    const std::string where = text("node ", i);
    LODESTONE_TRY(const Json* const node, document.element("nodes", "node", i));
    LODESTONE_TRY(auto children, size_array_member(*node, "children", where));
    LODESTONE_TRY(auto lower, lower_levels(*node, where));
    for (const std::size_t child : children) {
      LODESTONE_CHECK(check_node(child, count, where));
      if (std::exchange(graph.parent[child], i) != kNoNode)
        return fail(ErrorCode::Malformed, text("node ", child, ": has two parents"));
    }
    for (const std::size_t id : lower) {
      LODESTONE_CHECK(check_node(id, count, where));
      graph.is_lower_level[id] = true;
    }
    graph.children.push_back(std::move(children));
    graph.lower_levels.push_back(std::move(lower));
  }
  LODESTONE_CHECK(check_no_cycle(graph));
  return graph;
}

std::vector<std::size_t> roots_of(const NodeGraph& graph) {
  std::vector<std::size_t> roots;
  for (std::size_t i = 0; i < graph.parent.size(); ++i)
    if (graph.parent[i] == kNoNode) roots.push_back(i);
  return roots;
}

Result<std::vector<std::size_t>> scene_roots(const GltfDocument& document, const NodeGraph& graph, std::size_t index) {
  LODESTONE_TRY(const Json* const scene, document.element("scenes", "scene", index));
  LODESTONE_TRY(auto roots, size_array_member(*scene, "nodes", text("scene ", index)));
  for (const std::size_t root : roots) LODESTONE_CHECK(check_node(root, graph.parent.size(), text("scene ", index)));
  return roots;
}

Result<std::vector<std::size_t>> find_roots(const GltfDocument& document, const NodeGraph& graph) {
  if (document.count("scenes") > 0) {
    LODESTONE_TRY(const std::size_t index, size_member_or(document.json(), "scene", 0, "gltf"));
    return scene_roots(document, graph, index);
  }
  return roots_of(graph);
}

/// Marks what stands below the roots of any scene.
Result<void> mark_shown(const GltfDocument& document, const NodeGraph& graph, std::vector<NodePlace>& places) {
  std::vector<std::size_t> stack;
  for (std::size_t i = 0; i < document.count("scenes"); ++i) {
    LODESTONE_TRY(const auto roots, scene_roots(document, graph, i));
    stack.insert(stack.end(), roots.begin(), roots.end());
  }
  if (document.count("scenes") == 0) stack = roots_of(graph);
  while (!stack.empty()) {
    const std::size_t node = stack.back();
    stack.pop_back();
    if (std::exchange(places[node].shown, true)) continue;
    stack.insert(stack.end(), graph.children[node].begin(), graph.children[node].end());
  }
  return {};
}

Result<LocalPlace> local_place(const Json& node, std::string_view where) {
  LODESTONE_TRY(const auto matrix, number_array_member(node, "matrix", 16, where));
  if (!matrix.empty()) {
    Transform t;
    for (std::size_t row = 0; row < 3; ++row)
      for (std::size_t column = 0; column < 4; ++column) t.rows[row][column] = matrix[4 * column + row];
    return LocalPlace{t, {}};
  }
  LODESTONE_TRY(auto translation, number_array_member(node, "translation", 3, where));
  LODESTONE_TRY(auto rotation, number_array_member(node, "rotation", 4, where));
  LODESTONE_TRY(auto scale, number_array_member(node, "scale", 3, where));
  if (translation.empty()) translation = {0, 0, 0};
  if (rotation.empty()) rotation = {0, 0, 0, 1};
  if (scale.empty()) scale = {1, 1, 1};
  return LocalPlace{std::nullopt,
                    {translation[0], translation[1], translation[2]},
                    {rotation[0], rotation[1], rotation[2], rotation[3]},
                    {scale[0], scale[1], scale[2]}};
}

/// Walks the scene once; a stack and not recursion, since depth comes from the file.
class Walk {
 public:
  Walk(const GltfDocument& document, const NodeGraph& graph, std::size_t level)
      : document_(document), graph_(graph), level_(level), visited_(graph.parent.size()) {}

  Result<std::vector<MeshInstance>> run(std::span<const std::size_t> roots) {
    for (const std::size_t root : roots) {
      stack_.push_back({root, Transform{}});
      while (!stack_.empty()) {
        const Step step = stack_.back();
        stack_.pop_back();
        // What stands in for coarser levels is reached through its finest node, wherever else the scene lists it.
        if (!graph_.is_lower_level[step.node]) LODESTONE_CHECK(visit(at_level(step.node), step.parent));
      }
    }
    return std::move(instances_);
  }

 private:
  struct Step {
    std::size_t node;
    Transform parent;
  };

  std::size_t at_level(std::size_t node) const {
    const auto& lower = graph_.lower_levels[node];
    return level_ == 0 || lower.empty() ? node : lower[std::min(level_, lower.size()) - 1];
  }

  Result<void> visit(std::size_t index, const Transform& parent) {
    const std::string where = text("node ", index);
    if (visited_[index]) return fail(ErrorCode::Malformed, where + ": stands in the scene twice");
    visited_[index] = true;
    LODESTONE_TRY(const Json* const node, document_.element("nodes", "node", index));
    LODESTONE_TRY(const LocalPlace local, local_place(*node, where));
    const Transform world = parent * local.transform();
    if (find_member(*node, "mesh") != nullptr) {
      LODESTONE_TRY(const std::size_t mesh, size_member(*node, "mesh", where));
      LODESTONE_CHECK(add_instances(index, *node, mesh, world));
    }
    const auto& children = graph_.children[index];
    for (auto child = children.rbegin(); child != children.rend(); ++child) stack_.push_back({*child, world});
    return {};
  }

  Result<void> add_instances(std::size_t index, const Json& node, std::size_t mesh, const Transform& world) {
    const std::string where = text("node ", index);
    if (find_member(node, "skin") != nullptr) {
      LODESTONE_TRY(const std::size_t skin, size_member(node, "skin", where));
      instances_.push_back({index, mesh, skin, Transform{}});
      return {};
    }
    LODESTONE_TRY(const auto copies, read_copies(document_, node, where));
    if (copies.size() > kMaxInstances - std::min(kMaxInstances, instances_.size()))
      return fail(ErrorCode::LimitExceeded,
                  text("gltf: the scene has more than ", kMaxInstances, " instances of meshes"));
    for (const Transform& copy : copies) instances_.push_back({index, mesh, kNoSkin, world * copy});
    return {};
  }

  const GltfDocument& document_;
  const NodeGraph& graph_;
  std::size_t level_;
  std::vector<bool> visited_;
  std::vector<Step> stack_;
  std::vector<MeshInstance> instances_;
};

}  // namespace

Result<std::size_t> level_count(const GltfDocument& document) {
  LODESTONE_TRY(const NodeGraph graph, read_graph(document));
  std::size_t most = 0;
  for (const auto& lower : graph.lower_levels) most = std::max(most, lower.size());
  return most + 1;
}

Result<std::vector<MeshInstance>> collect_instances(const GltfDocument& document, std::size_t level) {
  LODESTONE_TRY(const NodeGraph graph, read_graph(document));
  if (graph.parent.empty()) {
    std::vector<MeshInstance> instances;
    for (std::size_t mesh = 0; mesh < document.count("meshes"); ++mesh)
      instances.push_back({kNoNode, mesh, kNoSkin, Transform{}});
    return instances;
  }
  LODESTONE_TRY(const auto roots, find_roots(document, graph));
  return Walk(document, graph, level).run(roots);
}

Result<NodeTree> NodeTree::read(const GltfDocument& document) {
  LODESTONE_TRY(const NodeGraph graph, read_graph(document));
  NodeTree tree;
  tree.parent_ = graph.parent;
  tree.shown_.resize(graph.parent.size());
  LODESTONE_CHECK(mark_shown(document, graph, tree.shown_));
  for (std::size_t i = 0; i < graph.parent.size(); ++i) {
    LODESTONE_TRY(const Json* const node, document.element("nodes", "node", i));
    LODESTONE_TRY(tree.at_rest_.emplace_back(), local_place(*node, text("node ", i)));
  }
  tree.order_ = roots_of(graph);
  for (std::size_t i = 0; i < tree.order_.size(); ++i)
    for (const std::size_t child : graph.children[tree.order_[i]]) tree.order_.push_back(child);
  return tree;
}

std::vector<NodePlace> NodeTree::place(std::span<const LocalPlace> nodes) const {
  std::vector<NodePlace> places = shown_;
  for (const std::size_t node : order_) {
    const Transform local = nodes[node].transform();
    places[node].world = parent_[node] == kNoNode ? local : places[parent_[node]].world * local;
  }
  return places;
}

Result<std::vector<NodePlace>> place_nodes(const GltfDocument& document) {
  LODESTONE_TRY(const NodeTree tree, NodeTree::read(document));
  return tree.place(tree.at_rest());
}

Result<std::vector<std::vector<std::size_t>>> lod_chains(const GltfDocument& document) {
  LODESTONE_TRY(const NodeGraph graph, read_graph(document));
  std::vector<std::vector<std::size_t>> chains;
  for (std::size_t i = 0; i < graph.lower_levels.size(); ++i) {
    if (graph.lower_levels[i].empty()) continue;
    chains.push_back({i});
    chains.back().insert(chains.back().end(), graph.lower_levels[i].begin(), graph.lower_levels[i].end());
  }
  return chains;
}

}  // namespace lodestone::detail
