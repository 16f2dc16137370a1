#include <lodestone/pipeline/importance.h>

#include <algorithm>
#include <cmath>
#include <set>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/lod/simplify_options.h>

namespace lodestone {
namespace {

using detail::text;

constexpr const char* kImportanceAttribute = "_LODESTONE_IMPORTANCE";

Result<void> check_known(const std::map<std::string, PartImportance>& parts, const std::set<std::string>& known,
                         const char* what) {
  for (const auto& [name, part] : parts)
    if (!known.contains(name))
      return fail(ErrorCode::InvalidArgument, text("no ", what, " of the scene's meshes is called '", name, "'"));
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
      return fail(ErrorCode::InvalidArgument,
                  text("mesh '", mesh.name, "': ", attribute.name, " has ", value, ", importance is 0 or more"));
    largest[mesh.mesh.wedge_vertex[w]] = std::max(largest[mesh.mesh.wedge_vertex[w]], value);
  }
  for (std::size_t v = 0; v < importance.size(); ++v) importance[v] *= largest[v];
  return {};
}

double value_of(const PartImportance& part) {
  return part.lock ? static_cast<double>(kLockingImportance) : part.factor;
}

void multiply_by_materials(const SceneMesh& mesh, const Importance& parts, std::vector<double>& importance) {
  std::vector<double> largest(importance.size(), 0);
  for (Index face = 0; face < mesh.mesh.face_count(); ++face) {
    const Index primitive = mesh.mesh.material_of(face);
    const auto found =
        primitive < mesh.materials.size() ? parts.materials.find(mesh.materials[primitive]) : parts.materials.end();
    const double value = found == parts.materials.end() ? 1 : value_of(found->second);
    for (Index k = 0; k < 3; ++k) {
      double& at = largest[mesh.mesh.corner_vertex(3 * face + k)];
      at = std::max(at, value);
    }
  }
  for (std::size_t v = 0; v < importance.size(); ++v) importance[v] *= largest[v];
}

}  // namespace

double importance_of(const SceneMesh& mesh, const Importance& importance) {
  double largest = 0;
  for (const std::string& node : mesh.nodes) {
    const auto found = importance.nodes.find(node);
    largest = std::max(largest, found == importance.nodes.end() ? 1 : value_of(found->second));
  }
  return mesh.nodes.empty() ? 1 : largest;
}

Result<void> check_names(const Importance& importance, const Scene& scene) {
  std::set<std::string> materials;
  std::set<std::string> nodes;
  for (const SceneMesh& mesh : scene.meshes()) {
    materials.insert(mesh.materials.begin(), mesh.materials.end());
    nodes.insert(mesh.nodes.begin(), mesh.nodes.end());
  }
  LODESTONE_CHECK(check_known(importance.materials, materials, "material"));
  return check_known(importance.nodes, nodes, "node");
}

Result<std::vector<float>> vertex_importance(const SceneMesh& mesh, const Importance& parts) {
  std::vector<double> importance(mesh.mesh.vertex_count(), importance_of(mesh, parts));
  if (!parts.materials.empty()) multiply_by_materials(mesh, parts, importance);
  const std::string wanted = parts.attribute.empty() ? kImportanceAttribute : parts.attribute;
  for (const Attribute& candidate : mesh.mesh.attributes)
    if (candidate.name == wanted) LODESTONE_CHECK(multiply_by_attribute(mesh, candidate, importance));
  if (std::all_of(importance.begin(), importance.end(), [](double i) { return i == 1; })) return std::vector<float>{};
  return std::vector<float>(importance.begin(), importance.end());
}

}  // namespace lodestone
