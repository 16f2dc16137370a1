// Propagates winding from face to face, as CGAL's orient_polygon_soup and MeshLab do. Departures: what winds alike
// already is visited as a whole, so that it stays together; from there on breadth first, so that a surface of one side,
// such as a Möbius strip, is left cut along a short line.

#include "winding.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <utility>
#include <vector>

#include "overlap.h"

namespace lodestone::detail {
namespace {

// Of a region's faces, so many decide alone which side is its front. Fewer may be chance, or sides of a solid that were
// each right in themselves.
constexpr double kClearMajority = 0.9;

// A region has an outside where it encloses more than this share of its area to the power 1.5 (a ball: 0.094).
constexpr double kClosedVolume = 1e-6;  // rounding
constexpr double kOpenVolume = 0.01;    // hills

/// Returns for each face whether its normals look where it faces: 1, or away from there: −1; 0 where that is unknown.
std::vector<std::int8_t> sides_of_normals(const Mesh& mesh) {
  std::vector<std::int8_t> sides(mesh.face_count(), 0);
  const auto normals = std::find_if(mesh.attributes.begin(), mesh.attributes.end(),
                                    [](const Attribute& a) { return a.name == "NORMAL" && a.component_count == 3; });
  if (normals == mesh.attributes.end()) return sides;
  const std::vector<float> values = attribute_values(*normals);
  for (Index face = 0; face < sides.size(); ++face) {
    Vec3 sum;
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
      const float* n = &values[3 * std::size_t{mesh.corner_wedge[corner]}];
      sum += Vec3(n[0], n[1], n[2]);
    }
    const double along = dot(sum, area_vector(mesh, face));
    sides[face] = static_cast<std::int8_t>(along > 0 ? 1 : along < 0 ? -1 : 0);
  }
  return sides;
}

class WindingFinder {
 public:
  WindingFinder(const Mesh& mesh, std::span<const HalfEdge> halves);

  /// Returns the faces to be turned.
  std::vector<Index> run();

 private:
  enum class State : std::uint8_t { Unseen, AsFirst, Turned };  // beside the region's first face

  void join(const HalfEdge& a, const HalfEdge& b, const std::vector<bool>& crowded);
  bool wind_alike(Index corner) const { return mesh_.corner_vertex(corner) != mesh_.corner_vertex(across_[corner]); }
  void gather(Index first);
  void gather_alike(Index face, State state);
  bool is_closed() const;
  double volume_share() const;
  bool first_is_front() const;

