#include "build_report.h"

#include <algorithm>
#include <cstdio>
#include <optional>
#include <utility>

#include "process_memory.h"
#include "text_table.h"

namespace lodestone::tool {
namespace {

/// Raised by one whenever a member changes its meaning or goes away; new members do not raise it.
constexpr int kReportSchemaVersion = 1;

Json input_json(const BuildReport& report) {
  const BuildReport::Input& input = report.input;
  std::vector<std::string> notes = input.notes;
  notes.insert(notes.end(), report.build.notes.begin(), report.build.notes.end());
  return {{"path", input.path},
          {"faces", input.face_count},
          {"vertices", input.vertex_count},
          {"bounding_box", box_json(input.box)},
          {"assembly", assembly_json(input.assembly)},
          {"notes", std::move(notes)}};
}

Json target_json(const std::optional<LevelTarget>& target) {
  if (!target) return nullptr;
  if (target->relative) return {{std::string(name_of(target->kind)) + "_ratio", target->value}};  // of each mesh
  if (target->kind == TargetKind::Faces) return {{"faces", static_cast<std::uint64_t>(target->value)}};
  return {{std::string(name_of(target->kind)), target->value}};
}

Json beyond_json(double deviation) { return deviation > 0 ? Json(deviation) : Json(nullptr); }

Json left_out_json(const BuildResult::LeftOut& left_out) {
  return {{"target", target_json(left_out.target)},
          {"target_met", left_out.met},
          {"stopped_by", left_out.stopped_by},
          {"deviation_beyond", beyond_json(left_out.deviation_beyond)},
          {"level", left_out.level}};
}

Json level_json(const BuildResult::Level& level) {
  return {{"faces", level.face_count},
          {"vertices", level.vertex_count},
          {"deviation", deviation_json(level.deviation)},
          {"deviation_bound", level.deviation_bound},
          {"curvature_error", level.curvature_error},
          {"bytes", level.bytes},
          {"target", target_json(level.target)},
          {"target_met", level.met},
          {"stopped_by", level.stopped_by},
          {"deviation_beyond", beyond_json(level.deviation_beyond)}};
}

Json stream_json(const BuildResult::Stream& stream) {
  return {{"bytes", stream.bytes},
          {"records", stream.record_count},
          {"rounds", stream.round_count},
          {"base_faces", stream.base_face_count},
          {"stopped_by", name_of(stream.stop_reason)},
          {"blocked",
           {{"locked", stream.blocked.locked},
            {"flip", stream.blocked.flip},
            {"link", stream.blocked.link},
            {"shape", stream.blocked.shape},
            {"texture", stream.blocked.texture},
            {"ring", stream.blocked.ring},
            {"error", stream.blocked.error}}}};
}

Json part_json(const BuildResult::MeshPart& part) {
  Json levels = Json::array();
  for (const BuildResult::MeshPart::Level& level : part.levels)
    levels.push_back({{"faces", level.face_count},
                      {"vertices", level.vertex_count},
                      {"deviation", deviation_json(level.deviation)},
                      {"deviation_bound", level.deviation_bound},
                      {"attributes", attributes_json(level.attributes)}});
  return {{"name", part.name},
          {"instances", part.instance_count},
          {"scale", part.scale},
          {"assembly", assembly_json(part.assembly)},
          {"stream", stream_json(part.stream)},
          {"levels", std::move(levels)}};
}

Json output_json(const BuildReport& report) {
  Json files = Json::array();
  for (const BuildReport::OutputFile& file : report.files)
    files.push_back({{"path", file.path}, {"bytes", file.bytes}});
  return {{"path", report.output_path},
          {"bytes", report.output_bytes},
          {"quantisation_error", report.build.quantisation_error},
          {"position_bits", report.build.position_bits},
          {"files", std::move(files)}};
}

Json timings_json(const BuildReport& report) {
  const BuildResult::Timings& timings = report.build.timings_ms;
  return {{"read", report.reading_ms},
          {"simplify", timings.simplify},
          {"levels", timings.levels},
          {"write", timings.write}};
}

/// Why a level is no coarser; for an error that stops what faces were asked for, the one that would have come next.
std::string stopped_text(const BuildResult::Level& level, double diagonal) {
  if (!(level.deviation_beyond > 0)) return level.stopped_by;
  return level.stopped_by + ": " + percent_text(level.deviation_beyond, diagonal);
}

std::vector<std::string> row_of(std::size_t number, const BuildResult::Level& level, double diagonal) {
  return {std::to_string(number),
          std::to_string(level.face_count),
          std::to_string(level.vertex_count),
          percent_text(level.deviation.maximum(), diagonal),
          percent_text(std::max(level.deviation.forward.mean, level.deviation.backward.mean), diagonal),
          level.bytes > 0 ? std::to_string(level.bytes) : "-",
          stopped_text(level, diagonal)};
}

}  // namespace

Json report_json(const BuildReport& report) {
  Json levels = Json::array();
  for (const BuildResult::Level& level : report.build.levels) levels.push_back(level_json(level));
  Json left_out = Json::array();
  for (const BuildResult::LeftOut& target : report.build.left_out) left_out.push_back(left_out_json(target));
  Json meshes = Json::array();
  for (const BuildResult::MeshPart& part : report.build.meshes) meshes.push_back(part_json(part));
  return {{"schema_version", kReportSchemaVersion},
          {"tool", {{"name", "lodestone"}, {"version", LODESTONE_VERSION}}},
          {"input", input_json(report)},
          {"settings", report.settings},
          {"levels", levels},
          {"left_out", left_out},
          {"stream", stream_json(report.build.stream)},
          {"meshes", meshes},
          {"output", output_json(report)},
          {"timings_ms", timings_json(report)},
          {"peak_memory_bytes", peak_memory_bytes()}};
}

void print_table(const BuildReport& report) {
  TextTable table({"level", "faces", "vertices", "max", "mean", "bytes", "stopped by"});
  const double diagonal = report.input.box.diagonal();
  for (std::size_t i = 0; i < report.build.levels.size(); ++i) table.add(row_of(i, report.build.levels[i], diagonal));
  table.print();
  for (const BuildResult::LeftOut& left_out : report.build.left_out)
    if (left_out.met) std::printf("one level less: it would repeat level %zu\n", left_out.level);
  if (report.build.stream.bytes > 0) {
    std::printf("stream: %zu records in %zu rounds over a base of %zu faces, %llu bytes\n",
                report.build.stream.record_count, report.build.stream.round_count, report.build.stream.base_face_count,
                static_cast<unsigned long long>(report.build.stream.bytes));
  }
  for (const BuildReport::OutputFile& file : report.files)
    std::printf("%s: %llu bytes\n", file.path.c_str(), static_cast<unsigned long long>(file.bytes));
}

}  // namespace lodestone::tool
