/* Prints a checksum of a stream's mesh after each chunk, by lodestone.h: web/stream.mjs finds the same in WebAssembly.
 *
 *   stream_sums STREAM */

#include <lodestone/lodestone.h>
#include <stdio.h>
#include <stdlib.h>

/* FNV-1a. */
static uint32_t add(uint32_t sum, const void* bytes, size_t size) {
  for (size_t i = 0; i < size; ++i) sum = (sum ^ ((const unsigned char*)bytes)[i]) * 16777619u;
  return sum;
}

static uint32_t add_attribute(uint32_t sum, lodestone_stream* stream, uint32_t index, uint32_t wedge_count) {
  lodestone_attribute attribute = {.size = sizeof attribute};
  lodestone_stream_get_attribute(stream, index, &attribute);
  const size_t size = (size_t)wedge_count * attribute.element_bytes;
  void* const values = malloc(size + 1);
  if (values != NULL && lodestone_stream_copy_attribute(stream, index, 0, wedge_count, values, size) == LODESTONE_OK)
    sum = add(sum, values, size);
  free(values);
  return sum;
}

/* Of the level at a position. */
static uint32_t sum_of_level(lodestone_stream* stream, lodestone_cursor* cursor, uint32_t position) {
  lodestone_stream_state state = {.size = sizeof state};
  lodestone_level level = {.size = sizeof level};
  lodestone_cursor_seek(cursor, position);
  lodestone_stream_get_state(stream, &state);
  lodestone_cursor_get_level(cursor, &level);
  uint32_t sum = 2166136261u;
  for (uint32_t group = 0; group < state.group_count; ++group) {
    const uint32_t* corners;
    size_t count;
    if (lodestone_cursor_get_corners(cursor, group, &corners, &count) == LODESTONE_OK)
      sum = add(sum, corners, count * sizeof *corners);
  }
  const size_t floats = 3 * (size_t)level.wedge_count;
  float* const positions = malloc(floats * sizeof *positions + 1);
  if (positions != NULL &&
      lodestone_cursor_copy_positions(cursor, 0, level.wedge_count, positions, floats) == LODESTONE_OK)
    sum = add(sum, positions, floats * sizeof *positions);
  free(positions);
  for (uint32_t i = 0; i < state.attribute_count; ++i) sum = add_attribute(sum, stream, i, level.wedge_count);
  return add(sum, &level.deviation, sizeof level.deviation);
}

static int print_sums(FILE* file, lodestone_stream* stream) {
  lodestone_cursor* cursor = NULL;
  lodestone_stream_state state = {.size = sizeof state};
  uint32_t printed = 0;
  uint64_t offset = 0;
  unsigned char byte;
  while (fread(&byte, 1, 1, file) == 1) {
    if (lodestone_stream_append(stream, offset++, &byte, 1) != LODESTONE_OK) return 0;
    lodestone_stream_get_state(stream, &state);
    if (state.chunks_ready == printed) continue;
    printed = state.chunks_ready;
    if (cursor == NULL && lodestone_cursor_create(stream, NULL, &cursor) != LODESTONE_OK) return 0;
    printf("%u %u\n", (unsigned)sum_of_level(stream, cursor, state.record_count),
           (unsigned)sum_of_level(stream, cursor, state.record_count / 2));
  }
  lodestone_cursor_destroy(cursor);
  return lodestone_stream_finish(stream) == LODESTONE_OK;
}

int main(int argc, char** argv) {
  FILE* const file = argc == 2 ? fopen(argv[1], "rb") : NULL;
  lodestone_stream* stream = NULL;
  if (file == NULL || lodestone_stream_create(NULL, &stream) != LODESTONE_OK) return 2;
  const int printed = print_sums(file, stream);
  if (!printed) fprintf(stderr, "%s\n", lodestone_stream_message(stream));
  lodestone_stream_destroy(stream);
  fclose(file);
  return printed ? 0 : 1;
}
