#include <lodestone/lodestone.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <limits>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <lodestone/io/compact_stream.h>
#include <lodestone/io/draw_cursor.h>
#include <lodestone/io/geomorph.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/lod/simplify.h>

#include "support/mesh_properties.h"
#include "support/placed_shapes.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

ProgressiveMesh progressive(const TriangleSoup& soup) {
  SimplifyOptions options;
  options.dense_rounds = 1.5;
  return std::move(simplify(mesh_of(soup), options).value().mesh);
}

std::vector<std::byte> compact_bytes() { return encode_compact(progressive(terrain(30, 3))).value().bytes; }

/// With vertices that move.
std::vector<std::byte> placed_bytes() {
  const ProgressiveMesh mesh = progressive(terrain(30, 3));
  return encode_compact(mesh, {}, scattered_levels(mesh, 2, 0.01, 0.01, 1)).value().bytes;
}

/// With attributes, several groups and wedges.
std::vector<std::byte> removal_bytes() {
  TriangleSoup soup = two_material_grid(8);
  Attribute colour{"COLOR_0", ComponentType::UInt8, 4, true, {}};
  for (std::size_t i = 0; i < 4 * soup.positions.size(); ++i) colour.data.push_back(static_cast<std::byte>(7 * i));
  soup.attributes = {colour};
  return encode_stream(progressive(soup)).value();
}

template <class Struct>
Struct sized() {
  Struct value{};
  value.size = sizeof value;
  return value;
}

lodestone_stream* make_stream() {
  lodestone_stream* stream = nullptr;
  REQUIRE(lodestone_stream_create(nullptr, &stream) == LODESTONE_OK);
  return stream;
}

lodestone_stream* read_whole(const std::vector<std::byte>& bytes) {
  lodestone_stream* const stream = make_stream();
  REQUIRE(lodestone_stream_append(stream, 0, bytes.data(), bytes.size()) == LODESTONE_OK);
  return stream;
}

lodestone_cursor* make_cursor(lodestone_stream* stream) {
  lodestone_cursor* cursor = nullptr;
  REQUIRE(lodestone_cursor_create(stream, nullptr, &cursor) == LODESTONE_OK);
  return cursor;
}

lodestone_stream_state state_of(lodestone_stream* stream) {
  auto state = sized<lodestone_stream_state>();
  REQUIRE(lodestone_stream_get_state(stream, &state) == LODESTONE_OK);
  return state;
}

}  // namespace

