// Compact streams whose levels on the way have places of their own.

#include <cmath>
#include <string>

#include <lodestone/io/compact_stream.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/place_levels.h>
#include <lodestone/lod/simplify.h>

#include "support/compact.h"
#include "support/data.h"
#include "support/deviations.h"
#include "support/fuzz_reader.h"
#include "support/mesh_properties.h"
#include "support/placed_shapes.h"
#include "support/progressive_shapes.h"
#include "support/random.h"
#include "support/same_mesh.h"

namespace lodestone::test {
namespace {

constexpr int kBits = 12;

/// The cube around a mesh, and the step of its grid.
struct Box {
  CompactGrid grid;
  double step = 0;
};

Box box_of(const ProgressiveMesh& mesh) {
  Vec3f low = mesh.positions.front(), high = low;
  for (const Vec3f& p : mesh.positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const float range = std::max({high.x - low.x, high.y - low.y, high.z - low.z, 1e-6F});
  return {{low, range}, static_cast<double>(range) / ((1 << kBits) - 1)};
}

CompactStream encoded(const ProgressiveMesh& mesh, const std::vector<PlacedLevel>& levels,
                      CompactCoding coding = CompactCoding::Small) {
  CompactOptions options;
  options.coding = coding;
  options.grid_bits = kBits;
  options.grid = box_of(mesh).grid;
  return stream_of(mesh, options, levels);
}

/// How far a point is outside of a box.
Vec3 clamped(const Vec3f& p, const CompactGrid& grid) {
  const auto on_axis = [&](float value, float low) {
    return std::clamp(static_cast<double>(value), static_cast<double>(low), static_cast<double>(low) + grid.range);
  };
  return {on_axis(p.x, grid.origin.x), on_axis(p.y, grid.origin.y), on_axis(p.z, grid.origin.z)};
}

/// Checks that a level lies where it was placed, as finely as it was said to matter; at the upper edges of the grid,
/// where there may be no multiple of the step, twice as far.
void check_places(const ProgressiveMesh& coded, const CompactStream& stream, const std::vector<Vec3f>& wanted,
                  Index position, double reach, const CompactGrid& grid) {
  const std::vector<Vec3f> found = positions_at(coded, position);
  REQUIRE(found.size() == wanted.size());
  double farthest = 0;
  for (std::size_t v = 0; v < wanted.size(); ++v) {
    const Vec3 off = Vec3(found[stream.vertex_numbers[v]]) - clamped(wanted[v], grid);
    farthest = std::max({farthest, std::abs(off.x), std::abs(off.y), std::abs(off.z)});
  }
  CHECK(farthest <= reach);
}

}  // namespace

TEST_CASE("levels of a stream lie where they were placed, and what follows them where the mesh has it") {
  const CompactCoding coding = GENERATE(CompactCoding::Small, CompactCoding::Fast);
  int count = 0;
  for (const ProgressiveMesh& mesh : progressive_shapes()) {
    const Box box = box_of(mesh);
    for (const double precision : {0.0, 8.1})
      for (const std::size_t level_count : {1, 3}) {
        INFO(count << ": " << mesh.record_count() << " records, " << level_count << " levels, precision " << precision);
        const double reach = 30 * box.step;
        const auto levels = scattered_levels(mesh, level_count, reach, precision * box.step, count + 1U);
        const CompactStream stream = encoded(mesh, levels, coding);
        const ProgressiveMesh coded = decoded(stream.bytes);
        const double step = precision > 0 ? 8 * box.step : box.step;
        const double far = 1.001 * (precision > 0 ? step : step / 2) + 1e-6;
        for (const PlacedLevel& level : levels) {
          check_places(coded, stream, level.positions, level.position, far, box.grid);
          // With what rounding moves both surfaces by, rounded up by an eighth of an octave.
          const double widest = (static_cast<double>(level.deviation) + std::sqrt(3.0) * (far + box.step)) * 1.0906;
          CHECK(static_cast<double>(coded.deviation[level.position]) <= widest);
        }
        check_places(coded, stream, mesh.positions, static_cast<Index>(mesh.record_count()), 0.501 * box.step + 1e-6,
                     box.grid);
        CHECK(coded.deviation.back() == 0);
        check_in_pieces(stream.bytes, coded);
        ++count;
      }
  }
  CHECK(count > 50);
}

TEST_CASE("the deviation of any level of a stream with placed levels is a bound, within rounds too") {
  Random random(5);
  for (const TriangleSoup& soup : {terrain(kReduced ? 8 : 16, 3), icosphere(kReduced ? 2 : 3, 0.05, 1),
                                   annulus(24, kReduced ? 2 : 4), cube(kReduced ? 3 : 6), seam_sphere(12, 9)}) {
    SimplifyOptions options;
    options.dense_rounds = 1.5;
    const ProgressiveMesh mesh = simplify(mesh_of(soup), options).value().mesh;
    const Box box = box_of(mesh);
    for (const double reach : {3.0, kReduced ? 30.0 : 100.0}) {
      const CompactStream stream =
          encoded(mesh, scattered_levels(mesh, 3, reach * box.step, 4.1 * box.step, random.next()));
      const ProgressiveMesh coded = decoded(stream.bytes);
      const Mesh whole = extract_level(coded, kNoIndex);
      const MeasuredSurface surface(whole);
      for (int i = 0; i < (kReduced ? 1 : 6); ++i) {
        const auto position = static_cast<Index>(random.below(coded.record_count() + 1));
        const Mesh level = extract_level(coded, position);
        if (level.face_count() == 0) continue;
        const double measured = largest_deviation(MeasuredSurface(level), surface);
        INFO(position << " of " << coded.record_count() << ", moved by up to " << reach);
        CHECK(measured <= 1.00001 * static_cast<double>(coded.deviation[position]) + 1e-7);
      }
    }
  }
}

TEST_CASE("a stream with placed levels that ends with a chunk is the level that it leads to") {
  SimplifyOptions options;
  options.dense_rounds = 1.5;
  const ProgressiveMesh mesh = simplify(mesh_of(terrain(50, 3)), options).value().mesh;
  const Box box = box_of(mesh);
  const auto levels = scattered_levels(mesh, 3, 20 * box.step, 4.1 * box.step, 3);
  const CompactStream stream = encoded(mesh, levels);
  const ProgressiveMesh whole = decoded(stream.bytes);
  const auto chunks = read_compact_chunks(stream.bytes);
  REQUIRE(chunks);
  REQUIRE(chunks->size() > 3);
  std::size_t placed = 0;
  for (const CompactChunk& chunk : *chunks) {
    const auto bytes = std::span(stream.bytes).first(static_cast<std::size_t>(chunk.byte_offset + chunk.byte_length));
    const ProgressiveMesh part = decoded(bytes);
    const Index position = chunk.record_begin + chunk.record_count;
    REQUIRE(part.record_count() == position);
    CHECK(positions_at(part, position) == positions_at(whole, position));
    CHECK(part.deviation.back() == whole.deviation[position]);
    CHECK(chunk.deviation == whole.deviation[position]);
    for (const PlacedLevel& level : levels) placed += level.position == position ? 1U : 0U;
  }
  CHECK(placed == levels.size());  // each ends a chunk
}

TEST_CASE("what moves in a stream is counted, and only where levels are placed") {
  SimplifyOptions options;
  options.dense_rounds = 1.5;
  const ProgressiveMesh mesh = simplify(mesh_of(icosphere(4, 0.05, 1)), options).value().mesh;
  const CompactStream plain = encoded(mesh, {});
  CHECK(plain.sizes.moves < 40);
  CHECK(decoded(plain.bytes).moves.empty());
  const CompactStream placed = encoded(mesh, scattered_levels(mesh, 2, 0.01, 0, 1));
  CHECK(placed.sizes.moves > 1000);
  CHECK(std::abs(placed.sizes.sum() - 8.0 * static_cast<double>(placed.bytes.size())) < 1e-6);
  const auto parts = measure_compact(placed.bytes);
  REQUIRE(parts);
  CHECK(std::abs(parts->sizes.moves - placed.sizes.moves) < 64);
}

TEST_CASE("levels that are none of the mesh are refused") {
  const ProgressiveMesh mesh = simplify(mesh_of(icosphere(2, 0.05, 1))).value().mesh;
  const auto good = scattered_levels(mesh, 2, 0.01, 0.01, 1);
  REQUIRE(good.size() == 2);
  REQUIRE(encode_compact(mesh, {}, good));
  const auto refused = [&](auto&& change, const std::string& message) {
    auto levels = good;
    change(levels);
    const auto stream = encode_compact(mesh, {}, levels);
    REQUIRE(!stream);
    CHECK(stream.error().code == ErrorCode::InvalidArgument);
    CHECK_THAT(stream.error().message, contains(message));
  };
  refused([](auto& l) { std::swap(l[0], l[1]); }, "does not lie between");
  refused([](auto& l) { l[1] = l[0]; }, "does not lie between");
  refused([](auto& l) { l[0].position = 0; }, "does not lie between 0 and ");
  refused([&](auto& l) { l[1].position = static_cast<Index>(mesh.record_count()); }, "does not lie between");
  refused([](auto& l) { l[0].positions.pop_back(); }, " vertices has ");
  refused([](auto& l) { l[1].positions[3].y = std::nanf(""); }, "not finite");
  refused([](auto& l) { l[0].deviation = -1; }, "has an error of -1");
  refused([](auto& l) { l[0].precision = std::nanf(""); }, "a precision of ");

  const auto many = encode_compact(mesh, {}, scattered_levels(mesh, 40, 0.01, 0.01, 1));
  REQUIRE(!many);
  CHECK(many.error().code == ErrorCode::LimitExceeded);

  ProgressiveMesh moved = mesh;
  add_moves(moved, 0.01, 1);
  REQUIRE(validate(moved));
  CHECK(encode_compact(moved).error().code == ErrorCode::Unsupported);
}

TEST_CASE("placed levels lie closer to the mesh than its own vertices do, and say by how much") {
  for (const TriangleSoup& soup : {icosphere(kReduced ? 4 : 5, 0, 1), terrain(kReduced ? 40 : 60, 3),
                                   torus(kReduced ? 40 : 60, kReduced ? 20 : 30)}) {
    const Mesh original = mesh_of(soup);
    SimplifyOptions options;
    options.dense_rounds = 1.5;
    const ProgressiveMesh mesh = simplify(original, options).value().mesh;
    const MeasuredSurface surface(original);
    const auto levels = place_levels(LevelFitter(original), surface, mesh);
    REQUIRE(levels.size() >= 2);
    for (const PlacedLevel& level : levels) {
      INFO(level.position << " of " << mesh.record_count());
      Mesh placed = extract_level(mesh, level.position);
      const double before = measure_deviation(MeasuredSurface(placed), surface).backward.rms;
      placed.positions = level.positions;
      const Deviation after = measure_deviation(MeasuredSurface(placed), surface);
      CHECK(after.backward.rms < 0.9 * before);
      CHECK(after.maximum() <= static_cast<double>(level.deviation) * 1.000001);
      CHECK(level.precision > 0);
    }
    // Where something stays, it stays exactly, whatever grid it comes to lie on.
    PlacementOptions fixed;
    fixed.fixed.assign(original.vertex_count(), 0);
    fixed.fixed[0] = 1;
    for (const PlacedLevel& level : place_levels(LevelFitter(original), surface, mesh, fixed))
      CHECK(level.precision == 0);
  }
}

}  // namespace lodestone::test
