#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <lodestone/core/ids.h>
#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// A symmetric 3 × 3 matrix.
struct Symmetric3 {
  double xx = 0, yy = 0, zz = 0, xy = 0, yz = 0, zx = 0;

  static Symmetric3 identity(double s) { return {s, s, s, 0, 0, 0}; }
  /// s·n nᵀ
  static Symmetric3 outer(const Vec3& n, double s) {
    return {s * n.x * n.x, s * n.y * n.y, s * n.z * n.z, s * n.x * n.y, s * n.y * n.z, s * n.z * n.x};
  }
  void add(const Symmetric3& m, double s) {
    xx += s * m.xx, yy += s * m.yy, zz += s * m.zz, xy += s * m.xy, yz += s * m.yz, zx += s * m.zx;
  }
  double trace() const { return xx + yy + zz; }
  friend Symmetric3 operator+(Symmetric3 a, const Symmetric3& b) {
    a.add(b, 1);
    return a;
  }
  friend Vec3 operator*(const Symmetric3& m, const Vec3& v) {
    return {m.xx * v.x + m.xy * v.y + m.zx * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
            m.zx * v.x + m.yz * v.y + m.zz * v.z};
  }
};

/// A symmetric, positive definite system whose unknowns are one point for each vertex; entries off the diagonal exist for
/// pairs of vertices that share a face.
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
