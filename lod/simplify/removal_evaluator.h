#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/curvature.h>
#include <lodestone/core/detail/grouping.h>
#include <lodestone/core/removal.h>
#include <lodestone/core/triangulation.h>
#include <lodestone/lod/simplify_options.h>

#include "distance/point_triangle.h"
#include "simplify/attribute_cost.h"
#include "simplify/plain_evaluator.h"
#include "simplify/polygon_fills.h"
#include "simplify/removal_cost.h"
#include "simplify/removal_rules.h"
#include "simplify/simplify_state.h"
#include "simplify/star_points.h"

namespace lodestone::detail {

/// Larger rings wait until their neighbours' removals have shrunk them.
inline constexpr std::size_t kMaxRing = 250;

/// Takes over a trial that is better than the best so far; where none is legal yet, why this one is not.
bool take_better(Evaluation& best, const Evaluation& found);

/// A removal as evaluated: a record for the vertex, and one for each of its copies.
using Removal = std::vector<RemovalRecord>;

/// Finds the best way to remove a vertex, and what it costs.
///
/// Interior vertices and those on a line leave a hole that is retriangulated. Corners move to a neighbour. The copies
/// of a vertex that was cut into sheets go together: where the sheets coincide their holes are filled alike, elsewhere
/// all move to one place.
///
/// Keeps scratch memory of one star: one object for each thread.
class RemovalEvaluator {
 public:
  /// All outlive the object. Without the short path plain stars are evaluated as all others are: the same, slower.
  RemovalEvaluator(const SimplifyState& state, const SimplifyOptions& options, const AttributeCost& attributes,
                   const FaceRules& rules, bool short_path = true);

  /// Evaluates a removal; of several copies `vertex` is the first. `choice` names what was chosen.
  Evaluation evaluate(Index vertex, Choice& choice);

  /// Describes a removal that was evaluated, where it is still legal: `removal` holds the records with the triangles
  /// chosen, `curvature` K̄ of the polygon's vertices after it, or nothing. Where the choice is still admissible, no
  /// other is tried. The evaluation's cost may be left out.
  Evaluation describe(Index vertex, Choice& choice, Removal& removal, std::vector<double>& curvature);

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
    std::size_t target = 0;      // the ring number of a moved sector's last corner
    FaceRules::Replaced faces;
    Vec3 entry_normal;  // of the triangle chosen at the edge shared with the sector before
    Vec3 exit_normal;   // and with the sector after; the same for an open sector
    AttributeScale scale;
    std::size_t size() const { return patch->polygon.size(); }
    bool is_moved() const { return patch->shape == SectorShape::Moved; }
  };
  /// A border or feature line that a removal moves: it then runs straight between two ring vertices.
  struct Line {
    std::size_t from = 0;  // ring numbers
    std::size_t to = 0;
    double weight = 1;
    bool carries_from = true;  // whether it takes over what the line to `from` stood for
  };
  bool measures_distances() const { return fully_ranked_ > 0; }
  using Triangles = std::span<const PolygonTriangle>;
  // How an edge joins two ring vertices: in the sheet looked at, or in another.
  static constexpr std::uint8_t kLinkedHere = 1;
  static constexpr std::uint8_t kLinkedElsewhere = 2;
  bool gather_plain(Index vertex);
  Evaluation evaluate_star(Index vertex, Removal& removal, Choice& choice);
  Evaluation evaluate_hole(RemovalRecord& record, Choice& choice);
  Evaluation evaluate_corner(RemovalRecord& record, Choice& choice);
  Evaluation evaluate_copies(Index vertex, Removal& removal, Choice& choice);
  Evaluation evaluate_layers(Index vertex, Removal& removal, Choice& choice);
  Evaluation evaluate_layer(const RemovalRecord& filled, RemovalRecord& record);
  Evaluation evaluate_copies_at(Index vertex, Index target_site, Removal& removal);
  Evaluation evaluate_collapse(std::size_t target, RemovalRecord& record);

  Verdict gather(Index vertex);
  void gather_ring();
  void gather_normals();
  bool gather_links(Index vertex);
  bool falls_onto_face(std::size_t target) const;
  bool copy_triangles(const RemovalRecord& filled, SectorPatch& patch);
  Index widest_copy(Index vertex);
  void gather_shared_ends(Index vertex, Index target_site);
  void pass_shared_ends(std::size_t target);
  void gather_points(const Sector& sector);
  void gather_outside_curvature();
  bool is_target(std::size_t spoke) const;
  bool is_constrained_spoke(std::size_t spoke) const;
  double line_weight(std::size_t spoke) const;
  Index best_wedge(Index vertex, Index like) const;

