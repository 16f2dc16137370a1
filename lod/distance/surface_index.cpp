// A packed R-tree over faces in a compact order, of which runs of four fill the nodes of an implicit four-wide tree
// without pointers (as in Kamel and Faloutsos, "On packing R-trees", CIKM 1993). The boxes lie along the principal axes
// of what they hold, as those of Gottschalk, Lin and Manocha ("OBBTree", SIGGRAPH 1996): boxes along the mesh's axes
// would all overlap where faces are long and thin. The search is Roussopoulos, Kelley and Vincent's ("Nearest neighbor
// queries", SIGMOD 1995), depth first and nearest child first.
//
// Boxes are floats in coordinates of their node, whose origin is in the midst of them, so that they are as fine as the
// node is small, wherever the mesh lies and however large the rest of it is. They are grown by more than the rounding
// of all that, so that what they prune is certainly too far. Everything is computed with in doubles.

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include <lodestone/core/detail/hash_index.h>
#include <lodestone/lod/deviation.h>

#include "distance/face_order.h"
#include "distance/point_spread.h"
#include "distance/tree_levels.h"
#include "distance/triangle.h"
#include "distance/wide_vectors.h"

namespace lodestone {
namespace {

using detail::HashIndex;
using detail::PointSpread;
using detail::Triangle;

constexpr std::size_t kWidth = detail::kRunWidth;
constexpr double kBoxSlack = 1e-6;       // Of the largest coordinate in a node: more than single precision loses there.
constexpr double kAxesSlack = 1 + 1e-6;  // Relative, of squared distances: single precision of a node's axes, and more.
constexpr double kSingleSlack = 1e-5;    // The same where they are computed in single precision.
constexpr double kFarthest = 1e15;       // Points farther away are pulled in, for that: squares of floats are finite.
constexpr double kTogether = 8;          // How far apart points searched for at once may lie, in sizes of a face.
constexpr std::size_t kStackSize = 64;   // Three entries stay behind on each level.
constexpr std::size_t kMostTurned = 256;  // Faces of a child whose box is tried along other axes than the mesh's.

/// A box by its centre and half size along each axis; the default contains nothing.
struct CentredBox {
  double centre[3] = {0, 0, 0};
  double half[3] = {-std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity(),
                    -std::numeric_limits<double>::infinity()};
};

using Local = std::array<double, 3>;

/// Coordinates relative to an origin and along axes. Lengths are true to kAxesSlack in them. The mesh is scaled before,
/// see SurfaceIndex::Impl::scale.
struct Frame {
  Vec3f origin;
  std::array<Vec3f, 3> axes;  // The mesh's, in local coordinates.

  Local local(const Vec3& p) const {
    const Vec3 d = p - Vec3(origin);
    const Vec3 q = Vec3(axes[0]) * d.x + Vec3(axes[1]) * d.y + Vec3(axes[2]) * d.z;
    return {q.x, q.y, q.z};
  }
};

/// The boxes of four children, transposed for arithmetic on four lanes.
struct alignas(16) Node {
  Frame frame;
  float centre[3][kWidth];
  float half[3][kWidth];

  void set(std::size_t child, const CentredBox& box) {
    for (int axis = 0; axis < 3; ++axis) {
      centre[axis][child] = static_cast<float>(box.centre[axis]);
      half[axis][child] = static_cast<float>(box.half[axis]);
    }
  }
};

/// Twice how far `x` lies outside an interval. The sum of t and |t| needs no comparison, which the compiler would not
/// turn into lanes.
template <class Real>
Real twice_outside(float centre, float half, Real x) {
  const Real t = std::fabs(x - static_cast<Real>(centre)) - static_cast<Real>(half);
  return t + std::fabs(t);
}

/// Four times the squared distances of a point to the boxes of a node.
std::array<double, kWidth> box_distances(const Node& node, const Local& p) {
  std::array<double, kWidth> result;
  for (std::size_t i = 0; i < kWidth; ++i) {
    const double x = twice_outside(node.centre[0][i], node.half[0][i], p[0]);
    const double y = twice_outside(node.centre[1][i], node.half[1][i], p[1]);
    const double z = twice_outside(node.centre[2][i], node.half[2][i], p[2]);
    result[i] = x * x + y * y + z * z;
  }
  return result;
}

/// A box by its extremes, grown by uniting.
struct Extent {
  Local low;
  Local high;