  const Mesh& mesh_;
  std::vector<Index> across_;  // by corner: the same edge in the neighbour; kNoIndex where there is none
  std::vector<std::int8_t> sides_;
  std::vector<State> state_;
  std::vector<Index> region_;
  std::vector<std::pair<Index, State>> queue_;
};

WindingFinder::WindingFinder(const Mesh& mesh, std::span<const HalfEdge> halves)
    : mesh_(mesh),
      across_(mesh.corner_wedge.size(), kNoIndex),
      sides_(sides_of_normals(mesh)),
      state_(mesh.face_count(), State::Unseen) {
  std::vector<bool> crowded(mesh.vertex_count(), false);
  for_each_edge(halves, [&](Edge edge) {
    if (edge.size() < 3) return;
    crowded[mesh.corner_vertex(edge[0].corner)] = crowded[mesh.corner_vertex(next_corner(edge[0].corner))] = true;
  });
  for_each_edge(halves, [&](Edge edge) {
    if (edge.size() == 2) join(edge[0], edge[1], crowded);
  });
}

/// Two that lie on one another are two sheets that end there, if there is more than one sheet beside them.
void WindingFinder::join(const HalfEdge& a, const HalfEdge& b, const std::vector<bool>& crowded) {
  if (a.forward == b.forward) {
    const bool both_right = sides_[face_of_corner(a.corner)] > 0 && sides_[face_of_corner(b.corner)] > 0;
    const bool among_sheets =
        crowded[mesh_.corner_vertex(a.corner)] || crowded[mesh_.corner_vertex(next_corner(a.corner))];
    const bool same_place =
        mesh_.corner_vertex(previous_corner(a.corner)) == mesh_.corner_vertex(previous_corner(b.corner));
    if (both_right || same_place || (among_sheets && overlap(mesh_, a.corner, b.corner) > kLayered)) return;
  }
  across_[a.corner] = b.corner;
  across_[b.corner] = a.corner;
}

std::vector<Index> WindingFinder::run() {
  std::vector<Index> turned;
  for (Index face = 0; face < state_.size(); ++face) {
    if (state_[face] != State::Unseen) continue;
    gather(face);
    const auto winds = [&](State state) { return [&, state](Index f) { return state_[f] == state; }; };
    if (std::none_of(region_.begin(), region_.end(), winds(State::Turned))) continue;
    const State back = first_is_front() ? State::Turned : State::AsFirst;
    std::copy_if(region_.begin(), region_.end(), std::back_inserter(turned), winds(back));
  }
  return turned;
}

/// Collects a region, what winds alike at a time.
void WindingFinder::gather(Index first) {
  region_.clear();
  queue_.assign(1, {first, State::AsFirst});
  for (std::size_t i = 0; i < queue_.size(); ++i) {
    const auto [face, state] = queue_[i];
    if (state_[face] == State::Unseen) gather_alike(face, state);
  }
}

/// Collects what winds as `face` does and hangs together with it; queues the neighbours that wind the other way.
void WindingFinder::gather_alike(Index face, State state) {
  const State other = state == State::Turned ? State::AsFirst : State::Turned;
  std::size_t next = region_.size();
  region_.push_back(face);
  state_[face] = state;
  for (; next < region_.size(); ++next)
    for (Index corner = 3 * region_[next]; corner < 3 * region_[next] + 3; ++corner) {
      if (across_[corner] == kNoIndex) continue;
      const Index neighbour = face_of_corner(across_[corner]);
      if (state_[neighbour] != State::Unseen) continue;
      if (wind_alike(corner)) {
        region_.push_back(neighbour);
        state_[neighbour] = state;
      } else {
        queue_.emplace_back(neighbour, other);
      }
    }
}

/// Whether the region has no border, once it winds as it will.
bool WindingFinder::is_closed() const {
  return std::all_of(region_.begin(), region_.end(), [&](Index face) {
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) {
      if (across_[corner] == kNoIndex) return false;
      const bool turned_alike = state_[face] == state_[face_of_corner(across_[corner])];
      if (turned_alike != wind_alike(corner)) return false;
    }
    return true;
  });
}

/// The volume under the region, as its first face winds, about the middle of its corners, over its area to the
/// power 1.5.
double WindingFinder::volume_share() const {
  Vec3 middle;
  for (const Index face : region_)
    for (Index corner = 3 * face; corner < 3 * face + 3; ++corner) middle += mesh_.corner_position(corner);
  middle = middle * (1.0 / (3 * static_cast<double>(region_.size())));
  double volume = 0, area = 0;
  for (const Index face : region_) {
    const Vec3 normal = area_vector(mesh_, face);
    const double pyramid = dot(mesh_.corner_position(3 * face) - middle, normal) / 6;
    volume += state_[face] == State::AsFirst ? pyramid : -pyramid;
    area += length(normal) / 2;
  }
  return area > 0 ? volume / (area * std::sqrt(area)) : 0;
}

bool WindingFinder::first_is_front() const {
  std::int64_t of_normals = 0, of_faces = 0;
  for (const Index face : region_) {
    const int sign = state_[face] == State::AsFirst ? 1 : -1;
    of_normals += sign * sides_[face];
    of_faces += sign;
  }
  if (of_normals != 0) return of_normals > 0;
  const double majority = (1 + std::abs(static_cast<double>(of_faces)) / static_cast<double>(region_.size())) / 2;
  if (majority >= kClearMajority) return of_faces > 0;
  const double outwards = volume_share();
  if (std::abs(outwards) > (is_closed() ? kClosedVolume : kOpenVolume)) return outwards > 0;
  return of_faces >= 0;
}

}  // namespace

std::size_t make_winding_coherent(Mesh& mesh, std::span<const HalfEdge> halves) {
  bool some_disagree = false;
  for_each_edge(halves, [&](Edge edge) { some_disagree |= edge.size() == 2 && edge[0].forward == edge[1].forward; });
  if (!some_disagree) return 0;
  const std::vector<Index> turned = WindingFinder(mesh, halves).run();
  for (const Index face : turned) std::swap(mesh.corner_wedge[3 * face + 1], mesh.corner_wedge[3 * face + 2]);
  return turned.size();
}

}  // namespace lodestone::detail
