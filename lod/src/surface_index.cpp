// A packed R-tree in the order of a k-d tree: faces are halved by the median of their centroids along the longest axis
// (Bentley, "Multidimensional binary search trees used for associative searching", CACM 18(9), 1975), at multiples of
// powers of four, so that runs of four fill the nodes of an implicit four-wide tree without pointers (as in Kamel and
// Faloutsos, "On packing R-trees", CIKM 1993). The search is Roussopoulos, Kelley and Vincent's ("Nearest neighbor
// queries", SIGMOD 1995), depth first and nearest child first.
//
// Boxes are floats in a scale of their own where coordinates lie within [-1, 1]; they are grown by more than the
// rounding of their arithmetic, so that what they prune is certainly too far. Distances to triangles are doubles.

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include <lodestone/lod/deviation.h>

#include "triangle.h"

namespace lodestone {
namespace {

using detail::Triangle;

constexpr std::size_t kWidth = 4;
constexpr float kBoxSlack = 1e-6f;      // Absolute, of the unit scale: four times the rounding at coordinates of 1.
constexpr double kFarSlack = 1 + 4e-6;  // Relative, of squared distances: for points far outside the unit box.
constexpr float kFarthest = 1e9f;       // Coordinates of points are clamped here: their squares stay finite.
constexpr std::size_t kStackSize = 64;  // Three entries stay behind on each of at most 17 levels.

/// A box by its centre and half size along each axis; the default contains nothing.
struct CentredBox {
  float centre[3] = {0, 0, 0};
  float half[3] = {-std::numeric_limits<float>::infinity(), -std::numeric_limits<float>::infinity(),
                   -std::numeric_limits<float>::infinity()};
};

/// The boxes of four children, transposed for arithmetic on four lanes.
struct Node {
  float centre[3][kWidth];
  float half[3][kWidth];

  void set(std::size_t child, const CentredBox& box) {
    for (int axis = 0; axis < 3; ++axis) {
      centre[axis][child] = box.centre[axis];
      half[axis][child] = box.half[axis];
    }
  }
};

/// Twice how far `x` lies outside an interval. The sum of t and |t| needs no comparison, which the compiler would not
/// turn into lanes.
float twice_outside(float centre, float half, float x) {
  const float t = std::fabs(x - centre) - half;
  return t + std::fabs(t);
}

/// Four times the squared distances of a point to the boxes of a node.
std::array<float, kWidth> box_distances(const Node& node, const std::array<float, 3>& p) {
  std::array<float, kWidth> result;
  for (std::size_t i = 0; i < kWidth; ++i) {
    const float x = twice_outside(node.centre[0][i], node.half[0][i], p[0]);
    const float y = twice_outside(node.centre[1][i], node.half[1][i], p[1]);
    const float z = twice_outside(node.centre[2][i], node.half[2][i], p[2]);
    result[i] = x * x + y * y + z * z;
  }
  return result;
}

/// A box by its extremes, grown by uniting.
struct Extent {
  std::array<float, 3> low;
  std::array<float, 3> high;

