#include "scene_undo.h"

#include <algorithm>
#include <optional>
#include <set>

#include "gltf_scene.h"
#include "scene_nodes.h"
#include "text.h"
#include "try.h"

namespace lodestone::detail {
namespace {

using Chain = std::vector<std::size_t>;

auto foreign(std::size_t node) {
  return fail(ErrorCode::Unsupported, text("node ", node, ": its levels of detail (MSFT_lod) are not lodestone's"));
}

/// The nodes of all levels are the last of the document: nothing else refers to a number behind them.
Result<void> check_chains(const Json& nodes, std::span<const Chain> chains) {
  std::set<std::size_t> added;
  for (const Chain& chain : chains) {
    const Json* extras = find_member(nodes[chain[0]], "extras");
    if (extras == nullptr || find_member(*extras, "lodestone") == nullptr) return foreign(chain[0]);
    for (const std::size_t node : chain)
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

Result<void> take_out_chain(Json& document, const Chain& chain) {
  Json& nodes = document["nodes"];
  const auto parent = leave_parent(nodes, chain[0]);
  if (!parent || mesh_of(nodes[*parent])) return foreign(chain[0]);
  move_mesh_members(nodes[chain[0]], nodes[*parent]);
  retarget_weights(document, chain[0], *parent, {});
  for (std::size_t i = 1; i < chain.size(); ++i) drop_weights_channels(document, chain[i]);
  return {};
}

/// Drops the meshes that only coarser levels showed; they are the last of the document.
void drop_meshes(Json& document, std::set<std::size_t> coarser, std::vector<Json>& dropped) {
  if (!document.contains("meshes")) return;
  for (const Json& node : document["nodes"])
    if (const auto mesh = mesh_of(node)) coarser.erase(*mesh);
  Json& meshes = document["meshes"];
  while (!meshes.empty() && coarser.contains(meshes.size() - 1)) {
    dropped.push_back(std::move(meshes[meshes.size() - 1]));
    meshes.erase(meshes.size() - 1);
  }
}

bool has_material_levels(const GltfDocument& document) {
  for (std::size_t i = 0; i < document.count("materials"); ++i)
    if (GltfDocument::extension(document.json()["materials"][i], "MSFT_lod") != nullptr) return true;
  return false;
}

}  // namespace

Result<void> take_out_levels(Scene::Impl& scene) {
  Json& document = scene.document.edit();
  LODESTONE_TRY(const std::vector<Chain> chains, lod_chains(scene.document));
  if (chains.empty()) return {};
  LODESTONE_CHECK(check_chains(document["nodes"], chains));
  std::set<std::size_t> coarser;
  std::size_t first = document["nodes"].size();
  for (const Chain& chain : chains) {
    for (std::size_t i = 1; i < chain.size(); ++i)
      if (const auto mesh = mesh_of(document["nodes"][chain[i]])) coarser.insert(*mesh);
    first = std::min(first, *std::min_element(chain.begin(), chain.end()));
  }
  for (const Chain& chain : chains) LODESTONE_CHECK(take_out_chain(document, chain));
  Json& nodes = document["nodes"];
  while (nodes.size() > first) nodes.erase(nodes.size() - 1);
  drop_meshes(document, coarser, scene.dropped_meshes);
  const Json* names = find_member(document, "extensionsUsed");
  if (has_material_levels(scene.document) || names == nullptr || !names->is_array()) return {};
  Json& used = document["extensionsUsed"];
  used.erase(std::remove(used.begin(), used.end(), "MSFT_lod"), used.end());
  return {};
}

}  // namespace lodestone::detail
