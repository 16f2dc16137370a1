#include "scene/scene_undo.h"

#include <algorithm>
#include <optional>
#include <set>
#include <span>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "gltf/gltf_scene.h"
#include "scene/scene_channels.h"
#include "scene/scene_materials.h"
#include "scene/scene_nodes.h"

namespace lodestone::detail {
namespace {

/// The nodes of one MSFT_lod, finest first.
struct NodeChain {
  std::vector<std::size_t> nodes;
  bool in_place = false;  ///< the finest is the node that had the mesh in the document; else a child of that
};

auto foreign(std::size_t node) {
  return fail(ErrorCode::Unsupported, text("node ", node, ": its levels of detail (MSFT_lod) are not lodestone's"));
}

/// The nodes that `encode_scene` added: all of a chain, but for a finest level that stayed where it was.
std::span<const std::size_t> added_nodes(const NodeChain& chain) {
  return std::span(chain.nodes).subspan(chain.in_place ? 1 : 0);
}

/// The nodes of all levels are the last of the document: nothing else refers to a number behind them.
Result<void> check_chains(const Json& nodes, std::span<const NodeChain> chains) {
  std::set<std::size_t> added;
  for (const NodeChain& chain : chains) {
    const Json* extras = find_member(nodes[chain.nodes[0]], "extras");
    if (extras == nullptr || find_member(*extras, "lodestone") == nullptr) return foreign(chain.nodes[0]);
    for (const std::size_t node : added_nodes(chain))
      if (!added.insert(node).second) return foreign(node);
  }
  if (!added.empty() && *added.begin() + added.size() != nodes.size()) return foreign(*added.begin());
  return {};
}

/// Returns the number of a node's mesh.
std::optional<std::size_t> mesh_of(const Json& node) {
  const auto mesh = size_member(node, "mesh", "");
  return mesh ? std::optional(*mesh) : std::nullopt;
}

/// Takes a child out of its parent and returns the parent.
std::optional<std::size_t> leave_parent(Json& nodes, std::size_t child) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].contains("children")) continue;
    Json& children = nodes[i]["children"];
    const auto found = std::find_if(children.begin(), children.end(), [&](const Json& c) { return c == child; });
    if (found == children.end()) continue;
    children.erase(found);
    if (children.empty()) nodes[i].erase("children");
    return i;
  }
  return std::nullopt;
}

void erase_member(Json& object, const char* name, const char* member) {
  object[name].erase(member);
  if (object[name].empty()) object.erase(name);
}

/// Moves the finest level back to where it came from, and says what becomes of what animations move.
Result<void> take_out_chain(Json& document, const NodeChain& chain, ChannelMap& channels) {
  Json& nodes = document["nodes"];
  const std::size_t finest = chain.nodes[0];
  for (std::size_t i = 1; i < chain.nodes.size(); ++i) channels.move_weights(chain.nodes[i], {});
  if (chain.in_place) {
    erase_member(nodes[finest], "extensions", "MSFT_lod");
    for (const char* key : {"lodestone", "MSFT_screencoverage"}) nodes[finest]["extras"].erase(key);
    if (nodes[finest]["extras"].empty()) nodes[finest].erase("extras");
    return {};
  }
  const auto parent = leave_parent(nodes, finest);
  if (!parent || mesh_of(nodes[*parent])) return foreign(finest);
  move_mesh_members(nodes[finest], nodes[*parent]);
  channels.move_weights(finest, {*parent});
  return {};
}

Result<void> check_level(std::span<const NodeChain> chains, std::size_t level) {
  std::size_t count = 1;
  for (const NodeChain& chain : chains) count = std::max(count, chain.nodes.size());
  if (level < count) return {};
  return fail(ErrorCode::InvalidArgument,
              text("level ", level, " does not exist: the file has levels 0 to ", count - 1));
}

/// Lets a holder name the first of all materials that are equal: a coarser level's is a copy of the document's.
void name_first_material(const Json& materials, Json& holder) {
  const auto own = size_member(holder, "material", "");
  if (!own || *own >= materials.size()) return;
  const auto first = std::find(materials.begin(), materials.end(), materials[*own]);
  holder["material"] = static_cast<std::size_t>(first - materials.begin());
}

/// Gives the meshes of the finest nodes what a coarser level shows, nothing where that has nothing left.
void put_level_first(Json& document, std::span<const NodeChain> chains, std::size_t level, std::vector<Json>& dropped) {
  const Json materials = document.contains("materials") ? document["materials"] : Json::array();
  std::set<std::size_t> replaced;
  for (const NodeChain& chain : chains) {
    Json& finest = document["nodes"][chain.nodes[0]];
    const auto coarse = mesh_of(document["nodes"][chain.nodes[std::min(level, chain.nodes.size() - 1)]]);
    const auto whole = mesh_of(finest);
    if (!whole) continue;
    if (!coarse || *coarse >= document["meshes"].size()) {
      for (const char* key : {"mesh", "skin", "weights"}) finest.erase(key);
    } else if (*whole < document["meshes"].size() && replaced.insert(*whole).second) {
      Json& mesh = document["meshes"][*whole];
      dropped.push_back(mesh);
      mesh["primitives"] = document["meshes"][*coarse]["primitives"];
      for (Json& primitive : mesh["primitives"])
        for_each_material_holder(primitive, [&](Json& holder) { name_first_material(materials, holder); });
    }
  }
}