  Extent() {
    low.fill(std::numeric_limits<double>::infinity());
    high.fill(-std::numeric_limits<double>::infinity());
  }
  void add(const Local& p) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], p[axis]);
      high[axis] = std::max(high[axis], p[axis]);
    }
  }
  bool empty() const { return high[0] < low[0]; }
  double half_area() const {
    if (empty()) return 0;
    const double x = high[0] - low[0], y = high[1] - low[1], z = high[2] - low[2];
    return x * y + y * z + z * x;
  }
  double largest_coordinate() const {
    double largest = 0;
    for (std::size_t axis = 0; axis < 3 && !empty(); ++axis) largest = std::max({largest, -low[axis], high[axis]});
    return largest;
  }
  CentredBox centred(double slack) const {
    CentredBox box;
    for (std::size_t axis = 0; axis < 3 && !empty(); ++axis) {
      box.centre[axis] = 0.5 * (low[axis] + high[axis]);
      box.half[axis] = 0.5 * (high[axis] - low[axis]) + slack;
    }
    return box;
  }
};

/// The extents of the four children of a node in one frame.
using ChildExtents = std::array<Extent, kWidth>;

double half_area(const ChildExtents& children) {
  double sum = 0;
  for (const Extent& child : children) sum += child.half_area();
  return sum;
}

/// What is known of a run of triangles without looking at each.
struct Run {
  PointSpread spread;
  Extent box;  // Along the mesh's axes.

  void add(const Vec3f& corner) {
    spread.add({1, Vec3(corner), {}});
    box.add({double{corner.x}, double{corner.y}, double{corner.z}});
  }
  void add(const Run& other) {
    spread.add(other.spread);
    box.add(other.box.low);
    box.add(other.box.high);
  }
};

Run run_of(const Triangle& triangle) {
  Run run;
  for (const Vec3f& corner : {triangle.a, triangle.b, triangle.c}) run.add(corner);
  return run;
}

using Bits = std::array<std::uint32_t, 9>;

Bits bits_of(const Triangle& triangle) { return std::bit_cast<Bits>(triangle); }

bool same_corners(const Triangle& a, const Triangle& b) { return bits_of(a) == bits_of(b); }

std::size_t hash_of(const Triangle& triangle) {
  std::uint64_t hash = 0;
  for (const std::uint32_t b : bits_of(triangle)) hash = (hash ^ b) * 0x9e3779b97f4a7c15u, hash ^= hash >> 29;
  return static_cast<std::size_t>(hash);
}

Vec3 point(const Local& p) { return {p[0], p[1], p[2]}; }

/// `axes` in the mesh's coordinates.
Frame make_frame(const Vec3f& origin, const std::array<Vec3, 3>& axes) {
  const auto& [u, v, w] = axes;
  return {origin, {to_float({u.x, v.x, w.x}), to_float({u.y, v.y, w.y}), to_float({u.z, v.z, w.z})}};
}

}  // namespace

struct SurfaceIndex::Impl {
  std::vector<Triangle> triangles;       // In the order of the tree; of faces with the same corners one for all.
  std::vector<Index> faces;              // The mesh's face of each triangle, the first of those with its corners.
  std::vector<Index> places;             // The triangle of each face.
  std::vector<Index> next_copy;          // Of each face: the next one with its corners; empty where there are none.
  std::vector<Node> nodes;               // Level by level from the triangles up; node i has the children 4i … 4i + 3.
  std::vector<std::size_t> level_begin;  // The first node of each level.
  double scale = 1;                      // A power of two, which makes the mesh's box about 1 large.
  Box box;                               // Of the mesh.

