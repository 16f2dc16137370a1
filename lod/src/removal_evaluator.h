#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/curvature.h>
#include <lodestone/core/removal.h>
#include <lodestone/core/triangulation.h>
#include <lodestone/lod/simplify.h>

#include "point_triangle.h"
#include "simplify_state.h"

namespace lodestone::detail {

/// Larger rings wait until their neighbours' removals have shrunk them.
inline constexpr std::size_t kMaxRing = 64;

/// What the evaluation of a removal found.
enum class Verdict : std::uint8_t { Legal, Locked, Flip, Link, Ring };

/// Which triangulation each sector of a star was given, for evaluating it again.
using Choice = std::array<std::uint8_t, 2>;
inline constexpr std::uint8_t kNoChoice = 255;

struct Evaluation {
  Verdict verdict = Verdict::Locked;
  double cost = 0;             ///< orders removals; for the pure curvature metrics it is the curvature error
  double curvature_error = 0;  ///< ε, in the metric's own unit
};

/// Finds the best retriangulation for the removal of a vertex, and what it costs.
///
/// Keeps scratch memory of one star: one object for each thread.
class RemovalEvaluator {
 public:
  RemovalEvaluator(const SimplifyState& state, const SimplifyOptions& options);

  /// Evaluates a removal. Where it is legal, `record` holds the sectors with the triangles chosen.
  /// `choice` names the triangulations chosen; where it comes with a choice that is still admissible, no other is
  /// tried.
  Evaluation evaluate(Index vertex, RemovalRecord& record, Choice& choice);

 private:
  /// A triangle of ring corners; its parts are computed when first asked for.
  struct Triangle {
    Vec3 normal;        // twice the area long
    double volume = 0;  // of the tetrahedron with the removed vertex
    Verdict verdict = Verdict::Legal;
    bool known = false;
    bool has_distances = false;
    bool has_angles = false;
    std::array<double, 3> angle{};
    std::vector<float> squared_distance;  // of each carried point of the sector
  };
  /// A sector of the star, in ring terms.
  struct Sector {
    const SectorPatch* patch = nullptr;
    std::size_t ring_begin = 0;  // the ring number of polygon corner 0, and of the first face
    Vec3 normal;                 // sum of its faces' normals
    Vec3 closing_normal;         // of the triangle chosen at the closing edge
    std::size_t size() const { return patch->polygon.size(); }
  };
  using Triangles = std::span<const PolygonTriangle>;

  Verdict gather(Index vertex, RemovalRecord& record);
  void gather_ring(const RemovalRecord& record);
  void gather_normals(const RemovalRecord& record);
  bool gather_links(Index vertex);
  void gather_points(const Sector& sector);
  void gather_outside_curvature();

  Verdict check_closing_edge() const;
  Verdict choose(Sector& sector, SectorPatch& patch, std::uint8_t& choice);
  Triangles candidate(const Sector& sector, int which);
  Verdict list_admissible(const Sector& sector);
  int best_by_distance(const Sector& sector);
  int best_by_curvature(Sector& sector);
  double tie_break(double squared_volume) const;
  void reset_triangles(std::size_t size);
  Triangle& triangle(const Sector& sector, PolygonTriangle t);
  Verdict judge(const Sector& sector, PolygonTriangle t, const Triangle& triangle) const;
  Verdict judge(const Sector& sector, Triangles triangles);
  double squared_volume_sum(const Sector& sector, Triangles triangles);
  void measure_distances(const Sector& sector, PolygonTriangle t, Triangle& triangle);
  double squared_distance_sum(const Sector& sector, Triangles triangles);

  double curvature_change(Sector& sector, Triangles triangles);
  void add_coarse_curvature(Sector& sector, Triangles triangles);
  void add_closing_curvature();
  double largest_change() const;
  double bridge_sum(const Sector& sector, Triangles triangles);
  double line_cost(Index vertex) const;
  Evaluation combine(Index vertex, const RemovalRecord& record);

  std::size_t ring_size() const { return ring_position_.size(); }
  std::size_t ring_number(const Sector& sector, std::size_t corner) const {
    return (sector.ring_begin + corner) % ring_size();
  }
  const Vec3& position(const Sector& sector, std::size_t corner) const {
    return ring_position_[ring_number(sector, corner)];
  }
  bool is_rim(const Sector& sector, std::size_t from, std::size_t to) const {
    return to == from + 1 || (sector.patch->closed && to == 0 && from + 1 == sector.size());
  }
  bool linked(std::size_t a, std::size_t b) const { return linked_[a * ring_size() + b] != 0; }

  const SimplifyState* state_;
  const SimplifyOptions* options_;
  bool needs_angles_ = false;
  bool needs_dihedrals_ = false;
  double tie_scale_ = 1;

  Star star_;
  Vec3 center_;
  std::vector<Sector> sectors_;
  std::vector<Index> ring_vertex_;
  std::vector<Vec3> ring_position_;
  std::vector<Index> fine_corner_;  // the star's corners at the vertex, in ring order
  std::vector<Vec3> fine_normal_;   // of the star's faces
  std::vector<Vec3> outer_normal_;  // of the faces beyond the rim; unset at a border
  std::vector<std::uint8_t> has_outer_;
  std::vector<VertexCurvature> outside_;  // the ring's curvature without the star
  std::vector<VertexCurvature> after_;    // and with a retriangulation
  std::vector<std::uint8_t> linked_;      // which ring vertices an edge joins
  std::vector<Index> ring_of_vertex_;     // by vertex, kNoIndex outside the ring
  PointBatch points_;                     // the sector's carried points
  std::vector<float> weights_;            // of those points
  std::vector<float> nearest_;
  std::vector<float> distance_;
  std::vector<Triangle> table_;
  Triangle untabulated_;
  std::vector<std::pair<double, int>> ranked_;
  std::vector<PolygonTriangle> fan_;
  std::vector<Vec3> edge_normal_;  // of coarse faces, by directed polygon edge
  std::vector<std::uint8_t> has_edge_normal_;
};

}  // namespace lodestone::detail
