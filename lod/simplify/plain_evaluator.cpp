#include "simplify/plain_evaluator.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "simplify/angles.h"

namespace lodestone::detail {

PlainEvaluator::PlainEvaluator(const SimplifyState& state, const SimplifyOptions& options,
                               const AttributeCost& attributes, const FaceRules& rules)
    : state_(&state),
      attributes_(&attributes),
      rules_(&rules),
      measured_(measured_triangulations(options)),
      against_original_(options.reference == Reference::Original) {}

Evaluation PlainEvaluator::evaluate(Choice& choice) {
  if (!is_simple(star_, state_->connectivity)) return {Verdict::Link};
  start();
  rank();
  const Verdict verdict = choose_legal();
  if (rejects(verdict)) return {verdict};
  Displacement moved;
  const Filling best = measured_ > 0 ? best_by_distance(moved) : legal_.front();
  moved.squared_volume = best.squared_volume;
  choice = {best.which, kPlain};
  const Triangles triangles = filling(best.which);
  if (measured_ > 0) moved.squared_distance = joined_distance(moved.squared_distance, bridge_sum(triangles));
  if (!attributes_->empty()) moved.squared_attributes = squared_attribute_difference(triangles);
  const double turned = curvature_error(triangles);
  return {Verdict::Legal, hybrid_cost(moved, measured_ > 0, turned), turned};
}

Evaluation PlainEvaluator::describe(const Choice& choice, RemovalRecord& record, std::vector<double>& curvature) {
  if (!is_simple(star_, state_->connectivity)) return {Verdict::Link};
  start();
  if (star_.size > kMaxTabulatedPolygon && choice[0] == star_.size) rank();
  const Triangles triangles = filling(choice[0]);
  if (const Verdict verdict = judge(triangles); rejects(verdict)) return {verdict};
  described_.corners.assign(star_.corner.begin(), star_.corner.begin() + static_cast<std::ptrdiff_t>(star_.size));
  described_.sector_begin.assign(1, 0);
  described_.closed = true;
  describe_removal(state_->connectivity, described_, record);
  record.sectors.front().triangles.assign(triangles.begin(), triangles.end());
  const double turned = curvature_error(triangles);
  curvature.assign(curvature_after_.begin(), curvature_after_.begin() + static_cast<std::ptrdiff_t>(star_.size));
  return {Verdict::Legal, 0, turned};
}

/// Forgets what was known of the last star.
void PlainEvaluator::start() {
  ++star_number_;
  links_known_ = 0;
  if (!attributes_->empty()) scale_ = attribute_scale();
}

/// Lists the fillings and the volumes they sweep.
void PlainEvaluator::rank() {
  filling_count_ = 0;
  if (star_.size <= kMaxTabulatedPolygon) {
    rank_all();
  } else {
    rank_fans();
    const Triangles least = fills_.cheapest(
        star_.size, [&](PolygonTriangle t) { return squared_volume(t); },
        [&](PolygonTriangle t) { return !rejects(judge(t)); });
    least_volume_.assign(least.begin(), least.end());
    double sum = 0;
    for (const PolygonTriangle t : least_volume_) sum += squared_volume(t);
    if (!least.empty()) fillings_[filling_count_++] = {sum, static_cast<std::uint8_t>(star_.size)};
  }
}

void PlainEvaluator::rank_all() {
  std::array<double, triangle_count(kMaxTabulatedPolygon)> volume;
  std::size_t number = 0;  // in the order of triangle_number
  for (std::size_t c = 2; c < star_.size; ++c)
    for (std::size_t b = 1; b < c; ++b) {
      const Vec3 normal = cross(star_.spoke[b], star_.spoke[c]);
      for (std::size_t a = 0; a < b; ++a) {
        const double sixfold = dot(star_.spoke[a], normal);
        volume[number++] = sixfold * sixfold / 36;
      }
    }
  const auto size = static_cast<int>(star_.size);
  const std::uint8_t* next = triangulation_numbers(size).data();
  for (int which = 0; which < triangulation_count(size); ++which) {
    double sum = 0;
    for (int i = 0; i < size - 2; ++i) sum += volume[*next++];
    fillings_[filling_count_++] = {sum, static_cast<std::uint8_t>(which)};
  }
}

void PlainEvaluator::rank_fans() {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  for (std::size_t i = 0; i < star_.size; ++i) {
    const Vec3& a = star_.normal[i];
    xx += a.x * a.x, xy += a.x * a.y, xz += a.x * a.z;
    yy += a.y * a.y, yz += a.y * a.z, zz += a.z * a.z;
  }
  for (std::size_t i = 0; i < star_.size; ++i) {
    const Vec3& u = star_.spoke[i];
    const double form = u.x * (xx * u.x + 2 * (xy * u.y + xz * u.z)) + u.y * (yy * u.y + 2 * yz * u.z) + u.z * zz * u.z;
    fillings_[filling_count_++] = {std::max(form, 0.0) / 36, static_cast<std::uint8_t>(i)};
  }
}

/// Finds the legal fillings of least volume, as many as are measured; where there is none, tells why.
Verdict PlainEvaluator::choose_legal() {
  legal_count_ = 0;
  distances_.clear();
  Verdict verdict = Verdict::Ring;
  const std::size_t wanted = std::max<std::size_t>(measured_, 1);
  const auto end = fillings_.begin() + static_cast<std::ptrdiff_t>(filling_count_);
  const auto less = [](const Filling& a, const Filling& b) { return a.squared_volume < b.squared_volume; };
  for (auto rest = fillings_.begin(); rest != end && legal_count_ < wanted; ++rest) {
    std::iter_swap(rest, std::min_element(rest, end, less));
    const Triangles triangles = filling(rest->which);
    const Verdict found = judge(triangles);
    verdict = std::min(verdict, found);
    if (rejects(found)) continue;
    legal_[legal_count_++] = *rest;
    if (measured_ > 0) distances_.add(triangles);
  }
  return verdict;
}

/// Returns the legal filling whose volume and distances are least together, and what its distances are charged.
PlainEvaluator::Filling PlainEvaluator::best_by_distance(Displacement& moved) {
  points_.start();
  for (std::size_t i = 0; i < star_.size; ++i)
    points_.add_face(state_->points, face_of_corner(star_.corner[i]), star_.center);
  distances_.measure(points_.places, {star_.spoke.data(), star_.size});
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < legal_count_; ++i) {
    const double distance = squared_distance(i);
    // By (V·D)⁶; the curvature's part is left to the order of removals.
    const double rank = legal_[i].squared_volume * distance * distance * distance;
    if (i > 0 && !(rank < least)) continue;
    least = rank;
    best = i;
    moved.squared_distance = distance;
  }
  return legal_[best];
}

