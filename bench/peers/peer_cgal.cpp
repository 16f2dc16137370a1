#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_filter.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#ifdef LODESTONE_BENCH_EIGEN
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#endif
#include <CGAL/version.h>

#include "simplifier.h"

namespace lodestone::bench {
namespace {

namespace sms = CGAL::Surface_mesh_simplification;
namespace np = CGAL::parameters;
using Kernel = CGAL::Simple_cartesian<double>;
using SurfaceMesh = CGAL::Surface_mesh<Kernel::Point_3>;

#if CGAL_VERSION_NR >= 1060000000
template <class T>
using Optional = std::optional<T>;
#else
template <class T>
using Optional = boost::optional<T>;
#endif

SurfaceMesh to_cgal(const Mesh& mesh) {
  SurfaceMesh result;
  for (const Vec3f& p : mesh.positions) result.add_vertex({p.x, p.y, p.z});
  for (Index c = 0; c < mesh.corner_wedge.size(); c += 3) {
    const auto vertex = [&](Index corner) { return SurfaceMesh::Vertex_index(mesh.corner_vertex(corner)); };
    result.add_face(vertex(c), vertex(c + 1), vertex(c + 2));
  }
  return result;
}

/// Removed elements are still in the arrays: points keep their numbers, faces are those that remain.
Surface from_cgal(const SurfaceMesh& mesh) {
  Surface surface;
  surface.points.resize(mesh.num_vertices());
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    surface.points[v] = {p.x(), p.y(), p.z()};
  }
  for (const auto f : mesh.faces()) {
    std::array<Index, 3> face{};
    int i = 0;
    for (const auto v : mesh.vertices_around_face(mesh.halfedge(f))) face[i++] = v;
    surface.faces.push_back(face);
  }
  return surface;
}

/// The levels that one run passes on its way down, each with the time until then.
class Snapshots {
 public:
  explicit Snapshots(std::span<const std::size_t> face_counts) : face_counts_(face_counts) {}

  /// Takes the levels that are due; returns whether that was the last.
  bool offer(const SurfaceMesh& mesh) {
    if (done() || mesh.number_of_faces() > face_counts_[levels_.size()]) return done();
    const Clock copying;
    const Seconds seconds = clock_.seconds() - spent_copying_;
    while (!done() && mesh.number_of_faces() <= face_counts_[levels_.size()]) {
      levels_.push_back({from_cgal(mesh), seconds});
    }
    spent_copying_ = spent_copying_ + copying.seconds();
    return done();
  }

  /// Fills up with where the run ended, where it could not go on.
  std::vector<Level> finish(const SurfaceMesh& mesh) {
    while (!done()) levels_.push_back({from_cgal(mesh), clock_.seconds() - spent_copying_});
    return std::move(levels_);
  }

 private:
  bool done() const { return levels_.size() == face_counts_.size(); }

  std::span<const std::size_t> face_counts_;
  std::vector<Level> levels_;
  Clock clock_;
  Seconds spent_copying_;
};

/// CGAL's stop predicate, asked before each collapse.
struct StopAfterLast {
  Snapshots* snapshots;
  template <class Cost, class Profile>
  bool operator()(const Cost&, const Profile& profile, std::size_t, std::size_t) const {
    return snapshots->offer(profile.surface_mesh());
  }
};

/// Lindstrom–Turk's cost with the better of an edge's end points, of those that turn no face by more than 90°.
class BetterEndPoint {
 public:
  template <class Profile>
  Optional<typename Profile::Point> operator()(const Profile& profile) const {
    using Point = Optional<typename Profile::Point>;
    const sms::LindstromTurk_cost<SurfaceMesh> cost;
    const sms::Bounded_normal_change_filter<> filter;
    const Point p0 = filter(profile, Point(profile.p0()));
    const Point p1 = filter(profile, Point(profile.p1()));
    if (!p0 || !p1) return p0 ? p0 : p1;
    const auto cost0 = cost(profile, p0);
    const auto cost1 = cost(profile, p1);
    if (!cost0 || !cost1) return cost0 ? p0 : p1;
    return *cost1 < *cost0 ? p1 : p0;
  }
};

template <class Parameters>
std::vector<Level> collapse(SurfaceMesh& mesh, Snapshots& snapshots, const Parameters& parameters) {
  sms::edge_collapse(mesh, StopAfterLast{&snapshots}, parameters);
  return snapshots.finish(mesh);
}

}  // namespace

std::vector<Level> run_cgal_lindstrom_turk(const Mesh& mesh, std::span<const std::size_t> face_counts) {
  SurfaceMesh copy = to_cgal(mesh);
  Snapshots snapshots(face_counts);
  return collapse(
      copy, snapshots,
      np::get_cost(sms::LindstromTurk_cost<SurfaceMesh>()).get_placement(sms::LindstromTurk_placement<SurfaceMesh>()));
}

std::vector<Level> run_cgal_lindstrom_turk_end_points(const Mesh& mesh, std::span<const std::size_t> face_counts) {
  SurfaceMesh copy = to_cgal(mesh);
  Snapshots snapshots(face_counts);
  return collapse(copy, snapshots,
                  np::get_cost(sms::LindstromTurk_cost<SurfaceMesh>()).get_placement(BetterEndPoint()));
}

#ifdef LODESTONE_BENCH_EIGEN
std::vector<Level> run_cgal_garland_heckbert(const Mesh& mesh, std::span<const std::size_t> face_counts) {
  SurfaceMesh copy = to_cgal(mesh);
  Snapshots snapshots(face_counts);
  const sms::GarlandHeckbert_plane_policies<SurfaceMesh, Kernel> policies(copy);
  return collapse(copy, snapshots,
                  np::get_cost(policies.get_cost())
                      .filter(sms::Bounded_normal_change_filter<>())
                      .get_placement(policies.get_placement()));
}
#endif

}  // namespace lodestone::bench
