#include <lodestone/lodestone.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/detail/text.h>
#include <lodestone/io/detail_choice.h>
#include <lodestone/io/draw_cursor.h>
#include <lodestone/io/geomorph.h>
#include <lodestone/io/shared_stream.h>
#include <lodestone/io/stream_reader.h>

using lodestone::Attribute;
using lodestone::DetailChoice;
using lodestone::DrawCursor;
using lodestone::EntryRange;
using lodestone::ErrorCode;
using lodestone::Geomorph;
using lodestone::Index;
using lodestone::ProgressiveMesh;
using lodestone::ReaderChunk;
using lodestone::Result;
using lodestone::SharedStream;
using lodestone::StreamReader;
using lodestone::StreamReaderOptions;
using lodestone::Vec3f;
using lodestone::detail::text;

static_assert(sizeof(Index) == sizeof(std::uint32_t));
static_assert(sizeof(Vec3f) == 3 * sizeof(float));
static_assert(LODESTONE_VERSION == LODESTONE_PROJECT_VERSION, "the header's version is the project's");

namespace {

/// What has arrived of a stream.
struct Arrived {
  const ProgressiveMesh* mesh = nullptr;
  lodestone::ByteRange due;
  std::span<const ReaderChunk> chunks;
  std::size_t chunk_count = 0;
};

template <class From>
Arrived arrived_of(const From& from) {
  return {&from.mesh(), from.due(), from.chunks(), from.chunk_count()};
}

/// What reads a stream: for one thread, or for two. Programs that make no shared stream link nothing of threads.
class Reading {
 public:
  virtual ~Reading() = default;
  virtual Result<void> append_at(std::uint64_t offset, std::span<const std::byte> piece) = 0;
  virtual Result<void> finish() = 0;
  /// Says what has arrived, which stays what it is until it is released.
  virtual Arrived hold() = 0;
  virtual void release() {}
  /// Whether another thread reads than the one that draws.
  virtual bool is_shared() const { return false; }
};

class ReadingAlone : public Reading {
 public:
  explicit ReadingAlone(const StreamReaderOptions& options) : reader_(options) {}
  Result<void> append_at(std::uint64_t offset, std::span<const std::byte> piece) override {
    return reader_.append_at(offset, piece);
  }
  Result<void> finish() override { return reader_.finish(); }
  Arrived hold() override { return arrived_of(reader_); }

 private:
  StreamReader reader_;
};

class ReadingShared : public Reading {
 public:
  explicit ReadingShared(const StreamReaderOptions& options) : stream_(options) {}
  Result<void> append_at(std::uint64_t offset, std::span<const std::byte> piece) override {
    return stream_.append_at(offset, piece);
  }
  Result<void> finish() override { return stream_.finish(); }
  Arrived hold() override { return arrived_of(hold_.emplace(stream_.hold())); }
  void release() override { hold_.reset(); }
  bool is_shared() const override { return true; }

 private:
  SharedStream stream_;
  std::optional<SharedStream::Hold> hold_;
};

}  // namespace

struct lodestone_stream {
  explicit lodestone_stream(std::unique_ptr<Reading> what_reads) : reading(std::move(what_reads)) {}

  const ProgressiveMesh& mesh() const { return *now.mesh; }
  void grow_box();

  std::unique_ptr<Reading> reading;
  std::string reading_message;  // of the thread that reads; what follows is of the one that draws
  std::string message;
  Arrived now;  // during a call
  Vec3f low = {HUGE_VALF, HUGE_VALF, HUGE_VALF}, high = {-HUGE_VALF, -HUGE_VALF, -HUGE_VALF};
  std::size_t vertices_in_box = 0, moves_in_box = 0;
};

struct lodestone_cursor {
  lodestone_cursor(lodestone_stream& from, double slack)
      : stream(&from), draw(from.mesh()), choice(from.mesh(), slack) {}

  lodestone_stream* stream;
  DrawCursor draw;
  DetailChoice choice;
  std::optional<Geomorph> morph;
  std::vector<EntryRange> ranges;
};

