#include "json_text.h"

#include <numbers>

namespace lodestone::tool {

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, nlohmann::detail::error_handler_t::replace) + "\n";
}

Json assembly_json(const AssemblyReport& report) {
  return {{"nonfinite_faces", report.nonfinite_faces},     {"degenerate_faces", report.degenerate_faces},
          {"duplicate_faces", report.duplicate_faces},     {"unused_points", report.unused_points},
          {"nonmanifold_edges", report.nonmanifold_edges}, {"cut_vertices", report.cut_vertices}};
}

Json one_sided_json(const OneSidedDeviation& deviation) {
  return {{"max", deviation.maximum},
          {"bound", deviation.maximum_bound},
          {"mean", deviation.mean},
          {"rms", deviation.rms},
          {"samples", deviation.sample_count}};
}

Json deviation_json(const Deviation& deviation) {
  return {{"max", deviation.maximum()},
          {"bound", deviation.maximum_bound()},
          {"forward", one_sided_json(deviation.forward)},
          {"backward", one_sided_json(deviation.backward)},
          {"mean_normal_angle_degrees", deviation.mean_normal_angle * 180 / std::numbers::pi}};
}

Json box_json(const Box& box) {
  return {{"low", {box.low.x, box.low.y, box.low.z}},
          {"high", {box.high.x, box.high.y, box.high.z}},
          {"diagonal", box.diagonal()}};
}

}  // namespace lodestone::tool
