#include "json_text.h"

#include <numbers>

namespace lodestone::tool {

std::string json_text(const Json& json) {
  return json.dump(2, ' ', false, nlohmann::detail::error_handler_t::replace) + "\n";
}

Json assembly_json(const AssemblyReport& report) {
  return {{"nonfinite_faces", report.nonfinite_faces}, {"degenerate_faces", report.degenerate_faces},
          {"duplicate_faces", report.duplicate_faces}, {"unused_points", report.unused_points},
          {"turned_faces", report.turned_faces},       {"nonmanifold_edges", report.nonmanifold_edges},
          {"cut_vertices", report.cut_vertices}};
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

namespace {

Json attribute_json(const AttributeDeviation& deviation) {
  const double unit = deviation.name == "NORMAL" ? 180 / std::numbers::pi : 1;
  return {{"name", deviation.name},
          {"mean", deviation.mean * unit},
          {"rms", deviation.rms * unit},
          {"max", deviation.maximum * unit}};
}

}  // namespace

Json attributes_json(const std::vector<AttributeDeviation>& deviations) {
  Json json = Json::array();
  for (const AttributeDeviation& deviation : deviations) json.push_back(attribute_json(deviation));
  return json;
}

Json box_json(const Box& box) {
  return {{"low", {box.low.x, box.low.y, box.low.z}},
          {"high", {box.high.x, box.high.y, box.high.z}},
          {"diagonal", box.diagonal()}};
}

}  // namespace lodestone::tool