  void take_sectors(RemovalRecord& record, std::size_t target);
  void take_lines(std::size_t target);
  AttributeScale attribute_scale(const SectorPatch& patch, std::size_t ring_begin) const;
  Verdict check_closing_edge() const;
  Verdict check_target(std::size_t target) const;
  Verdict fill_with_fan(Sector& sector, SectorPatch& patch, std::size_t target);
  Verdict judge_filled(Sector& sector, const SectorPatch& patch);
  Verdict choose(Sector& sector, SectorPatch& patch, std::uint8_t& choice);
  Triangles candidate(const Sector& sector, int which);
  Triangles least_volume(const Sector& sector);
  Verdict list_admissible(const Sector& sector);
  int best_by_distance(const Sector& sector);
  int best_by_curvature(Sector& sector);
  double tie_break(double squared_volume) const;
  void reset_triangles(std::size_t size);
  Triangle& triangle(const Sector& sector, PolygonTriangle t);
  Verdict judge(const Sector& sector, PolygonTriangle t, const Triangle& triangle) const;
  Verdict judge(const Sector& sector, Triangles triangles);
  void gather_faces(Sector& sector) const;
  double squared_volume_sum(const Sector& sector, Triangles triangles);
  void measure_distances(const Sector& sector, PolygonTriangle t, Triangle& triangle);
  double added_squared_distance(const Sector& sector, Triangles triangles);

  double curvature_change(Sector& sector, Triangles triangles);
  void add_coarse_curvature(Sector& sector, Triangles triangles);
  void add_closing_curvature();
  double largest_change() const;
  double bridge_sum(const Sector& sector, Triangles triangles);
  double line_cost(Index vertex) const;
  double squared_attribute_difference(const Sector& sector, Triangles triangles) const;
  Evaluation combine(const RemovalRecord& record);

  std::size_t ring_size() const { return ring_position_.size(); }
  std::size_t ring_number(const Sector& sector, std::size_t corner) const {
    if (sector.is_moved() && corner + 1 == sector.size()) return sector.target;
    return (sector.ring_begin + corner) % ring_size();
  }
  const Vec3& position(const Sector& sector, std::size_t corner) const {
    return ring_position_[ring_number(sector, corner)];
  }
  bool is_rim(const Sector& sector, std::size_t from, std::size_t to) const {
    const bool wraps = sector.patch->shape == SectorShape::Closed && to == 0 && from + 1 == sector.size();
    return wraps || (to == from + 1 && !(sector.is_moved() && to + 1 == sector.size()));
  }
  bool is_entry(const Sector& sector, std::size_t from, std::size_t to) const {
    return sector.patch->shape != SectorShape::Closed && to == 0 && from + 1 == sector.size();
  }
  bool is_exit(const Sector& sector, std::size_t from, std::size_t to) const {
    return sector.is_moved() ? to == from + 1 && to + 1 == sector.size() : is_entry(sector, from, to);
  }
  bool linked(std::size_t a, std::size_t b) const { return linked_[a * ring_size() + b] != 0; }

  const SimplifyState* state_;
  const SimplifyOptions* options_;
  const AttributeCost* attributes_;
  const FaceRules* rules_;
  PlainEvaluator plain_;
  bool takes_short_path_ = false;  // where the star is plain
  Removal scratch_;
  Grouping wedges_;               // by vertex; empty without seams
  std::size_t fully_ranked_ = 0;  // triangulations by the distances of all points; 0: by volume alone
  bool needs_angles_ = false;
  bool needs_dihedrals_ = false;
  double tie_scale_ = 1;

  Star star_;
  Vec3 center_;
  std::vector<Sector> sectors_;
  std::vector<Line> lines_;
  std::vector<Index> ring_vertex_;
  std::vector<Vec3> ring_position_;
  std::vector<Index> fine_corner_;           // the star's corners at the vertex, in ring order
  std::vector<Vec3> fine_normal_;            // of the star's faces
  std::vector<std::uint8_t> has_direction_;  // whether that of a fine face is more than rounding
  std::vector<Vec3> outer_normal_;           // of the faces beyond the rim; unset at a border
  // Whether a face beyond the rim stays: there is one, and it is not in another copy's star.
  std::vector<std::uint8_t> has_outer_;
  std::vector<std::uint8_t> bends_;  // whether the angle at the rim is curvature: there is a face beyond, and no crease
  std::vector<VertexCurvature> outside_;  // the ring's curvature without the star
  std::vector<VertexCurvature> after_;    // and with a retriangulation
  std::vector<std::uint8_t> linked_;      // which ring vertices an edge joins, and in which sheets
  std::vector<Index> shared_ends_;        // sites, sorted: see gather_shared_ends
  std::vector<Index> ring_of_site_;       // by vertex, the first of its copies; kNoIndex outside the ring
  StarPoints points_;                     // of the sector
  PointBatch bridge_;                     // points of new faces
  std::vector<float> nearest_;
  std::vector<float> distance_;
  std::vector<Triangle> table_;
  Triangle untabulated_;
  std::vector<std::pair<double, int>> ranked_;
  PolygonFills fills_;
  RemovalRecord trial_;
  Removal trial_copies_;
  std::vector<Vec3> edge_normal_;  // of coarse faces, by directed polygon edge
  std::vector<std::uint8_t> has_edge_normal_;
};

}  // namespace lodestone::detail
