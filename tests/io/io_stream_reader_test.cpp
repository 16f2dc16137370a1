#include <lodestone/io/stream_reader.h>

#include <algorithm>
#include <functional>
#include <string>
#include <vector>

#include <lodestone/io/compact_stream.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "support/counted_memory.h"
#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/random.h"
#include "support/same_mesh.h"

namespace lodestone::test {
namespace {

using StreamBytes = std::vector<std::byte>;
using Decode = Result<ProgressiveMesh> (*)(std::span<const std::byte>);

/// A stream with what decodes it as a whole.
struct Stream {
  std::string name;
  StreamBytes bytes;
  Decode decode;
};

ProgressiveMesh progressive(const TriangleSoup& soup, double dense_rounds) {
  SimplifyOptions options;
  options.dense_rounds = dense_rounds;
  options.vanish = dense_rounds == 0;  // compact streams have no vanishing pieces yet
  auto result = simplify(mesh_of(soup), options);
  REQUIRE(result);
  return std::move(result->mesh);
}

Stream compact(const std::string& name, const TriangleSoup& soup) {
  auto stream = encode_compact(progressive(soup, 1.5));
  REQUIRE(stream);
  return {"compact " + name, std::move(stream->bytes), decode_compact};
}

Stream removal(const std::string& name, const TriangleSoup& soup, std::size_t records_per_chunk) {
  StreamOptions options;
  options.records_per_chunk = records_per_chunk;
  auto bytes = encode_stream(progressive(soup, 0), options);
  REQUIRE(bytes);
  return {"removal " + name, std::move(*bytes), decode_stream};
}

/// Of both formats, each of several chunks; the removal streams have all that their format has.
const std::vector<Stream>& streams() {
  static const std::vector<Stream> kAll = [] {
    std::vector<Stream> all = {compact("terrain", terrain(40, 3)), compact("tetrahedron", tetrahedron()),
                               compact("torus", torus(24, 16))};
    for (const NamedShape& shape : all_shapes()) all.push_back(removal(shape.name, shape.soup, 16));
    return all;
  }();
  return kAll;
}

/// Hands a reader pieces of lengths that `length` gives, up to the end or its first error.
Result<void> feed(StreamReader& reader, std::span<const std::byte> bytes, const std::function<std::size_t()>& length) {
  while (!bytes.empty()) {
    const auto piece = bytes.first(std::min(length(), bytes.size()));
    if (auto taken = reader.append(piece); !taken) return taken;
    bytes = bytes.subspan(piece.size());
  }
  return reader.finish();
}

ProgressiveMesh whole(const Stream& stream) {
  auto mesh = stream.decode(stream.bytes);
  REQUIRE(mesh);
  return std::move(*mesh);
}

/// The mesh that a stream's first chunks lead to.
ProgressiveMesh after_chunks(const Stream& stream, std::span<const ReaderChunk> chunks, std::size_t count) {
  auto mesh = stream.decode(std::span(stream.bytes).first(chunks[count - 1].bytes.end));
  REQUIRE(mesh);
  return std::move(*mesh);
}

void check_valid(const ProgressiveMesh& mesh) {
  const auto valid = validate(mesh);
  INFO((valid ? std::string() : valid.error().message));
  CHECK(valid);
}

}  // namespace

TEST_CASE("whatever pieces a stream arrives in, its mesh is that of the whole") {
  Random random(1);
  for (const Stream& stream : streams()) {
    INFO(stream.name);
    const ProgressiveMesh expected = whole(stream);
    const std::vector<std::function<std::size_t()>> cuts = {
        [&] { return stream.bytes.size(); }, [] { return 1; }, [] { return 17; }, [&] { return random.below(100); },
        [&] { return random.below(5) == 0 ? random.below(2000) : 0; }};
    for (const auto& length : cuts) {
      StreamReader reader;
      const auto fed = feed(reader, stream.bytes, length);
      INFO((fed ? std::string() : fed.error().message));
      REQUIRE(fed);
      CHECK(reader.done());
      CHECK(reader.due().empty());
      CHECK(reader.byte_count() == stream.bytes.size());
      CHECK(same(reader.mesh(), expected));
    }
  }
}

TEST_CASE("after each chunk the mesh is the one that the stream cut there has, and a cursor goes on") {
  for (const Stream& stream : streams()) {
    INFO(stream.name);
    StreamReader reader;
    std::optional<Cursor> cursor;
    std::size_t chunks = 0;
    for (const std::byte byte : stream.bytes) {
      REQUIRE(reader.append({&byte, 1}));
      if (reader.chunk_count() == chunks) continue;
      chunks = reader.chunk_count();
      const ReaderChunk& chunk = reader.chunks()[chunks - 1];
      INFO("chunk " << chunks - 1);
      const ProgressiveMesh& mesh = reader.mesh();
      CHECK(reader.byte_count() == chunk.bytes.end);
      CHECK(mesh.record_count() == chunk.position);
      CHECK(mesh.vertex_count() == chunk.vertex_count);
      CHECK(mesh.deviation.back() == chunk.deviation);
      CHECK(same(mesh, after_chunks(stream, reader.chunks(), chunks)));
      check_valid(mesh);
      if (!cursor) cursor.emplace(mesh);
      cursor->seek(chunk.position - chunk.position / 3);  // from where it stood, before all this was there
      Cursor fresh(mesh);
      fresh.seek(cursor->position());
      for (std::size_t group = 0; group < mesh.groups.size(); ++group)
        CHECK(std::ranges::equal(cursor->corners(group), fresh.corners(group)));
      cursor->seek(chunk.position);
      CHECK(cursor->face_count() == chunk.face_count);
    }
    CHECK(reader.done());
    CHECK(chunks == reader.chunks().size());
  }
}

TEST_CASE("what is due is enough: asking for it and no more reads the whole stream, chunk by chunk") {
  for (const Stream& stream : streams()) {
    INFO(stream.name);
    StreamReader reader;
    std::size_t requests = 0;
    for (; !reader.due().empty(); ++requests) {
      const ByteRange due = reader.due();
      REQUIRE(due.begin == reader.byte_count());
      REQUIRE(due.end <= stream.bytes.size());
      REQUIRE(reader.append_at(due.begin, std::span(stream.bytes).subspan(due.begin, due.end - due.begin)));
    }
    CHECK(reader.done());
    CHECK(requests == reader.chunks().size() + 2);  // the header in two
    CHECK(same(reader.mesh(), whole(stream)));
  }
}

TEST_CASE("pieces that are missing are told by where they were, and those that come again change nothing") {
  Random random(5);
  for (const Stream& stream : streams()) {
    INFO(stream.name);
    StreamReader reader;
    const std::span<const std::byte> bytes = stream.bytes;
    while (!reader.done()) {
      const std::uint64_t at = reader.byte_count();
      const std::uint64_t offset = random.below(std::min<std::uint64_t>(at + 50, bytes.size()));
      const auto piece = bytes.subspan(offset, std::min<std::size_t>(random.below(200), bytes.size() - offset));
      const auto taken = reader.append_at(offset, piece);
      REQUIRE(taken.has_value() == (offset <= at));
      if (!taken) {
        CHECK(taken.error().code == ErrorCode::InvalidArgument);
        CHECK(taken.error().byte_offset == at);
      }
      CHECK(reader.byte_count() == (taken ? std::max<std::uint64_t>(at, offset + piece.size()) : at));
    }
    CHECK(same(reader.mesh(), whole(stream)));
    CHECK(reader.append_at(0, bytes));
    CHECK(reader.finish());
  }
}

TEST_CASE("a piece left out or put twice is a named error, and the mesh that of the chunks before it") {
  Random random(7);
  for (const Stream& stream : streams()) {
    INFO(stream.name);
    for (int i = 0; i < 20; ++i) {
      const std::size_t begin = random.below(stream.bytes.size());
      const std::size_t end = begin + 1 + random.below(stream.bytes.size() - begin);
      INFO(begin << " to " << end);
      const auto at = [&](std::size_t offset) { return stream.bytes.begin() + static_cast<std::ptrdiff_t>(offset); };
      StreamBytes broken(at(0), at(i % 2 == 0 ? begin : end));
      broken.insert(broken.end(), at(i % 2 == 0 ? end : begin), stream.bytes.end());
      StreamReader reader;
      const auto fed = feed(reader, broken, [&] { return random.below(300); });
      const bool cut_behind_a_chunk = i % 2 == 0 && end == stream.bytes.size() && fed;
      if (cut_behind_a_chunk) CHECK(!reader.done());
      CHECK(fed.has_value() == cut_behind_a_chunk);
      if (!fed) CHECK(fed.error().byte_offset);
      if (reader.chunk_count() > 0)
        CHECK(same(reader.mesh(),
                   reader.done() ? whole(stream) : after_chunks(stream, reader.chunks(), reader.chunk_count())));
    }
  }
}

TEST_CASE("any cut gives the mesh so far, and says whether it was behind a chunk") {
  for (const Stream& stream : {compact("terrain", terrain(20, 3)), removal("torus", torus(12, 8), 16)}) {
    INFO(stream.name);
    for (std::size_t size = 0; size < stream.bytes.size(); size += kReduced ? 41 : 5) {
      StreamReader reader;
      REQUIRE(reader.append(std::span(stream.bytes).first(size)));
      const auto end = reader.finish();
      const std::size_t chunks = reader.chunk_count();
      CHECK(end.has_value() == (chunks > 0 && reader.chunks()[chunks - 1].bytes.end == size));
      if (!end) CHECK(end.error().code == ErrorCode::Malformed);
      if (!end) CHECK(end.error().byte_offset == size);
      if (chunks == 0) CHECK(reader.mesh().groups.empty());
      if (chunks > 0) CHECK(reader.mesh().record_count() == reader.chunks()[chunks - 1].position);
      // What is missing comes later, and all is well.
      REQUIRE(reader.append(std::span(stream.bytes).subspan(size)));
      CHECK(reader.done());
    }
  }
}

TEST_CASE("a flipped bit is a named error that stays, and the mesh that of the chunks before it") {
  Random random(9);
  for (Stream stream : {compact("ball", icosphere(3, 0.05, 1)), removal("torus", torus(12, 8), 16)}) {
    INFO(stream.name);
    StreamReader good;
    REQUIRE(good.append(stream.bytes));
    for (std::size_t at = 0; at < stream.bytes.size(); at += 1 + random.below(kReduced ? 60 : 8)) {
      INFO(at);
      const std::byte flip = std::byte{1} << random.below(8);
      stream.bytes[at] ^= flip;
      StreamReader reader;
      const auto fed = feed(reader, stream.bytes, [&] { return 1 + random.below(500); });
      stream.bytes[at] ^= flip;
      REQUIRE(!fed);
      CHECK(fed.error().byte_offset);
      CHECK(fed.error().message.find("stream: ") != std::string::npos);
      CHECK(!reader.done());
      const std::size_t chunks = reader.chunk_count();
      for (std::size_t chunk = 0; chunk < chunks; ++chunk) CHECK(good.chunks()[chunk].bytes.end <= at);
      if (chunks > 0) CHECK(same(reader.mesh(), after_chunks(stream, good.chunks(), chunks)));
      if (chunks == 0) CHECK(reader.mesh().positions.empty());
      if (!reader.error()) continue;  // it said how many bytes there are, so that some are missing in the end
      CHECK(reader.due().empty());
      const auto again = reader.append(stream.bytes);
      REQUIRE(!again);
      CHECK(again.error().message == fed.error().message);
    }
  }
}

TEST_CASE("bytes behind the end are an error, and those of no stream are told from their beginning") {
  for (const Stream& stream : {compact("ball", icosphere(2, 0.05, 1)), removal("torus", torus(12, 8), 16)}) {
    StreamReader reader;
    REQUIRE(reader.append(stream.bytes));
    const auto behind = reader.append(std::span(stream.bytes).first(3));
    REQUIRE(!behind);
    CHECK_THAT(behind.error().message, contains("3 bytes follow its end"));
    CHECK(behind.error().byte_offset == stream.bytes.size());
    CHECK(same(reader.mesh(), whole(stream)));

    StreamBytes other = stream.bytes;
    other[8] = std::byte{4};
    StreamReader newer;
    const auto newer_taken = newer.append(std::span(other).first(16));
    REQUIRE(!newer_taken);
    CHECK(newer_taken.error().code == ErrorCode::Unsupported);
    CHECK_THAT(newer_taken.error().message, contains("version 4"));
  }
  StreamReader reader;
  const StreamBytes zeros(16);
  const auto taken = reader.append(zeros);
  REQUIRE(!taken);
  CHECK_THAT(taken.error().message, contains("magic"));
}

TEST_CASE("a mesh larger than its reader may hold is refused, and stays what it was") {
  for (const Stream& stream : {compact("terrain", terrain(40, 3)), removal("terrain", terrain(40, 3), 200)}) {
    INFO(stream.name);
    StreamReaderOptions options;
    options.most_bytes = 60000;
    StreamReader reader(options);
    const auto taken = reader.append(stream.bytes);
    REQUIRE(!taken);
    CHECK(taken.error().code == ErrorCode::LimitExceeded);
    REQUIRE(reader.chunk_count() > 0);
    REQUIRE(reader.chunk_count() < reader.chunks().size());
    CHECK(same(reader.mesh(), after_chunks(stream, reader.chunks(), reader.chunk_count())));
  }
}

TEST_CASE("a reader takes the memory that it says") {
  const TriangleSoup soup = icosphere(5, 0.01, 7);
  for (const Stream& stream : {compact("ball", soup), removal("ball", soup, 4096)}) {
    INFO(stream.name);
    const std::size_t before = live_bytes;
    peak_bytes = before;
    StreamReader reader;
    REQUIRE(reader.append(stream.bytes));
    const auto vertices = static_cast<double>(reader.mesh().vertex_count());
    const double stays = static_cast<double>(live_bytes - before) / vertices;
    const double peak = static_cast<double>(peak_bytes - before) / vertices;
    CAPTURE(stays, peak);
    CHECK(stays <= 96);
    CHECK(peak <= stays + 540);
  }
}

}  // namespace lodestone::test
