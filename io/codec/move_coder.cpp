#include "codec/move_coder.h"

#include <algorithm>
#include <cstdlib>

namespace lodestone::detail {

MoveCoder::MoveCoder()
    : shift_({0, 0, 0, 0}, {0, 0, 0, 0}, 1 << 17),
      normal_size_({0, kHalfWeight, 0, kQuarterWeight, 0, 0}, 1 << 14),
      tangent_size_({0, kHalfWeight, 0, 0, kQuarterWeight, 0}, 1 << 14) {}

void MoveCoder::start(std::size_t vertex_count) {
  misses_.assign(vertex_count, std::nullopt);
  went_.assign(vertex_count, {});
}

/// How well the moves of vertices around were predicted.
void MoveCoder::find_misses(const Ring& ring) {
  MissSum sum;
  Vec3i went;
  for (const Index corner : ring.corners()) {
    if (corner >= misses_.size() || !misses_[corner]) continue;
    sum.add(*misses_[corner]);
    went = went + went_[corner];
  }
  around_ = sum.mean();
  went_around_ = around_ ? divide(went, sum.count()) : Vec3i{};
}

void MoveCoder::code(BitCoder& coder, const Ring& ring, bool closed, const Vec3i& from, int from_step, int step,
                     Vec3i& position) {
  find_misses(ring);
  start_ = from * 16;
  point_ = start_ + shift_.predict({ring.mean - start_, ring.pulls[0], ring.pulls[3], went_around_}, ring);
  const int log_one = 64;
  const int log_radius = log2_16(static_cast<std::uint64_t>(ring.radius));
  const int log_step = 16 * from_step + log_one;
  const Miss around = around_.value_or(Miss{log_step - 24 - log_radius, log_step - 24 - log_radius});
  traits_ = {log_one,       log_step - log_radius, log_of(shift_.normal()[0]) - log_one,
             around.normal, around.tangent,        (around_ ? 0 : log_one)};
  const auto size = [&](const Traits& fit) {
    return static_cast<int>(std::clamp<std::int64_t>(log_radius + fit.predict(traits_), 16, 16 * 20));
  };
  CoordinateCoder::Expected expected = {point_, {size(normal_size_), size(tangent_size_)}, closed ? 1 : 0, around_};
  coordinates_.code(coder, ring, expected, step, position);
}

void MoveCoder::learn(Index vertex, const Vec3i& position, const Ring& ring) {
  went_[vertex] = position * 16 - start_;
  misses_[vertex] = miss_of(position * 16 - point_, ring);
  shift_.learn(went_[vertex], ring);
  normal_size_.add(traits_, misses_[vertex]->normal);
  normal_size_.end_sample();
  tangent_size_.add(traits_, misses_[vertex]->tangent);
  tangent_size_.end_sample();
}

}  // namespace lodestone::detail
