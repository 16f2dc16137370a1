// Branch and bound over both surfaces (see supremum.cpp), with bounds that outlive a level. Backward, from the level to
// the original, a face's bound stays true for as long as the face exists, since the original does not change. Forward,
// a vertex of the original keeps the face it was near until a removal takes that face away; then its distance is at
// most the old one and what the surface moved.

#include <lodestone/lod/level_deviation.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include <lodestone/core/detail/position_index.h>

#include "distance/face_names.h"
#include "distance/supremum.h"
#include "distance/triangle.h"

namespace lodestone {
namespace {

using detail::FaceName;
using detail::FaceNames;
using detail::Goal;
using detail::KnownDistance;
using detail::PatchBound;
using detail::PositionIndex;
using detail::SupremumSearch;
using detail::SurfaceBounds;
using detail::TargetSurface;
using detail::Triangle;
using detail::Witnesses;

/// Returns the original's vertex at each vertex of `mesh`, the first where several are; kNoIndex where none is.
std::vector<Index> find_all(const PositionIndex& vertices, const Mesh& mesh) {
  std::vector<Index> found;
  found.reserve(mesh.vertex_count());
  for (const Vec3f& position : mesh.positions) found.push_back(vertices.find(position));
  return found;
}

/// What names a face of the original and of its levels alike: its corners in the original's vertices, ascending.
FaceName face_name(const Mesh& mesh, const std::vector<Index>& vertex_names, Index face) {
  FaceName name;
  for (Index i = 0; i < 3; ++i) name[i] = vertex_names[mesh.corner_vertex(3 * face + i)];
  std::sort(name.begin(), name.end());
  return name;
}

/// Whether all corners are vertices of the original.
bool is_known(const FaceName& name) { return name[2] != kNoIndex; }

}  // namespace

struct LevelDeviation::Impl {
  Impl(const Mesh& mesh, const DeviationOptions& wanted);

  Deviation measure(const Mesh& level, double moved, double enough);
  void forget();
  SurfaceBounds inherit(const Mesh& level, double moved);
  std::vector<Index> recognise_faces(const Mesh& level, const std::vector<Index>& vertex_names,
                                     SurfaceBounds& backward);
  void carry(const std::vector<Index>& face_now, double moved);
  void carry_nearest(const std::vector<Index>& face_now, double moved);
  void carry_bounds(const std::vector<Index>& face_now, double moved);
  void place_common_vertices(const Mesh& level, const std::vector<Index>& names, SurfaceBounds& backward);
  void bound_new_faces(const Mesh& level, Goal& goal, SurfaceBounds& backward);
  void place_at(Index vertex, const Triangle& triangle, Index face);
  void start(SupremumSearch& forward_search, SupremumSearch& backward_search, Goal& goal) const;

  const Mesh& original;
  DeviationOptions options;
  double diagonal;              // The original's.
  std::vector<Index> opposite;  // Of the original's corners.
  TargetSurface surface;
  PatchBound patch;
  PositionIndex vertices;  // Of the original.
  FaceNames original_faces;
  std::vector<Index> face_at;  // A face at each of the original's vertices, by name; kNoIndex: none.
  SurfaceBounds forward;       // Of the original, to the last level.

  FaceNames level_faces;             // Of the last level.
  std::vector<double> level_bounds;  // Of the last level's faces, to the original.
  Vec3 farthest_point;               // Of the original, from the last level.
  Index farthest_face = kNoIndex;    // Of the level, from the original; as numbered now.
  double farthest_distance = 0;      // Of farthest_face.
};

LevelDeviation::Impl::Impl(const Mesh& mesh, const DeviationOptions& wanted)
    : original(mesh),
      options(wanted),
      diagonal(bounding_box(mesh).diagonal()),
      opposite(detail::opposite_corners(mesh)),
      surface(mesh, opposite),
      patch(mesh, opposite),
      vertices(mesh.positions),
      original_faces(mesh.vertex_count(), mesh.face_count()),
      face_at(mesh.vertex_count(), kNoIndex),
      forward(mesh, true) {
  const std::vector<Index> vertex_names = vertices.add_all();
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const FaceName name = face_name(mesh, vertex_names, f);
    original_faces.insert(name, f);
    for (const Index v : name) {
      if (face_at[v] == kNoIndex) face_at[v] = f;
    }
  }
  if (mesh.face_count() > 0) farthest_point = mesh.corner_position(0);
}

