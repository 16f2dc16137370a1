// Texture coordinates are predicted by the plane that fits those of the ring best, over the ring's projection along the
// normal, at the place where the vertex is known to lie: charts are close to linear maps of the surface nearly
// everywhere. Where the sector is narrow, vertices beyond the ring steady the plane.

#include "codec/texture_coder.h"

#include <algorithm>
#include <cstdlib>

#include "codec/ring.h"

namespace lodestone::detail {
namespace {

constexpr std::int64_t kOne = 256;          // what the radius is in features
constexpr int kCoordinateBits = 10;         // of projected positions
constexpr std::int64_t kMostOff = 1 << 20;  // from the mean, sixteenths
constexpr int kUsualTextureMiss = -32;

}  // namespace

FittedTextureCoder::FittedTextureCoder(const AttributeSpec& spec)
    : ElementCoder(spec),
      pulls_{Pulls({kWholeWeight, 0, 0}, 1 << 17), Pulls({kWholeWeight, 0, 0}, 1 << 17)},
      size_{Traits({0, kHalfWeight, 0, kHalfWeight}, 1 << 14), Traits({0, kHalfWeight, 0, kHalfWeight}, 1 << 14)},
      misses_(kUsualTextureMiss) {}

void FittedTextureCoder::add_point(const ElementPlace& place, const Vec3i& along_x, const Vec3i& along_y, Index wedge) {
  const Vec3i d = place.positions[place.wedges.vertex(wedge)] - place.positions[place.wedges.vertex(place.wedge)];
  points_.push_back({dot(d, along_x) >> 4, dot(d, along_y) >> 4, {16 * number(wedge, 0), 16 * number(wedge, 1)}});
}

/// Gathers the points around, projected along the normal.
void FittedTextureCoder::gather(const ElementPlace& place) {
  points_.clear();
  const Vec3i n = unit(place.area());
  const Vec3i first =
      place.positions[place.wedges.vertex(place.ring.front())] - place.positions[place.wedges.vertex(place.wedge)];
  const Vec3i along_x = unit(first * 16 - times(n, along(first * 16, n)));
  const Vec3i across = cross(n, along_x);
  const Vec3i along_y = {across.x >> kUnitBits, across.y >> kUnitBits, across.z >> kUnitBits};
  for (const Index wedge : place.ring) add_point(place, along_x, along_y, wedge);
  ring_count_ = points_.size();
  is_open_ = place.ring.size() > place.faces.size();
  for (const Index face : place.faces) {
    const Index half = 3 * face + 1, twin = place.mesh.twin(half);
    if (twin == kNoIndex || place.mesh.is_seam(half)) continue;
    const Index beyond = place.mesh.wedge(previous_corner(twin));
    if (beyond < place.wedge) add_point(place, along_x, along_y, beyond);
  }
  std::int64_t largest = 0;
  for (const Point& p : points_) largest = std::max({largest, std::abs(p.x), std::abs(p.y)});
  int shift = 0;
  while (largest >> shift >= (std::int64_t{1} << kCoordinateBits)) ++shift;
  for (Point& p : points_) p.x >>= shift, p.y >>= shift;
}

/// Fits a plane to the first points: its value at the vertex, and how far it is from the ring.
void FittedTextureCoder::fit_plane(std::size_t count, Guess& guess) const {
  const auto n = static_cast<std::int64_t>(count);
  std::int64_t x_sum = 0, y_sum = 0;
  Pair sum{};
  for (std::size_t i = 0; i < count; ++i) {
    x_sum += points_[i].x;
    y_sum += points_[i].y;
    for (std::size_t c = 0; c < 2; ++c) sum[c] += points_[i].value[c];
  }
  const std::int64_t x_mean = divide(x_sum, n), y_mean = divide(y_sum, n);
  const Pair mean = {divide(sum[0], n), divide(sum[1], n)};
  std::int64_t xx = 0, xy = 0, yy = 0;
  Pair xv{}, yv{};
  for (std::size_t i = 0; i < count; ++i) {
    const std::int64_t x = points_[i].x - x_mean, y = points_[i].y - y_mean;
    xx += x * x;
    xy += x * y;
    yy += y * y;
    for (std::size_t c = 0; c < 2; ++c) {
      const std::int64_t off = std::clamp(points_[i].value[c] - mean[c], -kMostOff, kMostOff);
      xv[c] += x * off;
      yv[c] += y * off;
    }
  }
  int shift = 0;
  while ((xx + yy) >> shift >= std::int64_t{1} << 20) ++shift;
  const std::int64_t ridge = ((xx + yy) >> (shift + 7)) + 1;
  xx = (xx >> shift) + ridge;
  yy = (yy >> shift) + ridge;
  xy >>= shift;
  const std::int64_t det = std::max<std::int64_t>(xx * yy - xy * xy, 1);
  std::int64_t bend = 0;
  for (std::size_t c = 0; c < 2; ++c) {
    const std::int64_t a = yy * (xv[c] >> shift) - xy * (yv[c] >> shift);
    const std::int64_t b = xx * (yv[c] >> shift) - xy * (xv[c] >> shift);
    const auto at = [&](std::int64_t x, std::int64_t y) {
      return mean[c] + std::clamp((a * (x - x_mean) + b * (y - y_mean)) / det, -kMostOff, kMostOff);
    };
    guess.pulls[0][c] = at(0, 0) - guess.mean[c];
    for (std::size_t i = 0; i < ring_count_; ++i)
      bend += std::abs(points_[i].value[c] - at(points_[i].x, points_[i].y));
  }
  guess.bend = bend / static_cast<std::int64_t>(ring_count_);
}

FittedTextureCoder::Guess FittedTextureCoder::look() {
  Guess guess;
  const auto n = static_cast<std::int64_t>(ring_count_);
  for (std::size_t c = 0; c < 2; ++c) {
    std::int64_t sum = 0;
    for (std::size_t i = 0; i < ring_count_; ++i) sum += points_[i].value[c];
    guess.mean[c] = divide(sum, n);
  }
  std::int64_t off = 0;
  for (std::size_t i = 0; i < ring_count_; ++i)
    for (std::size_t c = 0; c < 2; ++c) off += std::abs(points_[i].value[c] - guess.mean[c]);
  guess.radius = std::max<std::int64_t>(16, off / n);
  // The closer, the more.
  std::int64_t weights = 0;
  Pair near{};
  for (std::size_t i = 0; i < ring_count_; ++i) {
    const Point& p = points_[i];
    const std::int64_t weight = (1 << 20) / (16 + square_root(static_cast<std::uint64_t>(p.x * p.x + p.y * p.y)));
    weights += weight;
    for (std::size_t c = 0; c < 2; ++c) near[c] += weight * (p.value[c] - guess.mean[c]);
  }
  for (std::size_t c = 0; c < 2; ++c) guess.pulls[1][c] = near[c] / weights;
  Guess wide = guess;
  fit_plane(points_.size(), wide);
  fit_plane(ring_count_, guess);
  if (ring_count_ < 3) std::swap(wide.pulls[0], guess.pulls[0]);
  for (std::size_t c = 0; c < 2; ++c) guess.pulls[2][c] = wide.pulls[0][c] - guess.pulls[0][c];
  return guess;
}

bool FittedTextureCoder::code_pair(BitCoder& coder, const Pair& expected, std::int64_t error, std::uint32_t kind,
                                   std::uint32_t hint, std::span<std::int32_t> numbers) {
  const std::int64_t lowest = spec().lowest(), highest = spec().highest();
  NumberCoder::Guess guess;
  guess.scale = std::max<std::int64_t>(error, 1);
  guess.hints[0] = hint;
  guess.hints[1] = NumberCoder::hint(log_of(error), 0, 12);
  for (std::size_t c = 0; c < 2; ++c) {
    guess.kind = 2 * kind + static_cast<std::uint32_t>(c);
    guess.value = std::clamp(expected[c], 16 * lowest, 16 * highest);
    const std::int64_t coded = numbers_.code(coder, numbers[c], guess);
    if (coded < lowest || coded > highest) return false;
    numbers[c] = static_cast<std::int32_t>(coded);
    const std::int64_t off = std::abs(16 * coded - guess.value);
    guess.hints[2] = NumberCoder::hint(log_of(off + guess.scale / 16) - log_of(guess.scale) + 64, 0, 8);
  }
  return true;
}

bool FittedTextureCoder::code_alone(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) {
  const std::int64_t lowest = spec().lowest(), highest = spec().highest();
  NumberCoder::Guess guess;
  guess.scale = (highest - lowest) * 2;
  for (std::size_t c = 0; c < 2; ++c) {
    guess.kind = static_cast<std::uint32_t>(c);
    guess.value = 16 * (place.beside != kNoIndex ? number(place.beside, c) : lowest + (highest - lowest) / 2);
    const std::int64_t coded = alone_.code(coder, numbers[c], guess);
    if (coded < lowest || coded > highest) return false;
    numbers[c] = static_cast<std::int32_t>(coded);
  }
  misses_.note(place.wedge, misses_.usual());
  return true;
}

bool FittedTextureCoder::code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) {
  if (place.ring.empty()) return code_alone(coder, place, numbers);
  gather(place);
  const Guess guess = look();
  Pulls& pulls = pulls_[is_open_ ? 1 : 0];
  Traits& size = size_[is_open_ ? 1 : 0];
  std::array<Pulls::Features, 2> features{};
  Pair expected{};
  for (std::size_t c = 0; c < 2; ++c) {
    for (std::size_t i = 0; i < kPulls; ++i) features[c][i] = guess.pulls[i][c] * kOne / guess.radius;
    expected[c] = guess.mean[c] + pulls.predict(features[c]) * guess.radius / kOne;
  }
  const int log_radius = log_of(guess.radius), around = misses_.around(place);
  const auto relative = [&](std::int64_t x) { return log_of(x) - log_radius; };
  const auto across = [&](std::size_t i) { return std::abs(guess.pulls[i][0]) + std::abs(guess.pulls[i][1]); };
  const Traits::Features traits = {
      64, around, relative(across(0)), relative(guess.bend), relative(16), relative(across(2)), relative(across(1))};
  const auto log_error = static_cast<int>(std::clamp<std::int64_t>(log_radius + size.predict(traits), 0, 16 * 30));
  if (!code_pair(coder, expected, exp2_16(log_error), is_open_ ? 1 : 0, NumberCoder::hint(around, -112, 8), numbers))
    return false;

  std::int64_t off = 3;
  for (std::size_t c = 0; c < 2; ++c) {
    const std::int64_t found = 16 * std::int64_t{numbers[c]};
    pulls.add(features[c], (found - guess.mean[c]) * kOne / guess.radius);
    off += std::abs(found - expected[c]) / 2;
  }
  pulls.end_sample();
  const int miss = std::clamp(log_of(off) - log_radius, -1000, 1000);
  size.add(traits, miss);
  size.end_sample();
  misses_.note(place.wedge, miss);
  return true;
}

}  // namespace lodestone::detail