  void set_box(const Mesh& mesh);
  Vec3 cut_off(const Vec3& p) const;
  double reach(double squared) const;
  void order_faces(const Mesh& mesh);
  std::vector<Index> find_distinct(std::span<const Triangle> all);
  void build_nodes();
  Run build_node(std::size_t level, std::size_t number, std::size_t child_size);
  Node make_node(std::size_t begin, std::size_t child_size, std::span<const Run> children, const Run& all) const;
  ChildExtents child_extents(const Frame& frame, std::size_t begin, std::size_t child_size) const;
};

namespace {

/// One search on its way: the nearest point so far, and how far it still has to look. With a list it looks for all
/// faces within the limit.
class Search {
 public:
  Search(const SurfaceIndex::Impl& tree, const Vec3& p, double limit, std::vector<Index>* all = nullptr)
      : tree_(tree), p_(p), scaled_(p * tree.scale), best_squared_(limit * limit), all_(all) {
    hit_.distance = std::numeric_limits<double>::infinity();
    update_reach();
  }

  void test(std::size_t place) {
    ++hit_.visits;
    const Vec3 q = detail::nearest_on_triangle(p_, tree_.triangles[place]);
    const double squared = squared_length(p_ - q);
    const Index face = tree_.faces[place];
    if (all_ != nullptr) {
      if (squared <= best_squared_) list_copies(face);
      return;
    }
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
      open(item);
    }
  }

  SurfaceIndex::Hit result() const {
    SurfaceIndex::Hit hit = hit_;
    if (hit.face != kNoIndex) hit.distance = std::sqrt(best_squared_);
    return hit;
  }

 private:
  void list_copies(Index face) {
    const std::vector<Index>& next = tree_.next_copy;
    for (; face != kNoIndex; face = next.empty() ? kNoIndex : next[face]) all_->push_back(face);
  }

  struct Item {
    double distance;      // Four times the squared distance of the box.
    std::uint32_t level;  // Of the node, from 1 on.
    Index place;          // On its level.
  };

  void open(const Item& item) {
    ++hit_.visits;
    const std::uint32_t level = item.level - 1;
    const Node& node = tree_.nodes[tree_.level_begin[level] + item.place];
    const std::array<double, kWidth> distances = box_distances(node, node.frame.local(scaled_));
    const std::size_t base = size_;
    for (std::uint32_t i = 0; i < kWidth; ++i) {
      if (!(distances[i] <= reach_)) continue;
      const Index place = static_cast<Index>(kWidth * item.place + i);
      level == 0 ? test(place) : push({distances[i], level, place}, base);
    }
  }

  /// Pushes, keeping the entries from `base` on in descending order: the nearest is popped first.
  void push(const Item& item, std::size_t base) {
    assert(size_ < kStackSize);
    std::size_t i = size_++;
    for (; i > base && stack_[i - 1].distance < item.distance; --i) stack_[i] = stack_[i - 1];
    stack_[i] = item;
  }

  void update_reach() { reach_ = tree_.reach(best_squared_); }

  const SurfaceIndex::Impl& tree_;
  Vec3 p_;
  Vec3 scaled_;  // For boxes.
  double best_squared_;
  std::vector<Index>* all_;
  double reach_ = 0;
  SurfaceIndex::Hit hit_;
  std::size_t size_ = 0;
  std::array<Item, kStackSize> stack_;
};

/// Several searches at once, for points that lie together: a node is opened once for all that it may concern, and lanes
/// are points.
class PacketSearch {
 public:
  static constexpr std::size_t kPoints = 8;
  using Mask = std::uint32_t;  // Bit i stands for point i.

