#include "scene/scene_mending.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <lodestone/core/detail/text.h>

namespace lodestone::detail {
namespace {

constexpr double kLengthTolerance = 0.005;  // an eight-bit normal is as far off, rounded as well as can be
constexpr double kWeightTolerance = 2e-7;   // for each weight of a point: what floats lose in their sum

/// The numbers of one column, which can be changed.
class Column {
 public:
  Column(LevelGeometry& level, std::size_t number)
      : level_(level), number_(number), layout_(*level.columns[number]), values_(attribute_values(layout_)) {}

  std::size_t component_count() const { return layout_.component_count; }
  std::size_t point_count() const { return values_.size() / component_count(); }
  ComponentType type() const { return layout_.type; }
  bool is_integer() const { return type() != ComponentType::Float32; }
  bool is_normalized() const { return layout_.normalized; }

  double get(std::size_t point, std::size_t component) const {
    return static_cast<double>(values_[point * component_count() + component]);
  }

  /// The first change gives the level a copy of the column.
  void set(std::size_t point, std::size_t component, double value) {
    if (value == get(point, component)) return;
    std::unique_ptr<Attribute>& copy = level_.mended[number_];
    if (!copy) copy = std::make_unique<Attribute>(layout_);
    level_.columns[number_] = copy.get();
    std::byte* const at = copy->data.data() + (point * component_count() + component) * component_bytes(type());
    store_component(type(), is_normalized(), value, at);
  }

 private:
  LevelGeometry& level_;
  std::size_t number_;
  const Attribute& layout_;  // as it was
  std::vector<float> values_;
};

std::optional<std::size_t> find_column(const MeshSource& source, const std::string& semantic) {
  for (std::size_t c = 0; c < source.columns.size(); ++c)
    if (!source.columns[c].target && source.columns[c].semantic == semantic) return c;
  return std::nullopt;
}

/// Returns a direction for each wedge from the faces that use it; that of z where these have no area.
std::vector<Vec3> normals_of_faces(const Mesh& mesh) {
  std::vector<Vec3> sums(mesh.wedge_count());
  for (Index corner = 0; corner < mesh.corner_wedge.size(); ++corner)
    sums[mesh.corner_wedge[corner]] += area_vector(mesh, corner / 3);
  for (Vec3& sum : sums) sum = length(sum) > 0 ? normalized(sum) : Vec3(0, 0, 1);
  return sums;
}

/// Any direction in the plane that a normal stands on.
Vec3 across(const Vec3& normal) {
  const Vec3 axis = std::abs(normal.x) < 0.5 ? Vec3(1, 0, 0) : Vec3(0, 1, 0);
  return normalized(cross(normal, axis));
}

Vec3 direction(const Column& column, std::size_t point) {
  return {column.get(point, 0), column.get(point, 1), column.get(point, 2)};
}

void set_direction(Column& column, std::size_t point, const Vec3& value) {
  column.set(point, 0, value.x);
  column.set(point, 1, value.y);
  column.set(point, 2, value.z);
}

bool is_unit(const Vec3& v) { return std::abs(length(v) - 1) <= kLengthTolerance; }

void mend_normals(const MeshSource& source, LevelGeometry& level) {
  const auto number = find_column(source, "NORMAL");
  if (!number) return;
  Column normals(level, *number);
  std::vector<Vec3> of_faces;
  for (std::size_t i = 0; i < normals.point_count(); ++i) {
    const Vec3 normal = direction(normals, i);
    if (is_unit(normal)) continue;
    if (of_faces.empty()) of_faces = normals_of_faces(*level.mesh);
    set_direction(normals, i, has_direction(normal) ? normalized(normal) : of_faces[i]);
  }
}

/// Pre: normals are mended.
void mend_tangents(const MeshSource& source, LevelGeometry& level) {
  const auto number = find_column(source, "TANGENT"), normal_number = find_column(source, "NORMAL");
  if (!number || !normal_number) return;
  Column tangents(level, *number);
  const Column normals(level, *normal_number);
  for (std::size_t i = 0; i < tangents.point_count(); ++i) {
    const Vec3 tangent = direction(tangents, i);
    if (!is_unit(tangent))
      set_direction(tangents, i, has_direction(tangent) ? normalized(tangent) : across(direction(normals, i)));
    if (std::abs(tangents.get(i, 3)) != 1) tangents.set(i, 3, tangents.get(i, 3) < 0 ? -1 : 1);
  }
}

/// What moves a point: a joint's number and its weight.
struct Influence {
  double joint = 0;
  double weight = 0;
};

/// Lets each joint stand once, and none without a weight.
void join_equal(std::vector<Influence>& influences) {
  for (auto at = influences.begin(); at != influences.end(); ++at) {
    if (!(at->weight > 0) || !std::isfinite(at->weight)) at->weight = 0;
    const auto first =
        std::find_if(influences.begin(), at, [&](const Influence& i) { return i.weight > 0 && i.joint == at->joint; });
    if (first != at) first->weight += std::exchange(at->weight, 0);
  }
}

/// Lets weights sum to 1, in whole steps of 1 / `steps` where that is not 0. A point without any weight has all of its
/// first joint's, as three.js does it.
void normalise(std::vector<Influence>& influences, double steps) {
  double sum = 0, count = 0;
  for (const Influence& influence : influences) {
    sum += influence.weight;
    count += influence.weight > 0 ? 1 : 0;
  }
  if (sum > 0 && std::abs(sum - 1) <= kWeightTolerance * count) return;
  if (!(sum > 0)) influences[0].weight = sum = 1;
  double rest = 1;
  for (Influence& i : influences) {
    i.weight /= sum;
    if (steps > 0) i.weight = std::floor(i.weight * steps) / steps;
    rest -= i.weight;
  }
  const auto heavier = [](const Influence& a, const Influence& b) { return a.weight < b.weight; };
  if (steps > 0) std::max_element(influences.begin(), influences.end(), heavier)->weight += rest;
}

/// The sets of joints and weights of a mesh, JOINTS_0 and WEIGHTS_0 and on.
class SkinColumns {
 public:
  SkinColumns(const MeshSource& source, LevelGeometry& level) {
    for (std::size_t set = 0;; ++set) {
      const auto joints = find_column(source, text("JOINTS_", set)),
                 weights = find_column(source, text("WEIGHTS_", set));
      if (!joints || !weights) return;
      joints_.emplace_back(level, *joints);
      weights_.emplace_back(level, *weights);
    }
  }