double PlainEvaluator::squared_volume(PolygonTriangle t) const {
  const double sixfold = dot(star_.spoke[t.a], cross(star_.spoke[t.b], star_.spoke[t.c]));
  return sixfold * sixfold / 36;
}

/// Filling `which`: of a small ring by the table's numbers; of a larger one the fan of that ring vertex, or the one of
/// least volume.
PlainEvaluator::Triangles PlainEvaluator::filling(std::size_t which) {
  if (star_.size <= kMaxTabulatedPolygon) return triangulation(static_cast<int>(star_.size), static_cast<int>(which));
  return which < star_.size ? fills_.fan(star_.size, which) : Triangles(least_volume_);
}

/// Judges a whole filling; an empty one is none.
Verdict PlainEvaluator::judge(Triangles triangles) {
  if (triangles.empty()) return Verdict::Shape;
  for (const PolygonTriangle t : triangles)
    if (const Verdict verdict = judge(t); rejects(verdict)) return verdict;
  return Verdict::Legal;
}

Verdict PlainEvaluator::judge(PolygonTriangle t) {
  Judged& judged = judged_[static_cast<std::size_t>(triangle_number(t))];
  if (judged.star == star_number_) return judged.verdict;
  judged = {star_number_, judge_shape(t)};
  if (rejects(judged.verdict)) return judged.verdict;
  for (const auto& [from, to] : {std::pair{t.a, t.b}, std::pair{t.b, t.c}, std::pair{t.c, t.a}})
    if (!is_rim(from, to) && is_linked(from, to)) judged.verdict = Verdict::Link;
  const PlainStar::Ring<Index>& wedge = star_.ring_wedge;
  if (!rejects(judged.verdict) && attributes_->texture_count() > 0 &&
      attributes_->turns_texture(wedge[t.a], wedge[t.b], wedge[t.c], scale_))
    judged.verdict = Verdict::Texture;
  return judged.verdict;
}

Verdict PlainEvaluator::judge_shape(PolygonTriangle t) const {
  const Vec3& a = star_.spoke[t.a];
  const Vec3& b = star_.spoke[t.b];
  const Vec3& c = star_.spoke[t.c];
  const Vec3 normal = cross(b - a, c - a);
  const double square = squared_length(normal);
  const double longest = squared_longest_edge(a, b, c);
  if (rules_->is_too_thin(square, longest, star_.faces)) return Verdict::Shape;
  bool at_rim = false;
  for (const auto& [from, to] : {std::pair{t.a, t.b}, std::pair{t.b, t.c}, std::pair{t.c, t.a}}) {
    if (!is_rim(from, to) || !star_.has_direction[from]) continue;
    at_rim = true;
    if (rules_->turns_too_far(normal, star_.normal[from])) return Verdict::Turn;
  }
  return !at_rim && rules_->looks_away(normal, star_.faces) ? Verdict::Turn : Verdict::Legal;
}

bool PlainEvaluator::is_linked(std::size_t a, std::size_t b) {
  if ((links_known_ >> b & 1) != 0) std::swap(a, b);
  if ((links_known_ >> a & 1) == 0) linked_[a] = linked_ring(star_, state_->connectivity, a);
  links_known_ |= std::uint32_t{1} << a;
  return (linked_[a] >> b & 1) != 0;
}

