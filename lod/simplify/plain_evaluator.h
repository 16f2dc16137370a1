#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <lodestone/core/removal.h>
#include <lodestone/lod/simplify_options.h>

#include "simplify/attribute_cost.h"
#include "simplify/face_frames.h"
#include "simplify/filling_distances.h"
#include "simplify/plain_star.h"
#include "simplify/polygon_fills.h"
#include "simplify/removal_cost.h"
#include "simplify/simplify_state.h"
#include "simplify/star_points.h"

namespace lodestone::detail {

/// Finds the best way to fill the hole that a vertex with a plain star leaves, and what it costs, by the hybrid metric:
/// the short path of the great majority.
///
/// Fillings are ranked by the volume they sweep; only the best that are legal are looked at further. Of small rings all
/// fillings are ranked. Of larger ones the fans are, and the filling of least volume: with aᵢ the normals of the star's
/// faces, twice their area long, the fan of ring vertex u sweeps Σ (aᵢ·u)² / 36 in squared tetrahedra, since the two
/// faces beside u contribute nothing.
///
/// Keeps scratch memory of one star: one object for each thread.
class PlainEvaluator {
 public:
  /// All outlive the object.
  PlainEvaluator(const SimplifyState& state, const SimplifyOptions& options, const AttributeCost& attributes,
                 const FaceRules& rules);

  /// Looks at a vertex that is not one of several copies; false where its star is not plain.
  bool gather(Index vertex) { return star_.gather(state_->mesh, state_->connectivity, *rules_, vertex); }

  /// Evaluates the removal of the vertex gathered; `choice` names the best filling.
  Evaluation evaluate(Choice& choice);

  /// Describes the removal by a filling that was chosen, where it is (still) legal, and K̄ of the ring's vertices after
  /// it. The evaluation's cost is not worked out.
  Evaluation describe(const Choice& choice, RemovalRecord& record, std::vector<double>& curvature);

 private:
  using Triangles = std::span<const PolygonTriangle>;
  static constexpr std::size_t kMaxFillings = 42;  // of a ring of kMaxTabulatedPolygon
  struct Filling {
    double squared_volume = 0;
    std::uint8_t which = 0;
  };
  /// What is known of a triangle of ring vertices, by its number; stale where it is of another star.
  struct Judged {
    std::uint32_t star = 0;
    Verdict verdict = Verdict::Legal;
  };

  void start();
  void rank();
  void rank_all();
  void rank_fans();
  double squared_volume(PolygonTriangle t) const;
  Triangles filling(std::size_t which);
  Verdict judge(Triangles triangles);
  Verdict judge(PolygonTriangle t);
  Verdict judge_shape(PolygonTriangle t) const;
  bool is_rim(std::size_t from, std::size_t to) const { return star_.after(from) == to; }
  bool is_linked(std::size_t a, std::size_t b);
  Verdict choose_legal();
  Filling best_by_distance(Displacement& moved);
  double squared_distance(std::size_t filling);
  double bridge_sum(Triangles triangles);
  AttributeScale attribute_scale() const;
  double squared_attribute_difference(Triangles triangles) const;
  double curvature_error(Triangles triangles);

  const SimplifyState* state_;
  const AttributeCost* attributes_;
  const FaceRules* rules_;
  std::size_t measured_ = 0;  // fillings whose distances are looked at
  bool against_original_ = true;

  PlainStar star_;
  std::uint32_t star_number_ = 0;
  std::array<Filling, kMaxFillings> fillings_;
  std::size_t filling_count_ = 0;
  std::array<Filling, kMostMeasured> legal_;  // of least volume
  std::size_t legal_count_ = 0;
  std::array<Judged, triangle_count(PlainStar::kMaxSize)> judged_;
  PlainStar::Ring<std::uint32_t> linked_{};  // by ring vertex, see linked_ring
  std::uint32_t links_known_ = 0;            // by ring vertex
  PlainStar::Ring<double> curvature_after_{};
  PolygonFills fills_;
  std::vector<PolygonTriangle> least_volume_;  // the filling of a large ring
  AttributeScale scale_;
  StarPoints points_;
  FillingDistances distances_;
  FaceFrames star_frames_;
  PointBatch bridge_;  // points of new faces
  std::vector<float> nearest_;
  Star described_;
};

}  // namespace lodestone::detail
