#include "build_settings.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <lodestone/io/file.h>
#include <lodestone/lod/simplify.h>

#include "json_text.h"
#include "messages.h"
#include "text_table.h"

namespace lodestone::tool {
namespace {

constexpr const char* kImportanceAttribute = "_LODESTONE_IMPORTANCE";

auto malformed(const std::filesystem::path& path, const std::string& what) {
  return fail(ErrorCode::Malformed, quoted(path) + ": " + what);
}

Result<PartSettings> parse_part(const std::filesystem::path& path, const std::string& where, const Json& json) {
  PartSettings part;
  if (!json.is_object()) return malformed(path, where + " is not an object");
  for (const auto& [name, value] : json.items()) {
    if (name == "importance" && value.is_number() && value.get<double>() >= 0)
      part.importance = value.get<double>();
    else if (name == "lock" && value.is_boolean())
      part.lock = value.get<bool>();
    else if (name == "importance" || name == "lock")
      return malformed(path, where + ": " + name + (name == "lock" ? " is not true or false" : " is not a number of 0 or more"));
    else
      return malformed(path, where + ": no setting is called " + quoted(std::string_view(name)));
  }
  return part;
}

Result<std::map<std::string, PartSettings>> parse_parts(const std::filesystem::path& path, const std::string& member,
                                                        const Json& json) {
  std::map<std::string, PartSettings> parts;
  if (!json.is_object()) return malformed(path, member + " is not an object");
  for (const auto& [name, value] : json.items()) {
    Result<PartSettings> part = parse_part(path, member + " " + quoted(std::string_view(name)), value);
    if (!part) return tl::unexpected(part.error());
    parts[name] = *part;
  }
  return parts;
}

Result<void> check_known(const std::map<std::string, PartSettings>& parts, const std::set<std::string>& known,
                         const char* what) {
  for (const auto& [name, part] : parts)
    if (!known.contains(name))
      return fail(ErrorCode::InvalidArgument,
                  std::string("--settings: no ") + what + " of the scene's meshes is called " + quoted(std::string_view(name)));
  return {};
}

double painted_importance(double component) {
  constexpr double kFullyPainted = 0.999;  // eight bits of colour, gone through a float
  return component >= kFullyPainted ? static_cast<double>(kLockingImportance) : std::pow(16.0, 2 * component - 1);
}

Result<void> multiply_by_attribute(const SceneMesh& mesh, const Attribute& attribute, std::vector<double>& importance) {
  const bool is_colour = attribute.name.starts_with("COLOR_");
  std::vector<double> largest(importance.size(), 0);
  const std::vector<float> values = attribute_values(attribute);
  for (std::size_t w = 0; w < mesh.mesh.wedge_count(); ++w) {
    const auto first = static_cast<double>(values[w * attribute.component_count]);
    const double value = is_colour ? painted_importance(first) : first;
    if (!(value >= 0))
      return fail(ErrorCode::InvalidArgument, "mesh " + quoted(std::string_view(mesh.name)) + ": " + attribute.name +
                                                  " has " + number_text(value) + ", importance is 0 or more");
    largest[mesh.mesh.wedge_vertex[w]] = std::max(largest[mesh.mesh.wedge_vertex[w]], value);
  }
  for (std::size_t v = 0; v < importance.size(); ++v) importance[v] *= largest[v];
  return {};
}

double value_of(const PartSettings& part) {
  return part.lock ? static_cast<double>(kLockingImportance) : part.importance;
}

void multiply_by_materials(const SceneMesh& mesh, const BuildSettings& settings, std::vector<double>& importance) {
  std::vector<double> largest(importance.size(), 0);
  for (Index face = 0; face < mesh.mesh.face_count(); ++face) {
    const Index primitive = mesh.mesh.material_of(face);
    const auto found = primitive < mesh.materials.size() ? settings.materials.find(mesh.materials[primitive])
                                                         : settings.materials.end();
    const double value = found == settings.materials.end() ? 1 : value_of(found->second);
    for (Index k = 0; k < 3; ++k) {
      double& at = largest[mesh.mesh.corner_vertex(3 * face + k)];
      at = std::max(at, value);
    }
  }
  for (std::size_t v = 0; v < importance.size(); ++v) importance[v] *= largest[v];
}

}  // namespace

double BuildSettings::importance_of(const SceneMesh& mesh) const {
  double largest = 0;
  for (const std::string& node : mesh.nodes) {
    const auto found = nodes.find(node);
    largest = std::max(largest, found == nodes.end() ? 1 : value_of(found->second));
  }
  return mesh.nodes.empty() ? 1 : largest;
}

Result<BuildSettings> read_settings(const std::filesystem::path& path) {
  const Result<std::vector<std::byte>> bytes = read_file(path);
  if (!bytes) return tl::unexpected(bytes.error());
  const auto* text = reinterpret_cast<const char*>(bytes->data());
  const Json json = Json::parse(text, text + bytes->size(), nullptr, false, true);
  if (json.is_discarded() || !json.is_object()) return malformed(path, "is not a JSON object");
  BuildSettings settings;
  for (const auto& [name, value] : json.items()) {
    if (name != "materials" && name != "nodes")
      return malformed(path, "no setting is called " + quoted(std::string_view(name)));
    auto parts = parse_parts(path, name, value);
    if (!parts) return tl::unexpected(parts.error());
    (name == "nodes" ? settings.nodes : settings.materials) = std::move(*parts);
  }
  return settings;
}

Result<void> check_names(const BuildSettings& settings, const Scene& scene) {
  std::set<std::string> materials;
  std::set<std::string> nodes;
  for (const SceneMesh& mesh : scene.meshes()) {
    materials.insert(mesh.materials.begin(), mesh.materials.end());
    nodes.insert(mesh.nodes.begin(), mesh.nodes.end());
  }
  if (auto known = check_known(settings.materials, materials, "material"); !known) return known;
  return check_known(settings.nodes, nodes, "node");
}

Result<std::vector<float>> vertex_importance(const SceneMesh& mesh, const BuildSettings& settings,
                                             const std::string& attribute) {
  std::vector<double> importance(mesh.mesh.vertex_count(), settings.importance_of(mesh));
  if (!settings.materials.empty()) multiply_by_materials(mesh, settings, importance);
  const std::string wanted = attribute.empty() ? kImportanceAttribute : attribute;
  for (const Attribute& candidate : mesh.mesh.attributes)
    if (candidate.name == wanted)
      if (auto done = multiply_by_attribute(mesh, candidate, importance); !done) return tl::unexpected(done.error());
  if (std::all_of(importance.begin(), importance.end(), [](double i) { return i == 1; })) return std::vector<float>{};
  return std::vector<float>(importance.begin(), importance.end());
}

}  // namespace lodestone::tool