TEST_CASE("the C interface gives what the C++ one does") {
  for (const std::vector<std::byte>& bytes : {compact_bytes(), removal_bytes()}) {
    StreamReader reader;
    REQUIRE(reader.append(bytes));
    const ProgressiveMesh& mesh = reader.mesh();
    lodestone_stream* const stream = read_whole(bytes);
    CHECK(lodestone_stream_finish(stream) == LODESTONE_OK);

    const lodestone_stream_state state = state_of(stream);
    CHECK(state.due_begin == state.due_end);
    CHECK(state.chunk_count == reader.chunks().size());
    CHECK(state.chunks_ready == state.chunk_count);
    CHECK(state.record_count == mesh.record_count());
    CHECK(state.wedge_count == mesh.wedge_vertex.size());
    const Box box = bounding_box(extract_level(mesh, kNoIndex));
    CHECK(to_float(box.low) == Vec3f{state.low[0], state.low[1], state.low[2]});
    CHECK(to_float(box.high) == Vec3f{state.high[0], state.high[1], state.high[2]});

    for (std::uint32_t i = 0; i < state.chunk_count; ++i) {
      auto chunk = sized<lodestone_chunk>();
      REQUIRE(lodestone_stream_get_chunk(stream, i, &chunk) == LODESTONE_OK);
      const ReaderChunk& expected = reader.chunks()[i];
      CHECK(chunk.byte_begin == expected.bytes.begin);
      CHECK(chunk.byte_end == expected.bytes.end);
      CHECK(chunk.position == expected.position);
      CHECK(chunk.vertex_count == expected.vertex_count);
      CHECK(chunk.face_count == expected.face_count);
      CHECK(chunk.deviation == expected.deviation);
    }
    REQUIRE(state.attribute_count == mesh.attributes.size());
    for (std::uint32_t i = 0; i < state.attribute_count; ++i) {
      auto attribute = sized<lodestone_attribute>();
      REQUIRE(lodestone_stream_get_attribute(stream, i, &attribute) == LODESTONE_OK);
      CHECK(attribute.name == mesh.attributes[i].name);
      CHECK(attribute.component_type == static_cast<std::uint32_t>(mesh.attributes[i].type));
      CHECK(attribute.component_count == mesh.attributes[i].component_count);
      CHECK(attribute.normalized == (mesh.attributes[i].normalized ? 1 : 0));
      REQUIRE(attribute.element_bytes == mesh.attributes[i].element_bytes());
      std::vector<std::byte> out((state.wedge_count - 3) * attribute.element_bytes);
      REQUIRE(lodestone_stream_copy_attribute(stream, i, 3, state.wedge_count, out.data(), out.size()) == LODESTONE_OK);
      CHECK(std::memcmp(out.data(), &mesh.attributes[i].data[3 * attribute.element_bytes], out.size()) == 0);
    }

    lodestone_cursor* const cursor = make_cursor(stream);
    DrawCursor expected(mesh);
    Random random(1);
    for (int move = 0; move < 20; ++move) {
      const auto goal = static_cast<std::uint32_t>(random.below(mesh.record_count() + 2));
      REQUIRE(lodestone_cursor_seek(cursor, goal) == LODESTONE_OK);
      expected.seek(goal);
      auto level = sized<lodestone_level>();
      REQUIRE(lodestone_cursor_get_level(cursor, &level) == LODESTONE_OK);
      CHECK(level.position == expected.position());
      CHECK(level.vertex_count == expected.vertex_count());
      CHECK(level.wedge_count == expected.wedge_count());
      CHECK(level.face_count == expected.face_count());
      CHECK(level.deviation == mesh.deviation[expected.position()]);

      lodestone_range wedges;
      REQUIRE(lodestone_cursor_take_new_wedges(cursor, &wedges) == LODESTONE_OK);
      CHECK(EntryRange{wedges.begin, wedges.end} == expected.take_new_wedges());
      std::vector<float> out(3 * level.wedge_count), same(3 * level.wedge_count);
      REQUIRE(lodestone_cursor_copy_positions(cursor, 0, level.wedge_count, out.data(), out.size()) == LODESTONE_OK);
      copy_positions(mesh, expected, {0, level.wedge_count}, same.data());
      CHECK(out == same);
      REQUIRE(lodestone_cursor_copy_normals(cursor, out.data(), out.size()) == LODESTONE_OK);
      copy_normals(mesh, expected, same.data());
      CHECK(out == same);

      REQUIRE(state.group_count == expected.group_count());
      for (std::uint32_t group = 0; group < state.group_count; ++group) {
        const std::uint32_t* corners = nullptr;
        std::size_t count = 0;
        REQUIRE(lodestone_cursor_get_corners(cursor, group, &corners, &count) == LODESTONE_OK);
        CHECK(std::ranges::equal(std::span(corners, count), expected.corners(group)));
        const std::size_t room = 1 + random.below(3);
        std::vector<lodestone_range> ranges(room);
        REQUIRE(lodestone_cursor_take_changes(cursor, group, 0, ranges.data(), room, &count) == LODESTONE_OK);
        std::vector<EntryRange> all;
        expected.take_changes(group, 0, all);
        REQUIRE(count == std::min(room, all.size()));
        for (std::size_t i = 0; i < count; ++i) {
          CHECK(ranges[i].begin == all[i].begin);
          CHECK(ranges[i].end == (i + 1 < count ? all[i] : all.back()).end);
        }
        auto described = sized<lodestone_group>();
        REQUIRE(lodestone_stream_get_group(stream, group, &described) == LODESTONE_OK);
        CHECK(described.material == mesh.groups[group].material);
        CHECK(described.face_count == mesh.groups[group].face_count);
      }
    }
    lodestone_cursor_destroy(cursor);
    lodestone_stream_destroy(stream);
  }
}

