// Cutting and stitching after Guéziec, Taubin, Lazarus, Horn: Cutting and stitching: converting sets of polygons to
// manifold surfaces (IEEE Transactions on Visualization and Computer Graphics 7, 2001): at an edge of many faces they
// are stitched in pairs again, so that what was drawn as a sheet is one. Which two belong together is told, in this
// order, by material, by wedges, by how flat they meet and, where sheets coincide, by what they are joined to
// elsewhere.

#include "fans.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <map>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include <lodestone/core/detail/hash_index.h>
#include <lodestone/core/union_find.h>

#include "overlap.h"

namespace lodestone::detail {
namespace {

/// Finds out which two faces are neighbours in a sheet, at every edge. Two that lie back to back never are.
class SheetFinder {
 public:
  SheetFinder(const Mesh& mesh, std::span<const HalfEdge> halves);

  std::size_t nonmanifold_edges() const { return nonmanifold_edges_; }
  /// The same edge in the neighbour, named by the corner that it leaves there; kNoIndex where there is none.
  Index across(Index corner) const { return across_[corner]; }
  /// Whether several sheets lie at some edge of the vertex.
  bool is_layered(Index vertex) const { return layered_[vertex] != 0; }
  bool any_layered() const { return any_layered_; }
  void cut(Index corner) { across_[std::exchange(across_[corner], kNoIndex)] = kNoIndex; }

 private:
  /// Two half-edges that may be joined, and what speaks against it.
  struct Match {
    Index a = kNoIndex;
    Index b = kNoIndex;
    int materials_apart = 0;
    int wedges_apart = 0;
    double overlap = 0;
    int sheets_apart = 0;
    int rank_apart = 0;  // sheets that stand in a file one after the other have their faces in the same order

    auto clear_signs() const { return std::tie(materials_apart, wedges_apart, overlap); }
    auto order() const { return std::tie(materials_apart, wedges_apart, overlap, sheets_apart, rank_apart, a, b); }
  };

  Index apex(Index corner) const { return mesh_.corner_vertex(previous_corner(corner)); }
  bool may_join(const HalfEdge& a, const HalfEdge& b) const {
    return a.forward != b.forward && apex(a.corner) != apex(b.corner);
  }
  bool is_layered(Edge edge) const;
  void join(Index a, Index b);
  void cut_folds();
  void join_layers(std::span<const Edge> edges);
  bool lies_on(Index a, Index b) const;
  Match match(Index a, Index b, int rank_apart);
  std::vector<Match> list_matches(Edge edge);
  bool is_clear(const std::vector<Match>& matches) const;
  void join_best(Edge edge);

