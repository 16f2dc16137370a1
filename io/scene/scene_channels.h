#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/json.h"

namespace lodestone::detail {

/// What became of objects that animations move: where they now stand, and where copies of them do.
class ChannelMap {
 public:
  struct Place {
    std::size_t index = 0;                ///< in the same top-level array
    std::vector<std::size_t> primitives;  ///< of a mesh: which of its primitives as they were each of these was
  };

  /// Says that the morph target weights of a node are those of other nodes now.
  void move_weights(std::size_t node, const std::vector<std::size_t>& nodes);
  /// Says that a mesh has become several.
  void move_mesh(std::size_t mesh, std::vector<Place> meshes);
  /// Says that a material has become several.
  void move_material(std::size_t material, const std::vector<std::size_t>& materials);

  /// Lets each animation channel, also by KHR_animation_pointer, move what its target became, one channel for each; one
  /// whose target is gone stays out.
  void apply(Json& document) const;

 private:
  using Target = std::pair<std::string, std::size_t>;  // a top-level array, and a number in it

  std::vector<Json> channels_of(const Json& channel) const;

  std::map<Target, std::vector<Place>> places_;
};

}  // namespace lodestone::detail
