#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/core/detail/symmetric3.h>
#include <lodestone/core/ids.h>
#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// A symmetric, positive definite system whose unknowns are one point for each vertex; entries off the diagonal exist
/// for pairs of vertices that share a face.
class SparseSystem {
 public:
  /// `corner_vertex`: three vertices for each face.
  SparseSystem(std::size_t vertex_count, std::span<const Index> corner_vertex);

  /// Sets all entries and right-hand sides to zero.
  void clear();
  /// Adds rᵀ·metric·r with r = Σ w[k]·x[v[k]] − target to what is minimised; 1 to 3 vertices that share a face.
  void add(const Index* vertices, const double* weights, std::size_t count, const Vec3& target,
           const Symmetric3& metric);
  /// The mean of a vertex's three diagonal entries.
  double stiffness(Index vertex) const { return diagonal_[vertex].trace() / 3; }

  /// Improves `x` by conjugate gradients until the residual has fallen far, or `max_steps` are done.
  void solve(std::vector<Vec3>& x, int max_steps) const;

 private:
  Symmetric3& entry(Index row, Index column);
  void multiply(const std::vector<Vec3>& x, std::vector<Vec3>& out) const;

  std::vector<Index> row_begin_;
  std::vector<Index> column_;
  std::vector<Symmetric3> value_;
  std::vector<Symmetric3> diagonal_;
  std::vector<Vec3> right_;
};

}  // namespace lodestone::detail
