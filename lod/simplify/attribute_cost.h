#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <lodestone/core/detail/texture_areas.h>
#include <lodestone/core/mesh.h>
#include <lodestone/core/triangulation.h>
#include <lodestone/lod/simplify_options.h>

#include "distance/triangle.h"

namespace lodestone::detail {

/// What turns differences of attributes into lengths, for one side of a star.
struct AttributeScale {
  double radius = 0;             ///< of the star, mesh units
  std::vector<double> texture;   ///< by texture channel: mesh units per unit of texture
  std::vector<int> orientation;  ///< by texture channel: sign of the faces' area; 0 where they have none or disagree
};

/// Prices what a removal does to attributes, as lengths in mesh units.
///
/// A texture that slides by some length over the surface costs that length. A normal or colour that differs by d over a
/// star of radius r costs d·r, and so does a share d of skinning weight that goes to other joints. A morph target that
/// displaces by d too much or too little costs d. Each is multiplied by its weight of `AttributeWeights`.
class AttributeCost {
 public:
  AttributeCost(const Mesh& mesh, const AttributeWeights& weights);

  /// Whether there is nothing to price, nor a texture whose faces must not turn over.
  bool empty() const { return channels_.empty() && skin_.empty() && textures_.count() == 0; }
  std::size_t texture_count() const { return textures_.count(); }

  /// Returns the scale of one side of a star whose faces are (center, polygon[i], polygon[i + 1]), and have `area` in
  /// all; `wraps`: the last is (center, polygon.back(), polygon.front()).
  AttributeScale scale(Index center, std::span<const Index> polygon, bool wraps, double area) const;

  /// Where attributes stand on a face: the wedges of its corners, and the weight of each.
  struct Place {
    std::array<Index, 3> wedges{};
    std::array<double, 3> weights{1, 0, 0};
  };
  /// Returns the squared length that stands for the difference between a wedge and a place on the new surface.
  double squared_difference(Index wedge, const Place& place, const AttributeScale& scale) const;
  /// The same for the place nearest to where the wedge is on new faces, whose corners `position_at` and `wedge_at`
  /// name.
  template <class PositionAt, class WedgeAt>
  double squared_difference(Index wedge, const Vec3& at, std::span<const PolygonTriangle> triangles,
                            const PositionAt& position_at, const WedgeAt& wedge_at, const AttributeScale& scale) const {
    double least = std::numeric_limits<double>::infinity();
    Place place;
    for (const PolygonTriangle t : triangles) {
      const Barycentric nearest = nearest_weights(at, {position_at(t.a), position_at(t.b), position_at(t.c)});
      if (nearest.squared_distance >= least) continue;
      least = nearest.squared_distance;
      place = {{wedge_at(t.a), wedge_at(t.b), wedge_at(t.c)}, nearest.weights};
    }
    return squared_difference(wedge, place, scale);
  }

  /// Whether a texture would be turned over or lose its area on a new face, where it did neither on the old ones.
  bool turns_texture(Index a, Index b, Index c, const AttributeScale& scale) const;

  /// Returns twice the signed area of three wedges in a texture channel.
  double texture_area(std::size_t texture, Index a, Index b, Index c) const { return textures_.area(texture, a, b, c); }

 private:
  enum class Kind : std::uint8_t { Direction, Texture, Value, Displacement };
  /// One attribute as floats.
  struct Channel {
    Kind kind = Kind::Value;
    double weight = 0;
    std::size_t texture = 0;  // its number, for Kind::Texture
    std::size_t width = 0;
    std::vector<float> values;  // empty for Kind::Texture: see textures_
  };
  /// The joints that move each wedge, and their weights.
  struct Skin {
    double weight = 0;
    std::size_t width = 0;
    std::vector<float> joints;
    std::vector<float> weights;
  };

  void add_channel(const Attribute& attribute, Kind kind, double weight);
  void add_texture(std::size_t texture, double weight);
  void add_skin(const Mesh& mesh, const Attribute& joints, double weight);
  double difference(const Channel& channel, Index wedge, const Place& place) const;
  static double difference(const Skin& skin, Index wedge, const Place& place);

  TextureAreas textures_;
  std::vector<Channel> channels_;
  std::vector<Skin> skin_;
};

}  // namespace lodestone::detail
