#include "gltf/gltf_attribute.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace lodestone::detail {
namespace {

// The types of glTF 2.0 section 3.7.2.1, and those KHR_mesh_quantization adds. Bits: 1 float; 2 normalized and
// 4 plain unsigned 8 or 16 bits; 8 normalized and 16 plain signed 8 or 16 bits.
enum TypeBit : unsigned { kFloat = 1, kUnsignedNormalized = 2, kUnsigned = 4, kSignedNormalized = 8, kSigned = 16 };

struct Rule {
  std::string_view prefix;  ///< ends with '_' where a set number follows
  unsigned components;      ///< bits: 1 << component_count
  unsigned core_types;
  unsigned quantized_types;
};

constexpr unsigned kAnyQuantized = kUnsignedNormalized | kUnsigned | kSignedNormalized | kSigned;
constexpr std::array<Rule, 6> kRules = {{
    {"NORMAL", 1u << 3, kFloat, kSignedNormalized},
    {"TANGENT", 1u << 4, kFloat, kSignedNormalized},
    {"TEXCOORD_", 1u << 2, kFloat | kUnsignedNormalized, kAnyQuantized},
    {"COLOR_", 1u << 3 | 1u << 4, kFloat | kUnsignedNormalized, 0},
    {"JOINTS_", 1u << 4, kUnsigned, 0},
    {"WEIGHTS_", 1u << 4, kFloat | kUnsignedNormalized, 0},
}};

unsigned type_bit(const Attribute& attribute) {
  switch (attribute.type) {
    case ComponentType::Float32:
      return kFloat;
    case ComponentType::UInt8:
    case ComponentType::UInt16:
      return attribute.normalized ? kUnsignedNormalized : kUnsigned;
    case ComponentType::Int8:
    case ComponentType::Int16:
      return attribute.normalized ? kSignedNormalized : kSigned;
    case ComponentType::UInt32:
      return 0;
  }
  return 0;
}

bool names(const Rule& rule, std::string_view name) {
  if (!rule.prefix.ends_with('_')) return name == rule.prefix;
  const std::string_view number = name.substr(std::min(rule.prefix.size(), name.size()));
  return name.starts_with(rule.prefix) && !number.empty() && number.find_first_not_of("0123456789") == number.npos;
}

}  // namespace

std::optional<GltfSemantic> gltf_semantic(const Attribute& attribute) {
  const unsigned type = type_bit(attribute);
  if (type == 0 || attribute.component_count < 1 || attribute.component_count > 4) return std::nullopt;
  if (attribute.name.starts_with('_')) return GltfSemantic{attribute.name};
  for (const Rule& rule : kRules) {
    if (!names(rule, attribute.name) || !(rule.components >> attribute.component_count & 1)) continue;
    if (rule.core_types & type) return GltfSemantic{attribute.name};
    if (rule.quantized_types & type) return GltfSemantic{attribute.name, true};
  }
  return GltfSemantic{'_' + attribute.name};
}

bool same_layout(const Attribute& a, const Attribute& b) {
  return a.name == b.name && a.type == b.type && a.component_count == b.component_count && a.normalized == b.normalized;
}

const char* gltf_type(std::uint8_t component_count) {
  constexpr std::array<const char*, 4> kTypes = {"SCALAR", "VEC2", "VEC3", "VEC4"};
  return kTypes.at(component_count - 1u);
}

}  // namespace lodestone::detail