TEST_CASE("a cursor chooses as the C++ choice does, and views that are none are told") {
  lodestone_stream* const stream = read_whole(compact_bytes());
  auto options = sized<lodestone_cursor_options>();
  lodestone_cursor* cursor = nullptr;
  for (const double slack : {0.5, -1.0, HUGE_VAL, std::nan("")}) {
    options.slack = slack;
    CHECK(lodestone_cursor_create(stream, &options, &cursor) == LODESTONE_INVALID_ARGUMENT);
    CHECK_THAT(std::string(lodestone_stream_message(stream)), contains("slack"));
  }
  options.slack = 1;
  REQUIRE(lodestone_cursor_create(stream, &options, &cursor) == LODESTONE_OK);
  auto level = sized<lodestone_level>();
  REQUIRE(lodestone_cursor_get_level(cursor, &level) == LODESTONE_OK);
  const float coarsest = level.deviation;
  std::uint32_t position = 0;
  for (const float part : {0.5F, 0.1F, 0.3F}) {
    REQUIRE(lodestone_cursor_choose(cursor, coarsest * part, &position) == LODESTONE_OK);
    REQUIRE(lodestone_cursor_seek(cursor, position) == LODESTONE_OK);
    REQUIRE(lodestone_cursor_get_level(cursor, &level) == LODESTONE_OK);
    CHECK(level.position == position);
    CHECK(level.deviation <= coarsest * part);
    CHECK(level.position > 0);
  }
  CHECK(lodestone_cursor_choose(cursor, -1, &position) == LODESTONE_INVALID_ARGUMENT);
  CHECK(lodestone_cursor_choose(cursor, std::nan(""), &position) == LODESTONE_INVALID_ARGUMENT);
  CHECK(position > 0);
  CHECK(lodestone_cursor_choose(cursor, HUGE_VAL, &position) == LODESTONE_OK);
  CHECK(position == 0);
  lodestone_cursor_destroy(cursor);
  lodestone_stream_destroy(stream);

  lodestone_view view = {sizeof view, 1000, 1, 10, 1};
  CHECK(std::abs(lodestone_pixels_per_unit(&view) - 1000 / (20 * std::tan(0.5))) < 1e-9);
  view.distance = 0;
  CHECK(std::isinf(lodestone_pixels_per_unit(&view)));
  view.field_of_view = 4;
  CHECK(lodestone_pixels_per_unit(&view) == -1);
  CHECK(lodestone_pixels_per_unit(nullptr) == -1);
}

TEST_CASE("errors have codes, names and words, and go with the next call") {
  lodestone_stream* const stream = make_stream();
  std::vector<std::byte> bytes = compact_bytes();
  CHECK(lodestone_stream_append(stream, 5, bytes.data(), 5) == LODESTONE_INVALID_ARGUMENT);
  CHECK_THAT(std::string(lodestone_stream_message(stream)), contains("bytes from 5 on, where those from 0 are due"));
  lodestone_cursor* cursor = nullptr;
  CHECK(lodestone_cursor_create(stream, nullptr, &cursor) == LODESTONE_NOT_READY);
  CHECK(cursor == nullptr);
  CHECK(lodestone_stream_append(stream, 0, bytes.data(), 100) == LODESTONE_OK);
  CHECK(std::string(lodestone_stream_message(stream)).empty());
  CHECK(lodestone_stream_finish(stream) == LODESTONE_MALFORMED);
  bytes[bytes.size() / 2] ^= std::byte{1};
  CHECK(lodestone_stream_append(stream, 0, bytes.data(), bytes.size()) == LODESTONE_MALFORMED);
  CHECK_THAT(std::string(lodestone_stream_message(stream)), contains("checksum"));
  CHECK(state_of(stream).due_begin == state_of(stream).due_end);
  CHECK(lodestone_stream_append(stream, 0, bytes.data(), 1) == LODESTONE_MALFORMED);
  lodestone_stream_destroy(stream);

  auto options = sized<lodestone_stream_options>();
  options.most_bytes = 1000;
  lodestone_stream* small = nullptr;
  REQUIRE(lodestone_stream_create(&options, &small) == LODESTONE_OK);
  bytes[bytes.size() / 2] ^= std::byte{1};
  CHECK(lodestone_stream_append(small, 0, bytes.data(), bytes.size()) == LODESTONE_LIMIT_EXCEEDED);
  lodestone_stream_destroy(small);

  std::set<std::string> names;
  for (std::int32_t code = 0; code >= LODESTONE_OUT_OF_MEMORY; --code) names.insert(lodestone_code_name(code));
  CHECK(names.size() == 8);
  CHECK(!names.contains("LODESTONE_UNKNOWN"));
  for (const std::int32_t code : {1, LODESTONE_OUT_OF_MEMORY - 1, std::numeric_limits<std::int32_t>::min()})
    CHECK(std::string(lodestone_code_name(code)) == "LODESTONE_UNKNOWN");
  CHECK(std::string(lodestone_code_name(LODESTONE_NO_ROOM)) == "LODESTONE_NO_ROOM");
  CHECK(lodestone_version() == LODESTONE_VERSION);
}

