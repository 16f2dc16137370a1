#include "scene/scene_levels.h"

#include <algorithm>
#include <cmath>

namespace lodestone::detail {
namespace {

/// Sets a number unless it is infinite or NaN, which JSON cannot say.
void set_finite(Json& object, const char* key, double value) {
  if (std::isfinite(value)) object[key] = value;
}

/// The same in few digits: these come before all that is drawn. What is beyond floats keeps its digits.
void set_short(Json& object, const char* key, double value) {
  const auto rounded = static_cast<float>(value);
  set_finite(object, key, std::isnormal(rounded) ? of_few_digits(rounded) : value);
}

}  // namespace

bool same_mesh(const Mesh& a, const Mesh& b) {
  return a.corner_wedge == b.corner_wedge && a.face_material == b.face_material && a.wedge_vertex == b.wedge_vertex &&
         a.positions == b.positions &&
         std::equal(a.attributes.begin(), a.attributes.end(), b.attributes.begin(), b.attributes.end(),
                    [](const Attribute& x, const Attribute& y) { return x.name == y.name && x.data == y.data; });
}

void add_shown_numbers(const AssetLevel& level, const SceneMesh& mesh, Json& extension) {
  const Deviation& d = level.deviation;
  set_short(extension, "deviation", d.maximum());
  set_short(extension, "mean_deviation", std::max(d.forward.mean, d.backward.mean));
  set_short(extension, "rms_deviation", std::max(d.forward.rms, d.backward.rms));
  set_short(extension, "curvature_error", level.curvature_error);
  set_short(extension, "world_scale", mesh.scale);
  set_short(extension, "world_area", mesh.area);
}

Json level_numbers(const AssetLevel& level, const WrittenLevel& written, const SceneMesh& mesh, std::size_t node_count,
                   std::optional<double> position_step) {
  const Deviation& d = level.deviation;
  Json numbers = {{"faces", written.face_count}, {"vertices", written.vertex_count}};
  set_finite(numbers, "maximum_deviation", d.maximum());
  set_finite(numbers, "mean_deviation", std::max(d.forward.mean, d.backward.mean));
  set_finite(numbers, "rms_deviation", std::max(d.forward.rms, d.backward.rms));
  set_finite(numbers, "curvature_error", level.curvature_error);
  if (position_step) set_finite(numbers, "position_step", *position_step);
  set_finite(numbers, "world_scale", mesh.scale);
  set_finite(numbers, "world_area", mesh.area / static_cast<double>(node_count));
  numbers["stop_reason"] = level.stop_reason;
  if (level.deviation_beyond > 0) set_finite(numbers, "deviation_beyond", level.deviation_beyond);
  return numbers;
}

}  // namespace lodestone::detail
