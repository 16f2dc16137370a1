#include "fit/edge_turns.h"

#include <algorithm>
#include <array>
#include <vector>

#include <lodestone/core/detail/edges.h>
#include <lodestone/core/detail/grouping.h>
#include <lodestone/core/detail/texture_areas.h>

#include "distance/point_triangle.h"

// Edge swaps that lower the fit's energy, as in Hoppe, DeRose, Duchamp, McDonald, Stuetzle: Mesh optimization (SIGGRAPH
// 1993). Departures: edges are tried once, in order, rather than at random; vertices stay where they are meanwhile; and
// sheets that lie on one another turn together.

namespace lodestone::detail {
namespace {

constexpr double kGain = 0.98;  // turned where the samples' sum falls below this share
constexpr double kStays = 3;    // not tried again where it would be larger than this share

class EdgeTurner {
 public:
  EdgeTurner(Mesh& mesh, std::span<MeshEdge> edges, std::span<SurfaceSample> samples, SampleNorm norm,
             const OriginalGuard& guard, std::span<const std::uint8_t> fixed)
      : mesh_(mesh),
        edges_(edges),
        norm_(norm),
        guard_(guard),
        samples_(samples),
        samples_of_face_(mesh.face_count(), samples.size(), [&](Index i) { return samples[i].face; }),
        textures_(mesh),
        fixed_(fixed),
        error_(mesh.face_count(), 0) {
    for (const SurfaceSample& sample : samples)
      error_[sample.face] += sample.weight * norm.error(sample.squared_distance);
  }

  std::size_t run() {
    std::size_t count = 0;
    for (Index f = 0; f < mesh_.face_count(); ++f) taken_.push_back(is_fixed(f) ? 1 : 0);
    for (MeshEdge& edge : edges_) count += !edge.constrained && !edge.stays && turn(edge) ? 1 : 0;
    for (MeshEdge& edge : edges_)
      edge.stays = edge.stays && std::none_of(edge.corners.begin(), edge.corners.end(),
                                              [&](Index corner) { return taken_[face_of_corner(corner)] != 0; });
    return count;
  }

 private:
  /// The two faces as (a, b, c) and (b, a, d): they become (a, d, c) and (d, b, c).
  struct Quad {
    std::array<Index, 2> face;
    Index a, b, c, d;  // wedges
  };

  Quad quad_at(const std::array<Index, 2>& corners) const {
    const auto wedge = [&](Index corner) { return mesh_.corner_wedge[corner]; };
    return {{face_of_corner(corners[0]), face_of_corner(corners[1])},
            wedge(next_corner(corners[0])),
            wedge(previous_corner(corners[0])),
            wedge(corners[0]),
            wedge(corners[1])};
  }

  /// Turns the edge in all sheets that lie on one another, or in none.
  bool turn(MeshEdge& edge) {
    quads_.assign(1, quad_at(edge.corners));
    for (const auto& corners : edge.layers) quads_.push_back(quad_at(corners));
    const Quad& quad = quads_.front();
    const auto is_taken = [&](const Quad& q) { return taken_[q.face[0]] != 0 || taken_[q.face[1]] != 0; };
    if (std::any_of(quads_.begin(), quads_.end(), is_taken)) return false;
    const auto turns = [&](const Quad& q) { return turns_texture(q); };
    if (!keeps_shape(quad) || std::any_of(quads_.begin(), quads_.end(), turns)) return false;
    if (!is_nearer(edge.stays) || has_edge(quad.c, quad.d) || !is_let_pass(quad)) return false;
    for (const Quad& q : quads_) {
      for (std::size_t i = 0; i < 2; ++i) taken_[q.face[i]] = 1;
      set_face(q.face[0], {q.a, q.d, q.c});
      set_face(q.face[1], {q.d, q.b, q.c});
      for (const Index face : q.face)
        for (const Index i : samples_of_face_[face]) place(samples_[i], q);
    }
    added_.push_back(edge_key(vertex(quad.c), vertex(quad.d)));
    return true;
  }

  void place(SurfaceSample& sample, const Quad& quad) const {
    SurfaceSample other = sample;
    sample.place_on(mesh_, quad.face[0]);
    other.place_on(mesh_, quad.face[1]);
    if (other.squared_distance < sample.squared_distance) sample = other;
  }

  bool is_fixed(Index face) const {
    const auto stays = [&](Index corner) { return fixed_[mesh_.corner_vertex(corner)] != 0; };
    return stays(3 * face) && stays(3 * face + 1) && stays(3 * face + 2);
  }

