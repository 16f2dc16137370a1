#pragma once

#include <vector>

#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// Whether a triangle may replace one of normal `before` (of any length): it does not turn far, nor is it a sliver.
bool is_upright(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& before);

/// Puts back vertices whose new positions would turn faces over or make them slivers, until none does.
void keep_faces_upright(const Mesh& mesh, std::vector<Vec3f>& positions);

}  // namespace lodestone::detail