  Extent() {
    low.fill(std::numeric_limits<float>::infinity());
    high.fill(-std::numeric_limits<float>::infinity());
  }
  void add(const std::array<float, 3>& p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  void add(const Extent& other) {
    add(other.low);
    add(other.high);
  }
  std::size_t longest_axis() const {
    std::size_t axis = 0;
    for (std::size_t i = 1; i < 3; ++i) {
      if (high[i] - low[i] > high[axis] - low[axis]) axis = i;
    }
    return axis;
  }
  CentredBox centred() const {
    CentredBox box;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      box.centre[axis] = 0.5f * (low[axis] + high[axis]);
      box.half[axis] = 0.5f * (high[axis] - low[axis]) + kBoxSlack;
    }
    return box;
  }
};

/// A face on its way to its place in the tree.
struct Entry {
  std::array<float, 3> centroid;
  Index face;
};

/// Orders entries so that every run of 4^k, counted from the start, is compact. Pre: size ≤ capacity, a power of two.
void order_by_medians(Entry* begin, Entry* end, std::size_t capacity) {
  const std::size_t size = static_cast<std::size_t>(end - begin);
  if (size <= kWidth) return;
  while (capacity >= size) capacity /= 2;
  Extent extent;
  for (const Entry* e = begin; e != end; ++e) extent.add(e->centroid);
  const std::size_t axis = extent.longest_axis();
  Entry* middle = begin + capacity;
  std::nth_element(begin, middle, end, [axis](const Entry& a, const Entry& b) {
    return a.centroid[axis] != b.centroid[axis] ? a.centroid[axis] < b.centroid[axis] : a.face < b.face;
  });
  order_by_medians(begin, middle, capacity);
  order_by_medians(middle, end, capacity);
}

}  // namespace

struct SurfaceIndex::Impl {
  std::vector<Triangle> triangles;       // In the order of the tree.
  std::vector<Index> faces;              // The mesh's face of each triangle.
  std::vector<Index> places;             // The triangle of each face.
  std::vector<Node> nodes;               // Level by level from the triangles up; node i has the children 4i … 4i + 3.
  std::vector<std::size_t> level_begin;  // The first node of each level.
  double scale = 1;                      // From mesh units to the boxes' units: a power of two.

  void set_scale(const Mesh& mesh);
  void order_faces(const Mesh& mesh);
  void build_nodes();
  std::vector<Extent> add_level(const std::vector<Extent>& children);
  std::array<float, 3> scaled(const Vec3f& p) const { return scaled(Vec3(p)); }
  std::array<float, 3> scaled(const Vec3& p) const;
};

namespace {

/// One search on its way: the nearest point so far, and how far it still has to look.
class Search {
 public:
  Search(const SurfaceIndex::Impl& tree, const Vec3& p, double limit)
      : tree_(tree), p_(p), scaled_p_(tree.scaled(p)), best_squared_(limit * limit) {
    hit_.distance = std::numeric_limits<double>::infinity();
    update_reach();
  }

  void test(std::size_t place) {
    const Vec3 q = detail::nearest_on_triangle(p_, tree_.triangles[place]);
    const double squared = squared_length(p_ - q);
    const Index face = tree_.faces[place];
    if (squared > best_squared_ || (squared == best_squared_ && face >= hit_.face)) return;
    best_squared_ = squared;
    hit_.point = q;
    hit_.face = face;
    update_reach();
  }

  void descend() {
    push({0, static_cast<std::uint32_t>(tree_.level_begin.size()), 0}, 0);
    while (size_ > 0) {
      const Item item = stack_[--size_];
      if (item.distance > reach_) continue;
      if (item.level == 0) {
        test(item.place);
      } else {
        open(item);
      }
    }
  }

  SurfaceIndex::Hit result() const {
    SurfaceIndex::Hit hit = hit_;
    if (hit.face != kNoIndex) hit.distance = std::sqrt(best_squared_);
    return hit;
  }

 private:
  struct Item {
    float distance;       // Four times the squared distance of the box.
    std::uint32_t level;  // 0: a triangle.
    Index place;          // On its level.
  };

  void open(const Item& item) {
    const std::uint32_t level = item.level - 1;
    const std::array<float, kWidth> distances =
        box_distances(tree_.nodes[tree_.level_begin[level] + item.place], scaled_p_);
    const std::size_t base = size_;
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      if (distances[i] <= reach_) push({distances[i], level, static_cast<Index>(kWidth * item.place + i)}, base);
    }
  }

  /// Pushes, keeping the entries from `base` on in descending order: the nearest is popped first.
  void push(const Item& item, std::size_t base) {
    assert(size_ < kStackSize);
    std::size_t i = size_++;
    for (; i > base && stack_[i - 1].distance < item.distance; --i) stack_[i] = stack_[i - 1];
    stack_[i] = item;
  }

  void update_reach() {
    const double scaled = std::min(4 * best_squared_ * tree_.scale * tree_.scale * kFarSlack, 1e30);
    reach_ = static_cast<float>(scaled);
  }