namespace {

constexpr double kSlack = 1.3;

/// What a call ends with: a code, and words where it is negative.
struct Outcome {
  std::int32_t code = LODESTONE_OK;
  std::string message;
};

Outcome invalid(std::string message) { return {LODESTONE_INVALID_ARGUMENT, std::move(message)}; }

std::int32_t code_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::InvalidArgument:
      return LODESTONE_INVALID_ARGUMENT;
    case ErrorCode::LimitExceeded:
      return LODESTONE_LIMIT_EXCEEDED;
    case ErrorCode::Unsupported:
      return LODESTONE_UNSUPPORTED;
    default:
      return LODESTONE_MALFORMED;
  }
}

Outcome outcome_of(const Result<void>& result) {
  if (result) return {};
  return {code_of(result.error().code), result.error().message};
}

/// Does a job that allocates. Programs built without exceptions end where there is no memory.
template <class Job>
std::int32_t with_memory(const Job& job) {
#ifdef __cpp_exceptions
  try {
    return job();
  } catch (const std::exception&) {  // of the standard library alone: length_error, too, means a size beyond all
    return LODESTONE_OUT_OF_MEMORY;
  }
#else
  return job();
#endif
}

/// Does a job of the thread that draws with a stream, and keeps the words that it ends with.
template <class Job>
std::int32_t run(lodestone_stream* stream, const Job& job) {
  if (stream == nullptr) return LODESTONE_INVALID_ARGUMENT;
  stream->now = stream->reading->hold();
  const std::int32_t code = with_memory([&] {
    stream->message.clear();
    Outcome outcome = job(*stream);
    stream->message = std::move(outcome.message);
    return outcome.code;
  });
  stream->reading->release();
  return code;
}

/// Does a job of the thread that reads.
template <class Job>
std::int32_t run_reading(lodestone_stream* stream, const Job& job) {
  if (stream == nullptr) return LODESTONE_INVALID_ARGUMENT;
  return with_memory([&] {
    const Outcome outcome = job(*stream->reading);
    stream->reading_message = outcome.message;
    if (!stream->reading->is_shared()) stream->message = outcome.message;
    return outcome.code;
  });
}

template <class Job>
std::int32_t run(lodestone_cursor* cursor, const Job& job) {
  if (cursor == nullptr) return LODESTONE_INVALID_ARGUMENT;
  return run(cursor->stream, [&](lodestone_stream&) { return job(*cursor); });
}

/// Does a job with the morph of a cursor.
template <class Job>
std::int32_t run_morph(lodestone_cursor* cursor, const Job& job) {
  return run(cursor, [&](lodestone_cursor& c) {
    if (!c.morph) return Outcome{LODESTONE_NOT_READY, "no level to begin at has been named"};
    return job(c, *c.morph);
  });
}

/// Whether a caller's struct has at least the fields of this version.
template <class Struct>
bool has_fields(const Struct* value) {
  return value != nullptr && value->size >= sizeof(Struct);
}

/// Fills the fields that this version knows, and leaves the caller's size.
template <class Struct>
Outcome fill(Struct* out, Struct value) {
  value.size = out->size;
  *out = value;
  return {};
}

Outcome no_struct(const char* name) { return invalid(text(name, " is null or its size too small")); }

Outcome out_of(const char* name, std::uint64_t number, std::size_t count) {
  return invalid(text(name, ' ', number, " of ", count));
}

lodestone_range range_of(EntryRange range) { return {range.begin, range.end}; }

/// Gives as many ranges as there is room for, the last with all that follow; returns how many. Pre: room > 0.
std::size_t give_ranges(std::span<const EntryRange> given, lodestone_range* ranges, std::size_t room) {
  const std::size_t count = std::min(room, given.size());
  std::transform(given.begin(), given.begin() + static_cast<std::ptrdiff_t>(count), ranges, range_of);
  if (count > 0) ranges[count - 1].end = given.back().end;
  return count;
}