  explicit PacketSearch(const SurfaceIndex::Impl& tree) : tree_(tree) {
    best_squared_.fill(std::numeric_limits<double>::infinity());
    face_.fill(kNoIndex);
    for (std::size_t i = 0; i < kPoints; ++i) set_reach(i);
  }

  /// Adds one of at most kPoints points; `place` is a triangle that is likely near it, or kNoIndex.
  void add(const Vec3& p, Index place) {
    const Vec3 near = tree_.cut_off(p) * tree_.scale;
    for (std::size_t i = count_; i < kPoints; ++i) x_[i] = near.x, y_[i] = near.y, z_[i] = near.z;
    points_[count_++] = p;
    if (place != kNoIndex) test(count_ - 1, place);
  }

  void descend() {
    const Item root{{}, static_cast<std::uint32_t>(tree_.level_begin.size()), 0};
    push(root, 0);
    while (size_ > 0) {
      const Item item = stack_[--size_];
      const Mask mask = no_farther(item.distances, within_);
      if (mask != 0) open(item, mask);
    }
  }

  SurfaceIndex::Hit result(std::size_t i) const { return {std::sqrt(best_squared_[i]), nearest_[i], face_[i], 0}; }

 private:
  void test(std::size_t i, std::size_t place) {
    const Vec3 q = detail::nearest_on_triangle(points_[i], tree_.triangles[place]);
    const double squared = squared_length(points_[i] - q);
    const Index face = tree_.faces[place];
    if (squared > best_squared_[i] || (squared == best_squared_[i] && face >= face_[i])) return;
    best_squared_[i] = squared;
    nearest_[i] = q;
    face_[i] = face;
    set_reach(i);
  }

  void set_reach(std::size_t i) {
    constexpr double kMost = std::numeric_limits<float>::max();
    reach_[i] = std::min(tree_.reach(best_squared_[i]), kMost / (1 + kSingleSlack));
    within_[i] = static_cast<float>(reach_[i] * (1 + kSingleSlack));
    surely_within_[i] = static_cast<float>(reach_[i] * (1 - kSingleSlack));
  }

  using Lanes = std::array<float, kPoints>;
  struct Item {
    Lanes distances;      // Four times the squared distances of the box.
    std::uint32_t level;  // Of the node, from 1 on.
    Index place;          // On its level.
  };

  /// Which points have `distances` of at most that.
  Mask no_farther(const Lanes& distances, const Lanes& than) const {
    std::array<Mask, kPoints> bits;
    for (std::size_t i = 0; i < kPoints; ++i) bits[i] = distances[i] <= than[i] ? Mask{1} << i : 0;
    Mask mask = 0;
    for (const Mask bit : bits) mask |= bit;
    return mask & ((Mask{1} << count_) - 1);
  }