/// Carries what is known over to a new level; returns what is known of the level's own faces.
SurfaceBounds LevelDeviation::Impl::inherit(const Mesh& level, double moved) {
  const std::vector<Index> vertex_names = find_all(vertices, level);
  SurfaceBounds backward(level, false);
  carry(recognise_faces(level, vertex_names, backward), moved);
  level_faces = FaceNames(original.vertex_count(), level.face_count());
  for (Index f = 0; f < level.face_count(); ++f) {
    const FaceName name = face_name(level, vertex_names, f);
    if (!is_known(name)) continue;
    level_faces.insert(name, f);
    const Index same = original_faces.find(name);
    if (same == kNoIndex) continue;
    backward.faces[f] = 0;
    forward.lower(same, 0, std::array{f});
  }
  place_common_vertices(level, vertex_names, backward);
  return backward;
}

/// Returns the level's face for each of the last level's, and hands their bounds on. Then it forgets the last level:
/// the names of two levels at once would be the most that is held.
std::vector<Index> LevelDeviation::Impl::recognise_faces(const Mesh& level, const std::vector<Index>& vertex_names,
                                                         SurfaceBounds& backward) {
  std::vector<Index> face_now(level_bounds.size(), kNoIndex);
  for (Index f = 0; f < level.face_count() && !face_now.empty(); ++f) {
    const FaceName name = face_name(level, vertex_names, f);
    const Index before = is_known(name) ? level_faces.find(name) : kNoIndex;
    if (before == kNoIndex) continue;
    face_now[before] = f;
    backward.faces[f] = level_bounds[before];
  }
  level_faces = FaceNames();
  level_bounds = std::vector<double>();
  return face_now;
}

void LevelDeviation::Impl::carry(const std::vector<Index>& face_now, double moved) {
  carry_nearest(face_now, moved);
  carry_bounds(face_now, moved);
  if (farthest_face != kNoIndex) farthest_face = face_now[farthest_face];
}

void LevelDeviation::Impl::carry_nearest(const std::vector<Index>& face_now, double moved) {
  for (KnownDistance& known : forward.vertices) {
    known.searched = false;
    if (known.face != kNoIndex) known.face = face_now[known.face];
    if (known.face == kNoIndex) known.distance += moved;
  }
}

void LevelDeviation::Impl::carry_bounds(const std::vector<Index>& face_now, double moved) {
  for (std::size_t f = 0; f < forward.faces.size(); ++f) {
    Witnesses& witness = forward.witnesses[f];
    if (witness.known()) {
      for (Index& face : witness.faces) face = face_now[face];
    }
    if (std::find(witness.faces.begin(), witness.faces.end(), kNoIndex) == witness.faces.end()) continue;
    witness = {};
    forward.faces[f] += moved;
  }
}

/// Where the level kept a vertex, the surfaces meet.
void LevelDeviation::Impl::place_common_vertices(const Mesh& level, const std::vector<Index>& vertex_names,
                                                 SurfaceBounds& backward) {
  for (Index corner = 0; corner < level.corner_wedge.size(); ++corner) {
    const Index v = level.corner_vertex(corner);
    const Index name = vertex_names[v];
    if (name == kNoIndex || face_at[name] == kNoIndex) continue;
    forward.vertices[name] = {0, face_of_corner(corner), true};
    backward.vertices[v] = {0, face_at[name], true};
  }
}