/// Checks that wedges are among so many, and that so many numbers each have room.
Outcome check_wedges(std::size_t count, EntryRange wedges, std::size_t each, std::size_t room, const void* out) {
  if (wedges.begin > wedges.end || wedges.end > count)
    return invalid(text("wedges ", wedges.begin, " to ", wedges.end, " of ", count));
  if (room / each < wedges.size())
    return {LODESTONE_NO_ROOM, text(room, " where ", each, " times ", wedges.size(), " are due")};
  if (out == nullptr && wedges.size() > 0) return invalid("out is null");
  return {};
}

Outcome check_wedges(const lodestone_stream& stream, EntryRange wedges, std::size_t each, std::size_t room,
                     const void* out) {
  return check_wedges(stream.mesh().wedge_vertex.size(), wedges, each, room, out);
}

template <class What>
std::int32_t create(const lodestone_stream_options* options, lodestone_stream** stream) {
  if (stream == nullptr || (options != nullptr && !has_fields(options))) return LODESTONE_INVALID_ARGUMENT;
  return with_memory([&] {
    StreamReaderOptions reader;
    if (options != nullptr && options->most_bytes > 0) reader.most_bytes = options->most_bytes;
    *stream = new lodestone_stream(std::make_unique<What>(reader));
    return LODESTONE_OK;
  });
}

}  // namespace

/// Over the vertices that have come since.
void lodestone_stream::grow_box() {
  const std::vector<Vec3f>& positions = mesh().positions;
  const auto include = [&](const Vec3f& p) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  };
  for (; vertices_in_box < positions.size(); ++vertices_in_box) include(positions[vertices_in_box]);
  for (; moves_in_box < mesh().moves.size(); ++moves_in_box) include(mesh().moves[moves_in_box].to);
}

uint32_t lodestone_version(void) { return LODESTONE_VERSION; }

const char* lodestone_code_name(int32_t code) {
  constexpr std::array<const char*, 8> kNames = {
      "LODESTONE_OK",          "LODESTONE_INVALID_ARGUMENT", "LODESTONE_MALFORMED", "LODESTONE_LIMIT_EXCEEDED",
      "LODESTONE_UNSUPPORTED", "LODESTONE_NOT_READY",        "LODESTONE_NO_ROOM",   "LODESTONE_OUT_OF_MEMORY"};
  const std::int64_t number = -std::int64_t{code};
  return number >= 0 && number < std::int64_t{kNames.size()} ? kNames[static_cast<std::size_t>(number)]
                                                             : "LODESTONE_UNKNOWN";
}

int32_t lodestone_stream_create(const lodestone_stream_options* options, lodestone_stream** stream) {
  return create<ReadingAlone>(options, stream);
}

int32_t lodestone_stream_create_shared(const lodestone_stream_options* options, lodestone_stream** stream) {
  return create<ReadingShared>(options, stream);
}

void lodestone_stream_destroy(lodestone_stream* stream) { delete stream; }

int32_t lodestone_stream_append(lodestone_stream* stream, uint64_t offset, const void* bytes, size_t size) {
  return run_reading(stream, [&](Reading& reading) {
    if (bytes == nullptr && size > 0) return invalid("bytes are null");
    return outcome_of(reading.append_at(offset, {static_cast<const std::byte*>(bytes), size}));
  });
}

int32_t lodestone_stream_finish(lodestone_stream* stream) {
  return run_reading(stream, [](Reading& reading) { return outcome_of(reading.finish()); });
}

const char* lodestone_stream_message(const lodestone_stream* stream) {
  return stream == nullptr ? "stream is null" : stream->message.c_str();
}

const char* lodestone_stream_reading_message(const lodestone_stream* stream) {
  return stream == nullptr ? "stream is null" : stream->reading_message.c_str();
}