  void open(const Item& item, Mask mask) {
    const std::uint32_t level = item.level - 1;
    const Node& node = tree_.nodes[tree_.level_begin[level] + item.place];
    const Vec3f& origin = node.frame.origin;
    const std::array<Vec3f, 3>& axes = node.frame.axes;
    Lanes u, v, w;
    for (std::size_t i = 0; i < kPoints; ++i) {
      const auto x = static_cast<float>(x_[i] - static_cast<double>(origin.x));
      const auto y = static_cast<float>(y_[i] - static_cast<double>(origin.y));
      const auto z = static_cast<float>(z_[i] - static_cast<double>(origin.z));
      u[i] = axes[0].x * x + axes[1].x * y + axes[2].x * z;
      v[i] = axes[0].y * x + axes[1].y * y + axes[2].y * z;
      w[i] = axes[0].z * x + axes[1].z * y + axes[2].z * z;
    }
    const std::size_t base = size_;
    for (std::uint32_t child = 0; child < kWidth; ++child) {
      Item below{{}, level, static_cast<Index>(kWidth * item.place + child)};
      for (std::size_t i = 0; i < kPoints; ++i) {
        const float a = twice_outside(node.centre[0][child], node.half[0][child], u[i]);
        const float b = twice_outside(node.centre[1][child], node.half[1][child], v[i]);
        const float c = twice_outside(node.centre[2][child], node.half[2][child], w[i]);
        below.distances[i] = a * a + b * b + c * c;
      }
      Mask wanted = no_farther(below.distances, within_) & mask;
      if (wanted == 0) continue;
      for (Mask open = wanted & ~no_farther(below.distances, surely_within_); open != 0; open &= open - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(open));
        const double there = box_distances(node, node.frame.local({x_[i], y_[i], z_[i]}))[child];
        if (!(there <= reach_[i])) wanted &= ~(Mask{1} << i);
      }
      if (wanted != 0 && level > 0) push(below, base);
      for (; wanted != 0 && level == 0; wanted &= wanted - 1)
        test(static_cast<std::size_t>(std::countr_zero(wanted)), below.place);
    }
  }

  /// Pushes, keeping the entries from `base` on such that the one nearest to the first point is popped first.
  void push(const Item& item, std::size_t base) {
    assert(size_ < kStackSize);
    std::size_t i = size_++;
    for (; i > base && stack_[i - 1].distances[0] < item.distances[0]; --i) stack_[i] = stack_[i - 1];
    stack_[i] = item;
  }

  const SurfaceIndex::Impl& tree_;
  std::size_t count_ = 0;
  std::array<Vec3, kPoints> points_;
  std::array<double, kPoints> x_, y_, z_;  // Scaled, for boxes.
  std::array<double, kPoints> best_squared_;
  std::array<double, kPoints> reach_;
  Lanes within_, surely_within_;  // The reach in single precision, from above and from below.
  std::array<Vec3, kPoints> nearest_;
  std::array<Index, kPoints> face_;
  std::size_t size_ = 0;
  std::array<Item, kStackSize> stack_;
};

}  // namespace

void SurfaceIndex::Impl::set_box(const Mesh& mesh) {
  box = bounding_box(mesh);
  const double size = box.diagonal();
  if (size > 0 && std::isfinite(size)) scale = std::ldexp(1.0, -std::ilogb(size));
}

/// Pulls a point into a box around the mesh, so large that few are outside: to all that lies in it the point comes no
/// farther away.
Vec3 SurfaceIndex::Impl::cut_off(const Vec3& p) const {
  const double far = kFarthest / scale;
  const Vec3 centre = (box.low + box.high) * 0.5;
  const auto pull = [far](double x, double middle) { return std::clamp(x, middle - far, middle + far); };
  return {pull(p.x, centre.x), pull(p.y, centre.y), pull(p.z, centre.z)};
}

/// What four times the squared distances of boxes are compared with, where triangles are wanted that are no farther
/// than a distance, given by its square. Finite, so that boxes that contain nothing stay out of it.
double SurfaceIndex::Impl::reach(double squared) const {
  return std::min(4 * squared * scale * scale * kAxesSlack, std::numeric_limits<double>::max());
}

void SurfaceIndex::Impl::order_faces(const Mesh& mesh) {
  std::vector<Triangle> all(mesh.face_count());
  for (Index f = 0; f < all.size(); ++f) all[f] = detail::triangle_of(mesh, f);
  const std::vector<Index> distinct = find_distinct(all);
  places.resize(all.size());
  for (std::size_t i = 0; i < distinct.size(); ++i) all[i] = all[distinct[i]];  // they ascend
  all.resize(distinct.size());
  faces = detail::compact_order(all);
  triangles.reserve(all.size());
  for (Index& f : faces) {
    triangles.push_back(all[f]);
    f = distinct[f];
    for (Index copy = f; copy != kNoIndex; copy = next_copy.empty() ? kNoIndex : next_copy[copy])
      places[copy] = static_cast<Index>(triangles.size() - 1);
  }
}

