// Triangles are halved by the median of their centroids along the longest axis (Bentley, "Multidimensional binary
// search trees used for associative searching", CACM 18(9), 1975), at multiples of powers of two. Where the halves
// overlap, the triangles reach far for how near their centroids are: then they are halved in that one of a few ways
// which leaves the least boxes, by a surface area heuristic as in Goldsmith and Salmon ("Automatic creation of object
// hierarchies for ray tracing", IEEE CG&A 7(5), 1987). So long triangles part from short ones, and fans from each
// other.

#include "distance/face_order.h"

#include <algorithm>
#include <array>
#include <limits>

#include "distance/point_spread.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kFewEntries = 16;  // Their halves overlap in any mesh, and what can part has done so before.
constexpr double kOverlap = 0.3;         // Of a range along an axis: more is not how well-shaped triangles lie.

/// A triangle on its way to its place.
struct Entry {
  std::array<double, 3> centroid;  // Three times the centroid.
  Index face;
};

using Entries = std::span<Entry>;

struct Range {
  double low = std::numeric_limits<double>::infinity();
  double high = -std::numeric_limits<double>::infinity();

  void add(double x) {
    low = std::min(low, x);
    high = std::max(high, x);
  }
  double length() const { return high - low; }
};

std::size_t longest_axis(Entries entries) {
  std::array<Range, 3> ranges;
  for (const Entry& entry : entries) {
    for (std::size_t axis = 0; axis < 3; ++axis) ranges[axis].add(entry.centroid[axis]);
  }
  std::size_t longest = 0;
  for (std::size_t axis = 1; axis < 3; ++axis) {
    if (ranges[axis].length() > ranges[longest].length()) longest = axis;
  }
  return longest;
}

/// Puts the entries of the `size` least keys first.
template <class Key>
void part(Entries entries, std::size_t size, const Key& key) {
  std::nth_element(entries.begin(), entries.begin() + static_cast<std::ptrdiff_t>(size), entries.end(),
                   [&](const Entry& a, const Entry& b) {
                     const double a_key = key(a), b_key = key(b);
                     return a_key != b_key ? a_key < b_key : a.face < b.face;
                   });
}

class Ordering {
 public:
  explicit Ordering(std::span<const Triangle> triangles) : triangles_(triangles) {}

  /// Pre: at most `capacity` entries, a power of two.
  void order(Entries entries, std::size_t capacity) const {
    if (entries.size() <= kRunWidth) return;
    while (capacity >= entries.size()) capacity /= 2;
    const std::size_t axis = longest_axis(entries);
    part(entries, capacity, [axis](const Entry& entry) { return entry.centroid[axis]; });
    if (entries.size() > kFewEntries && overlap(entries, capacity, axis)) part_best(entries, capacity);
    order(entries.first(capacity), capacity);
    order(entries.subspan(capacity), capacity);
  }

 private:
  std::array<Vec3, 3> corners(const Entry& entry) const {
    const Triangle& t = triangles_[entry.face];
    return {Vec3(t.a), Vec3(t.b), Vec3(t.c)};
  }

  Range range(Entries entries, std::size_t axis) const {
    constexpr float Vec3f::*kCoordinates[] = {&Vec3f::x, &Vec3f::y, &Vec3f::z};
    Range range;
    for (const Entry& entry : entries) {
      const Triangle& t = triangles_[entry.face];
      for (const Vec3f* corner : {&t.a, &t.b, &t.c}) range.add(double{corner->*kCoordinates[axis]});
    }
    return range;
  }

  bool overlap(Entries entries, std::size_t size, std::size_t axis) const {
    const Range first = range(entries.first(size), axis);
    const Range second = range(entries.subspan(size), axis);
    return first.high - second.low > kOverlap * (std::max(first.high, second.high) - std::min(first.low, second.low));
  }

  /// Tries the centroids along the axes in which the triangles spread, and the triangles' sizes.
  void part_best(Entries entries, std::size_t size) const {
    PointSpread spread;
    for (const Entry& entry : entries) {
      for (const Vec3& corner : corners(entry)) spread.add({1, corner, {}});
    }
    const std::array<Vec3, 3> axes = spread.principal_axes();
    const auto part_by = [&](std::size_t way) {
      const auto along = [&](const Entry& entry) {
        const auto& c = entry.centroid;
        return c[0] * axes[way].x + c[1] * axes[way].y + c[2] * axes[way].z;
      };
      if (way < axes.size()) part(entries, size, along);
      if (way == axes.size()) part(entries, size, [&](const Entry& entry) { return longest_edge(entry); });
    };
    std::size_t best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t way = 0; way <= axes.size(); ++way) {
      part_by(way);
      const double now = cost(entries.first(size), axes) + cost(entries.subspan(size), axes);
      if (now < least) best = way, least = now;
    }
    part_by(best);
  }

  double longest_edge(const Entry& entry) const {
    const auto [a, b, c] = corners(entry);
    return std::max({squared_length(b - a), squared_length(c - b), squared_length(a - c)});
  }

  /// How often a query is likely to meet the entries' box, times how many it then meets.
  double cost(Entries entries, const std::array<Vec3, 3>& axes) const {
    std::array<Range, 3> box;
    for (const Entry& entry : entries) {
      for (const Vec3& corner : corners(entry)) {
        for (std::size_t i = 0; i < 3; ++i) box[i].add(dot(corner, axes[i]));
      }
    }
    const double x = box[0].length(), y = box[1].length(), z = box[2].length();
    return (x * y + y * z + z * x) * static_cast<double>(entries.size());
  }

  std::span<const Triangle> triangles_;
};

}  // namespace

std::vector<Index> compact_order(std::span<const Triangle> triangles) {
  std::vector<Entry> entries(triangles.size());
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const Triangle& t = triangles[i];
    const Vec3 sum = Vec3(t.a) + Vec3(t.b) + Vec3(t.c);
    entries[i] = {{sum.x, sum.y, sum.z}, static_cast<Index>(i)};
  }
  std::size_t capacity = 1;
  while (capacity < entries.size()) capacity *= 2;
  Ordering(triangles).order(entries, capacity);
  std::vector<Index> order;
  order.reserve(entries.size());
  for (const Entry& entry : entries) order.push_back(entry.face);
  return order;
}

}  // namespace lodestone::detail