int32_t lodestone_stream_get_state(lodestone_stream* stream, lodestone_stream_state* state) {
  return run(stream, [&](lodestone_stream& s) {
    if (!has_fields(state)) return no_struct("state");
    s.grow_box();
    lodestone_stream_state now{};
    now.due_begin = s.now.due.begin;
    now.due_end = s.now.due.end;
    now.chunk_count = static_cast<std::uint32_t>(s.now.chunks.size());
    now.chunks_ready = static_cast<std::uint32_t>(s.now.chunk_count);
    now.record_count = static_cast<std::uint32_t>(s.mesh().record_count());
    now.wedge_count = static_cast<std::uint32_t>(s.mesh().wedge_vertex.size());
    now.group_count = static_cast<std::uint32_t>(s.mesh().groups.size());
    now.attribute_count = static_cast<std::uint32_t>(s.mesh().attributes.size());
    std::memcpy(now.low, &s.low, sizeof now.low);
    std::memcpy(now.high, &s.high, sizeof now.high);
    return fill(state, now);
  });
}

int32_t lodestone_stream_get_chunk(lodestone_stream* stream, uint32_t index, lodestone_chunk* chunk) {
  return run(stream, [&](lodestone_stream& s) {
    if (!has_fields(chunk)) return no_struct("chunk");
    if (index >= s.now.chunks.size()) return out_of("chunk", index, s.now.chunks.size());
    const lodestone::ReaderChunk& c = s.now.chunks[index];
    return fill(chunk, {0, c.bytes.begin, c.bytes.end, c.position, c.vertex_count, c.face_count, c.deviation});
  });
}

int32_t lodestone_stream_get_group(lodestone_stream* stream, uint32_t index, lodestone_group* group) {
  return run(stream, [&](lodestone_stream& s) {
    if (!has_fields(group)) return no_struct("group");
    if (index >= s.mesh().groups.size()) return out_of("group", index, s.mesh().groups.size());
    const lodestone::FaceGroup& g = s.mesh().groups[index];
    return fill(group, {0, g.material, g.face_count});
  });
}

int32_t lodestone_stream_get_attribute(lodestone_stream* stream, uint32_t index, lodestone_attribute* attribute) {
  return run(stream, [&](lodestone_stream& s) {
    if (!has_fields(attribute)) return no_struct("attribute");
    if (index >= s.mesh().attributes.size()) return out_of("attribute", index, s.mesh().attributes.size());
    const Attribute& a = s.mesh().attributes[index];
    return fill(attribute, {0, a.name.c_str(), static_cast<std::uint32_t>(a.type), a.component_count,
                            a.normalized ? 1U : 0U, static_cast<std::uint32_t>(a.element_bytes())});
  });
}

int32_t lodestone_stream_copy_attribute(lodestone_stream* stream, uint32_t index, uint32_t begin, uint32_t end,
                                        void* out, size_t room) {
  return run(stream, [&](lodestone_stream& s) {
    if (index >= s.mesh().attributes.size()) return out_of("attribute", index, s.mesh().attributes.size());
    const Attribute& a = s.mesh().attributes[index];
    const EntryRange wedges = {begin, end};
    if (Outcome checked = check_wedges(s, wedges, a.element_bytes(), room, out); checked.code != LODESTONE_OK)
      return checked;
    if (wedges.size() > 0)
      std::memcpy(out, a.data.data() + begin * a.element_bytes(), wedges.size() * a.element_bytes());
    return Outcome{};
  });
}

int32_t lodestone_cursor_create(lodestone_stream* stream, const lodestone_cursor_options* options,
                                lodestone_cursor** cursor) {
  return run(stream, [&](lodestone_stream& s) {
    if (cursor == nullptr) return invalid("cursor is null");
    if (options != nullptr && !has_fields(options)) return no_struct("options");
    const double slack = options != nullptr && options->slack != 0 ? options->slack : kSlack;
    if (!(slack >= 1) || std::isinf(slack)) return invalid(text("slack is ", slack));
    if (s.now.chunk_count == 0) return Outcome{LODESTONE_NOT_READY, "the first chunk has not arrived"};
    *cursor = new lodestone_cursor(s, slack);
    return Outcome{};
  });
}