/// Returns the faces without those whose corners are an earlier one's, bit for bit, and links these to it: a search
/// that has come to one of them has come to all, however many there are.
std::vector<Index> SurfaceIndex::Impl::find_distinct(std::span<const Triangle> all) {
  std::vector<Index> distinct, last(all.size());
  HashIndex table(all.size());
  for (Index f = 0; f < all.size(); ++f) {
    last[f] = f;
    const Index first =
        table.find_or_insert(hash_of(all[f]), f, [&](Index other) { return same_corners(all[other], all[f]); });
    if (first == f) {
      distinct.push_back(f);
    } else {
      if (next_copy.empty()) next_copy.assign(all.size(), kNoIndex);
      next_copy[std::exchange(last[first], f)] = f;
    }
  }
  return distinct;
}

void SurfaceIndex::Impl::build_nodes() {
  detail::TreeLevels levels = detail::tree_levels(triangles.size(), kWidth);
  level_begin = std::move(levels.begin);
  nodes.resize(levels.node_count);
  std::size_t child_size = 1;
  for (std::size_t level = 1; level < level_begin.size(); ++level) child_size *= kWidth;
  build_node(level_begin.size() - 1, 0, child_size);
}

/// Builds a node, after those below it, above runs of `child_size` triangles each; returns the run of all of them.
Run SurfaceIndex::Impl::build_node(std::size_t level, std::size_t number, std::size_t child_size) {
  const std::size_t begin = kWidth * number * child_size;
  std::array<Run, kWidth> children;
  Run all;
  std::size_t count = 0;
  for (; count < kWidth && begin + count * child_size < triangles.size(); ++count) {
    children[count] = level > 0 ? build_node(level - 1, kWidth * number + count, child_size / kWidth)
                                : run_of(triangles[begin + count]);
    all.add(children[count]);
  }
  nodes[level_begin[level] + number] = make_node(begin, child_size, std::span(children).first(count), all);
  return all;
}

/// Makes the node of the triangles from `begin` on, along those axes that leave the smaller boxes.
Node SurfaceIndex::Impl::make_node(std::size_t begin, std::size_t child_size, std::span<const Run> children,
                                   const Run& all) const {
  Node node;
  const Vec3f origin = to_float(all.spread.mean * scale);
  node.frame = make_frame(origin, {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}});
  ChildExtents extents;
  for (std::size_t i = 0; i < children.size(); ++i) {
    extents[i].add(node.frame.local(point(children[i].box.low) * scale));
    extents[i].add(node.frame.local(point(children[i].box.high) * scale));
  }
  if (child_size <= kMostTurned) {
    const Frame turned = make_frame(origin, all.spread.principal_axes());
    const ChildExtents turned_extents = child_extents(turned, begin, child_size);
    if (half_area(turned_extents) < half_area(extents)) {
      node.frame = turned;
      extents = turned_extents;
    }
  }
  double largest = 0;
  for (const Extent& extent : extents) largest = std::max(largest, extent.largest_coordinate());
  const double slack = kBoxSlack * largest + static_cast<double>(std::numeric_limits<float>::min());
  for (std::size_t i = 0; i < kWidth; ++i) node.set(i, extents[i].centred(slack));
  return node;
}

ChildExtents SurfaceIndex::Impl::child_extents(const Frame& frame, std::size_t begin, std::size_t child_size) const {
  ChildExtents extents;
  for (std::size_t child = 0; child < kWidth; ++child) {
    const std::size_t end = std::min(begin + (child + 1) * child_size, triangles.size());
    for (std::size_t i = begin + child * child_size; i < end; ++i) {
      for (const Vec3f& corner : {triangles[i].a, triangles[i].b, triangles[i].c}) {
        extents[child].add(frame.local(Vec3(corner) * scale));
      }
    }
  }
  return extents;
}

