#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include <lodestone/core/detail/edges.h>

#include "support/catch.h"
#include "support/random.h"

namespace lodestone::test {

using detail::Edge;
using detail::for_each_edge;
using detail::HalfEdge;
using detail::sorted_edges;

TEST_CASE("edges come by their ends, each with all of its halves by corner, however far apart ends are numbered") {
  const Index step = GENERATE(1U, 300'000'000U);
  Random random(5);
  std::vector<Index> corners(300);  // broken faces that name an end twice among them
  for (Index& corner : corners) corner = step * static_cast<Index>(random.below(12));
  std::map<std::pair<Index, Index>, std::vector<Index>> expected;
  for (Index c = 0; c < corners.size(); ++c) expected[std::minmax(corners[c], corners[next_corner(c)])].push_back(c);

  const std::vector<HalfEdge> halves = sorted_edges(corners);
  auto next = expected.begin();
  for_each_edge(halves, [&](Edge edge) {
    REQUIRE(next != expected.end());
    CHECK(edge.front().low() == next->first.first);
    CHECK(edge.front().high() == next->first.second);
    CHECK(edge.front().is_loop() == (next->first.first == next->first.second));
    REQUIRE(edge.size() == next->second.size());
    for (std::size_t i = 0; i < edge.size(); ++i) {
      CHECK(edge[i].corner == next->second[i]);
      CHECK(edge[i].forward == (corners[edge[i].corner] < corners[next_corner(edge[i].corner)]));
    }
    ++next;
  });
  CHECK(next == expected.end());
}

}  // namespace lodestone::test
