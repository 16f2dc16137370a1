#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <lodestone/core/detail/symmetric3.h>
#include <lodestone/core/mesh.h>

namespace lodestone::detail {

/// A symmetric, positive definite system whose unknowns are one point for each vertex; entries off the diagonal exist
/// for pairs of vertices that share a face.
class SparseSystem {
 public:
  /// Takes the mesh's faces as they are now.
  explicit SparseSystem(const Mesh& mesh);

  /// Sets all entries and right-hand sides to zero.
  void clear();
  /// Adds rᵀ·metric·r with r = Σ w[k]·x[v[k]] − target to what is minimised; 1 to 3 vertices that share a face.
  void add(const Index* vertices, const double* weights, std::size_t count, const Vec3& target,
           const Symmetric3& metric);
  /// Adds the same of many r over one face at once: `products` holds the sums of w[0]², w[1]², w[2]², w[0]·w[1],
  /// w[1]·w[2] and w[2]·w[0], `pulls` those of w[k]·target.
  void add_face(Index face, const std::array<double, 6>& products, const std::array<Vec3, 3>& pulls,
                const Symmetric3& metric);
  /// The mean of a vertex's three diagonal entries.
  double stiffness(Index vertex) const { return diagonal_[vertex].trace() / 3; }

  /// Improves `x` by conjugate gradients until the residual has fallen far, or `max_steps` are done.
  void solve(std::vector<Vec3>& x, int max_steps) const;

 private:
  Index number_of(Index a, Index b) const;
  void multiply(const std::vector<Vec3>& x, std::vector<Vec3>& out) const;

  std::vector<Index> corner_vertex_;
  std::vector<Index> entry_;  // by corner: that of its vertex with the next one
  // Above the diagonal, row by row: below it the same stands again.
  std::vector<Index> row_begin_;
  std::vector<Index> column_;
  std::vector<Symmetric3> value_;
  std::vector<Symmetric3> diagonal_;
  std::vector<Vec3> right_;
};

}  // namespace lodestone::detail
