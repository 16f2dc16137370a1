#include <lodestone/io/screen_coverage.h>

#include <cmath>
#include <limits>
#include <random>

#include "support/catch.h"

namespace lodestone::test {
namespace {

void check_falls(const std::vector<double>& values) {
  for (std::size_t i = 1; i < values.size(); ++i)
    CHECK(static_cast<float>(values[i]) < static_cast<float>(values[i - 1]));
  REQUIRE_FALSE(values.empty());
  CHECK(values.front() < 1);
  CHECK(values.back() == 0);
}

}  // namespace

TEST_CASE("a level takes over where what one sees of it is a pixel of 1080 long") {
  // An object of 2 whose next level is off by 0.01: it spans 200 of 1080 pixels where 0.01 are one.
  const std::vector<double> values = screen_coverages(2, std::vector<double>{0, 0.01, 0.04});
  REQUIRE(values.size() == 3);
  CHECK(values[0] == Approx(200.0 / 1080));
  CHECK(values[1] == Approx(50.0 / 1080));
  CHECK(values[2] == 0);
}

TEST_CASE("screen coverages fall strictly from below 1 to 0, whatever the errors are") {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& errors : {std::vector<double>{0},
                                            {0, 0},
                                            {0, 0, 0, 0, 0},
                                            {0, 1e-9, 1e-9, 1e-9},
                                            {0, 0.1, 0.1, 0.1},
                                            {0, infinity, infinity},
                                            {0, 0.2, 0.1, 0.3},
                                            {0, 1e9, 1e9},
                                            {0, std::numeric_limits<double>::quiet_NaN(), 0.1}})
    for (const double size : {0.0, 1e-6, 1.0, 1e6}) check_falls(screen_coverages(size, errors));
  std::mt19937 random(1);
  for (int i = 0; i < 1000; ++i) {
    std::vector<double> errors(1 + random() % 20);
    for (double& error : errors) error = std::pow(10, -6 + static_cast<double>(random() % 8));
    check_falls(screen_coverages(1, errors));
  }
}

TEST_CASE("a level that looks better than the one before leaves it nearly no room") {
  const std::vector<double> values = screen_coverages(1, std::vector<double>{0, 0.1, 0.01});
  CHECK(values[1] == Approx(1 / (1080 * 0.01)));
  CHECK(values[0] < 1.05 * values[1]);
}

TEST_CASE("what one sees grows with distances and with turned normals, and is endless without faces") {
  const LevelLook exact{0, 0, 1, 100};
  CHECK(visible_error(exact) == 0);
  CHECK(visible_error({0.01, 0, 1, 100}) == Approx(0.02));
  CHECK(visible_error({0, 0.5, 1, 100}) == Approx(0.5 * 0.1));
  CHECK(visible_error({0, 0, 1, 0}) == std::numeric_limits<double>::infinity());
}

}  // namespace lodestone::test
