#include "codec/level_coder.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "codec/compact_layout.h"

namespace lodestone::detail {
namespace {

constexpr std::uint64_t kMostCornersEach = 64;  // of polygons, for each face and vertex of the level after the chunk

enum Flag : std::uint32_t { kAnyJoins, kJoins, kAnyExtra, kStageEnds, kFlags };

/// Rotates a face so that its largest wedge stands first.
void rotate_face(Index* vertices, Index* wedges) {
  const auto first = std::max_element(wedges, wedges + 3) - wedges;
  std::rotate(vertices, vertices + first, vertices + 3);
  std::rotate(wedges, wedges + first, wedges + 3);
}

}  // namespace

LevelCoder::LevelCoder(const LevelLimits& limits, std::span<const AttributeSpec> attributes)
    : limits_(limits),
      patch_coder_(limits.is_fast),
      wedge_coder_(limits.group_count),
      loose_coder_(limits.group_count),
      shapes_(ShapeCoder::make(limits.is_fast, limits.grid_bits)),
      attributes_(attributes, limits.is_fast),
      flags_({kFlags}, 1) {}

void LevelCoder::allow(std::uint64_t vertices, std::uint64_t wedges, std::uint64_t faces) {
  limits_.most_vertices = positions_.size() + vertices;
  limits_.most_wedges = wedges_.size() + wedges;
  limits_.most_faces = mesh_.face_count() + faces;
}

bool LevelCoder::may_end_chunk() const {
  return corners_ <= kMostCornersEach * (mesh_.face_count() + positions_.size()) &&
         move_count_ <= kMostMovesEach * positions_.size();
}

/// How many corners polygons may still have.
std::uint64_t LevelCoder::corners_left() const {
  const std::uint64_t most = kMostCornersEach * (limits_.most_faces + limits_.most_vertices);
  return most > corners_ ? most - corners_ : 0;
}

bool LevelCoder::code_flag(BitCoder& coder, std::uint32_t which, bool is) {
  return flags_.code(coder, is ? 1 : 0, std::array<std::uint32_t, 1>{which}, 0) != 0;
}

bool LevelCoder::code_base(BitCoder& coder, BaseMesh& base) {
  if (!base_coder_.code(coder, base, limits_.most_wedges, wedges_)) return false;
  for (Vec3i& position : base.positions) {
    if (!shapes_->code_base(coder, position) || !coder.goes_on()) return false;
    positions_.push_back(position);
  }
  moved_.assign(positions_.size(), 1);
  std::vector<Index> corners = base.corners, wedges;
  for (std::size_t c = 0; c < corners.size(); ++c) wedges.push_back(wedges_.begin(corners[c]) + base.wedges[c]);
  for (std::size_t c = 0; c < corners.size(); c += 3) rotate_face(&corners[c], &wedges[c]);
  mesh_.start(corners, wedges, base.groups, positions_.size());
  measure_edges();
  return true;
}

bool LevelCoder::code_base_attributes(BitCoder& coder, std::span<const std::vector<std::int32_t>> given) {
  return attributes_.code_base(coder, mesh_, wedges_, positions_, given);
}

bool LevelCoder::code_step(BitCoder& coder, int& step) {
  step = static_cast<int>(coder.code_raw(static_cast<std::uint32_t>(step), 4));
  if (step > limits_.grid_bits - kLeastStepBits) return false;
  shapes_->start_stage(step_, step, positions_.size());
  step_ = step;
  return true;
}

void LevelCoder::measure_edge(Index half) {
  mesh_.set_edge_log(half, log2_16(squared(positions_[mesh_.from(half)] - positions_[mesh_.to(half)])));
}

void LevelCoder::measure_edges() {
  for (Index h = 0; h < 3 * mesh_.face_count(); ++h) measure_edge(h);
}

/// Codes where a vertex goes.
bool LevelCoder::move(BitCoder& coder, Index vertex, Index half, Index star, std::span<const Vec3i> targets) {
  if (++move_count_ > kMostMovesEach * limits_.most_vertices) return false;
  Vec3i to = targets.empty() ? Vec3i{} : targets[vertex];
  if (!shapes_->code_move(coder, mesh_, vertex, half, positions_, to)) return false;
  const bool has_moved = !(to == positions_[vertex]);
  if (has_moved) moves_.push_back({star, vertex, positions_[vertex], to});
  positions_.set(vertex, to);
  const auto note_face = [&](Index leaving) {
    moved_faces_.push_back(face_of_corner(leaving));
    measure_edge(leaving);
    if (const Index entering = previous_corner(leaving); mesh_.twin(entering) == kNoIndex) measure_edge(entering);
  };
  if (has_moved && half != kNoIndex && !mesh_.visit_faces(half, note_face)) are_all_changed_ = true;
  moved_[vertex] = 1;
  --unmoved_count_;
  return true;
}

bool LevelCoder::code_moves(BitCoder& coder, std::span<const Vec3i> targets) {
  moves_.clear();
  shapes_->start_round(mesh_, positions_);
  if (unmoved_count_ == 0) return true;
  Index star = 0;
  const auto move_ends = [&](Index half) {
    const Index from = mesh_.from(half), to = mesh_.to(half);
    if (moved_[from] == 0 && !move(coder, from, half, star, targets)) return false;
    return moved_[to] != 0 || move(coder, to, next_corner(half), star, targets);
  };
  for (const Index half : patches_.ears) {
    if (!move_ends(half)) return false;
    ++star;
  }
  Index begin = 0;
  for (const RoundPatches::Patch& patch : patches_.patches) {
    for (Index i = begin; i < patch.polygon_end; ++i)
      if (!move_ends(patches_.polygons[i])) return false;
    begin = patch.polygon_end;
    ++star;
  }
  if (are_all_changed_) measure_edges();
  return true;
}

bool LevelCoder::code_stage_end(BitCoder& coder, bool& ends, std::span<const Vec3i> targets) {
  ends = code_flag(coder, kStageEnds, ends);
  moved_.resize(positions_.size(), 1);
  if (!ends) return true;
  if (unmoved_count_ > 0) {
    shapes_->start_round(mesh_, positions_);
    std::vector<Index> half(positions_.size(), kNoIndex);
    for (Index h = 0; h < 3 * mesh_.face_count(); ++h)
      if (half[mesh_.from(h)] == kNoIndex) half[mesh_.from(h)] = h;
    for (Index vertex = 0; vertex < positions_.size(); ++vertex)
      if (moved_[vertex] == 0 && !move(coder, vertex, half[vertex], kNoIndex, targets)) return false;
    if (are_all_changed_) measure_edges();
  }
  moved_.assign(positions_.size(), 0);
  unmoved_count_ = positions_.size();
  return true;
}

bool LevelCoder::code_patches(BitCoder& coder, const PatchPlan* plan) {
  has_seams_ = limits_.group_count > 1 || wedges_.size() > wedges_.vertex_count();
  const ChangedFaces changed = {stars_.faces, moved_faces_, are_all_changed_};
  const bool is_round =
      patch_coder_.code(coder, mesh_, has_seams_, positions_, ++round_number_, changed, plan, patches_);
  moved_faces_.clear();
  are_all_changed_ = false;
  vertices_done_ = 0;
  stars_.stars.clear();
  stars_.faces.clear();
  stars_.coarse.clear();
  vertices_.stars.clear();
  vertices_.star_end.clear();
  vertices_.sector_end.clear();
  sectors_.clear();
  return is_round;
}

bool LevelCoder::code_places(BitCoder& coder, std::span<const Index> joins) {
  const auto count = static_cast<Index>(patches_.ears.size() + patches_.patches.size());
  joined_.resize(count);
  bool any = false;
  for (Index i = 0; i < joins.size(); ++i) any = any || joins[i] != i;
  any = count > 1 && code_flag(coder, kAnyJoins, any);
  for (Index i = 0; i < count; ++i) {
    joined_[i] = i;
    if (!any || i == 0 || !code_flag(coder, kJoins, !joins.empty() && joins[i] != i)) continue;
    joined_[i] = coder.code_raw(joins.empty() ? 0 : joins[i], std::bit_width(i - 1));
    if (joined_[i] >= i || joined_[joined_[i]] != joined_[i]) return false;
  }
  add_stars();
  return true;
}

/// Ends a star whose faces are there.
void LevelCoder::end_star(Index vertex, bool closed, bool is_loose) {
  stars_.stars.push_back(
      {vertex, static_cast<Index>(stars_.faces.size()), static_cast<Index>(stars_.coarse.size()), closed, is_loose});
}

/// Ears come first: patches may move the faces that they hang on.
void LevelCoder::add_stars() {
  auto next = static_cast<Index>(positions_.size());
  const auto vertex_of_next = [&] {
    const auto i = static_cast<Index>(stars_.stars.size());
    return joined_[i] != i ? stars_.stars[joined_[i]].vertex : next++;
  };
  mesh_.reserve(patches_.ears.size() + patches_.polygons.size() - patches_.faces.size());
  for (const Index half : patches_.ears) {
    const Index vertex = vertex_of_next();
    mesh_.add_ear(half, vertex, round_number_, stars_.faces);
    end_star(vertex, false, false);
  }
  std::span<const Index> polygons = patches_.polygons, faces = patches_.faces;
  Index polygon_begin = 0, face_begin = 0;
  for (const RoundPatches::Patch& patch : patches_.patches) {
    const auto polygon = polygons.subspan(polygon_begin, patch.polygon_end - polygon_begin);
    const auto replaced = faces.subspan(face_begin, patch.face_end - face_begin);
    for (const Index face : replaced) {
      const Index c = 3 * face;
      stars_.coarse.push_back({face, mesh_.group(face), {mesh_.wedge(c), mesh_.wedge(c + 1), mesh_.wedge(c + 2)}});
    }
    const Index vertex = vertex_of_next();
    mesh_.refine(polygon, replaced, patch.closed, vertex, round_number_, stars_.faces);
    end_star(vertex, patch.closed, false);
    polygon_begin = patch.polygon_end;
    face_begin = patch.face_end;
  }
  order_stars(next - positions_.size());
}

/// Puts together the stars of each of so many new vertices.
void LevelCoder::order_stars(std::size_t count) {
  const auto first = static_cast<Index>(positions_.size());
  std::vector<Index>& ends = vertices_.star_end;
  ends.assign(count, 0);
  for (const NewStars::Star& star : stars_.stars) ++ends[star.vertex - first];
  Index begin = 0;
  for (Index& end : ends) begin += std::exchange(end, begin);
  vertices_.stars.resize(begin);
  // Where a vertex's begin moves to where they end.
  for (Index i = 0; i < begin; ++i) vertices_.stars[ends[stars_.stars[i].vertex - first]++] = i;
}

/// Adds the sectors of a star.
bool LevelCoder::split(std::size_t i) {
  const std::span<const Index> faces = stars_.star(i);
  const auto spoke_at = [&](std::size_t k) { return spoke(faces[k]); };
  if (!stars_.stars[i].closed || has_cut(faces.size(), spoke_at)) return split_cut(i);
  places_.resize(wedges_.size());
  for (auto k = static_cast<Index>(faces.size()); k-- > 0;)
    places_[mesh_.wedge(3 * faces[k] + 1)] = static_cast<std::uint16_t>(k);
  const auto place_of = [&](const NewStars::Coarse& triangle, std::size_t k) { return places_[triangle.wedges[k]]; };
  return add_closed(faces.size(), spoke_at, stars_.coarse_of(i), place_of, sectors_);
}

/// Adds the sectors of a star that is open or has cuts.
bool LevelCoder::split_cut(std::size_t i) {
  const std::span<const Index> faces = stars_.star(i);
  split_.closed = stars_.stars[i].closed;
  split_.faces.clear();
  split_.coarse.clear();
  for (const Index face : faces) split_.faces.push_back(spoke(face));
  places_.resize(std::max(wedges_.size(), mesh_.vertex_count()));
  for (auto k = static_cast<Index>(faces.size()); k-- > 0;)
    places_[mesh_.from(3 * faces[k] + 1)] = static_cast<std::uint16_t>(k);
  const auto place_of = [&](Index wedge) {
    const Index vertex = wedges_.vertex(wedge), place = places_[vertex];
    if (place < faces.size() && mesh_.from(3 * faces[place] + 1) == vertex) return place;
    return static_cast<Index>(faces.size());  // the end of an open star
  };
  for (const NewStars::Coarse& coarse : stars_.coarse_of(i))
    split_.coarse.push_back({coarse.face,
                             coarse.group,
                             {place_of(coarse.wedges[0]), place_of(coarse.wedges[1]), place_of(coarse.wedges[2])},
                             coarse.wedges});
  return split_star(split_, sectors_);
}

/// Ends a vertex whose sectors are there.
bool LevelCoder::end_vertex() {
  const Index begin = vertices_.sector_end.empty() ? 0 : vertices_.sector_end.back();
  const std::size_t first = begin == 0 ? 0 : sectors_.sectors[begin - 1].polygon_end;
  const std::size_t corners = sectors_.polygons.size() - first;
  vertices_.sector_end.push_back(static_cast<Index>(sectors_.sectors.size()));
  if (wedges_.count(static_cast<Index>(wedges_.vertex_count() - 1)) > kMostWedgesEach) return false;
  if (corners > corners_left() || wedges_.size() > limits_.most_wedges) return false;
  corners_ += corners;
  return true;
}

bool LevelCoder::code_extra(BitCoder& coder, Index count) {
  return wedge_coder_.code_extra(coder, count, static_cast<Index>(limits_.most_wedges - wedges_.size()), wedges_);
}

bool LevelCoder::code_wedges(BitCoder& coder, const WedgePlan* plan) {
  if (mesh_.face_count() > limits_.most_faces) return false;
  if (positions_.size() + vertices_.count() > limits_.most_vertices) return false;
  bool any_extra =
      plan != nullptr && std::any_of(plan->extra.begin(), plan->extra.end(), [](Index n) { return n > 0; });
  any_extra = code_flag(coder, kAnyExtra, any_extra);
  for (std::size_t v = 0; v < vertices_.count(); ++v) {
    wedges_.add_vertex();
    for (const Index i : vertices_.stars_of(v)) {
      const Star::Spoke* wanted = plan != nullptr ? plan->faces.data() + stars_.face_begin(i) : nullptr;
      const bool is_ear = i < patches_.ears.size();
      if (!wedge_coder_.code(coder, mesh_, has_seams_, stars_.star(i), stars_.stars[i].closed, is_ear, wanted, wedges_))
        return false;
      if (!split(i)) return false;
    }
    if (wedges_.size() > limits_.most_wedges) return false;
    if (any_extra && !code_extra(coder, plan != nullptr ? plan->extra[v] : 0)) return false;
    if (!end_vertex() || !coder.goes_on()) return false;
  }
  return true;
}

bool LevelCoder::code_points(BitCoder& coder, std::span<const Vec3i> given) {
  const std::size_t first = positions_.size(), count = vertices_.count();
  positions_.resize(first + count);
  const auto star_of = [&](std::size_t i) { return vertices_.stars_of(i).front(); };
  for (std::size_t i = 0; i < count; ++i) {
    const Index star = star_of(i);
    positions_.set(first + i, ShapeCoder::guess(mesh_, stars_.star(star), stars_.stars[star].closed, positions_));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const Index star = star_of(i);
    Vec3i position = given.empty() ? Vec3i{} : given[i];
    if (!shapes_->code_point(coder, mesh_, stars_.star(star), stars_.stars[star].closed, positions_, position))
      return false;
    if (!coder.goes_on()) return false;
    positions_.set(first + i, position);
    measure_spokes(i);
  }
  return true;
}

/// Measures the spokes of a vertex of the round.
void LevelCoder::measure_spokes(std::size_t i) {
  for (const Index star : vertices_.stars_of(i)) {
    const std::span<const Index> faces = stars_.star(star);
    for (const Index face : faces) measure_edge(3 * face);
    if (!stars_.stars[star].closed) measure_edge(3 * faces.back() + 2);
  }
}

/// The middle of what a loose vertex's faces stand on; without any, where the vertex before it lies.
Vec3i LevelCoder::guess_loose(std::span<const Index> fine) const {
  Vec3i sum;
  std::int64_t count = 0;
  for (const Index face : fine)
    for (Index c = 3 * face + 1; c < 3 * face + 3; ++c, ++count) sum = sum + positions_[mesh_.from(c)];
  if (count > 0) return divide(sum, count);
  return positions_.empty() ? Vec3i{} : positions_.back();
}

bool LevelCoder::code_loose_vertex(BitCoder& coder, LooseVertex& vertex) {
  wedges_.add_vertex();
  mesh_.add_vertex();
  const std::size_t first_fine = sectors_.fine.size();
  if (!loose_coder_.code(coder, vertex.record, round_number_, corners_left(), mesh_, wedges_, sectors_)) return false;
  if (mesh_.face_count() > limits_.most_faces || wedges_.size() > limits_.most_wedges) return false;
  if (!code_extra(coder, vertex.extra) || !end_vertex()) return false;
  const auto fine = std::span(sectors_.fine).subspan(first_fine);
  if (!shapes_->code_loose(coder, guess_loose(fine), vertex.position)) return false;
  stars_.faces.insert(stars_.faces.end(), fine.begin(), fine.end());
  end_star(static_cast<Index>(positions_.size()), false, true);
  positions_.push_back(vertex.position);
  for (const Index face : fine)
    for (Index h = 3 * face; h < 3 * face + 3; ++h) measure_edge(h);
  vertices_.stars.push_back(static_cast<Index>(stars_.stars.size() - 1));
  vertices_.star_end.push_back(static_cast<Index>(vertices_.stars.size()));
  return coder.goes_on();
}

bool LevelCoder::code_loose_count(BitCoder& coder, Index& count) {
  count = loose_coder_.code_count(coder, count);
  return positions_.size() + count <= limits_.most_vertices && count + vertices_.count() > 0;
}

bool LevelCoder::code_attributes(BitCoder& coder, std::span<const std::vector<std::int32_t>> given) {
  if (attributes_.count() == 0) return true;
  const std::size_t first = positions_.size() - vertices_.count();
  const Index first_wedge = vertices_done_ < vertices_.count()
                                ? wedges_.begin(static_cast<Index>(first + vertices_done_))
                                : static_cast<Index>(wedges_.size());
  if (vertices_done_ < vertices_.count()) attributes_.look(mesh_, wedges_, positions_);
  for (; vertices_done_ < vertices_.count(); ++vertices_done_) {
    vertex_faces_.clear();
    for (const Index star : vertices_.stars_of(vertices_done_)) {
      const std::span<const Index> faces = stars_.star(star);
      vertex_faces_.insert(vertex_faces_.end(), faces.begin(), faces.end());
    }
    if (!attributes_.code_vertex(coder, mesh_, wedges_, positions_, static_cast<Index>(first + vertices_done_),
                                 vertex_faces_, given, first_wedge))
      return false;
  }
  return true;
}

}  // namespace lodestone::detail