void lodestone_cursor_destroy(lodestone_cursor* cursor) { delete cursor; }

int32_t lodestone_cursor_seek(lodestone_cursor* cursor, uint32_t position) {
  return run(cursor, [&](lodestone_cursor& c) {
    c.draw.seek(position);
    return Outcome{};
  });
}

int32_t lodestone_cursor_choose(lodestone_cursor* cursor, double deviation, uint32_t* position) {
  return run(cursor, [&](lodestone_cursor& c) {
    if (!(deviation >= 0)) return invalid(text("deviation is ", deviation));
    if (position == nullptr) return invalid("position is null");
    *position = c.choice.choose(c.draw.position(), deviation);
    return Outcome{};
  });
}

int32_t lodestone_cursor_get_level(lodestone_cursor* cursor, lodestone_level* level) {
  return run(cursor, [&](lodestone_cursor& c) {
    if (!has_fields(level)) return no_struct("level");
    return fill(level,
                {0, c.draw.position(), static_cast<std::uint32_t>(c.draw.vertex_count()),
                 static_cast<std::uint32_t>(c.draw.wedge_count()), static_cast<std::uint32_t>(c.draw.face_count()),
                 c.stream->mesh().deviation[c.draw.position()]});
  });
}

int32_t lodestone_cursor_get_corners(lodestone_cursor* cursor, uint32_t group, const uint32_t** corners,
                                     size_t* count) {
  return run(cursor, [&](lodestone_cursor& c) {
    if (corners == nullptr || count == nullptr) return invalid("corners or count is null");
    if (group >= c.draw.group_count()) return out_of("group", group, c.draw.group_count());
    *corners = c.draw.corners(group).data();
    *count = c.draw.corners(group).size();
    return Outcome{};
  });
}

int32_t lodestone_cursor_take_changes(lodestone_cursor* cursor, uint32_t group, size_t gap, lodestone_range* ranges,
                                      size_t room, size_t* count) {
  return run(cursor, [&](lodestone_cursor& c) {
    if (ranges == nullptr || count == nullptr) return invalid("ranges or count is null");
    if (group >= c.draw.group_count()) return out_of("group", group, c.draw.group_count());
    if (room == 0) return Outcome{LODESTONE_NO_ROOM, "no room for a range"};
    c.draw.take_changes(group, gap, c.ranges);
    *count = give_ranges(c.ranges, ranges, room);
    return Outcome{};
  });
}

int32_t lodestone_cursor_take_moved_wedges(lodestone_cursor* cursor, size_t gap, lodestone_range* ranges, size_t room,
                                           size_t* count) {
  return run(cursor, [&](lodestone_cursor& c) {
    if (ranges == nullptr || count == nullptr) return invalid("ranges or count is null");
    if (room == 0) return Outcome{LODESTONE_NO_ROOM, "no room for a range"};
    c.draw.take_moved_wedges(gap, c.ranges);
    *count = give_ranges(c.ranges, ranges, room);
    return Outcome{};
  });
}

int32_t lodestone_cursor_copy_positions(lodestone_cursor* cursor, uint32_t begin, uint32_t end, float* out,
                                        size_t room) {
  return run(cursor, [&](lodestone_cursor& c) {
    const EntryRange wedges = {begin, end};
    if (Outcome checked = check_wedges(*c.stream, wedges, 3, room, out); checked.code != LODESTONE_OK) return checked;
    lodestone::copy_positions(c.stream->mesh(), c.draw, wedges, out);
    return Outcome{};
  });
}

int32_t lodestone_cursor_take_new_wedges(lodestone_cursor* cursor, lodestone_range* wedges) {
  return run(cursor, [&](lodestone_cursor& c) {
    if (wedges == nullptr) return invalid("wedges are null");
    *wedges = range_of(c.draw.take_new_wedges());
    return Outcome{};
  });
}

