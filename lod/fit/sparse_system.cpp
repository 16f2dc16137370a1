// Conjugate gradients with the 3 × 3 blocks of the diagonal as preconditioner, after Hestenes, Stiefel: Methods of
// conjugate gradients for solving linear systems (1952).

#include "fit/sparse_system.h"

#include <algorithm>
#include <numeric>

#include <lodestone/core/detail/edges.h>

namespace lodestone::detail {
namespace {

constexpr double kEnough = 1e-6;  // of the squared residual at the start

double sum_of_products(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += dot(a[i], b[i]);
  return sum;
}

/// Pre: `m` is positive definite, or zero: then so is the result.
Symmetric3 inverse(const Symmetric3& m) {
  const Symmetric3 adjoint{m.yy * m.zz - m.yz * m.yz, m.xx * m.zz - m.zx * m.zx, m.xx * m.yy - m.xy * m.xy,
                           m.yz * m.zx - m.xy * m.zz, m.xy * m.zx - m.yz * m.xx, m.xy * m.yz - m.zx * m.yy};
  const double determinant = m.xx * adjoint.xx + m.xy * adjoint.xy + m.zx * adjoint.zx;
  Symmetric3 result;
  if (determinant > 0) result.add(adjoint, 1 / determinant);
  return result;
}

}  // namespace

SparseSystem::SparseSystem(const Mesh& mesh) : corner_vertex_(mesh.corner_wedge.size()) {
  for (Index c = 0; c < corner_vertex_.size(); ++c) corner_vertex_[c] = mesh.corner_vertex(c);
  const std::vector<HalfEdge> halves = sorted_edges(mesh);
  row_begin_.assign(mesh.vertex_count() + 1, 0);
  for_each_edge(halves, [&](Edge edge) {
    ++row_begin_[edge[0].low() + 1];
    column_.push_back(edge[0].high());
  });
  std::partial_sum(row_begin_.begin(), row_begin_.end(), row_begin_.begin());
  column_.shrink_to_fit();
  entry_.resize(corner_vertex_.size());
  for (Index c = 0; c < corner_vertex_.size(); ++c)
    entry_[c] = number_of(corner_vertex_[c], corner_vertex_[next_corner(c)]);
  clear();
}

void SparseSystem::clear() {
  value_.assign(column_.size(), {});
  diagonal_.assign(row_begin_.size() - 1, {});
  right_.assign(row_begin_.size() - 1, Vec3{});
}

/// Of two vertices, whichever comes first.
Index SparseSystem::number_of(Index a, Index b) const {
  const auto [row, column] = std::minmax(a, b);
  const auto begin = column_.begin() + row_begin_[row];
  const auto end = column_.begin() + row_begin_[row + 1];
  return static_cast<Index>(std::lower_bound(begin, end, column) - column_.begin());
}

void SparseSystem::add_face(Index face, const std::array<double, 6>& products, const std::array<Vec3, 3>& pulls,
                            const Symmetric3& metric) {
  for (Index k = 0; k < 3; ++k) {
    const Index corner = 3 * face + k;
    diagonal_[corner_vertex_[corner]].add(metric, products[k]);
    right_[corner_vertex_[corner]] += metric * pulls[k];
    if (products[3 + k] != 0) value_[entry_[corner]].add(metric, products[3 + k]);
  }
}

void SparseSystem::add(const Index* vertices, const double* weights, std::size_t count, const Vec3& target,
                       const Symmetric3& metric) {
  const Vec3 pull = metric * target;
  for (std::size_t i = 0; i < count; ++i) {
    diagonal_[vertices[i]].add(metric, weights[i] * weights[i]);
    right_[vertices[i]] += pull * weights[i];
    for (std::size_t j = i + 1; j < count; ++j) {
      const double product = weights[i] * weights[j];
      if (product != 0) value_[number_of(vertices[i], vertices[j])].add(metric, product);
    }
  }
}

/// What stands below the diagonal adds to rows that are yet to come: each gets its smaller neighbours first.
void SparseSystem::multiply(const std::vector<Vec3>& x, std::vector<Vec3>& out) const {
  for (std::size_t row = 0; row < out.size(); ++row) out[row] = diagonal_[row] * x[row];
  for (std::size_t row = 0; row < out.size(); ++row) {
    Vec3 sum = out[row];
    for (Index i = row_begin_[row]; i < row_begin_[row + 1]; ++i) {
      sum += value_[i] * x[column_[i]];
      out[column_[i]] += value_[i] * x[row];
    }
    out[row] = sum;
  }
}

void SparseSystem::solve(std::vector<Vec3>& x, int max_steps) const {
  const std::size_t count = x.size();
  std::vector<Vec3> residual(count), preconditioned(count), direction(count), image(count);
  std::vector<Symmetric3> inverses(count);
  for (std::size_t i = 0; i < count; ++i) inverses[i] = inverse(diagonal_[i]);
  const auto precondition = [&] {
    for (std::size_t i = 0; i < count; ++i) preconditioned[i] = inverses[i] * residual[i];
  };
  multiply(x, image);
  for (std::size_t i = 0; i < count; ++i) residual[i] = right_[i] - image[i];
  precondition();
  direction = preconditioned;
  double product = sum_of_products(residual, preconditioned);
  const double enough = product * kEnough;
  for (int step = 0; step < max_steps && product > enough; ++step) {
    multiply(direction, image);
    const double curvature = sum_of_products(direction, image);
    if (!(curvature > 0)) return;
    const double length = product / curvature;
    for (std::size_t i = 0; i < count; ++i) x[i] += direction[i] * length;
    for (std::size_t i = 0; i < count; ++i) residual[i] = residual[i] - image[i] * length;
    precondition();
    const double next = sum_of_products(residual, preconditioned);
    for (std::size_t i = 0; i < count; ++i) direction[i] = preconditioned[i] + direction[i] * (next / product);
    product = next;
  }
}

}  // namespace lodestone::detail
