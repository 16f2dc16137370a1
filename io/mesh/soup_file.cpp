#include "mesh/soup_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <unordered_map>

#include <lodestone/core/detail/text.h>

#include "base/bytes.h"

namespace lodestone::detail {
namespace {

constexpr double kUnitTolerance = 1e-3;  // Four decimals in a text file stay within it, a scaled normal does not.

void store_unit(Attribute& normals, std::size_t point, const Vec3& direction) {
  const Vec3f stored = to_float(normalized(direction));
  std::memcpy(normals.data.data() + point * sizeof stored, &stored, sizeof stored);
}

/// Gives the points the direction of the sum of their faces' area vectors; z where that has none either.
void compute_normals(const TriangleSoup& soup, std::span<const std::size_t> points, Attribute& normals) {
  std::unordered_map<std::size_t, Vec3> sums;
  for (const std::size_t point : points) sums[point] = Vec3{};
  for (std::size_t i = 0; i + 2 < soup.indices.size(); i += 3) {
    const auto corner = [&](std::size_t k) { return Vec3(soup.positions[soup.indices[i + k]]); };
    for (std::size_t k = 0; k < 3; ++k) {
      const auto sum = sums.find(soup.indices[i + k]);
      if (sum != sums.end()) sum->second += cross(corner(1) - corner(0), corner(2) - corner(0));
    }
  }
  for (const auto& [point, sum] : sums) store_unit(normals, point, has_direction(sum) ? sum : Vec3{0, 0, 1});
}

}  // namespace

void tidy_normals(SoupFile& file) {
  auto& attributes = file.soup.attributes;
  const auto normals = std::find_if(attributes.begin(), attributes.end(), [](const Attribute& a) {
    return a.name == "NORMAL" && a.type == ComponentType::Float32 && a.component_count == 3;
  });
  if (normals == attributes.end()) return;
  std::vector<std::size_t> without_direction;
  for (std::size_t point = 0; point < file.soup.positions.size(); ++point) {
    const Vec3 normal(load<Vec3f>(normals->data, point * sizeof(Vec3f)));
    if (!has_direction(normal))
      without_direction.push_back(point);
    else if (std::abs(length(normal) - 1) > kUnitTolerance)
      store_unit(*normals, point, normal);
  }
  if (without_direction.empty()) return;
  compute_normals(file.soup, without_direction, *normals);
  file.notes.push_back(text(without_direction.size(), " normals without a direction were computed from their faces"));
}

Attribute float_attribute(std::string name, std::uint8_t component_count, std::span<const float> values) {
  Attribute attribute{std::move(name), ComponentType::Float32, component_count, false, {}};
  const auto bytes = std::as_bytes(values);
  attribute.data.assign(bytes.begin(), bytes.end());
  return attribute;
}

}  // namespace lodestone::detail
