#include "gltf/largest_pose.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "gltf/gltf_skin.h"
#include "gltf/node_animation.h"

namespace lodestone::detail {
namespace {

// Files may have any number of animations that share their numbers: what is looked at in all of them together.
constexpr std::size_t kMostNumbers = 64'000'000, kMostPoses = 1024, kMostPlaces = 4'000'000;

// What is larger by rounding alone stays at rest.
constexpr double kLarger = 1.001;

/// Whether a stretch is larger than one before it.
bool grows(double before, double now) { return std::isfinite(now) && now > kLarger * before; }

class PoseSearch {
 public:
  PoseSearch(const GltfDocument& document, const NodeTree& tree)
      : document_(document), tree_(tree), found_{{}, {}, MorphRanges(document)} {}

  Result<void> add(std::size_t index) {
    LODESTONE_TRY(const Json* const node, document_.element("nodes", "node", index));
    found_.morphs.add_node(index, *node);
    std::size_t& skin = found_.nodes[index].skin;
    if (find_member(*node, "skin") == nullptr) return {};
    LODESTONE_TRY(skin, size_member(*node, "skin", text("node ", index)));
    if (skins_.contains(skin)) return {};
    LODESTONE_TRY(skins_[skin], read_skin(document_, skin));
    return {};
  }

  LargestPoses run() && {
    begin_at_rest();
    const std::size_t count = std::min(document_.count("animations"), kMostPoses);
    std::size_t numbers = kMostNumbers, places = kMostPlaces;
    for (std::size_t i = 0; i < count && numbers > 0; ++i) {
      const Animation animation = read_animation(document_, i, numbers);
      found_.morphs.add_animation(animation.weights);
      const std::vector<AnimationCurve>& curves = animation.places;
      const std::size_t cost = pose_cost() + curves.size();
      for (const float time : choose_key_frames(curves, tree_.at_rest(), std::min(kMostPoses / count, places / cost))) {
        places -= cost;
        std::vector<LocalPlace> nodes = tree_.at_rest();
        apply(curves, time, nodes);
        look_at(tree_.place(nodes));
      }
    }
    return std::move(found_);
  }

 private:
  /// Places that one pose needs.
  std::size_t pose_cost() const {
    std::size_t cost = tree_.at_rest().size();
    for (const auto& [index, skin] : skins_) cost += skin.joints.size();
    return cost;
  }

  static PosedSkin pose(const Skin& skin, const std::vector<NodePlace>& places) {
    PosedSkin posed{skin.pose(places)};
    for (const Transform& joint : posed.joints) posed.stretch = std::max(posed.stretch, joint.stretch());
    return posed;
  }

  void begin_at_rest() {
    const std::vector<NodePlace> places = tree_.place(tree_.at_rest());
    for (auto& [node, largest] : found_.nodes) largest.world = places[node].world;
    for (const auto& [index, skin] : skins_) found_.skins[index] = pose(skin, places);
  }

  void look_at(const std::vector<NodePlace>& places) {
    for (auto& [node, largest] : found_.nodes)
      if (grows(largest.world.stretch(), places[node].world.stretch())) largest.world = places[node].world;
    for (const auto& [index, skin] : skins_) {
      PosedSkin posed = pose(skin, places);
      if (grows(found_.skins[index].stretch, posed.stretch)) found_.skins[index] = std::move(posed);
    }
  }

  const GltfDocument& document_;
  const NodeTree& tree_;
  std::map<std::size_t, Skin> skins_;
  LargestPoses found_;
};

}  // namespace

Result<LargestPoses> find_largest_poses(const GltfDocument& document, std::span<const std::size_t> nodes) {
  LODESTONE_TRY(const NodeTree tree, NodeTree::read(document));
  PoseSearch search(document, tree);
  for (const std::size_t node : nodes) LODESTONE_CHECK(search.add(node));
  return std::move(search).run();
}

}  // namespace lodestone::detail