TEST_CASE("what is null, out of range or too small is refused, and nothing written") {
  lodestone_stream* const stream = read_whole(removal_bytes());
  lodestone_cursor* const cursor = make_cursor(stream);
  const std::uint32_t wedges = state_of(stream).wedge_count;
  std::vector<float> out(3 * wedges, 7);
  const auto refused = [](std::int32_t code, std::int32_t expected = LODESTONE_INVALID_ARGUMENT) {
    CHECK(code == expected);
  };
  refused(lodestone_stream_create(nullptr, nullptr));
  refused(lodestone_stream_append(nullptr, 0, nullptr, 0));
  refused(lodestone_stream_append(stream, 0, nullptr, 1));
  refused(lodestone_stream_finish(nullptr));
  refused(lodestone_stream_get_state(stream, nullptr));
  refused(lodestone_cursor_create(stream, nullptr, nullptr));
  refused(lodestone_cursor_seek(nullptr, 0));
  refused(lodestone_cursor_choose(nullptr, 0, nullptr));
  refused(lodestone_cursor_choose(cursor, 0, nullptr));
  CHECK(std::string(lodestone_stream_message(nullptr)) != "");
  auto state = sized<lodestone_stream_state>();
  state.size -= 1;
  refused(lodestone_stream_get_state(stream, &state));
  auto chunk = sized<lodestone_chunk>();
  refused(lodestone_stream_get_chunk(stream, state_of(stream).chunk_count, &chunk));
  auto group = sized<lodestone_group>();
  refused(lodestone_stream_get_group(stream, 2, &group));
  auto attribute = sized<lodestone_attribute>();
  refused(lodestone_stream_get_attribute(stream, 1, &attribute));
  refused(lodestone_cursor_copy_positions(cursor, 0, wedges + 1, out.data(), 2 * out.size()));
  refused(lodestone_cursor_copy_positions(cursor, 2, 1, out.data(), out.size()));
  refused(lodestone_cursor_copy_positions(cursor, 0, wedges, nullptr, out.size()));
  refused(lodestone_cursor_copy_positions(cursor, 0, wedges, out.data(), out.size() - 1), LODESTONE_NO_ROOM);
  refused(lodestone_stream_copy_attribute(stream, 1, 0, 1, out.data(), out.size()));
  refused(lodestone_stream_copy_attribute(stream, 0, 0, wedges, out.data(), 4 * wedges - 1), LODESTONE_NO_ROOM);
  refused(lodestone_stream_copy_attribute(stream, 0, 0, 1, nullptr, 4));
  refused(lodestone_cursor_copy_normals(cursor, out.data(), 1), LODESTONE_NO_ROOM);
  const std::uint32_t* corners = nullptr;
  std::size_t count = 9;
  refused(lodestone_cursor_get_corners(cursor, 2, &corners, &count));
  refused(lodestone_cursor_get_corners(cursor, 0, nullptr, &count));
  lodestone_range range = {5, 6};
  refused(lodestone_cursor_take_changes(cursor, 2, 0, &range, 1, &count));
  refused(lodestone_cursor_take_changes(cursor, 0, 0, nullptr, 1, &count));
  refused(lodestone_cursor_take_changes(cursor, 0, 0, &range, 0, &count), LODESTONE_NO_ROOM);
  refused(lodestone_cursor_take_new_wedges(cursor, nullptr));
  CHECK(std::all_of(out.begin(), out.end(), [](float value) { return value == 7; }));
  CHECK(count == 9);
  CHECK(range.begin == 5);
  // What was refused has taken nothing either.
  std::size_t changed = 0;
  for (std::uint32_t g = 0; g < 2; ++g) {
    REQUIRE(lodestone_cursor_take_changes(cursor, g, 0, &range, 1, &count) == LODESTONE_OK);
    changed += count;
  }
  CHECK(changed > 0);
  lodestone_cursor_destroy(cursor);
  lodestone_stream_destroy(stream);
  lodestone_cursor_destroy(nullptr);
  lodestone_stream_destroy(nullptr);
}