/// Bounds the level's new faces by the patches of the original they stand for, and takes those patches' vertices, which
/// have lost the faces they were near, as near the new ones.
void LevelDeviation::Impl::bound_new_faces(const Mesh& level, Goal& goal, SurfaceBounds& backward) {
  std::vector<bool> lost(forward.vertices.size());
  for (std::size_t v = 0; v < lost.size(); ++v) lost[v] = forward.vertices[v].face == kNoIndex;
  for (Index f = 0; f < level.face_count(); ++f) {
    const Index start = backward.vertices[level.corner_vertex(3 * f)].face;
    if (backward.faces[f] <= goal.threshold() || start == kNoIndex) continue;
    const Triangle triangle = detail::triangle_of(level, f);
    backward.faces[f] = patch.bound({Vec3(triangle.a), Vec3(triangle.b), Vec3(triangle.c)}, start, goal.threshold(),
                                    goal.patch_slack());
    goal.step();
    for (const Index g : patch.patch()) {
      for (Index corner = 3 * g; corner < 3 * g + 3; ++corner) {
        const Index v = original.corner_vertex(corner);
        if (lost[v] && forward.vertices[v].face != f) place_at(v, triangle, f);
      }
    }
  }
}

void LevelDeviation::Impl::place_at(Index vertex, const Triangle& triangle, Index face) {
  KnownDistance& known = forward.vertices[vertex];
  const Vec3 p(original.positions[vertex]);
  const double distance = length(p - detail::nearest_on_triangle(p, triangle));
  if (known.face == kNoIndex || distance < known.distance) known = {distance, face, false};
}

/// Raises the goal at once to where the last level's maximum suggests.
void LevelDeviation::Impl::start(SupremumSearch& forward_search, SupremumSearch& backward_search, Goal& goal) const {
  forward_search.probe(farthest_point, goal);
  if (farthest_face != kNoIndex) backward_search.assume(farthest_face, farthest_distance, goal);
}

Deviation LevelDeviation::Impl::measure(const Mesh& level, double moved, double enough) {
  SurfaceBounds backward = inherit(level, moved);
  const std::vector<Index> level_opposite = detail::opposite_corners(level);
  TargetSurface level_surface(level, level_opposite);
  PatchBound level_patch(level, level_opposite);
  SupremumSearch forward_search(original, level_surface, level_patch, forward);
  SupremumSearch backward_search(level, surface, patch, backward);
  Goal goal = detail::goal_of(options, std::max(diagonal, bounding_box(level).diagonal()), enough);
  start(forward_search, backward_search, goal);
  bound_new_faces(level, goal, backward);
  const Deviation result = detail::narrow_both(forward_search, backward_search, goal, options.budget);
  if (forward_search.largest_distance() > 0) farthest_point = forward_search.farthest_point();
  farthest_face = backward_search.farthest_face();
  farthest_distance = backward_search.largest_distance();
  level_bounds = std::move(backward.faces);
  return result;
}

void LevelDeviation::Impl::forget() {
  forward = SurfaceBounds(original, true);
  level_faces = FaceNames();
  level_bounds.clear();
  farthest_face = kNoIndex;
}

LevelDeviation::LevelDeviation(const Mesh& original, const DeviationOptions& options)
    : impl_(std::make_unique<Impl>(original, options)) {}
LevelDeviation::~LevelDeviation() = default;
LevelDeviation::LevelDeviation(LevelDeviation&&) noexcept = default;
LevelDeviation& LevelDeviation::operator=(LevelDeviation&&) noexcept = default;

Deviation LevelDeviation::measure(const Mesh& level, double moved, double enough) {
  if (impl_->original.face_count() == 0 || level.face_count() == 0) {
    impl_->forget();
    return detail::maximum_of_empty(impl_->original, level);
  }
  return impl_->measure(level, moved, enough);
}

}  // namespace lodestone