  const Mesh& mesh_;
  std::vector<Index> across_;          // by corner
  std::vector<std::uint8_t> layered_;  // by vertex
  bool any_layered_ = false;
  UnionFind sheets_;  // of faces
  std::size_t nonmanifold_edges_ = 0;
};

SheetFinder::SheetFinder(const Mesh& mesh, std::span<const HalfEdge> halves)
    : mesh_(mesh),
      across_(mesh.corner_wedge.size(), kNoIndex),
      layered_(mesh.vertex_count(), 0),
      sheets_(mesh.face_count()) {
  std::vector<Edge> crowded;
  for_each_edge(halves, [&](Edge edge) {
    const bool agree = edge.size() == 2 && edge[0].forward != edge[1].forward;
    if (edge.size() > 1 && !agree) ++nonmanifold_edges_;
    if (edge.size() == 2 && may_join(edge[0], edge[1])) join(edge[0].corner, edge[1].corner);
    if (edge.size() > 2 && edge.size() <= kMostFacesAtEdge) crowded.push_back(edge);
  });
  std::erase_if(crowded, [&](Edge edge) { return !is_layered(edge); });
  for (const Edge edge : crowded)
    for (const Index c : {edge[0].corner, next_corner(edge[0].corner)}) layered_[mesh.corner_vertex(c)] = 1;
  any_layered_ = !crowded.empty();
  if (!any_layered_) return;
  cut_folds();
  join_layers(crowded);
}

/// Cuts where sheets lie on one another and a face is folded back onto its neighbour: that is the border of both
/// sheets.
void SheetFinder::cut_folds() {
  for (Index c = 0; c < across_.size(); ++c) {
    const Index other = across_[c];
    if (other == kNoIndex || other < c) continue;
    const bool layered = is_layered(mesh_.corner_vertex(c)) || is_layered(mesh_.corner_vertex(other));
    if (layered && lies_on(c, other))
      cut(c);
    else
      sheets_.join(face_of_corner(c), face_of_corner(other));
  }
}

/// Joins faces at edges of several sheets: first where it is clear which, then the others by what is joined already.
void SheetFinder::join_layers(std::span<const Edge> edges) {
  std::vector<Edge> unclear;
  for (const Edge edge : edges) is_clear(list_matches(edge)) ? join_best(edge) : unclear.push_back(edge);
  for (const Edge edge : unclear) join_best(edge);
}

void SheetFinder::join(Index a, Index b) {
  across_[a] = b;
  across_[b] = a;
}

/// Whether two faces at an edge lie on one another, or nearly so. The two halves of a square that are cut along
/// different diagonals do, however bent it is.
bool SheetFinder::lies_on(Index a, Index b) const {
  const auto has_beside = [&](Index corner, Index vertex) {
    for (const Index c : {next_corner(corner), previous_corner(corner)})
      if (across_[c] != kNoIndex && apex(across_[c]) == vertex) return true;
    return false;
  };
  return apex(a) == apex(b) || overlap(mesh_, a, b) > kLayered || (has_beside(a, apex(b)) && has_beside(b, apex(a)));
}

/// Whether some of an edge's faces lie on one another: several sheets do. Where none do, sheets end or cross at the
/// edge, and its being cut keeps that line.
bool SheetFinder::is_layered(Edge edge) const {
  for (std::size_t i = 0; i < edge.size(); ++i)
    for (std::size_t j = i + 1; j < edge.size(); ++j)
      if (lies_on(edge[i].corner, edge[j].corner)) return true;
  return false;
}

SheetFinder::Match SheetFinder::match(Index a, Index b, int rank_apart) {
  const auto apart = [&](Index p, Index q) { return mesh_.corner_wedge[p] != mesh_.corner_wedge[q] ? 1 : 0; };
  Match match;
  match.a = a;
  match.b = b;
  match.materials_apart = mesh_.material_of(face_of_corner(a)) != mesh_.material_of(face_of_corner(b)) ? 1 : 0;
  match.wedges_apart = apart(a, next_corner(b)) + apart(next_corner(a), b);
  match.overlap = overlap(mesh_, a, b);
  match.sheets_apart = sheets_.find(face_of_corner(a)) != sheets_.find(face_of_corner(b)) ? 1 : 0;
  match.rank_apart = rank_apart;
  return match;
}

std::vector<SheetFinder::Match> SheetFinder::list_matches(Edge edge) {
  std::vector<Match> matches;
  int rank_a = 0;
  for (const HalfEdge& a : edge) {
    if (!a.forward) continue;
    int rank_b = 0;
    for (const HalfEdge& b : edge) {
      if (may_join(a, b)) matches.push_back(match(a.corner, b.corner, std::abs(rank_a - rank_b)));
      if (!b.forward) ++rank_b;
    }
    ++rank_a;
  }
  std::sort(matches.begin(), matches.end(), [](const Match& a, const Match& b) { return a.order() < b.order(); });
  return matches;
}

/// Whether no face has two neighbours that are as good as one another.
bool SheetFinder::is_clear(const std::vector<Match>& matches) const {
  for (std::size_t i = 0; i < matches.size(); ++i)
    for (std::size_t j = i + 1; j < matches.size() && matches[j].clear_signs() == matches[i].clear_signs(); ++j)
      if (matches[j].a == matches[i].a || matches[j].b == matches[i].b) return false;
  return true;
}

void SheetFinder::join_best(Edge edge) {
  for (const Match& match : list_matches(edge))
    if (across_[match.a] == kNoIndex && across_[match.b] == kNoIndex) {
      join(match.a, match.b);
      sheets_.join(face_of_corner(match.a), face_of_corner(match.b));
    }
}

/// The faces around a vertex that hang together, counter-clockwise: their corners at the vertex.
struct Fan {
  std::vector<Index> corners;
  bool closed = false;
};

/// Cuts every fan that meets a position of its ring twice, at the sharpest folds between the two: there no sheet goes
/// on, as at the border of a leaf whose two sides are joined.
class FanSimplifier {
 public:
  FanSimplifier(const Mesh& mesh, SheetFinder& sheets)
      : mesh_(mesh), sheets_(sheets), seen_(mesh.corner_wedge.size(), 0) {}

