#include "displaced_torus.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

namespace lodestone::bench {
namespace {

constexpr double kTube = 0.4;       // its radius; the torus' own is 1
constexpr int kOctaves = 6;         // each of twice the frequency
constexpr double kFrequency = 2;    // of the first, lattice points for each unit of length
constexpr double kAmplitude = 0.2;  // of the first
constexpr double kFall = 0.4;       // of the amplitude from one octave to the next
constexpr double kJitter = 1. / 3;  // of a step: on a regular grid everything ties

/// Returns the same number in [−1, 1) for the same three everywhere.
double random_at(std::int64_t x, std::int64_t y, std::int64_t z) {
  const auto in = [](std::int64_t i) { return static_cast<std::uint64_t>(i); };
  std::uint64_t h = in(x)*0x9E3779B97F4A7C15U ^ in(y)*0xC2B2AE3D27D4EB4FU ^ in(z)*0x165667B19E3779F9U;
  h = (h ^ (h >> 30U)) * 0xBF58476D1CE4E5B9U;  // splitmix64
  h = (h ^ (h >> 27U)) * 0x94D049BB133111EBU;
  h ^= h >> 31U;
  return static_cast<double>(h >> 11U) * 0x1p-52 - 1;
}

/// Random numbers at the points of a lattice, blended between them.
double noise(const Vec3& p) {
  const std::array<double, 3> at = {p.x, p.y, p.z};
  std::array<std::int64_t, 3> cell{};
  std::array<double, 3> share{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double floor = std::floor(at[k]);
    const double t = at[k] - floor;
    cell[k] = static_cast<std::int64_t>(floor);
    share[k] = t * t * (3 - 2 * t);
  }
  double sum = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const unsigned dx = corner & 1U, dy = corner >> 1U & 1U, dz = corner >> 2U;
    const double weight =
        (dx != 0 ? share[0] : 1 - share[0]) * (dy != 0 ? share[1] : 1 - share[1]) * (dz != 0 ? share[2] : 1 - share[2]);
    sum += weight * random_at(cell[0] + dx, cell[1] + dy, cell[2] + dz);
  }
  return sum;
}

double displacement(const Vec3& p) {
  double sum = 0;
  double frequency = kFrequency;
  double amplitude = kAmplitude;
  for (int octave = 0; octave < kOctaves; ++octave) {
    sum += amplitude * noise(p * frequency);
    frequency *= 2;
    amplitude *= kFall;
  }
  return sum;
}

/// The point at two angles, in turns.
Vec3 point_at(double around, double across) {
  constexpr double kTurn = 2 * std::numbers::pi;
  const Vec3 outwards{std::cos(kTurn * around), std::sin(kTurn * around), 0};
  const Vec3 away = outwards * std::cos(kTurn * across) + Vec3{0, 0, std::sin(kTurn * across)};
  const Vec3 p = outwards + away * kTube;
  return p + away * displacement(p);
}

}  // namespace

TriangleSoup displaced_torus(std::size_t faces) {
  // Squares cut in two, about as wide as high: the way around is 1 / kTube times as long as that across.
  const auto wanted = static_cast<double>(faces);
  const auto rows = std::max(3L, std::lround(std::sqrt(wanted * kTube / 2)));
  const auto columns = std::max(3L, std::lround(wanted / (2 * static_cast<double>(rows))));
  TriangleSoup soup;
  soup.positions.reserve(static_cast<std::size_t>(rows * columns));
  soup.indices.reserve(static_cast<std::size_t>(6 * rows * columns));
  for (long j = 0; j < rows; ++j) {
    for (long i = 0; i < columns; ++i) {
      const double u = static_cast<double>(i) + kJitter * random_at(i, j, 1);
      const double v = static_cast<double>(j) + kJitter * random_at(i, j, 2);
      const Vec3 p = point_at(u / static_cast<double>(columns), v / static_cast<double>(rows));
      soup.positions.push_back(to_float(p));
    }
  }
  const auto at = [&](long i, long j) { return static_cast<Index>(j % rows * columns + i % columns); };
  for (long j = 0; j < rows; ++j) {
    for (long i = 0; i < columns; ++i) {
      const Index a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
      soup.indices.insert(soup.indices.end(), {a, b, c, a, c, d});
    }
  }
  return soup;
}

}  // namespace lodestone::bench