  const SurfaceIndex::Impl& tree_;
  Vec3 p_;
  std::array<float, 3> scaled_p_;
  double best_squared_;
  float reach_ = 0;
  SurfaceIndex::Hit hit_;
  std::size_t size_ = 0;
  std::array<Item, kStackSize> stack_;
};

}  // namespace

std::array<float, 3> SurfaceIndex::Impl::scaled(const Vec3& p) const {
  const auto clamped = [this](double x) {
    return static_cast<float>(std::clamp(x * scale, -double{kFarthest}, double{kFarthest}));
  };
  return {clamped(p.x), clamped(p.y), clamped(p.z)};
}

void SurfaceIndex::Impl::set_scale(const Mesh& mesh) {
  float largest = 0;
  for (const Vec3f& p : mesh.positions) {
    largest = std::max({largest, std::fabs(p.x), std::fabs(p.y), std::fabs(p.z)});
  }
  if (!(largest > 0) || !std::isfinite(largest)) return;
  int exponent = 0;
  std::frexp(largest, &exponent);
  scale = std::ldexp(1.0, -exponent);
}

void SurfaceIndex::Impl::order_faces(const Mesh& mesh) {
  const std::size_t count = mesh.face_count();
  std::vector<Entry> entries(count);
  for (std::size_t f = 0; f < count; ++f) {
    const Triangle t = detail::triangle_of(mesh, static_cast<Index>(f));
    const Vec3 sum = Vec3(t.a) + Vec3(t.b) + Vec3(t.c);
    entries[f] = {scaled(sum * (1.0 / 3.0)), static_cast<Index>(f)};
  }
  std::size_t capacity = 1;
  while (capacity < count) capacity *= 2;
  order_by_medians(entries.data(), entries.data() + count, capacity);

  triangles.resize(count);
  faces.resize(count);
  places.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Index f = entries[i].face;
    triangles[i] = detail::triangle_of(mesh, f);
    faces[i] = f;
    places[f] = static_cast<Index>(i);
  }
}

void SurfaceIndex::Impl::build_nodes() {
  std::vector<Extent> extents(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    extents[i].add(scaled(triangles[i].a));
    extents[i].add(scaled(triangles[i].b));
    extents[i].add(scaled(triangles[i].c));
  }
  do {
    extents = add_level(extents);
  } while (extents.size() > 1);
}

/// Appends the nodes above `children` and returns their extents.
std::vector<Extent> SurfaceIndex::Impl::add_level(const std::vector<Extent>& children) {
  const std::size_t count = (children.size() + kWidth - 1) / kWidth;
  const std::size_t first = nodes.size();
  level_begin.push_back(first);
  nodes.resize(first + count);
  std::vector<Extent> parents(count);
  for (std::size_t i = 0; i < kWidth * count; ++i) {
    const bool present = i < children.size();
    nodes[first + i / kWidth].set(i % kWidth, present ? children[i].centred() : CentredBox{});
    if (present) parents[i / kWidth].add(children[i]);
  }
  return parents;
}

SurfaceIndex::SurfaceIndex(const Mesh& mesh) : impl_(std::make_unique<Impl>()) {
  if (mesh.face_count() == 0) return;
  impl_->set_scale(mesh);
  impl_->order_faces(mesh);
  impl_->build_nodes();
}

SurfaceIndex::~SurfaceIndex() = default;
SurfaceIndex::SurfaceIndex(SurfaceIndex&&) noexcept = default;
SurfaceIndex& SurfaceIndex::operator=(SurfaceIndex&&) noexcept = default;

SurfaceIndex::Hit SurfaceIndex::nearest(const Vec3& p, double limit, Index hint) const {
  Search search(*impl_, p, limit);
  if (empty()) return search.result();
  assert(hint == kNoIndex || hint < impl_->places.size());
  if (hint != kNoIndex) search.test(impl_->places[hint]);
  search.descend();
  return search.result();
}

double SurfaceIndex::distance_to_face(const Vec3& p, Index face) const {
  return length(p - detail::nearest_on_triangle(p, impl_->triangles[impl_->places[face]]));
}

bool SurfaceIndex::empty() const { return impl_->triangles.empty(); }

}  // namespace lodestone
