// Branch and bound, as supremum.cpp does it for whole surfaces: the distance to one triangle is a convex function,
// whose largest value over a part of another triangle is at a corner.

#include "distance/patch_distance.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace lodestone::detail {
namespace {

constexpr double kPatchTolerance = 0.1;
constexpr int kMaxHalvings = 8;
constexpr int kMaxParts = 4000;  // in all: where surfaces touch almost everywhere no distance found ends the search

using Part = std::array<Vec3, 3>;

/// The search for the largest distance from parts of one set to the other set.
class PatchSearch {
 public:
  /// `found` is the largest distance that some point is known to have: bounds close to it need no narrowing.
  PatchSearch(std::span<const Triangle> to, double& found, int& parts_left)
      : to_(to), found_(found), parts_left_(parts_left) {}

  double bound(const Part& part, int halvings_left) {
    const double upper = bound_by_corners(part);
    if (halvings_left == 0 || --parts_left_ < 0 || upper <= found_ * (1 + kPatchTolerance)) return upper;
    const std::size_t i = longest_edge(part);
    const Vec3 middle = (part[i] + part[(i + 1) % 3]) * 0.5;
    Part first = part;
    Part second = part;
    first[(i + 1) % 3] = middle;
    second[i] = middle;
    return std::max(bound(first, halvings_left - 1), bound(second, halvings_left - 1));
  }

 private:
  /// The least of what the triangles bound each by itself; notes how far the corners really are.
  double bound_by_corners(const Part& part) {
    double upper = std::numeric_limits<double>::infinity();
    std::array<double, 3> nearest{upper, upper, upper};
    for (const Triangle& triangle : to_) {
      double farthest = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        const double distance = length(part[i] - nearest_on_triangle(part[i], triangle));
        nearest[i] = std::min(nearest[i], distance);
        farthest = std::max(farthest, distance);
      }
      upper = std::min(upper, farthest);
    }
    found_ = std::max({found_, nearest[0], nearest[1], nearest[2]});
    return upper * kRoundingSlack;
  }

  static std::size_t longest_edge(const Part& part) {
    std::size_t longest = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (squared_length(part[(i + 1) % 3] - part[i]) > squared_length(part[(longest + 1) % 3] - part[longest]))
        longest = i;
    return longest;
  }

  std::span<const Triangle> to_;
  double& found_;
  int& parts_left_;
};

}  // namespace

double patch_distance_bound(std::span<const Triangle> a, std::span<const Triangle> b) {
  double found = 0;
  int parts_left = kMaxParts;
  double bound = 0;
  const auto add_all = [&](std::span<const Triangle> from, std::span<const Triangle> to) {
    PatchSearch search(to, found, parts_left);
    for (const Triangle& t : from)
      bound = std::max(bound, search.bound({Vec3(t.a), Vec3(t.b), Vec3(t.c)}, kMaxHalvings));
  };
  add_all(a, b);
  add_all(b, a);
  return bound;
}

}  // namespace lodestone::detail
