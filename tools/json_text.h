#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <lodestone/core/assemble.h>
#include <lodestone/core/mesh.h>
#include <lodestone/lod/attribute_deviation.h>
#include <lodestone/lod/deviation.h>

namespace lodestone::tool {

/// Objects keep the order in which they were filled, so that two reports compare line by line.
using Json = nlohmann::ordered_json;

/// Returns indented text with a final newline; bytes that are no UTF-8 are replaced, infinities become null.
std::string json_text(const Json& json);

Json assembly_json(const AssemblyReport& report);
Json one_sided_json(const OneSidedDeviation& deviation);
/// Lengths in mesh units; the angle in degrees.
Json deviation_json(const Deviation& deviation);
/// Normals in degrees.
Json attributes_json(const std::vector<AttributeDeviation>& deviations);
Json box_json(const Box& box);

}  // namespace lodestone::tool
