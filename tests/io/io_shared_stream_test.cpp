#include <lodestone/io/shared_stream.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>
#include <vector>

#include <lodestone/io/compact_stream.h>
#include <lodestone/io/draw_cursor.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "support/counted_memory.h"
#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/placed_shapes.h"
#include "support/random.h"
#include "support/same_mesh.h"

namespace lodestone::test {
namespace {

using StreamBytes = std::vector<std::byte>;

ProgressiveMesh progressive(const TriangleSoup& soup, double dense_rounds) {
  SimplifyOptions options;
  options.dense_rounds = dense_rounds;
  options.measure_step = 0;
  return std::move(simplify(mesh_of(soup), options).value().mesh);
}

/// Of both formats, each of several chunks; with attributes, several groups, and vertices that move.
const std::vector<StreamBytes>& streams() {
  static const std::vector<StreamBytes> kAll = [] {
    std::vector<StreamBytes> all;
    const ProgressiveMesh hills = progressive(terrain(kReduced ? 40 : 80, 3), 1.5);
    all.push_back(encode_compact(hills, {}, scattered_levels(hills, 2, 0.01, 0.01, 1)).value().bytes);
    all.push_back(encode_compact(progressive(seam_sphere(24, 16), 1.5)).value().bytes);
    StreamOptions options;
    options.records_per_chunk = 16;
    for (const TriangleSoup& soup : {seam_cube(8), two_material_sphere(2), skinned_cylinder(12, 12), empty_soup()})
      all.push_back(encode_stream(progressive(soup, 0), options).value());
    return all;
  }();
  return kAll;
}

}  // namespace

TEST_CASE("after each chunk those who draw have the mesh of the reader, and cursors go on") {
  Random random(1);
  for (const StreamBytes& bytes : streams()) {
    StreamReader reader;
    SharedStream stream;
    const ProgressiveMesh* const address = &stream.hold().mesh();
    std::optional<Cursor> cursor;
    CHECK(stream.hold().due().end == reader.due().end);
    for (std::span<const std::byte> rest = bytes; !rest.empty();) {
      const auto piece = rest.first(std::min<std::size_t>(1 + random.below(400), rest.size()));
      rest = rest.subspan(piece.size());
      REQUIRE(reader.append(piece));
      REQUIRE(stream.append(piece));
      const auto held = stream.hold();
      REQUIRE(&held.mesh() == address);
      REQUIRE(same(held.mesh(), reader.mesh()));
      REQUIRE(held.chunk_count() == reader.chunk_count());
      REQUIRE(held.chunks().size() == reader.chunks().size());
      REQUIRE(held.due().begin == reader.due().begin);
      REQUIRE(held.due().end == reader.due().end);
      if (held.chunk_count() == 0) continue;
      if (!cursor) cursor.emplace(held.mesh());
      cursor->seek(static_cast<Index>(random.below(held.mesh().record_count() + 1)));
      Cursor direct(reader.mesh());
      direct.seek(cursor->position());
      for (std::size_t group = 0; group < held.mesh().groups.size(); ++group)
        REQUIRE(std::ranges::equal(cursor->corners(group), direct.corners(group)));
    }
    REQUIRE(stream.finish());
    CHECK(stream.hold().done());
  }
}

TEST_CASE("a thread draws while another reads, and ends with the whole") {
  for (const StreamBytes& bytes : streams()) {
    SharedStream stream;
    std::atomic<bool> ended = false;
    std::size_t drawn = 0;
    std::vector<float> positions;
    std::thread drawing([&] {
      std::optional<DrawCursor> cursor;
      std::vector<EntryRange> ranges;
      for (bool last = false; !last; std::this_thread::yield()) {
        last = ended;
        const auto held = stream.hold();
        if (held.chunk_count() == 0) continue;
        if (!cursor) cursor.emplace(held.mesh());
        cursor->seek(last ? kNoIndex : static_cast<Index>(held.mesh().record_count() / (1 + drawn % 3)));
        const EntryRange wedges = cursor->take_new_wedges();
        positions.resize(3 * wedges.end);
        cursor->take_moved_wedges(0, ranges);
        ranges.push_back(wedges);
        for (const EntryRange& range : ranges)
          copy_positions(held.mesh(), *cursor, range, positions.data() + 3 * range.begin);
        ++drawn;
      }
    });
    bool taken = true;
    for (std::size_t at = 0; at < bytes.size() && taken; at += 64) {
      taken = stream.append(std::span(bytes).subspan(at, std::min<std::size_t>(64, bytes.size() - at))).has_value();
      std::this_thread::yield();
    }
    ended = true;
    drawing.join();
    REQUIRE(taken);
    REQUIRE(stream.finish());
    CHECK(drawn > 0);
    const auto held = stream.hold();
    const std::vector<Vec3f> expected = positions_at(held.mesh(), static_cast<Index>(held.mesh().record_count()));
    REQUIRE(positions.size() == 3 * held.mesh().wedge_vertex.size());
    for (std::size_t w = 0; w < held.mesh().wedge_vertex.size(); ++w)
      REQUIRE(Vec3f{positions[3 * w], positions[3 * w + 1], positions[3 * w + 2]} ==
              expected[held.mesh().wedge_vertex[w]]);
  }
}

TEST_CASE("what fails leaves those who draw what they have, and bytes that are missing or known are as for a reader") {
  StreamBytes bytes = streams().front();
  SharedStream stream;
  CHECK(stream.append_at(5, std::span(bytes).first(5)).error().code == ErrorCode::InvalidArgument);
  REQUIRE(stream.append_at(0, std::span(bytes).first(bytes.size() / 2)));
  REQUIRE(stream.append_at(0, std::span(bytes).first(bytes.size() / 3)));
  CHECK(stream.finish().error().code == ErrorCode::Malformed);
  const std::size_t chunk_count = stream.hold().chunk_count();
  REQUIRE(chunk_count > 0);
  REQUIRE(chunk_count < stream.hold().chunks().size());
  const ProgressiveMesh before = stream.hold().mesh();
  bytes[bytes.size() / 2] ^= std::byte{1};
  CHECK(stream.append_at(bytes.size() / 3, std::span(bytes).subspan(bytes.size() / 3)).error().code ==
        ErrorCode::Malformed);
  CHECK(stream.append({}).error().code == ErrorCode::Malformed);
  CHECK(stream.append_at(1 << 30, bytes).error().code == ErrorCode::Malformed);
  CHECK(stream.reader().error());
  CHECK(stream.hold().due().empty());
  CHECK(stream.hold().chunk_count() == chunk_count);
  CHECK(!stream.hold().done());
  CHECK(same(stream.hold().mesh(), before));
}

TEST_CASE("once all has arrived there is one mesh") {
  const StreamBytes& bytes = streams().front();
  const std::size_t before = live_bytes;
  SharedStream stream;
  REQUIRE(stream.append(bytes));
  const std::size_t shared = live_bytes - before;
  StreamReader reader;
  REQUIRE(reader.append(bytes));
  CHECK(live_bytes - before - shared <= shared);
  CHECK(shared < (live_bytes - before - shared) * 11 / 10);
}

}  // namespace lodestone::test