TEST_CASE("a later caller's larger structs are filled as far as they are known") {
  lodestone_stream* const stream = read_whole(compact_bytes());
  struct Later {
    lodestone_stream_state state;
    std::uint64_t more;
  } later{};
  later.state.size = sizeof later;
  later.more = 42;
  REQUIRE(lodestone_stream_get_state(stream, &later.state) == LODESTONE_OK);
  CHECK(later.state.size == sizeof later);
  CHECK(later.state.chunk_count == state_of(stream).chunk_count);
  CHECK(later.more == 42);
  lodestone_stream_destroy(stream);
}

TEST_CASE("a morph of the C interface is the C++ one's") {
  for (const std::vector<std::byte>& bytes : {compact_bytes(), placed_bytes(), removal_bytes()}) {
    StreamReader reader;
    REQUIRE(reader.append(bytes));
    const ProgressiveMesh& mesh = reader.mesh();
    lodestone_stream* const stream = read_whole(bytes);
    lodestone_cursor* const cursor = make_cursor(stream);
    lodestone_range wedges = {5, 6};
    std::size_t count = 9;
    CHECK(lodestone_cursor_take_morphed_wedges(cursor, 0, &wedges, 1, &count) == LODESTONE_NOT_READY);
    CHECK(lodestone_cursor_copy_start_positions(cursor, 0, 0, nullptr, 0) == LODESTONE_NOT_READY);
    CHECK(lodestone_cursor_copy_start_attribute(cursor, 0, 0, 0, nullptr, 0) == LODESTONE_NOT_READY);
    CHECK(lodestone_cursor_copy_origins(cursor, 0, 0, nullptr, 0) == LODESTONE_NOT_READY);
    CHECK(lodestone_cursor_morph_from(cursor, 1, &wedges) == LODESTONE_INVALID_ARGUMENT);
    CHECK_THAT(std::string(lodestone_stream_message(stream)), contains("position 1, where the cursor's is 0"));
    CHECK(lodestone_cursor_morph_from(cursor, 0, nullptr) == LODESTONE_INVALID_ARGUMENT);
    CHECK(wedges.begin == 5);

    Geomorph expected(mesh);
    Random random(1);
    for (int move = 0; move < 10; ++move) {
      const auto fine = static_cast<std::uint32_t>(random.below(mesh.record_count() + 1));
      const auto coarse = static_cast<std::uint32_t>(random.below(fine + 1));
      REQUIRE(lodestone_cursor_seek(cursor, fine) == LODESTONE_OK);
      REQUIRE(lodestone_cursor_morph_from(cursor, coarse, &wedges) == LODESTONE_OK);
      expected.set(coarse, fine);
      CHECK(EntryRange{wedges.begin, wedges.end} == expected.new_wedges());
      const auto end = static_cast<std::uint32_t>(wedges.end);
      std::vector<float> starts(3 * end), same_starts(3 * end);
      REQUIRE(lodestone_cursor_copy_start_positions(cursor, 0, end, starts.data(), starts.size()) == LODESTONE_OK);
      copy_starts(expected, {0, end}, same_starts.data());
      CHECK(starts == same_starts);
      std::vector<std::uint32_t> origins(end);
      REQUIRE(lodestone_cursor_copy_origins(cursor, 0, end, origins.data(), origins.size()) == LODESTONE_OK);
      for (std::uint32_t w = 0; w < end; ++w) CHECK(origins[w] == expected.origin(w));
      for (std::uint32_t i = 0; i < mesh.attributes.size(); ++i) {
        const std::size_t each = mesh.attributes[i].element_bytes();
        std::vector<std::byte> out(each * end), same_out(each * end);
        REQUIRE(lodestone_cursor_copy_start_attribute(cursor, i, 0, end, out.data(), out.size()) == LODESTONE_OK);
        copy_starts(expected, mesh.attributes[i], {0, end}, same_out.data());
        CHECK(out == same_out);
        CHECK(lodestone_cursor_copy_start_attribute(cursor, i, 0, 1, out.data(), each - 1) == LODESTONE_NO_ROOM);
      }
      std::vector<lodestone_range> ranges(100);
      std::vector<EntryRange> same_ranges;
      REQUIRE(lodestone_cursor_take_morphed_wedges(cursor, 0, ranges.data(), 100, &count) == LODESTONE_OK);
      expected.take_moved_wedges(0, same_ranges);
      REQUIRE(count == same_ranges.size());
      for (std::size_t i = 0; i < count; ++i) CHECK(EntryRange{ranges[i].begin, ranges[i].end} == same_ranges[i]);

      CHECK(lodestone_cursor_copy_start_positions(cursor, 0, end + 1, starts.data(), 3 * (end + 1)) ==
            LODESTONE_INVALID_ARGUMENT);
      CHECK(lodestone_cursor_copy_start_positions(cursor, 0, 1, starts.data(), 2) == LODESTONE_NO_ROOM);
      CHECK(lodestone_cursor_copy_start_positions(cursor, 0, 1, nullptr, 3) == LODESTONE_INVALID_ARGUMENT);
      CHECK(lodestone_cursor_copy_origins(cursor, 1, 0, origins.data(), 1) == LODESTONE_INVALID_ARGUMENT);
      CHECK(lodestone_cursor_copy_origins(cursor, 0, 1, origins.data(), 0) == LODESTONE_NO_ROOM);
      CHECK(lodestone_cursor_copy_origins(cursor, 0, 1, nullptr, 1) == LODESTONE_INVALID_ARGUMENT);
      CHECK(lodestone_cursor_take_morphed_wedges(cursor, 0, nullptr, 1, &count) == LODESTONE_INVALID_ARGUMENT);
      CHECK(lodestone_cursor_take_morphed_wedges(cursor, 0, ranges.data(), 0, &count) == LODESTONE_NO_ROOM);
    }
    CHECK(lodestone_cursor_copy_start_attribute(cursor, 99, 0, 0, nullptr, 0) == LODESTONE_INVALID_ARGUMENT);
    lodestone_cursor_destroy(cursor);
    lodestone_stream_destroy(stream);
  }
}

