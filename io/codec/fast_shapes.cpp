// A new vertex is expected near the mean of its ring, away from the mean of the vertices beyond, and towards the planes
// of the faces beyond; one that moves, where it lies. Two coordinates are coded first; they tell where the plane across
// the ring's normal has the third, in which that is steepest.

#include "codec/fast_shapes.h"

#include <algorithm>
#include <cstdlib>

namespace lodestone::detail {
namespace {

constexpr Miss kUsualMiss = {-48, -32};  // until something is learnt: sixteenths of logarithms over the radius
constexpr int kShareBits = 20;
constexpr std::int64_t kOneShare = std::int64_t{1} << kShareBits;
constexpr std::int64_t kMostShapeOff = std::int64_t{1} << 26;

std::int64_t cut(std::int64_t x, int bits) {
  return std::clamp(x, -(std::int64_t{1} << bits), std::int64_t{1} << bits);
}

/// The mean of so many positions that add up to `sum`, in sixteenths: nearly, and by one division.
Vec3i mean_of(const Vec3i& sum, std::int64_t count) {
  const std::int64_t share = kOneShare / count;
  return {sum.x * share >> (kShareBits - 4), sum.y * share >> (kShareBits - 4), sum.z * share >> (kShareBits - 4)};
}

/// A quarter of the way to a plane that is `distance` times the normal's length away.
Vec3i towards_plane(Vec3i normal, std::int64_t distance) {
  const int shift = shorten(normal, 16);
  const auto square = static_cast<std::int64_t>(squared(normal));
  if (square == 0) return {};
  const std::int64_t share = cut(cut(distance >> shift, 38) * (1 << 24) / square, 44);
  return {normal.x * share >> 26, normal.y * share >> 26, normal.z * share >> 26};
}

}  // namespace

void FastShapes::add_base() {
  misses_.emplace_back();
  base_count_ = misses_.size();
}

void FastShapes::add_loose() { misses_.push_back(kUsualMiss); }

/// Finds the vertices around and beyond: by themselves, so that the waits for memory overlap.
void FastShapes::gather(const Around& around) {
  const PatchMesh& mesh = around.mesh;
  ring_.clear();
  for (const Index half : around.outer) {
    const Index twin = mesh.twin(half);
    ring_.push_back({mesh.from(half), twin == kNoIndex ? kNoIndex : mesh.apex(twin)});
  }
  ring_.push_back({mesh.to(around.outer.back()), kNoIndex});
}

/// Looks at the ring of a new vertex.
void FastShapes::expect(const Around& around) {
  gather(around);
  const Vec3i first = around.positions[ring_.front().vertex];
  Vec3i sum, area, sum_beyond, area_beyond, from;
  std::int64_t squares = 0, planes = 0, count_beyond = 0;
  MissSum misses;
  const auto add_miss = [&](Index vertex) {
    if (vertex >= base_count_ && vertex < misses_.size()) misses.add(misses_[vertex]);
  };
  for (std::size_t i = 0; i + 1 < ring_.size(); ++i) {
    const Vec3i to = around.positions[ring_[i + 1].vertex] - first;
    sum = sum + from;
    squares += dot(from, from);
    area = area + cross(from, to);
    add_miss(ring_[i].vertex);
    if (const Index apex = ring_[i].beyond; apex != kNoIndex) {
      const Vec3i beyond = around.positions[apex] - first;
      const Vec3i normal = cross(to - from, from - beyond);
      sum_beyond = sum_beyond + beyond;
      ++count_beyond;
      area_beyond = area_beyond + normal;
      planes += dot(normal, from);
      add_miss(apex);
    }
    from = to;
  }
  if (!around.closed) add_miss(ring_.back().vertex);

  const auto count = static_cast<std::int64_t>(around.outer.size());
  const Vec3i centre = mean_of(sum, count);  // all as seen from the first corner
  const Vec3i mean = around.closed ? centre : from * 8;
  const std::int64_t square = (squares * (kOneShare / count) >> (kShareBits - 8)) - dot(centre, centre);
  log_radius_ = log2_16(static_cast<std::uint64_t>(std::max<std::int64_t>(square, 256))) / 2;
  const Vec3i pull = count_beyond == 0 ? Vec3i{} : mean - mean_of(sum_beyond, count_beyond);
  const Vec3i away = {pull.x * 5 >> 5, pull.y * 5 >> 5, pull.z * 5 >> 5};
  expected_.point = first * 16 + mean + away + towards_plane(area_beyond, 16 * planes - dot(area_beyond, mean));
  shorten(area, 28);
  expected_.normal = area;
  expected_.axis = longest_axis(area);

  const std::int64_t steepest = area[expected_.axis];
  const std::int64_t lift = steepest == 0 ? 0 : dot(pull, area) / steepest;
  const Miss usual = misses.mean().value_or(kUsualMiss);
  const int normal = (3 * usual.normal + log_of(std::abs(lift) + 3) - log_radius_) / 4;
  expected_.size = {std::clamp(normal + log_radius_, 16, 320), std::clamp(usual.tangent + log_radius_, 16, 320)};
}

/// Codes a position near the expected one; returns how far that was off.
Miss FastShapes::code_near(BitCoder& coder, NumberCoder& numbers, Vec3i& position) const {
  const Vec3i& n = expected_.normal;
  NumberCoder::Guess guess;
  const auto code = [&](int axis, std::int64_t mean) {
    guess.value = (expected_.point[axis] + mean) >> step();
    position[axis] = numbers.code(coder, position[axis] >> step(), guess) * (std::int64_t{1} << step());
    return std::clamp(position[axis] * 16 - expected_.point[axis], -kMostShapeOff, kMostShapeOff);
  };
  const int z = expected_.axis, x = z == 0 ? 1 : 0, y = 3 - z - x;
  guess.scale = exp2_16(expected_.size.tangent) >> step();
  const std::int64_t off_x = code(x, 0), off_y = code(y, 0);
  const std::int64_t slope = n[z] == 0 ? 0 : -(n[x] * off_x + n[y] * off_y) / n[z];
  const std::int64_t mean = std::clamp(slope, -kMostShapeOff, kMostShapeOff);
  guess.kind = 1;
  guess.scale = exp2_16(expected_.size.normal) >> step();
  const std::int64_t off_z = code(z, mean);
  return {log_of(std::abs(off_z - mean) + 3),
          log2_16(static_cast<std::uint64_t>(off_x * off_x + off_y * off_y + 9)) / 2};
}

bool FastShapes::code_new(BitCoder& coder, const Around& around, Vec3i& position) {
  expect(around);
  const Miss miss = code_near(coder, new_, position);
  misses_.push_back({miss.normal - log_radius_, miss.tangent - log_radius_});
  return is_on_grid(position);
}

bool FastShapes::code_moved(BitCoder& coder, const Around& around, Index vertex, Vec3i& position) {
  const PatchMesh& mesh = around.mesh;
  const Vec3i first = around.positions[mesh.from(around.outer.front())];
  Vec3i area;
  MissSum misses;
  const auto add_miss = [&](Index corner) {
    if (corner < moved_.size() && moved_[corner]) misses.add(*moved_[corner]);
  };
  for (const Index half : around.outer) {
    area = area + cross(around.positions[mesh.from(half)] - first, around.positions[mesh.to(half)] - first);
    add_miss(mesh.from(half));
  }
  if (!around.closed) add_miss(mesh.to(around.outer.back()));
  shorten(area, 28);
  const int usual = 16 * from() + 40;
  const Miss size = misses.mean().value_or(Miss{usual, usual});
  expected_ = {around.positions[vertex] * 16,
               area,
               longest_axis(area),
               {std::clamp(size.normal, 16, 320), std::clamp(size.tangent, 16, 320)}};
  moved_[vertex] = code_near(coder, moves_, position);
  return is_on_grid(position);
}

}  // namespace lodestone::detail