int32_t lodestone_cursor_copy_normals(lodestone_cursor* cursor, float* out, size_t room) {
  return run(cursor, [&](lodestone_cursor& c) {
    const EntryRange wedges = {0, c.draw.wedge_count()};
    if (Outcome checked = check_wedges(*c.stream, wedges, 3, room, out); checked.code != LODESTONE_OK) return checked;
    lodestone::copy_normals(c.stream->mesh(), c.draw, out);
    return Outcome{};
  });
}

int32_t lodestone_cursor_morph_from(lodestone_cursor* cursor, uint32_t position, lodestone_range* wedges) {
  return run(cursor, [&](lodestone_cursor& c) {
    if (wedges == nullptr) return invalid("wedges are null");
    if (position > c.draw.position())
      return invalid(text("position ", position, ", where the cursor's is ", c.draw.position()));
    if (!c.morph) c.morph.emplace(c.stream->mesh());
    c.morph->set(position, c.draw.position());
    *wedges = range_of(c.morph->new_wedges());
    return Outcome{};
  });
}

int32_t lodestone_cursor_take_morphed_wedges(lodestone_cursor* cursor, size_t gap, lodestone_range* ranges, size_t room,
                                             size_t* count) {
  return run_morph(cursor, [&](lodestone_cursor& c, Geomorph& morph) {
    if (ranges == nullptr || count == nullptr) return invalid("ranges or count is null");
    if (room == 0) return Outcome{LODESTONE_NO_ROOM, "no room for a range"};
    morph.take_moved_wedges(gap, c.ranges);
    *count = give_ranges(c.ranges, ranges, room);
    return Outcome{};
  });
}

int32_t lodestone_cursor_copy_start_positions(lodestone_cursor* cursor, uint32_t begin, uint32_t end, float* out,
                                              size_t room) {
  return run_morph(cursor, [&](lodestone_cursor&, const Geomorph& morph) {
    const EntryRange wedges = {begin, end};
    if (Outcome checked = check_wedges(morph.new_wedges().end, wedges, 3, room, out); checked.code != LODESTONE_OK)
      return checked;
    copy_starts(morph, wedges, out);
    return Outcome{};
  });
}

int32_t lodestone_cursor_copy_start_attribute(lodestone_cursor* cursor, uint32_t index, uint32_t begin, uint32_t end,
                                              void* out, size_t room) {
  return run_morph(cursor, [&](lodestone_cursor& c, const Geomorph& morph) {
    const std::vector<Attribute>& attributes = c.stream->mesh().attributes;
    if (index >= attributes.size()) return out_of("attribute", index, attributes.size());
    const EntryRange wedges = {begin, end};
    Outcome checked = check_wedges(morph.new_wedges().end, wedges, attributes[index].element_bytes(), room, out);
    if (checked.code != LODESTONE_OK) return checked;
    copy_starts(morph, attributes[index], wedges, static_cast<std::byte*>(out));
    return Outcome{};
  });
}

int32_t lodestone_cursor_copy_origins(lodestone_cursor* cursor, uint32_t begin, uint32_t end, uint32_t* out,
                                      size_t room) {
  return run_morph(cursor, [&](lodestone_cursor&, const Geomorph& morph) {
    const EntryRange wedges = {begin, end};
    if (Outcome checked = check_wedges(morph.new_wedges().end, wedges, 1, room, out); checked.code != LODESTONE_OK)
      return checked;
    for (std::uint32_t wedge = begin; wedge < end; ++wedge) *out++ = morph.origin(wedge);
    return Outcome{};
  });
}

double lodestone_pixels_per_unit(const lodestone_view* view) {
  if (!has_fields(view)) return -1;
  const bool is_view = view->screen_height > 0 && view->field_of_view > 0 && view->field_of_view < 3.1415926 &&
                       !std::isnan(view->distance) && view->scale > 0;
  if (!is_view) return -1;
  return lodestone::pixels_per_unit({view->screen_height, view->field_of_view, view->distance, view->scale});
}