SurfaceIndex::SurfaceIndex(const Mesh& mesh) : impl_(std::make_unique<Impl>()) {
  if (mesh.face_count() == 0) return;
  impl_->set_box(mesh);
  impl_->order_faces(mesh);
  impl_->build_nodes();
}

SurfaceIndex::~SurfaceIndex() = default;
SurfaceIndex::SurfaceIndex(SurfaceIndex&&) noexcept = default;
SurfaceIndex& SurfaceIndex::operator=(SurfaceIndex&&) noexcept = default;

namespace {

/// `hint` is a face likely near p, or kNoIndex.
SurfaceIndex::Hit search_one(const SurfaceIndex::Impl& tree, const Vec3& p, double limit, Index hint) {
  Search search(tree, p, limit);
  if (tree.triangles.empty()) return search.result();
  if (hint != kNoIndex) search.test(tree.places[hint]);
  search.descend();
  return search.result();
}

/// Searches for at most PacketSearch::kPoints points: at once where they lie within `together` of the first, since what
/// is the best way through the tree for one is so for all then; else one by one. The faces of hits are hints on entry.
void search_packet(const SurfaceIndex::Impl& tree, std::span<const Vec3> points, std::span<SurfaceIndex::Hit> hits,
                   double together) {
  const auto place_of = [&](Index face) { return face != kNoIndex ? tree.places[face] : kNoIndex; };
  const auto is_far = [&](const Vec3& p) { return !(length(p - points.front()) <= together); };
  if (std::any_of(points.begin(), points.end(), is_far)) {
    for (std::size_t i = 0; i < points.size(); ++i)
      hits[i] = search_one(tree, points[i], std::numeric_limits<double>::infinity(), hits[i].face);
    return;
  }
  PacketSearch search(tree);
  for (std::size_t i = 0; i < points.size(); ++i) search.add(points[i], place_of(hits[i].face));
  search.descend();
  for (std::size_t i = 0; i < points.size(); ++i) hits[i] = search.result(i);
}

}  // namespace

[[gnu::flatten]] LODESTONE_WIDE_VECTORS SurfaceIndex::Hit SurfaceIndex::nearest(const Vec3& p, double limit,
                                                                                Index hint) const {
  assert(hint == kNoIndex || hint < impl_->places.size());
  return search_one(*impl_, p, limit, hint);
}

[[gnu::flatten]] LODESTONE_WIDE_VECTORS void SurfaceIndex::nearest(std::span<const Vec3> points,
                                                                   std::span<Hit> hits) const {
  assert(points.size() == hits.size());
  if (empty()) std::fill(hits.begin(), hits.end(), Hit{std::numeric_limits<double>::infinity(), {}, kNoIndex, 0});
  if (empty()) return;
  const double together = kTogether * impl_->box.diagonal() / std::sqrt(static_cast<double>(impl_->places.size()));
  Index last = kNoIndex;
  for (std::size_t first = 0; first < points.size(); first += PacketSearch::kPoints) {
    const auto packet = hits.subspan(first, std::min(PacketSearch::kPoints, points.size() - first));
    for (Hit& hit : packet)
      if (hit.face == kNoIndex) hit.face = last;
    search_packet(*impl_, points.subspan(first, packet.size()), packet, together);
    last = packet.back().face;
  }
}

std::span<const Index> SurfaceIndex::ranks() const { return impl_->places; }

void SurfaceIndex::within(const Vec3& p, double distance, std::vector<Index>& faces) const {
  faces.clear();
  if (empty()) return;
  Search(*impl_, p, distance, &faces).descend();
  std::sort(faces.begin(), faces.end());
}

double SurfaceIndex::distance_to_face(const Vec3& p, Index face) const {
  return length(p - detail::nearest_on_triangle(p, impl_->triangles[impl_->places[face]]));
}

bool SurfaceIndex::empty() const { return impl_->triangles.empty(); }

}  // namespace lodestone
