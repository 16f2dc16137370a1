/* The runtime as a WebAssembly module: lodestone.h with numbers alone, so that lib/wasm.js needs to know the layout of
 * no struct. What a function gives beside its code lies in `results`, as doubles: they hold every whole number below
 * 2^53. */

#include <lodestone/lodestone.h>
#include <stdlib.h>
#include <string.h>

#define EXPORT(name) __attribute__((export_name(name)))

enum { kMostRanges = 64 };

static double results[2 + 2 * kMostRanges];

static void give(const double* values, size_t count) { memcpy(results, values, count * sizeof *values); }
#define GIVE(...)                                 \
  do {                                            \
    const double values[] = {__VA_ARGS__};        \
    give(values, sizeof values / sizeof *values); \
  } while (0)

EXPORT("results") const double* web_results(void) { return results; }
EXPORT("allocate") void* web_allocate(size_t size) { return malloc(size); }
EXPORT("release") void web_release(void* memory) { free(memory); }
EXPORT("version") uint32_t web_version(void) { return lodestone_version(); }
EXPORT("code_name") const char* web_code_name(int32_t code) { return lodestone_code_name(code); }

EXPORT("stream_create") lodestone_stream* web_stream_create(double most_bytes) {
  const lodestone_stream_options options = {sizeof options, (uint64_t)most_bytes};
  lodestone_stream* stream = NULL;
  lodestone_stream_create(&options, &stream);
  return stream;
}
EXPORT("stream_destroy") void web_stream_destroy(lodestone_stream* stream) { lodestone_stream_destroy(stream); }
EXPORT("stream_append")
int32_t web_stream_append(lodestone_stream* stream, double offset, const void* bytes, size_t size) {
  return lodestone_stream_append(stream, (uint64_t)offset, bytes, size);
}
EXPORT("stream_finish") int32_t web_stream_finish(lodestone_stream* stream) { return lodestone_stream_finish(stream); }
EXPORT("stream_message") const char* web_stream_message(lodestone_stream* stream) {
  return lodestone_stream_message(stream);
}

EXPORT("stream_state") int32_t web_stream_state(lodestone_stream* stream) {
  lodestone_stream_state s = {.size = sizeof s};
  const int32_t code = lodestone_stream_get_state(stream, &s);
  GIVE((double)s.due_begin, (double)s.due_end, s.chunk_count, s.chunks_ready, s.record_count, s.wedge_count,
       s.group_count, s.attribute_count, s.low[0], s.low[1], s.low[2], s.high[0], s.high[1], s.high[2]);
  return code;
}
EXPORT("stream_chunk") int32_t web_stream_chunk(lodestone_stream* stream, uint32_t index) {
  lodestone_chunk c = {.size = sizeof c};
  const int32_t code = lodestone_stream_get_chunk(stream, index, &c);
  GIVE((double)c.byte_begin, (double)c.byte_end, c.position, (double)c.vertex_count, (double)c.face_count, c.deviation);
  return code;
}
EXPORT("stream_group") int32_t web_stream_group(lodestone_stream* stream, uint32_t index) {
  lodestone_group g = {.size = sizeof g};
  const int32_t code = lodestone_stream_get_group(stream, index, &g);
  GIVE(g.material, g.face_count);
  return code;
}
EXPORT("stream_attribute") int32_t web_stream_attribute(lodestone_stream* stream, uint32_t index) {
  lodestone_attribute a = {.size = sizeof a};
  const int32_t code = lodestone_stream_get_attribute(stream, index, &a);
  GIVE((double)(size_t)a.name, a.component_type, a.component_count, a.normalized, a.element_bytes);
  return code;
}
EXPORT("stream_attribute_values")
int32_t web_stream_attribute_values(lodestone_stream* stream, uint32_t index, uint32_t begin, uint32_t end, void* out,
                                    size_t room) {
  return lodestone_stream_copy_attribute(stream, index, begin, end, out, room);
}