TEST_CASE("one thread appends to a shared stream while another draws from it") {
  const std::vector<std::byte> bytes = placed_bytes();
  lodestone_stream* stream = nullptr;
  CHECK(lodestone_stream_create_shared(nullptr, nullptr) == LODESTONE_INVALID_ARGUMENT);
  REQUIRE(lodestone_stream_create_shared(nullptr, &stream) == LODESTONE_OK);
  CHECK(lodestone_stream_append(stream, 5, bytes.data(), 5) == LODESTONE_INVALID_ARGUMENT);
  CHECK_THAT(std::string(lodestone_stream_reading_message(stream)), contains("bytes from 5 on"));
  CHECK(std::string(lodestone_stream_message(stream)).empty());
  std::atomic<bool> ended = false, failed = false;
  std::size_t frames = 0;
  std::thread drawing([&] {
    lodestone_cursor* cursor = nullptr;
    std::vector<float> positions;
    for (bool last = false; !last; ++frames) {
      last = ended;
      if (cursor == nullptr && lodestone_cursor_create(stream, nullptr, &cursor) == LODESTONE_NOT_READY) continue;
      auto state = sized<lodestone_stream_state>();
      auto level = sized<lodestone_level>();
      lodestone_range wedges;
      bool good = lodestone_stream_get_state(stream, &state) == LODESTONE_OK &&
                  lodestone_cursor_seek(cursor, last ? kNoIndex : state.record_count / 2) == LODESTONE_OK &&
                  lodestone_cursor_get_level(cursor, &level) == LODESTONE_OK &&
                  lodestone_cursor_morph_from(cursor, level.position / 2, &wedges) == LODESTONE_OK;
      positions.resize(3 * level.wedge_count);
      good = good && lodestone_cursor_copy_positions(cursor, 0, level.wedge_count, positions.data(),
                                                     positions.size()) == LODESTONE_OK;
      if (last) good = good && state.chunks_ready == state.chunk_count && level.position == state.record_count;
      if (!good) failed = true;
    }
    lodestone_cursor_destroy(cursor);
  });
  std::int32_t code = LODESTONE_OK;
  for (std::size_t at = 0; at < bytes.size() && code == LODESTONE_OK; at += 100)
    code = lodestone_stream_append(stream, at, &bytes[at], std::min<std::size_t>(100, bytes.size() - at));
  ended = true;
  drawing.join();
  CHECK(code == LODESTONE_OK);
  CHECK(lodestone_stream_finish(stream) == LODESTONE_OK);
  CHECK(std::string(lodestone_stream_reading_message(stream)).empty());
  CHECK(!failed);
  CHECK(frames > 0);
  lodestone_stream_destroy(stream);
  CHECK(std::string(lodestone_stream_reading_message(nullptr)) != "");
}

}  // namespace lodestone::test
