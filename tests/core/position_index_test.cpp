#include <limits>

#include <lodestone/core/detail/position_index.h>

#include "support/catch.h"
#include "support/random.h"

namespace lodestone::test {

using detail::places_of;
using detail::PositionIndex;

TEST_CASE("a point's place is named by the first point there") {
  Random random(3);
  std::vector<Vec3f> positions(500);
  for (Vec3f& p : positions) p = {float(random.below(5)), float(random.below(5)), float(random.below(5))};
  const std::vector<Index> places = places_of(positions);
  for (Index i = 0; i < positions.size(); ++i) {
    Index first = 0;
    while (positions[first] != positions[i]) ++first;
    CHECK(places[i] == first);
  }
}

TEST_CASE("only what was added is found") {
  const std::vector<Vec3f> positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  PositionIndex index(positions);
  CHECK(index.find({1, 0, 0}) == kNoIndex);
  CHECK(index.add(2) == 2);
  CHECK(index.add(1) == 2);
  CHECK(index.find({1, 0, 0}) == 2);
  CHECK(index.find({2, 0, 0}) == kNoIndex);
}

TEST_CASE("zeros of either sign are one place, what is not a number is at none") {
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<Vec3f> positions = {{0, 1, 0}, {kNan, 0, 0}, {-0.0F, 1, -0.0F}, {kNan, 0, 0}};
  PositionIndex index(positions);
  CHECK(index.add_all() == std::vector<Index>{0, 1, 0, 3});
  CHECK(index.find({0, 1, -0.0F}) == 0);
  CHECK(index.find({kNan, 0, 0}) == kNoIndex);
}

}  // namespace lodestone::test