  void run() {
    for (Index c = 0; c < seen_.size(); ++c) {
      if (seen_[c] != 0 || !sheets_.is_layered(mesh_.corner_vertex(c))) continue;
      gather(c);
      if (!is_simple()) cut();
    }
  }

 private:
  void gather(Index corner);
  bool is_simple() const;
  void cut();
  std::size_t sharpest(std::size_t begin, std::size_t end) const;

  /// Spokes are numbered by the face behind them; the last one of an open fan, or after the circle, has none.
  Index spoke_vertex(std::size_t spoke) const {
    return spoke < fan_.corners.size() ? mesh_.corner_vertex(next_corner(fan_.corners[spoke]))
                                       : mesh_.corner_vertex(previous_corner(fan_.corners.back()));
  }

  const Mesh& mesh_;
  SheetFinder& sheets_;
  std::vector<std::uint8_t> seen_;  // by corner
  Fan fan_;
};

/// Calls `visit(c)` for the corners of a fan, counter-clockwise, an open one from its first spoke on; returns whether
/// it is closed.
template <class Visit>
bool for_each_in_fan(const SheetFinder& sheets, Index corner, const Visit& visit) {
  Index first = corner;
  for (Index across = sheets.across(first); across != kNoIndex; across = sheets.across(first)) {
    first = next_corner(across);
    if (first == corner) break;
  }
  Index c = first;
  do {
    visit(c);
    c = sheets.across(previous_corner(c));
  } while (c != kNoIndex && c != first);
  return c == first;
}

void FanSimplifier::gather(Index corner) {
  fan_.corners.clear();
  fan_.closed = for_each_in_fan(sheets_, corner, [&](Index c) {
    fan_.corners.push_back(c);
    seen_[c] = 1;
  });
}

/// An open fan may begin and end at one position: its ends meet there, or another sheet lies between.
bool FanSimplifier::is_simple() const {
  std::vector<Index> ring;
  for (std::size_t spoke = 0; spoke < fan_.corners.size(); ++spoke) ring.push_back(spoke_vertex(spoke));
  if (!fan_.closed && spoke_vertex(fan_.corners.size()) != ring[0]) ring.push_back(spoke_vertex(fan_.corners.size()));
  std::sort(ring.begin(), ring.end());
  return std::adjacent_find(ring.begin(), ring.end()) == ring.end();
}

/// The spoke of the sharpest fold of some.
std::size_t FanSimplifier::sharpest(std::size_t begin, std::size_t end) const {
  std::size_t best = begin;
  double largest = -2;
  for (std::size_t spoke = begin; spoke < end; ++spoke) {
    const Index corner = fan_.corners[spoke];
    const Index across = sheets_.across(corner);
    const double fold = across == kNoIndex ? 1 : overlap(mesh_, corner, across);
    if (fold > largest) largest = fold, best = spoke;
  }
  return best;
}

void FanSimplifier::cut() {
  const auto cut_at = [&](std::size_t spoke) {
    if (sheets_.across(fan_.corners[spoke]) != kNoIndex) sheets_.cut(fan_.corners[spoke]);
  };
  if (fan_.closed) {
    const auto first = static_cast<std::ptrdiff_t>(sharpest(0, fan_.corners.size()));
    std::rotate(fan_.corners.begin(), fan_.corners.begin() + first, fan_.corners.end());
    cut_at(0);
  }
  std::map<Index, std::size_t> last_spoke;
  std::size_t begin = 0;
  for (std::size_t spoke = 0; spoke <= fan_.corners.size(); ++spoke) {
    const auto [entry, is_new] = last_spoke.try_emplace(spoke_vertex(spoke), spoke);
    const std::size_t before = std::exchange(entry->second, spoke);
    if (is_new || before < begin) continue;
    begin = sharpest(before + 1, spoke);
    cut_at(begin);
  }
}

/// Gives every fan a vertex, new ones where a vertex has several; returns it by corner.
std::vector<Index> number_fans(Mesh& mesh, const SheetFinder& sheets, AssemblyReport& report) {
  const std::size_t vertex_count = mesh.vertex_count();
  std::vector<bool> has_fan(vertex_count, false), is_cut(vertex_count, false);
  std::vector<Index> fan_vertex(mesh.corner_wedge.size(), kNoIndex);
  for (Index c = 0; c < mesh.corner_wedge.size(); ++c) {
    if (fan_vertex[c] != kNoIndex) continue;
    const Index vertex = mesh.corner_vertex(c);
    Index number = vertex;
    if (has_fan[vertex]) {
      number = static_cast<Index>(mesh.positions.size());
      mesh.positions.push_back(mesh.positions[vertex]);
      report.cut_vertices += is_cut[vertex] ? 0 : 1;
      is_cut[vertex] = true;
    }
    has_fan[vertex] = true;
    for_each_in_fan(sheets, c, [&](Index corner) { fan_vertex[corner] = number; });
  }
  return fan_vertex;
}

/// Gives the new vertices copies of the wedges that their corners had.
void copy_wedges(Mesh& mesh, const std::vector<Index>& fan_vertex) {
  std::vector<std::uint64_t> copies;  // (wedge, vertex) pairs that need a copy of the wedge, in order of first use
  HashIndex table(mesh.corner_wedge.size());
  const std::size_t wedge_count = mesh.wedge_count();
  for (Index c = 0; c < mesh.corner_wedge.size(); ++c) {
    const Index vertex = fan_vertex[c];
    const Index wedge = mesh.corner_wedge[c];
    if (mesh.wedge_vertex[wedge] == vertex) continue;
    const std::uint64_t pair = std::uint64_t{wedge} << 32 | vertex;
    const auto candidate = static_cast<Index>(copies.size());
    const Index copy = table.find_or_insert(mix_bits(pair), candidate, [&](Index i) { return copies[i] == pair; });
    if (copy == candidate) {
      copies.push_back(pair);
      mesh.wedge_vertex.push_back(vertex);
    }
    mesh.corner_wedge[c] = static_cast<Index>(wedge_count) + copy;
  }
  for (Attribute& attribute : mesh.attributes) {
    const std::size_t bytes = attribute.element_bytes();
    attribute.data.resize(bytes * mesh.wedge_count());
    for (std::size_t i = 0; i < copies.size(); ++i)
      std::memcpy(&attribute.data[(wedge_count + i) * bytes], &attribute.data[(copies[i] >> 32) * bytes], bytes);
  }
}

}  // namespace

void cut_into_fans(Mesh& mesh, std::span<const HalfEdge> halves, AssemblyReport& report) {
  SheetFinder sheets(mesh, halves);
  if (sheets.any_layered()) FanSimplifier(mesh, sheets).run();
  report.nonmanifold_edges = sheets.nonmanifold_edges();
  const std::vector<Index> fan_vertex = number_fans(mesh, sheets, report);
  if (report.cut_vertices > 0) copy_wedges(mesh, fan_vertex);
}

}  // namespace lodestone::detail
