// Directions are points of an octahedron, |x| + |y| + |z| = m, as in Cigolle et al.: A survey of efficient
// representations for independent unit vectors (2014). Two coordinates are coded, those in which the expected direction
// is short, so that the folds of a map of the octahedron do not come into play; the third follows but for its sign.

#include "codec/direction_coder.h"

#include <algorithm>
#include <cstdlib>

#include "codec/ring.h"

namespace lodestone::detail {
namespace {

constexpr int kUsualDirectionMiss = 16 * 10;  // of 2^14

std::int64_t length_of(const Vec3i& v) { return square_root(squared(v)); }

/// What the faces around a wedge tell of its direction: unit vectors.
struct Hints {
  Vec3i own;                 // what is expected first
  Vec3i even, third;         // other means
  Vec3i surface_around;      // of the ring
  std::int64_t spread = 0;   // mean distance of the faces' from the first
  bool is_mirrored = false;  // of tangents: whether texture coordinates run the other way round
};

/// Of normals: means of the faces', by area, by number, and nearly by angle.
Hints normals_of(const ElementPlace& place) {
  Hints hints;
  hints.own = place.normals[place.wedge];
  Vec3i even, by_angle;
  for (const Index face : place.faces) {
    const auto [a, b] = place.edges(face);
    const Vec3i n = unit(cross(a, b));
    even = even + n;
    by_angle = by_angle + n * (length_of(unit(a) - unit(b)) >> 4);
    hints.spread += length_of(n - hints.own);
  }
  hints.even = unit(even);
  hints.third = unit(by_angle);
  hints.spread /= std::max<std::int64_t>(1, static_cast<std::int64_t>(place.faces.size()));
  Vec3i around;
  for (const Index other : place.ring) around = around + place.normals[other];
  hints.surface_around = unit(around);
  return hints;
}

/// Of tangents: where the first texture coordinate grows, along the surface.
Hints tangents_of(const ElementPlace& place, const Vec3i& around) {
  Hints hints;
  Vec3i normal = place.normals[place.wedge];
  if (place.normal != nullptr) {
    const std::span<const std::int32_t> n = place.normal->numbers(place.wedge);
    normal = unit({n[0], n[1], n[2]});
  }
  const auto on_surface = [&](const Vec3i& v) { return unit(v - times(normal, along(v, normal))); };
  hints.surface_around = on_surface(around);
  hints.own = hints.even = hints.third = hints.surface_around;
  if (place.texture == nullptr) return hints;
  Vec3i sum, even;
  hints.is_mirrored = visit_growth(place, [&](const Vec3i& growth) {
    sum = sum + growth;
    even = even + unit(growth);
  });
  if (sum == Vec3i{}) return hints;
  hints.own = on_surface(unit(sum));
  hints.even = on_surface(unit(even));
  hints.third = unit(sum);
  hints.spread = length_of(hints.third - hints.own);
  return hints;
}

}  // namespace

FittedDirectionCoder::FittedDirectionCoder(const AttributeSpec& spec)
    : DirectionCoder(spec),
      pulls_({0, 0, 0, 0}, 1 << 17),
      size_({0, kHalfWeight, kQuarterWeight, kQuarterWeight}, 1 << 14),
      misses_(kUsualDirectionMiss) {}

Vec3i FittedDirectionCoder::direction(Index wedge) const {
  if (wedge >= directions_.size()) return {};
  const std::array<std::int16_t, 3>& d = directions_[wedge];
  return {d[0], d[1], d[2]};
}

/// Notes which direction a wedge's numbers are; returns it.
Vec3i FittedDirectionCoder::note_direction(Index wedge) {
  const Vec3i d = unit({number(wedge, 0), number(wedge, 1), number(wedge, 2)});
  if (directions_.size() <= wedge) directions_.resize(wedge + std::size_t{1});
  directions_[wedge] = {static_cast<std::int16_t>(d.x), static_cast<std::int16_t>(d.y), static_cast<std::int16_t>(d.z)};
  return d;
}

Vec3i FittedDirectionCoder::mean_of_ring(const ElementPlace& place) const {
  Vec3i sum;
  for (const Index other : place.ring) sum = sum + direction(other);
  return unit(sum);
}

/// Likely as far off as the wedge before it.
void FittedDirectionCoder::pass(const ElementPlace& place) {
  note_direction(place.wedge);
  misses_.note(place.wedge, place.wedge > 0 ? misses_.of(place.wedge - 1) : misses_.usual());
}

void DirectionCoder::code_sign(BitCoder& coder, const ElementPlace& place, bool is_mirrored,
                               std::span<std::int32_t> numbers) {
  std::uint32_t positive = 0;
  for (const Index other : place.ring) positive += number(other, 3) > 0 ? 1 : 0;
  std::uint32_t context = positive == 0 ? 4 : positive == place.ring.size() ? 5 : 6;
  if (place.ring.empty()) context = place.beside != kNoIndex && number(place.beside, 3) > 0 ? 7 : 8;
  context += is_mirrored ? 5 : 0;
  numbers[3] = bits_.code(coder, numbers[3] > 0 ? 1 : 0, std::array<std::uint32_t, 1>{context}, 0) != 0 ? 1 : -1;
}

bool DirectionCoder::code_point(BitCoder& coder, const Vec3i& expected, NumberCoder::Guess guess,
                                std::span<std::int32_t> numbers) {
  const std::int64_t size = spec().highest();
  const std::int64_t sum = std::abs(expected.x) + std::abs(expected.y) + std::abs(expected.z);
  const int top = longest_axis(expected);
  const Vec3i point = sum == 0 ? Vec3i{0, 0, 16 * size} : expected * (16 * size) / sum;
  std::int64_t rest = size;
  off_ = 0;
  for (int i = 1; i < 3; ++i) {
    const int c = (top + i) % 3;
    guess.value = point[c];
    const auto at = static_cast<std::size_t>(c);
    const std::int64_t coded = numbers_.code(coder, numbers[at], guess);
    if (std::abs(coded) > rest) return false;
    rest -= std::abs(coded);
    numbers[at] = static_cast<std::int32_t>(coded);
    const std::int64_t off = 16 * coded - guess.value;
    off_ += std::abs(off);
    guess.hints[2] = NumberCoder::hint(log_of(off), 0, 12);
    ++guess.kind;
  }
  const auto at = static_cast<std::size_t>(top);
  const bool as_expected = (numbers[at] >= 0) == (expected[top] >= 0);
  const std::array<std::uint32_t, 1> context = {rest < size / 4 ? 1U : 0U};
  if (rest == 0 || bits_.code(coder, as_expected ? 1 : 0, context, 0) != 0)
    numbers[at] = static_cast<std::int32_t>(expected[top] >= 0 ? rest : -rest);
  else
    numbers[at] = static_cast<std::int32_t>(expected[top] >= 0 ? -rest : rest);
  return true;
}

/// `expected`: a unit vector; `log_error`: sixteenths of the logarithm of what is expected, of 2^14.
bool FittedDirectionCoder::code_near(BitCoder& coder, const Vec3i& expected, int log_error, std::uint32_t kind,
                                     std::span<std::int32_t> numbers) {
  const std::int64_t size = spec().highest();
  const std::int64_t sum = std::abs(expected.x) + std::abs(expected.y) + std::abs(expected.z);
  NumberCoder::Guess guess;
  guess.scale = std::max<std::int64_t>(1, exp2_16(log_error) * 16 * size / std::max<std::int64_t>(sum, 1 << kUnitBits));
  guess.kind = 2 * kind;
  guess.hints[0] = NumberCoder::hint(log_error, 0, 14);
  guess.hints[1] = NumberCoder::hint(static_cast<int>(sum >> (kUnitBits - 4)), 16, 1);
  return code_point(coder, expected, guess, numbers);
}

bool FittedDirectionCoder::code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) {
  if (place.ring.empty()) {
    if (numbers.size() > 3) code_sign(coder, place, false, numbers);
    misses_.note(place.wedge, misses_.usual());
    const Vec3i near = place.beside != kNoIndex ? direction(place.beside) : Vec3i{};
    if (!code_near(coder, near, 16 * 12, 1, numbers)) return false;
    note_direction(place.wedge);
    return true;
  }
  const Vec3i around = mean_of_ring(place);
  const Hints hints = numbers.size() > 3 ? tangents_of(place, around) : normals_of(place);
  if (numbers.size() > 3) code_sign(coder, place, hints.is_mirrored, numbers);
  const Vec3i& own = hints.own;
  const auto count = static_cast<std::int64_t>(place.ring.size());
  std::int64_t turn = 0, off = 0;
  for (const Index other : place.ring) {
    const Vec3i there = direction(other);
    turn += length_of(there - around);
    off += length_of(there - (numbers.size() > 3 ? own : place.normals[other]));
  }
  std::array<Pulls::Features, 3> pulls{};
  Vec3i expected = own;
  for (int c = 0; c < 3; ++c) {
    Pulls::Features& f = pulls[static_cast<std::size_t>(c)];
    f = {(around[c] - own[c]) / 4, (hints.even[c] - own[c]) / 4, (hints.third[c] - own[c]) / 4,
         (hints.surface_around[c] - own[c]) / 4};
    expected[c] += 4 * pulls_.predict(f);
  }
  expected = unit(expected);
  const int log_one = 64;
  const Traits::Features traits = {log_one,
                                   misses_.around(place),
                                   log_of(length_of(around - own)),
                                   log_of(hints.spread),
                                   log_of(turn / count),
                                   log_of(length_of(hints.even - own)),
                                   log_of(off / count),
                                   log_of(length_of(hints.surface_around - own))};
  const auto log_error = static_cast<int>(std::clamp<std::int64_t>(size_.predict(traits), 16, 16 * 14));
  if (!code_near(coder, expected, log_error, 0, numbers)) return false;

  const Vec3i found = note_direction(place.wedge);
  for (int c = 0; c < 3; ++c) pulls_.add(pulls[static_cast<std::size_t>(c)], (found[c] - own[c]) / 4);
  pulls_.end_sample();
  const int miss = log_of(length_of(found - expected) + (1 << kUnitBits) / (4 * spec().highest()));
  size_.add(traits, miss);
  size_.end_sample();
  misses_.note(place.wedge, miss);
  return true;
}

}  // namespace lodestone::detail
