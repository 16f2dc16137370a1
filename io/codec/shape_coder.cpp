#include "codec/shape_coder.h"

#include <algorithm>

#include "codec/fast_shapes.h"
#include "codec/fitted_shapes.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kMostFaces = 256;  // of a star that are looked at

}  // namespace

std::unique_ptr<ShapeCoder> ShapeCoder::make(bool is_fast, int grid_bits) {
  if (is_fast) return std::make_unique<FastShapes>(grid_bits);
  return std::make_unique<FittedShapes>(grid_bits);
}

void ShapeCoder::start_stage(int from, int to, std::size_t vertex_count) {
  from_ = from;
  step_ = to;
  forget_moves(vertex_count);
}

bool ShapeCoder::is_on_grid(const Vec3i& position) const {
  const std::int64_t end = std::int64_t{1} << grid_bits_;
  return std::min({position.x, position.y, position.z}) >= 0 && std::max({position.x, position.y, position.z}) < end;
}

/// Codes a position by itself. `value`, `scale`: sixteenths of the grid's step.
bool ShapeCoder::code_numbers(BitCoder& coder, NumberCoder& numbers, const Vec3i& value, std::int64_t scale,
                              Vec3i& position) const {
  NumberCoder::Guess guess;
  guess.scale = std::max<std::int64_t>(scale >> step_, 1);
  for (int c = 0; c < 3; ++c) {
    guess.value = value[c] >> step_;
    position[c] = numbers.code(coder, position[c] >> step_, guess) * (std::int64_t{1} << step_);
  }
  return is_on_grid(position);
}

bool ShapeCoder::code_base(BitCoder& coder, Vec3i& position) {
  add_base();
  const std::int64_t half = std::int64_t{16} << (grid_bits_ - 1);
  return code_numbers(coder, base_, {half, half, half}, half / 4, position);
}

bool ShapeCoder::code_loose(BitCoder& coder, const Vec3i& guess, Vec3i& position) {
  add_loose();
  return code_numbers(coder, loose_, guess * 16, std::int64_t{16} << (grid_bits_ - 5), position);
}

bool ShapeCoder::code_point(BitCoder& coder, const PatchMesh& mesh, std::span<const Index> star, bool closed,
                            const GridPoints& positions, Vec3i& position) {
  outer_.clear();
  for (const Index face : star) outer_.push_back(3 * face + 1);
  return code_new(coder, {mesh, outer_, closed, positions}, position);
}

bool ShapeCoder::code_move(BitCoder& coder, const PatchMesh& mesh, Index vertex, Index half,
                           const GridPoints& positions, Vec3i& position) {
  if (half == kNoIndex) return code_numbers(coder, bare_, positions[vertex] * 16, std::int64_t{16} << from_, position);
  find_star(mesh, half);
  return code_moved(coder, {mesh, outer_, closed_, positions}, vertex, position);
}

/// Finds the half-edges across from a vertex, in order around it.
void ShapeCoder::find_star(const PatchMesh& mesh, Index half) {
  outer_.clear();
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
}

Vec3i ShapeCoder::guess(const PatchMesh& mesh, std::span<const Index> star, bool closed, const GridPoints& positions) {
  const Vec3i first = positions[mesh.from(3 * star.front() + 1)];
  if (!closed) return divide(first + positions[mesh.to(3 * star.back() + 1)], 2);
  Vec3i sum;
  for (const Index face : star) sum = sum + positions[mesh.from(3 * face + 1)];
  return divide(sum, static_cast<std::int64_t>(star.size()));
}

}  // namespace lodestone::detail