  Index vertex(Index wedge) const { return mesh_.wedge_vertex[wedge]; }
  Vec3 position(Index wedge) const { return Vec3(mesh_.positions[vertex(wedge)]); }
  void set_face(Index face, const std::array<Index, 3>& wedges) {
    std::copy(wedges.begin(), wedges.end(), mesh_.corner_wedge.begin() + 3 * std::ptrdiff_t{face});
  }

  /// Edges that were there at the start count even where they have been turned since: the next pass may use their
  /// place.
  bool has_edge(Index c, Index d) const {
    if (vertex(c) == vertex(d)) return true;
    const std::uint64_t wanted = edge_key(vertex(c), vertex(d));
    const auto found = std::lower_bound(edges_.begin(), edges_.end(), wanted,
                                        [](const MeshEdge& edge, std::uint64_t key) { return key_of(edge) < key; });
    return (found != edges_.end() && key_of(*found) == wanted) ||
           std::find(added_.begin(), added_.end(), wanted) != added_.end();
  }
  static std::uint64_t key_of(const MeshEdge& edge) { return edge_key(edge.vertices[0], edge.vertices[1]); }

  bool keeps_shape(const Quad& q) const {
    const Vec3 a = position(q.a), b = position(q.b), c = position(q.c), d = position(q.d);
    const Vec3 before = normalized(cross(b - a, c - a)) + normalized(cross(a - b, d - b));
    return is_upright(a, d, c, before) && is_upright(d, b, c, before);
  }

  bool turns_texture(const Quad& q) const {
    for (std::size_t t = 0; t < textures_.count(); ++t) {
      const double before = textures_.area(t, q.a, q.b, q.c) + textures_.area(t, q.b, q.a, q.d);
      if (before * textures_.area(t, q.a, q.d, q.c) < 0 || before * textures_.area(t, q.d, q.b, q.c) < 0) return true;
    }
    return false;
  }

  /// Whether the samples on the edge's faces would be nearer to the new ones; `stays`: they would be far from it.
  bool is_nearer(bool& stays) {
    const Quad& q = quads_.front();
    gather_samples(position(q.a));
    const Vec3 origin = position(q.a), a = Vec3(), b = position(q.b) - origin, c = position(q.c) - origin,
               d = position(q.d) - origin;
    for (std::vector<float>& squared : squared_distances_) squared.resize(points_.padded_size());
    squared_distances(points_, {a, d, c}, squared_distances_[0].data());
    squared_distances(points_, {d, b, c}, squared_distances_[1].data());
    const double before = error_before();
    double after = 0;
    for (std::size_t i = 0; i < points_.size() && after <= kStays * before; ++i)
      after += weights_[i] * norm_.error(double{std::min(squared_distances_[0][i], squared_distances_[1][i])});
    stays = after > kStays * before;
    return after < kGain * before;
  }

  void gather_samples(const Vec3& origin) {
    points_.clear();
    weights_.clear();
    for (const Quad& layer : quads_)
      for (const Index face : layer.face)
        for (const Index i : samples_of_face_[face]) {
          points_.add(samples_[i].position - origin);
          weights_.push_back(samples_[i].weight);
        }
  }

  double error_before() const {
    double sum = 0;
    for (const Quad& layer : quads_)
      for (const Index face : layer.face) sum += error_[face];
    return sum;
  }

  bool is_let_pass(const Quad& q) const {
    const Vec3 a = position(q.a), b = position(q.b), c = position(q.c), d = position(q.d);
    return guard_.lets_pass({{{a, d, c}, {d, b, c}}}, {{{a, b, c}, {b, a, d}}}, q.face);
  }

  Mesh& mesh_;
  std::span<MeshEdge> edges_;
  SampleNorm norm_;
  const OriginalGuard& guard_;
  std::span<SurfaceSample> samples_;
  Grouping samples_of_face_;
  TextureAreas textures_;
  std::span<const std::uint8_t> fixed_;  // by vertex
  std::vector<std::uint8_t> taken_;      // by face
  std::vector<std::uint64_t> added_;     // by their keys
  std::vector<double> error_;            // by face, of its samples as they were at the start
  // Of the edge looked at:
  std::vector<Quad> quads_;  // one in each sheet
  PointBatch points_;        // the samples on its faces, from one of its vertices
  std::vector<double> weights_;
  std::array<std::vector<float>, 2> squared_distances_;  // of the points from the new faces
};

}  // namespace

std::size_t turn_edges(Mesh& mesh, std::span<MeshEdge> edges, std::span<SurfaceSample> samples, SampleNorm norm,
                       const OriginalGuard& guard, std::span<const std::uint8_t> fixed) {
  return EdgeTurner(mesh, edges, samples, norm, guard, fixed).run();
}

}  // namespace lodestone::detail