EXPORT("cursor_create") lodestone_cursor* web_cursor_create(lodestone_stream* stream, double slack) {
  const lodestone_cursor_options options = {sizeof options, slack};
  lodestone_cursor* cursor = NULL;
  lodestone_cursor_create(stream, &options, &cursor);
  return cursor;
}
EXPORT("cursor_destroy") void web_cursor_destroy(lodestone_cursor* cursor) { lodestone_cursor_destroy(cursor); }
EXPORT("cursor_seek") int32_t web_cursor_seek(lodestone_cursor* cursor, uint32_t position) {
  return lodestone_cursor_seek(cursor, position);
}
EXPORT("cursor_choose") int32_t web_cursor_choose(lodestone_cursor* cursor, double deviation) {
  uint32_t position = 0;
  const int32_t code = lodestone_cursor_choose(cursor, deviation, &position);
  results[0] = position;
  return code;
}
EXPORT("cursor_level") int32_t web_cursor_level(lodestone_cursor* cursor) {
  lodestone_level l = {.size = sizeof l};
  const int32_t code = lodestone_cursor_get_level(cursor, &l);
  GIVE(l.position, l.vertex_count, l.wedge_count, l.face_count, l.deviation);
  return code;
}
EXPORT("cursor_corners") int32_t web_cursor_corners(lodestone_cursor* cursor, uint32_t group) {
  const uint32_t* corners = NULL;
  size_t count = 0;
  const int32_t code = lodestone_cursor_get_corners(cursor, group, &corners, &count);
  GIVE((double)(size_t)corners, (double)count);
  return code;
}
/* Gives their number, then the beginning and end of each. */
static void give_ranges(const lodestone_range* ranges, size_t count) {
  results[0] = (double)count;
  for (size_t i = 0; i < count; ++i) {
    results[1 + 2 * i] = (double)ranges[i].begin;
    results[2 + 2 * i] = (double)ranges[i].end;
  }
}
EXPORT("cursor_changes") int32_t web_cursor_changes(lodestone_cursor* cursor, uint32_t group, size_t gap) {
  lodestone_range ranges[kMostRanges];
  size_t count = 0;
  const int32_t code = lodestone_cursor_take_changes(cursor, group, gap, ranges, kMostRanges, &count);
  give_ranges(ranges, count);
  return code;
}
EXPORT("cursor_moved_wedges") int32_t web_cursor_moved_wedges(lodestone_cursor* cursor, size_t gap) {
  lodestone_range ranges[kMostRanges];
  size_t count = 0;
  const int32_t code = lodestone_cursor_take_moved_wedges(cursor, gap, ranges, kMostRanges, &count);
  give_ranges(ranges, count);
  return code;
}
EXPORT("cursor_positions")
int32_t web_cursor_positions(lodestone_cursor* cursor, uint32_t begin, uint32_t end, float* out, size_t room) {
  return lodestone_cursor_copy_positions(cursor, begin, end, out, room);
}
EXPORT("cursor_new_wedges") int32_t web_cursor_new_wedges(lodestone_cursor* cursor) {
  lodestone_range wedges = {0, 0};
  const int32_t code = lodestone_cursor_take_new_wedges(cursor, &wedges);
  GIVE((double)wedges.begin, (double)wedges.end);
  return code;
}
EXPORT("cursor_normals") int32_t web_cursor_normals(lodestone_cursor* cursor, float* out, size_t room) {
  return lodestone_cursor_copy_normals(cursor, out, room);
}
EXPORT("cursor_morph_from") int32_t web_cursor_morph_from(lodestone_cursor* cursor, uint32_t position) {
  lodestone_range wedges = {0, 0};
  const int32_t code = lodestone_cursor_morph_from(cursor, position, &wedges);
  GIVE((double)wedges.begin, (double)wedges.end);
  return code;
}
EXPORT("cursor_origins")
int32_t web_cursor_origins(lodestone_cursor* cursor, uint32_t begin, uint32_t end, uint32_t* out, size_t room) {
  return lodestone_cursor_copy_origins(cursor, begin, end, out, room);
}
EXPORT("pixels_per_unit")
double web_pixels_per_unit(double screen_height, double field_of_view, double distance, double scale) {
  const lodestone_view view = {sizeof view, screen_height, field_of_view, distance, scale};
  return lodestone_pixels_per_unit(&view);
}
