#include "codec/move_coder.h"

#include <algorithm>
#include <cstdlib>

namespace lodestone::detail {
namespace {

constexpr std::size_t kMostFaces = 256;  // of a star that are looked at

}  // namespace

MoveCoder::MoveCoder(int grid_bits)
    : grid_bits_(grid_bits),
      shift_({0, 0, 0, 0}, {0, 0, 0, 0}, 1 << 17),
      normal_size_({0, kHalfWeight, 0, kQuarterWeight, 0, 0}, 1 << 14),
      tangent_size_({0, kHalfWeight, 0, 0, kQuarterWeight, 0}, 1 << 14) {}

void MoveCoder::start(int from, int to, std::size_t vertex_count) {
  from_ = from;
  to_ = to;
  misses_.assign(vertex_count, std::nullopt);
  went_.assign(vertex_count, {});
}

/// Finds the half-edges across from a vertex, in order around it; false where it has no face.
bool MoveCoder::find_star(const PatchMesh& mesh, Index half) {
  outer_.clear();
  if (half == kNoIndex) return false;
  // From the border on, where there is one.
  Index first = half;
  closed_ = true;
  for (std::size_t i = 0; i < kMostFaces; ++i) {
    const Index twin = mesh.twin(first);
    if (twin == kNoIndex) {
      closed_ = false;
      break;
    }
    first = next_corner(twin);
    if (first == half) break;
  }
  if (closed_) first = half;
  for (Index at = first; outer_.size() < kMostFaces;) {
    outer_.push_back(next_corner(at));
    at = mesh.twin(previous_corner(at));
    if (at == kNoIndex || at == first) {
      closed_ = at == first;
      break;
    }
  }
  return true;
}

/// How well the moves of vertices around were predicted.
void MoveCoder::find_misses() {
  Miss sum;
  Vec3i went;
  int count = 0;
  for (const Index corner : ring_.corners()) {
    if (corner >= misses_.size() || !misses_[corner]) continue;
    sum.normal += misses_[corner]->normal;
    sum.tangent += misses_[corner]->tangent;
    went = went + went_[corner];
    ++count;
  }
  around_.reset();
  went_around_ = count > 0 ? divide(went, count) : Vec3i{};
  if (count > 0) around_ = Miss{sum.normal / count, sum.tangent / count};
}

bool MoveCoder::code(BitCoder& coder, const PatchMesh& mesh, Index vertex, Index half, std::span<const Vec3i> positions,
                     std::span<const Vec3i> normals, Vec3i& position) {
  const Vec3i start = positions[vertex] * 16;
  if (!find_star(mesh, half)) {
    NumberCoder::Guess guess;
    guess.scale = std::max<std::int64_t>((std::int64_t{16} << from_) >> to_, 1);
    for (int c = 0; c < 3; ++c) {
      guess.value = start[c] >> to_;
      position[c] = bare_.code(coder, position[c] >> to_, guess) * (std::int64_t{1} << to_);
    }
    return is_on_grid(position, grid_bits_);
  }
  ring_.look(mesh, outer_, closed_, positions, normals);
  find_misses();
  const Vec3i point = start + shift_.predict({ring_.mean - start, ring_.pulls[0], ring_.pulls[3], went_around_}, ring_);
  const int log_one = 64;
  const int log_radius = log2_16(static_cast<std::uint64_t>(ring_.radius));
  const int log_step = 16 * from_ + log_one;
  const Miss around = around_.value_or(Miss{log_step - 24 - log_radius, log_step - 24 - log_radius});
  traits_ = {log_one,       log_step - log_radius, log_of(shift_.normal()[0]) - log_one,
             around.normal, around.tangent,        (around_ ? 0 : log_one)};
  const auto size = [&](const Traits& fit) {
    return static_cast<int>(std::clamp<std::int64_t>(log_radius + fit.predict(traits_), 16, 16 * 20));
  };
  CoordinateCoder::Expected expected = {point, {size(normal_size_), size(tangent_size_)}, closed_ ? 1 : 0, around_};
  coordinates_.code(coder, ring_, expected, to_, position);
  if (!is_on_grid(position, grid_bits_)) return false;
  went_[vertex] = position * 16 - start;
  misses_[vertex] = miss_of(position * 16 - point, ring_);
  shift_.learn(went_[vertex], ring_);
  normal_size_.add(traits_, misses_[vertex]->normal);
  normal_size_.end_sample();
  tangent_size_.add(traits_, misses_[vertex]->tangent);
  tangent_size_.end_sample();
  return true;
}

}  // namespace lodestone::detail