  /// False where there is no skin, or its sets are not all of one type.
  bool is_usable() const {
    return !weights_.empty() && std::all_of(weights_.begin(), weights_.end(),
                                            [&](const Column& column) { return column.type() == weights_[0].type(); });
  }

  void mend() {
    const double steps = weights_[0].is_integer() ? largest_component(weights_[0].type()) : 0;
    std::vector<Influence> influences;
    for (std::size_t point = 0; point < weights_[0].point_count(); ++point) {
      get(point, influences);
      join_equal(influences);
      normalise(influences, steps);
      set(point, influences);
    }
  }

 private:
  void get(std::size_t point, std::vector<Influence>& influences) const {
    influences.clear();
    for (std::size_t set = 0; set < joints_.size(); ++set)
      for (std::size_t k = 0; k < joints_[set].component_count(); ++k)
        influences.push_back({joints_[set].get(point, k), weights_[set].get(point, k)});
  }

  void set(std::size_t point, const std::vector<Influence>& influences) {
    auto next = influences.begin();
    for (std::size_t set = 0; set < joints_.size(); ++set)
      for (std::size_t k = 0; k < joints_[set].component_count(); ++k, ++next) {
        weights_[set].set(point, k, next->weight);
        joints_[set].set(point, k, next->weight > 0 ? next->joint : 0);
      }
  }

  std::vector<Column> joints_, weights_;
};

}  // namespace

void mend_attributes(const MeshSource& source, LevelGeometry& level) {
  mend_normals(source, level);
  mend_tangents(source, level);
  SkinColumns skin(source, level);
  if (skin.is_usable()) skin.mend();
}

}  // namespace lodestone::detail