/// What the carried points are charged for by a legal filling.
double PlainEvaluator::squared_distance(std::size_t filling) {
  const float* nearest = distances_.to(filling);
  float sum = 0;
  for (std::size_t i = 0; i < points_.places.size(); ++i)
    sum += points_.weights[i] * rules_->beyond_rounding(nearest[i]);
  return charged_distance(static_cast<double>(sum), points_.squared_distance_before);
}

/// Sums the squared distances of the new faces' centroids and the new edges' midpoints to the star: the surface where
/// nothing was, as over a notch that the carried points do not see.
double PlainEvaluator::bridge_sum(Triangles triangles) {
  bridge_.clear();
  for (const PolygonTriangle t : triangles) {
    bridge_.add((star_.spoke[t.a] + star_.spoke[t.b] + star_.spoke[t.c]) * (1.0 / 3));
    for (const auto& [from, to] : {std::pair{t.a, t.b}, std::pair{t.b, t.c}})
      if (!is_rim(from, to)) bridge_.add((star_.spoke[from] + star_.spoke[to]) * 0.5);
  }
  std::array<Vec3, PlainStar::kMaxSize + 1> corners;  // the vertex itself is the first
  std::array<PolygonTriangle, PlainStar::kMaxSize> faces;
  for (std::size_t i = 0; i < star_.size; ++i) {
    corners[i + 1] = star_.spoke[i];
    faces[i] = {0, static_cast<std::uint8_t>(i + 1), static_cast<std::uint8_t>(star_.after(i) + 1)};
  }
  star_frames_.set({corners.data(), star_.size + 1}, {faces.data(), star_.size});
  nearest_.resize(bridge_.padded_size());
  star_frames_.least_squared_distances(bridge_, nearest_.data());
  float sum = 0;
  for (std::size_t i = 0; i < bridge_.size(); ++i) sum += rules_->beyond_rounding(nearest_[i]);
  return static_cast<double>(sum);
}

AttributeScale PlainEvaluator::attribute_scale() const {
  double area = 0;
  for (std::size_t i = 0; i < star_.size; ++i) area += 0.5 * std::sqrt(star_.squared_normal[i]);
  return attributes_->scale(star_.wedge, {star_.ring_wedge.data(), star_.size}, true, area);
}

/// Compares the removed wedge's attributes with those of the nearest point of the new faces.
double PlainEvaluator::squared_attribute_difference(Triangles triangles) const {
  const auto position_at = [&](std::size_t i) { return state_->mesh.positions[star_.ring_vertex[i]]; };
  const auto wedge_at = [&](std::size_t i) { return star_.ring_wedge[i]; };
  return attributes_->squared_difference(star_.wedge, star_.center, triangles, position_at, wedge_at, scale_);
}

/// The largest change of K̄ among the ring's vertices, by the angles at them in the star's faces and in the new ones.
double PlainEvaluator::curvature_error(Triangles triangles) {
  constexpr std::size_t kMaxAngles = 5 * PlainStar::kMaxSize;
  std::array<double, kMaxAngles> cosine, sine, angle;
  std::size_t count = 0;
  const auto add = [&](double c, double s) { cosine[count] = c, sine[count] = s, ++count; };
  for (std::size_t i = 0; i < star_.size; ++i) {
    const Vec3& a = star_.spoke[i];
    const Vec3& b = star_.spoke[star_.after(i)];
    const double product = dot(a, b);
    const double normal = std::sqrt(star_.squared_normal[i]);
    add(squared_length(a) - product, normal);
    add(squared_length(b) - product, normal);
  }
  for (const PolygonTriangle t : triangles) {
    const Vec3 a = star_.spoke[t.b] - star_.spoke[t.a];
    const Vec3 b = star_.spoke[t.c] - star_.spoke[t.a];
    const double product = dot(a, b);
    const double normal = length(cross(a, b));
    add(product, normal);
    add(squared_length(a) - product, normal);
    add(squared_length(b) - product, normal);
  }
  angles(count, cosine.data(), sine.data(), angle.data());
  for (std::size_t i = 0; i < star_.size; ++i) curvature_after_[i] = state_->gaussian[star_.ring_vertex[i]];
  const double* next = angle.data();
  for (std::size_t i = 0; i < star_.size; ++i) {
    curvature_after_[i] += *next++;
    curvature_after_[star_.after(i)] += *next++;
  }
  for (const PolygonTriangle t : triangles)
    for (const std::size_t corner : {t.a, t.b, t.c}) curvature_after_[corner] -= *next++;
  double largest = 0;
  for (std::size_t i = 0; i < star_.size; ++i) {
    const Index v = star_.ring_vertex[i];
    const double before = against_original_ ? static_cast<double>(state_->original_curvature[v]) : state_->gaussian[v];
    largest = std::max(largest, std::abs(before - curvature_after_[i]));
  }
  return largest;
}

}  // namespace lodestone::detail
