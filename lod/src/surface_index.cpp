#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <vector>

#include <lodestone/lod/deviation.h>

#include "triangle.h"

namespace lodestone {
namespace {

using detail::Triangle;

constexpr int kWidth = 4;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

struct Node {
  float low[3][kWidth];
  float high[3][kWidth];
};

inline float larger(float a, float b) { return a > b ? a : b; }
inline float outside(float low, float x, float high) { return larger(larger(low - x, x - high), 0.0f); }

#ifdef HILBERT
std::uint32_t hilbert3(std::array<std::uint32_t,3> X) {
  const int b = 10;
  std::uint32_t M = 1U << (b - 1), P, Q, t;
  for (Q = M; Q > 1; Q >>= 1) {
    P = Q - 1;
    for (int i = 0; i < 3; i++)
      if (X[i] & Q) X[0] ^= P;
      else { t = (X[0] ^ X[i]) & P; X[0] ^= t; X[i] ^= t; }
  }
  for (int i = 1; i < 3; i++) X[i] ^= X[i - 1];
  t = 0;
  for (Q = M; Q > 1; Q >>= 1) if (X[2] & Q) t ^= Q - 1;
  for (int i = 0; i < 3; i++) X[i] ^= t;
  std::uint32_t h = 0;
  for (int bit = b - 1; bit >= 0; --bit)
    for (int i = 0; i < 3; ++i) h = (h << 1) | ((X[i] >> bit) & 1U);
  return h;
}
#endif

}  // namespace

struct SurfaceIndex::Impl {
  std::vector<Triangle> triangles;
  std::vector<Index> face;
  std::vector<Index> place;
  std::vector<Node> nodes;
  std::vector<Index> level_begin;
  double scale = 1;

  void order(const Mesh& mesh);
  void partition(std::vector<std::array<float,3>>& c, Index* begin, Index* end, std::size_t capacity);
  void build_nodes();
};

void SurfaceIndex::Impl::partition(std::vector<std::array<float,3>>& c, Index* begin, Index* end, std::size_t capacity) {
  const std::size_t n = end - begin;
  if (n <= kWidth) return;
  while (capacity >= n) capacity /= 2;
  float lo[3] = {kInfinity, kInfinity, kInfinity}, hi[3] = {-kInfinity, -kInfinity, -kInfinity};
  for (Index* i = begin; i != end; ++i)
    for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], c[*i][k]), hi[k] = std::max(hi[k], c[*i][k]);
  int axis = 0;
  for (int k = 1; k < 3; ++k) if (hi[k] - lo[k] > hi[axis] - lo[axis]) axis = k;
  // balanced: multiple of 4
#ifdef ALIGNED
  std::size_t half = capacity;
#else
  std::size_t half = capacity;
#endif
  Index* mid = begin + half;
  std::nth_element(begin, mid, end, [&](Index a, Index b) { return c[a][axis] != c[b][axis] ? c[a][axis] < c[b][axis] : a < b; });
  partition(c, begin, mid, capacity);
  partition(c, mid, end, capacity);
}

void SurfaceIndex::Impl::order(const Mesh& mesh) {
  const std::size_t n = mesh.face_count();
  face.resize(n);
  std::iota(face.begin(), face.end(), 0);
  std::vector<std::array<float,3>> c(n);
  for (std::size_t f = 0; f < n; ++f) {
    const Vec3f& a = mesh.positions[mesh.corner_vertex(3 * f)];
    const Vec3f& b = mesh.positions[mesh.corner_vertex(3 * f + 1)];
    const Vec3f& d = mesh.positions[mesh.corner_vertex(3 * f + 2)];
    c[f] = {(a.x + b.x + d.x) / 3, (a.y + b.y + d.y) / 3, (a.z + b.z + d.z) / 3};
  }
#ifdef HILBERT
  std::array<float,3> lo = c[0], hi = c[0];
  for (auto& p : c) for (int k = 0; k < 3; ++k) lo[k] = std::min(lo[k], p[k]), hi[k] = std::max(hi[k], p[k]);
  float ext = std::max({hi[0]-lo[0], hi[1]-lo[1], hi[2]-lo[2]});
  std::vector<std::uint64_t> keys(n);
  for (std::size_t f = 0; f < n; ++f) {
    std::array<std::uint32_t,3> q;
    for (int k = 0; k < 3; ++k) q[k] = (std::uint32_t)((c[f][k]-lo[k]) / ext * 1023.f);
    keys[f] = (std::uint64_t(hilbert3(q)) << 32) | f;
  }
  std::sort(keys.begin(), keys.end());
  for (std::size_t f = 0; f < n; ++f) face[f] = (Index)keys[f];
#else
  std::size_t capacity = kWidth;
  while (capacity < n) capacity *= kWidth;
  partition(c, face.data(), face.data() + n, capacity);
#endif
  triangles.resize(n); place.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    Index f = face[i];
    place[f] = i;
    triangles[i] = {mesh.positions[mesh.corner_vertex(3 * f)], mesh.positions[mesh.corner_vertex(3 * f + 1)], mesh.positions[mesh.corner_vertex(3 * f + 2)]};
  }
}

