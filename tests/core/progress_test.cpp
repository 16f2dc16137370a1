#include <lodestone/core/progress.h>

#include <algorithm>
#include <vector>

#include <lodestone/core/parallel.h>

#include "support/catch.h"

namespace lodestone::test {

TEST_CASE("shares of parts add up in the whole, which never falls and ends at 1") {
  std::vector<double> heard;
  const Progress whole = [&](double done) {
    heard.push_back(done);
    return true;
  };
  const Progress first = whole.part(0.25), second = whole.part(0.75), half = second.part(0.5);
  CHECK(first.reach(1));
  CHECK(half.reach(0.5));
  CHECK(half.reach(0.25));
  CHECK(half.add(0.5));
  CHECK(second.reach(0.5));
  CHECK(second.reach(1));
  CHECK(whole.reach(1));
  const std::vector<double> expected = {0.25, 0.4375, 0.4375, 0.625, 0.625, 1, 1};
  REQUIRE(heard.size() == expected.size());
  for (std::size_t i = 0; i < heard.size(); ++i) CHECK(heard[i] == Approx(expected[i]));
}

TEST_CASE("a part with no share hears, and what is done twice counts once") {
  double heard = 0;
  bool wanted = true;
  const Progress whole = [&](double done) {
    heard = done;
    return wanted;
  };
  CHECK(whole.part(0).add(1));
  CHECK(heard == 0);
  const Progress part = whole.part(0.5);
  CHECK(part.add(2));
  CHECK(part.add(2));
  CHECK(heard == Approx(0.5));
  wanted = false;
  CHECK_FALSE(whole.part(0).add(0));
  CHECK(part.is_cancelled());
}

TEST_CASE("what is cancelled is cancelled in all parts, and nobody is called any more") {
  int calls = 0;
  const Progress whole = [&](double) { return ++calls < 3; };
  const Progress part = whole.part(0.5);
  ProgressSteps steps(part, 100, 10);
  int taken = 0;
  while (taken < 100 && steps.next()) ++taken;
  CHECK(taken == 29);
  CHECK(whole.is_cancelled());
  CHECK(part.is_cancelled());
  CHECK_FALSE(whole.reach(1));
  CHECK_FALSE(part.add(0.1));
  CHECK_FALSE(steps.next());
  CHECK(calls == 3);
}

TEST_CASE("without a listener everything goes on") {
  const Progress nobody;
  const Progress nothing = std::function<bool(double)>();
  for (const Progress& progress : {nobody, nothing, nobody.part(0.5)}) {
    CHECK(progress.reach(1));
    CHECK(progress.add(1));
    CHECK_FALSE(progress.is_cancelled());
    ProgressSteps steps(progress, 10, 1);
    for (int i = 0; i < 20; ++i) CHECK(steps.next());
  }
  ProgressSteps none;
  for (int i = 0; i < 20; ++i) CHECK(none.next());
}

TEST_CASE("threads report one at a time, and never less than before") {
  std::vector<double> heard;
  const Progress whole = [&](double done) {
    heard.push_back(done);
    return true;
  };
  with_threads(4, [&] {
    for_each_in_parallel(20, [&](std::size_t i) {
      ProgressSteps steps(whole.part(1.0 / 20), 50, 5);
      for (std::size_t k = 0; k < 50 + i; ++k) steps.next();
    });
  });
  CHECK(heard.size() >= 200);
  CHECK(std::is_sorted(heard.begin(), heard.end()));
  CHECK(heard.back() == Approx(1));
}

}  // namespace lodestone::test
