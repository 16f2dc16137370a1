#include <lodestone/io/detail_choice.h>

#include <cmath>
#include <numbers>

#include <lodestone/io/compact_stream.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/lod/simplify.h>

#include "support/mesh_properties.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

ProgressiveMesh progressive(const TriangleSoup& soup, double dense_rounds = 0) {
  SimplifyOptions options;
  options.dense_rounds = dense_rounds;
  options.vanish = dense_rounds == 0;  // compact streams have no vanishing pieces yet
  return std::move(simplify(mesh_of(soup), options).value().mesh);
}

}  // namespace

TEST_CASE("pixels are those of a perspective picture") {
  ObjectView view;
  view.screen_height = 1000;
  view.field_of_view = std::numbers::pi / 2;
  view.distance = 10;
  // At a distance of 10 the picture of a right angle shows 20 units.
  CHECK(std::abs(pixels_per_unit(view) - 50) < 1e-9);
  view.scale = 3;
  CHECK(std::abs(pixels_per_unit(view) - 150) < 1e-9);
  for (const double distance : {0.0, -1.0, std::nan("")}) {
    view.distance = distance;
    CHECK(std::isinf(pixels_per_unit(view)));
  }
}

TEST_CASE("the coarsest position is the one that a search from the first finds, and whole") {
  Random random(1);
  for (const NamedShape& shape : all_shapes()) {
    if (shape.soup.positions.empty()) continue;
    INFO(shape.name);
    const ProgressiveMesh mesh = progressive(shape.soup);
    DetailChoice choice(mesh);
    for (int i = 0; i < 50; ++i) {
      const double deviation = static_cast<double>(mesh.deviation[random.below(mesh.deviation.size())]) *
                               (i % 2 == 0 ? 1 : 2 * random.unit());
      Index expected = position_for_deviation(mesh, deviation);
      while (!is_whole(mesh, expected)) ++expected;
      CHECK(choice.coarsest(deviation) == expected);
    }
    CHECK(choice.coarsest(-1) == mesh.record_count());
    CHECK(choice.coarsest(HUGE_VAL) == 0);
  }
}

TEST_CASE("a choice stays where it is fine enough and not much too fine") {
  const ProgressiveMesh mesh = progressive(icosphere(4, 0.02, 1), 1.5);
  DetailChoice choice(mesh, 1.5);
  const auto last = static_cast<Index>(mesh.record_count());
  Random random(2);
  Index position = 0;
  for (int i = 0; i < 1000; ++i) {
    const double deviation = static_cast<double>(mesh.deviation[0]) * std::exp2(-8 * random.unit());
    const Index next = choice.choose(position, deviation);
    const Index coarse = choice.coarsest(deviation), fine = choice.coarsest(deviation / 1.5);
    CHECK(next >= coarse);
    CHECK(next <= fine);
    CHECK(((next == position) || next == coarse || next == fine));
    if (position >= coarse && position <= fine) CHECK(next == position);
    CHECK((next == last || static_cast<double>(mesh.deviation[next]) <= deviation));
    position = next;
  }
  // What trembles by less than the slack moves nothing.
  const double still = static_cast<double>(mesh.deviation[0]) / 20;
  position = choice.choose(0, still);
  for (int i = 0; i < 100; ++i) CHECK(choice.choose(position, still * (1 + 0.4 * random.unit())) == position);
}

TEST_CASE("a choice takes what has arrived since into account") {
  const auto stream = encode_compact(progressive(terrain(40, 3), 1.5));
  REQUIRE(stream);
  StreamReader reader;
  std::optional<DetailChoice> choice;
  std::size_t seen = 0;
  for (const std::byte byte : stream->bytes) {
    REQUIRE(reader.append({&byte, 1}));
    if (reader.chunk_count() == seen) continue;
    seen = reader.chunk_count();
    if (!choice) choice.emplace(reader.mesh());
    for (const double deviation : {0.0, 0.001, 0.01, 0.1})
      CHECK(choice->coarsest(deviation) == position_for_deviation(reader.mesh(), deviation));
  }
  CHECK(choice->coarsest(0) == position_for_deviation(reader.mesh(), 0));
}

}  // namespace lodestone::test
