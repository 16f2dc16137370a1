/* draw.cpp in C11, over lodestone.h alone: reads a stream in pieces, uploads what changes, goes to the level that a
 * camera asks for, on the way to which vertices slide, and prints what that took.
 *
 *   draw_c STREAM */

#include <lodestone/lodestone.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What stands for an engine's buffers. */
typedef struct {
  float* positions; /* three for each wedge */
  uint32_t* corners;
  size_t uploaded_bytes;
} buffers;

static int check(const lodestone_stream* stream, int32_t code) {
  if (code == LODESTONE_OK) return 1;
  fprintf(stderr, "%s: %s\n", lodestone_code_name(code), lodestone_stream_message(stream));
  return 0;
}

static lodestone_level level_of(lodestone_cursor* cursor) {
  lodestone_level level = {.size = sizeof level};
  lodestone_cursor_get_level(cursor, &level);
  return level;
}

static int go(lodestone_stream* stream, lodestone_cursor* cursor, double deviation) {
  uint32_t position;
  return check(stream, lodestone_cursor_choose(cursor, deviation, &position)) &&
         check(stream, lodestone_cursor_seek(cursor, position));
}

/* Of the first group: a program would have a buffer for each. */
static int upload(lodestone_stream* stream, lodestone_cursor* cursor, buffers* to) {
  lodestone_range wedges, ranges[16];
  const uint32_t* corners;
  size_t corner_count, count;
  if (!check(stream, lodestone_cursor_take_new_wedges(cursor, &wedges))) return 0;
  const size_t floats = 3 * (wedges.end - wedges.begin);
  to->positions = realloc(to->positions, 3 * wedges.end * sizeof *to->positions + 1);
  if (to->positions == NULL) return 0;
  if (!check(stream, lodestone_cursor_copy_positions(cursor, (uint32_t)wedges.begin, (uint32_t)wedges.end,
                                                     to->positions + 3 * wedges.begin, floats)))
    return 0;
  to->uploaded_bytes += floats * sizeof(float);
  if (!check(stream, lodestone_cursor_take_moved_wedges(cursor, 64, ranges, 16, &count))) return 0;
  for (size_t i = 0; i < count; ++i) {
    const size_t moved = 3 * (ranges[i].end - ranges[i].begin);
    if (!check(stream, lodestone_cursor_copy_positions(cursor, (uint32_t)ranges[i].begin, (uint32_t)ranges[i].end,
                                                       to->positions + 3 * ranges[i].begin, moved)))
      return 0;
    to->uploaded_bytes += moved * sizeof(float);
  }

  if (!check(stream, lodestone_cursor_get_corners(cursor, 0, &corners, &corner_count))) return 0;
  if (!check(stream, lodestone_cursor_take_changes(cursor, 0, 256, ranges, 16, &count))) return 0;
  to->corners = realloc(to->corners, corner_count * sizeof *to->corners + 1);
  if (to->corners == NULL) return 0;
  for (size_t i = 0; i < count; ++i) {
    const size_t bytes = (ranges[i].end - ranges[i].begin) * sizeof *corners;
    memcpy(to->corners + ranges[i].begin, corners + ranges[i].begin, bytes);
    to->uploaded_bytes += bytes;
  }
  return memcmp(to->corners, corners, corner_count * sizeof *corners) == 0;
}

/* Goes to a coarser level, as an engine does frame by frame: vertices slide to where that is, with the finer one's
 * faces, before it takes its place. Returns how many slide; 0 where something fails. */
static size_t slide(lodestone_stream* stream, lodestone_cursor* cursor, double deviation, const buffers* from) {
  uint32_t position;
  lodestone_range wedges;
  size_t sliding = 0;
  if (!check(stream, lodestone_cursor_choose(cursor, deviation, &position)) ||
      !check(stream, lodestone_cursor_morph_from(cursor, position, &wedges)))
    return 0;
  const size_t count = wedges.end - wedges.begin;
  float* const starts = malloc(3 * count * sizeof *starts + 1);
  if (starts != NULL && check(stream, lodestone_cursor_copy_start_positions(cursor, (uint32_t)wedges.begin,
                                                                            (uint32_t)wedges.end, starts, 3 * count)))
    for (int frame = 3; frame >= 0; --frame) {
      const float t = (float)frame / 4;
      sliding = 0;
      for (size_t i = 0; i < count; ++i) {
        const float* const own = from->positions + 3 * (wedges.begin + i);
        float place[3]; /* what is drawn: in a shader, of two vertex buffers */
        for (int axis = 0; axis < 3; ++axis) place[axis] = starts[3 * i + axis] * (1 - t) + own[axis] * t;
        sliding += memcmp(place, own, sizeof place) != 0;
      }
    }
  free(starts);
  return sliding;
}

static int draw(FILE* file, lodestone_stream* stream, lodestone_cursor** cursor, buffers* to) {
  unsigned char piece[512];
  uint64_t offset = 0;
  size_t size;
  while ((size = fread(piece, 1, sizeof piece, file)) > 0) {
    if (!check(stream, lodestone_stream_append(stream, offset, piece, size))) return 0;
    offset += size;
    if (*cursor == NULL) {
      const int32_t code = lodestone_cursor_create(stream, NULL, cursor);
      if (code == LODESTONE_NOT_READY) continue;
      if (!check(stream, code)) return 0;
    }
    if (!go(stream, *cursor, 0) || !upload(stream, *cursor, to)) return 0;
  }
  if (!check(stream, lodestone_stream_finish(stream)) || *cursor == NULL) return 0;

  const uint32_t faces = level_of(*cursor).face_count;
  const size_t bytes = to->uploaded_bytes;
  const lodestone_view far = {
      .size = sizeof far, .screen_height = 1080, .field_of_view = 0.8, .distance = 200, .scale = 1};
  const double two_pixels = 2 / lodestone_pixels_per_unit(&far);
  const size_t sliding = slide(stream, *cursor, two_pixels, to);
  if (!go(stream, *cursor, two_pixels) || !upload(stream, *cursor, to)) return 0;
  const uint32_t far_faces = level_of(*cursor).face_count;
  printf("%u faces; %zu bytes uploaded for all of it, from afar %zu more for %u faces, to which %zu wedges slide\n",
         (unsigned)faces, bytes, to->uploaded_bytes - bytes, (unsigned)far_faces, sliding);
  return far_faces < faces && sliding > 0;
}

int main(int argc, char** argv) {
  if (lodestone_version() / 1000 != LODESTONE_VERSION / 1000) {
    fprintf(stderr, "library of another version: %u\n", (unsigned)lodestone_version());
    return 2;
  }
  FILE* const file = argc == 2 ? fopen(argv[1], "rb") : NULL;
  if (file == NULL) return 2;
  lodestone_stream* stream = NULL;
  lodestone_cursor* cursor = NULL;
  buffers to = {NULL, NULL, 0};
  const int drawn = lodestone_stream_create(NULL, &stream) == LODESTONE_OK && draw(file, stream, &cursor, &to);
  lodestone_cursor_destroy(cursor);
  lodestone_stream_destroy(stream);
  free(to.positions);
  free(to.corners);
  fclose(file);
  return drawn ? 0 : 1;
}