void SurfaceIndex::Impl::build_nodes() {
  Node none;
  for (int k = 0; k < 3; ++k) for (int i = 0; i < kWidth; ++i) none.low[k][i] = kInfinity, none.high[k][i] = -kInfinity;
  std::size_t count = triangles.size();
  level_begin.push_back(0);
  float slack = 1e-6f; // TODO
  { std::size_t m = (count + kWidth - 1) / kWidth;
    nodes.resize(m, none);
    for (std::size_t t = 0; t < count; ++t) {
      const Triangle& r = triangles[t]; Node& nd = nodes[t / 4]; int i = t % 4;
      nd.low[0][i] = std::min({r.a.x, r.b.x, r.c.x}) - slack; nd.high[0][i] = std::max({r.a.x, r.b.x, r.c.x}) + slack;
      nd.low[1][i] = std::min({r.a.y, r.b.y, r.c.y}) - slack; nd.high[1][i] = std::max({r.a.y, r.b.y, r.c.y}) + slack;
      nd.low[2][i] = std::min({r.a.z, r.b.z, r.c.z}) - slack; nd.high[2][i] = std::max({r.a.z, r.b.z, r.c.z}) + slack;
    }
    count = m;
  }
  while (count > 1) {
    std::size_t m = (count + kWidth - 1) / kWidth;
    std::size_t b = level_begin.back();
    level_begin.push_back(nodes.size());
    nodes.resize(nodes.size() + m, none);
    for (std::size_t t = 0; t < count; ++t) {
      const Node& s = nodes[b + t]; Node& nd = nodes[level_begin.back() + t / 4]; int i = t % 4;
      for (int k = 0; k < 3; ++k) {
        nd.low[k][i] = std::min({s.low[k][0], s.low[k][1], s.low[k][2], s.low[k][3]});
        nd.high[k][i] = std::max({s.high[k][0], s.high[k][1], s.high[k][2], s.high[k][3]});
      }
    }
    count = m;
  }
}

SurfaceIndex::SurfaceIndex(const Mesh& mesh) : impl_(new Impl) {
  impl_->order(mesh);
  impl_->build_nodes();
}
SurfaceIndex::~SurfaceIndex() = default;
SurfaceIndex::SurfaceIndex(SurfaceIndex&&) noexcept = default;
bool SurfaceIndex::empty() const { return impl_->triangles.empty(); }
unsigned long tests, opened;

SurfaceIndex::Hit SurfaceIndex::nearest(const Vec3& p, double limit, Index hint) const {
  const Impl& s = *impl_;
  Hit best; best.distance = std::numeric_limits<double>::infinity();
  double best_sq = limit * limit;
  float pruned = (float)best_sq * 1.00001f;
  auto test = [&](Index t) {
    Vec3 q = detail::nearest_on_triangle(p, s.triangles[t]);
    double d = squared_length(p - q);
    ++tests;
    if (d < best_sq || (d == best_sq && s.face[t] < best.face)) {
      best_sq = d; best.point = q; best.face = s.face[t]; pruned = (float)d * 1.00001f; 
    }
  };
  if (hint != kNoIndex) test(s.place[hint]);
  struct Item { float d; std::uint32_t level; std::uint32_t index; };
  Item stack[64];
  int top = 0;
  stack[top++] = {0, (std::uint32_t)s.level_begin.size(), 0};
  const float x[3] = {(float)p.x, (float)p.y, (float)p.z};
  while (top) {
    Item it = stack[--top];
    if (it.d > pruned) continue;
    if (it.level == 0) { test(it.index); continue; }
    ++opened;
    const Node& nd = s.nodes[s.level_begin[it.level - 1] + it.index];
    float d[4];
    for (int i = 0; i < 4; ++i) {
      const float dx = outside(nd.low[0][i], x[0], nd.high[0][i]);
      const float dy = outside(nd.low[1][i], x[1], nd.high[1][i]);
      const float dz = outside(nd.low[2][i], x[2], nd.high[2][i]);
      d[i] = dx * dx + dy * dy + dz * dz;
    }
    int base = top;
    for (std::uint32_t i = 0; i < 4; ++i) {
      if (d[i] > pruned) continue;
      int j = top++;
      for (; j > base && stack[j - 1].d < d[i]; --j) stack[j] = stack[j - 1];
      stack[j] = {d[i], it.level - 1, it.index * 4 + i};
    }
  }
  if (best.face != kNoIndex) best.distance = std::sqrt(best_sq);
  return best;
}
}  // namespace lodestone
