// As the fitted coders of directions and texture coordinates, but from one prediction each, with fixed weights; the
// sizes of errors are those of errors around.

#include "codec/fast_attributes.h"

#include <algorithm>
#include <bit>
#include <cstdlib>

namespace lodestone::detail {
namespace {

constexpr int kUsualFastTextureMiss = -32;
constexpr std::int64_t kMostFastOff = 1 << 20;  // from the mean, sixteenths
constexpr std::int64_t kMostSlope = std::int64_t{1} << 51;

/// The surface's normal at a wedge, by area; not longer than 2^24.
Vec3i surface_of(const ElementPlace& place) {
  Vec3i sum = place.area();
  shorten(sum, 24);
  return sum;
}

}  // namespace

FastDirectionCoder::FastDirectionCoder(const AttributeSpec& spec)
    : DirectionCoder(spec), misses_(log_of(spec.highest())) {}

/// The sum of the ring's directions; not longer than 2^24.
Vec3i FastDirectionCoder::around(const ElementPlace& place) const {
  Vec3i sum;
  for (const Index other : place.ring) sum = sum + numbers_of(other);
  shorten(sum, 24);
  return sum;
}

/// Where texture coordinates grow, along the surface; where there are none, as around.
Vec3i FastDirectionCoder::tangent(const ElementPlace& place, bool& is_mirrored) const {
  Vec3i normal = surface_of(place), sum;
  if (place.normal != nullptr) {
    const std::span<const std::int32_t> n = place.normal->numbers(place.wedge);
    normal = {n[0], n[1], n[2]};
  }
  is_mirrored = place.texture != nullptr && visit_growth(place, [&](const Vec3i& growth) { sum = sum + growth; });
  if (sum == Vec3i{}) sum = around(place);
  shorten(sum, 24);
  shorten(normal, 14);
  const std::int64_t square = dot(normal, normal), height = dot(sum, normal);
  Vec3i across = square == 0 ? sum : sum * square - normal * height;
  shorten(across, 24);
  return across;
}

bool FastDirectionCoder::code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) {
  const bool has_sign = numbers.size() > 3, is_alone = place.ring.empty();
  bool is_mirrored = false;
  Vec3i expected;
  if (is_alone && place.beside != kNoIndex) expected = numbers_of(place.beside);
  if (!is_alone) expected = has_sign ? tangent(place, is_mirrored) : surface_of(place);
  if (!is_alone && expected == Vec3i{}) expected = around(place);
  if (has_sign) code_sign(coder, place, is_mirrored, numbers);
  NumberCoder::Guess guess;
  guess.scale = exp2_16(misses_.around(place));
  guess.kind = is_alone ? 2 : 0;
  if (!code_point(coder, expected, guess, numbers)) return false;
  misses_.note(place.wedge, log_of(off() / 2 + 3));
  return true;
}

FastTextureCoder::FastTextureCoder(const AttributeSpec& spec) : ElementCoder(spec), misses_(kUsualFastTextureMiss) {}

void FastTextureCoder::gather(const ElementPlace& place) {
  const Vec3i n = surface_of(place);
  const int z = longest_axis(n), x = z == 0 ? 1 : 0, y = 3 - z - x;
  const Vec3i own = place.positions[place.wedges.vertex(place.wedge)];
  points_.clear();
  std::uint64_t largest = 0;
  for (const Index wedge : place.ring) {
    const Vec3i d = place.positions[place.wedges.vertex(wedge)] - own;
    points_.push_back({d[x], d[y], {16 * number(wedge, 0), 16 * number(wedge, 1)}});
    largest |= static_cast<std::uint64_t>(std::abs(d[x]) | std::abs(d[y]));
  }
  const int shift = std::max(static_cast<int>(std::bit_width(largest)) - 10, 0);
  for (Point& p : points_) p.x >>= shift, p.y >>= shift;
}

/// Finds the plane's numbers at the vertex, and how far the ring's lie from their mean.
FastTextureCoder::Pair FastTextureCoder::expect(std::int64_t& radius) const {
  const auto count = static_cast<std::int64_t>(points_.size());
  std::int64_t x_sum = 0, y_sum = 0;
  Pair mean{};
  for (const Point& p : points_) {
    x_sum += p.x;
    y_sum += p.y;
    for (std::size_t c = 0; c < 2; ++c) mean[c] += p.value[c];
  }
  const std::int64_t x_mean = divide(x_sum, count), y_mean = divide(y_sum, count);
  for (std::int64_t& m : mean) m = divide(m, count);
  std::int64_t xx = 0, xy = 0, yy = 0, off_sum = 0;
  Pair xv{}, yv{};
  for (const Point& p : points_) {
    const std::int64_t x = p.x - x_mean, y = p.y - y_mean;
    xx += x * x;
    xy += x * y;
    yy += y * y;
    for (std::size_t c = 0; c < 2; ++c) {
      const std::int64_t off = std::clamp(p.value[c] - mean[c], -kMostFastOff, kMostFastOff);
      off_sum += std::abs(off);
      xv[c] += x * off;
      yv[c] += y * off;
    }
  }
  radius = std::max<std::int64_t>(16, off_sum / count);
  const int shift = std::max(static_cast<int>(std::bit_width(static_cast<std::uint64_t>(xx + yy))) - 20, 0);
  const std::int64_t ridge = ((xx + yy) >> (shift + 7)) + 1;
  xx = (xx >> shift) + ridge;
  yy = (yy >> shift) + ridge;
  xy >>= shift;
  const std::int64_t det = std::max<std::int64_t>(xx * yy - xy * xy, 1);
  Pair expected = mean;
  for (std::size_t c = 0; c < 2; ++c) {
    const std::int64_t a = std::clamp(yy * (xv[c] >> shift) - xy * (yv[c] >> shift), -kMostSlope, kMostSlope);
    const std::int64_t b = std::clamp(xx * (yv[c] >> shift) - xy * (xv[c] >> shift), -kMostSlope, kMostSlope);
    expected[c] -= std::clamp((a * x_mean + b * y_mean) / det, -kMostFastOff, kMostFastOff);
  }
  return expected;
}

bool FastTextureCoder::code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) {
  const std::int64_t lowest = spec().lowest(), highest = spec().highest();
  const bool is_alone = place.ring.empty();
  NumberCoder& coder_of = is_alone ? alone_ : numbers_;
  Pair expected{};
  std::int64_t radius = 16;
  NumberCoder::Guess guess;
  if (is_alone) {
    guess.scale = (highest - lowest) * 2;
    for (std::size_t c = 0; c < 2; ++c)
      expected[c] = 16 * (place.beside != kNoIndex ? number(place.beside, c) : lowest + (highest - lowest) / 2);
  } else {
    gather(place);
    expected = expect(radius);
    guess.scale = exp2_16(log_of(radius) + misses_.around(place));
  }
  std::int64_t off = 3;
  for (std::size_t c = 0; c < 2; ++c) {
    guess.kind = static_cast<std::uint32_t>(c);
    guess.value = std::clamp(expected[c], 16 * lowest, 16 * highest);
    const std::int64_t coded = coder_of.code(coder, numbers[c], guess);
    if (coded < lowest || coded > highest) return false;
    numbers[c] = static_cast<std::int32_t>(coded);
    off += std::abs(16 * coded - guess.value) / 2;
  }
  misses_.note(place.wedge, is_alone ? misses_.usual() : log_of(off) - log_of(radius));
  return true;
}

}  // namespace lodestone::detail