/// Drops the meshes that only coarser levels showed; they are the last of the document.
void drop_meshes(Json& document, std::set<std::size_t> coarser, std::vector<Json>& dropped, ChannelMap& channels) {
  if (!document.contains("meshes")) return;
  for (const Json& node : document["nodes"])
    if (const auto mesh = mesh_of(node)) coarser.erase(*mesh);
  Json& meshes = document["meshes"];
  while (!meshes.empty() && coarser.contains(meshes.size() - 1)) {
    channels.move_mesh(meshes.size() - 1, {});
    dropped.push_back(std::move(meshes[meshes.size() - 1]));
    meshes.erase(meshes.size() - 1);
  }
}

std::set<std::size_t> materials_of(const Json& meshes) {
  std::set<std::size_t> materials;
  for (const Json& mesh : meshes) {
    const Json* primitives = find_member(mesh, "primitives");
    if (primitives == nullptr || !primitives->is_array()) continue;
    for (const Json& primitive : *primitives)
      for_each_material_holder(primitive, [&](const Json& holder) {
        const auto material = size_member(holder, "material", "");
        if (material) materials.insert(*material);
      });
  }
  return materials;
}

/// Drops the materials that only dropped meshes named; they, too, are the last.
void drop_materials(Json& document, const std::vector<Json>& dropped, ChannelMap& channels) {
  if (!document.contains("materials") || !document["materials"].is_array()) return;
  std::set<std::size_t> unused = materials_of(Json(dropped));
  if (document.contains("meshes"))
    for (const std::size_t material : materials_of(document["meshes"])) unused.erase(material);
  Json& materials = document["materials"];
  while (!materials.empty() && unused.contains(materials.size() - 1)) {
    channels.move_material(materials.size() - 1, {});
    materials.erase(materials.size() - 1);
  }
  if (materials.empty()) document.erase("materials");
}

Result<std::vector<NodeChain>> find_chains(const GltfDocument& document) {
  LODESTONE_TRY(const auto lists, lod_chains(document));
  std::set<std::size_t> children;
  for (const Json& node : document.list("nodes")) {
    LODESTONE_TRY(const auto list, size_array_member(node, "children", "node"));
    children.insert(list.begin(), list.end());
  }
  std::vector<NodeChain> chains;
  for (const std::vector<std::size_t>& nodes : lists) chains.push_back({nodes, !children.contains(nodes[0])});
  return chains;
}

bool has_material_levels(const GltfDocument& document) {
  for (std::size_t i = 0; i < document.count("materials"); ++i)
    if (GltfDocument::extension(document.list("materials")[i], "MSFT_lod") != nullptr) return true;
  return false;
}

}  // namespace

Result<void> take_out_levels(Scene::Impl& scene, std::size_t level) {
  Json& document = scene.document.edit();
  LODESTONE_TRY(const std::vector<NodeChain> chains, find_chains(scene.document));
  LODESTONE_CHECK(check_level(chains, level));
  if (chains.empty()) return {};
  LODESTONE_CHECK(check_chains(document["nodes"], chains));
  if (level > 0) put_level_first(document, chains, level, scene.dropped_meshes);
  std::set<std::size_t> coarser;
  std::size_t first = document["nodes"].size();
  for (const NodeChain& chain : chains) {
    for (std::size_t i = 1; i < chain.nodes.size(); ++i)
      if (const auto mesh = mesh_of(document["nodes"][chain.nodes[i]])) coarser.insert(*mesh);
    for (const std::size_t node : added_nodes(chain)) first = std::min(first, node);
  }
  ChannelMap channels;
  for (const NodeChain& chain : chains) LODESTONE_CHECK(take_out_chain(document, chain, channels));
  Json& nodes = document["nodes"];
  while (nodes.size() > first) nodes.erase(nodes.size() - 1);
  drop_meshes(document, coarser, scene.dropped_meshes, channels);
  drop_materials(document, scene.dropped_meshes, channels);
  channels.apply(document);
  const Json* names = find_member(document, "extensionsUsed");
  if (has_material_levels(scene.document) || names == nullptr || !names->is_array()) return {};
  Json& used = document["extensionsUsed"];
  used.erase(std::remove(used.begin(), used.end(), "MSFT_lod"), used.end());
  return {};
}

}  // namespace lodestone::detail
