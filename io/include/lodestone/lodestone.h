/* Draws from lodestone's streams in C: reads a stream while it arrives, goes to any of its levels, and names what an
 * engine has to upload. What the C++ headers lodestone/io/stream_reader.h, draw_cursor.h and detail_choice.h say of
 * StreamReader, DrawCursor and DetailChoice holds here, too.
 *
 * Handles are opaque. A function returns LODESTONE_OK or a negative code; with a code it has changed nothing, but for
 * what append says. What comes out goes to memory of the caller. A struct that a function reads or writes begins with
 * its size, which the caller sets: later versions append fields. Pointers must not be null unless it says so. One
 * thread at a time for a stream and its cursors, but for shared streams; different streams know nothing of each other.
 */
#ifndef LODESTONE_LODESTONE_H
#define LODESTONE_LODESTONE_H

#include <stddef.h>
#include <stdint.h>

#if defined(_WIN32)
#if defined(LODESTONE_C_BUILD)
#define LODESTONE_API __declspec(dllexport)
#else
#define LODESTONE_API __declspec(dllimport)
#endif
#elif defined(__GNUC__)
#define LODESTONE_API __attribute__((visibility("default")))
#else
#define LODESTONE_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this header. Before 1.0, another minor version may have another interface. */
#define LODESTONE_VERSION_MAJOR 0
#define LODESTONE_VERSION_MINOR 1
#define LODESTONE_VERSION_PATCH 0
#define LODESTONE_VERSION (LODESTONE_VERSION_MAJOR * 1000000 + LODESTONE_VERSION_MINOR * 1000 + LODESTONE_VERSION_PATCH)

/* Returns the version of the library, made up as LODESTONE_VERSION is. */
LODESTONE_API uint32_t lodestone_version(void);

enum {
  LODESTONE_OK = 0,
  LODESTONE_INVALID_ARGUMENT = -1, /* a number out of range, a null pointer, a struct of unknown size */
  LODESTONE_MALFORMED = -2,        /* the bytes are not what the format says */
  LODESTONE_LIMIT_EXCEEDED = -3,   /* the mesh would take more than it may, or what a format limits is beyond it */
  LODESTONE_UNSUPPORTED = -4,      /* a stream of a version, or with something, that this library does not read */
  LODESTONE_NOT_READY = -5,        /* needs the first chunk, which has not arrived */
  LODESTONE_NO_ROOM = -6,          /* the caller's memory is too small */
  LODESTONE_OUT_OF_MEMORY = -7 /* the system has none left; the stream or cursor is good for nothing but destroying */
};

/* Returns a code's name, "LODESTONE_MALFORMED"; "LODESTONE_UNKNOWN" for other numbers. */
LODESTONE_API const char* lodestone_code_name(int32_t code);

/* ---- Streams ---- */

typedef struct lodestone_stream lodestone_stream;

typedef struct lodestone_stream_options {
  size_t size;         /* sizeof(lodestone_stream_options) */
  uint64_t most_bytes; /* that the mesh may take; 0: 2 GiB */
} lodestone_stream_options;

/* Makes a stream of which nothing has arrived. `options` may be null. */
LODESTONE_API int32_t lodestone_stream_create(const lodestone_stream_options* options, lodestone_stream** stream);
/* The same for two threads, as lodestone/io/shared_stream.h says: one reads, which calls append, finish and
 * reading_message; one draws, which calls all else, and then waits for what one chunk adds to be copied at most. It is
 * destroyed when neither calls anything any more. Takes a second mesh until all has arrived. */
LODESTONE_API int32_t lodestone_stream_create_shared(const lodestone_stream_options* options,
                                                     lodestone_stream** stream);
/* Ends a stream, or does nothing with null. Pre: its cursors have been destroyed. */
LODESTONE_API void lodestone_stream_destroy(lodestone_stream* stream);

/* Takes bytes of the stream from `offset` on; those that were there before are skipped. Chunks that they complete are
 * decoded. `bytes` may be null where `size` is 0.
 * INVALID_ARGUMENT where bytes are missing before them: the stream goes on. MALFORMED, LIMIT_EXCEEDED, UNSUPPORTED: the
 * mesh stays what it is, and all later bytes give the same code. */
LODESTONE_API int32_t lodestone_stream_append(lodestone_stream* stream, uint64_t offset, const void* bytes,
                                              size_t size);
/* Says that no more bytes come. MALFORMED where a stream does not end behind a chunk. */
LODESTONE_API int32_t lodestone_stream_finish(lodestone_stream* stream);
/* Returns what the last call with this stream or one of its cursors failed with, in words, "" where it did not; until
 * the next such call. Of a shared stream: the last but for append and finish. */
LODESTONE_API const char* lodestone_stream_message(const lodestone_stream* stream);
/* Returns what the last append or finish failed with, as lodestone_stream_message does. */
LODESTONE_API const char* lodestone_stream_reading_message(const lodestone_stream* stream);

typedef struct lodestone_stream_state {
  size_t size;        /* sizeof(lodestone_stream_state) */
  uint64_t due_begin; /* bytes that are due next: as many as have arrived … */
  uint64_t due_end;   /* … up to what completes the header or a chunk; both the same at the end and after an error */
  uint32_t chunk_count;  /* of the stream; 0 before its header is complete */
  uint32_t chunks_ready; /* decoded; all: the stream is complete */
  uint32_t record_count; /* so far: positions are 0 to this */
  uint32_t wedge_count;  /* so far: of the vertex buffers for the finest level */
  uint32_t group_count;  /* index buffers; fixed from the first chunk on, as attributes are */
  uint32_t attribute_count;
  float low[3], high[3]; /* of a box around all vertices so far; low > high where there are none */
} lodestone_stream_state;

LODESTONE_API int32_t lodestone_stream_get_state(lodestone_stream* stream, lodestone_stream_state* state);

typedef struct lodestone_chunk {
  size_t size;                       /* sizeof(lodestone_chunk) */
  uint64_t byte_begin, byte_end;     /* in the stream */
  uint32_t position;                 /* of the level that the chunks up to this one lead to */
  uint64_t vertex_count, face_count; /* of that level */
  float deviation;                   /* how far that level lies from the whole mesh at most, mesh units */
} lodestone_chunk;

/* Describes chunk `index`, which need not have arrived. */
LODESTONE_API int32_t lodestone_stream_get_chunk(lodestone_stream* stream, uint32_t index, lodestone_chunk* chunk);

typedef struct lodestone_group {
  size_t size;         /* sizeof(lodestone_group) */
  uint32_t material;   /* a number of whoever made the stream */
  uint32_t face_count; /* so far, at the finest level */
} lodestone_group;

LODESTONE_API int32_t lodestone_stream_get_group(lodestone_stream* stream, uint32_t index, lodestone_group* group);

typedef struct lodestone_attribute {
  size_t size;              /* sizeof(lodestone_attribute) */
  const char* name;         /* as in glTF, "NORMAL"; as long as the stream */
  uint32_t component_type;  /* as in glTF: 5120 to 5126 */
  uint32_t component_count; /* 1 to 16 */
  uint32_t normalized;      /* 1: whole numbers that stand for [0, 1] or [-1, 1] */
  uint32_t element_bytes;   /* of one wedge */
} lodestone_attribute;

LODESTONE_API int32_t lodestone_stream_get_attribute(lodestone_stream* stream, uint32_t index,
                                                     lodestone_attribute* attribute);

/* Copies an attribute of wedges [begin, end), element_bytes each. It never changes: what is in a vertex buffer stays.
 * `room`: bytes that `out` has place for. */
LODESTONE_API int32_t lodestone_stream_copy_attribute(lodestone_stream* stream, uint32_t index, uint32_t begin,
                                                      uint32_t end, void* out, size_t room);

/* ---- Cursors: levels of a stream, as many as one likes ---- */

typedef struct lodestone_cursor lodestone_cursor;

typedef struct lodestone_cursor_options {
  size_t size;  /* sizeof(lodestone_cursor_options) */
  double slack; /* how many times finer than asked for a level may be before a coarser one is chosen, >= 1; 0: 1.3 */
} lodestone_cursor_options;

/* Makes a cursor at the base mesh, all of which is to be uploaded. `options` may be null. NOT_READY before the first
 * chunk. */
LODESTONE_API int32_t lodestone_cursor_create(lodestone_stream* stream, const lodestone_cursor_options* options,
                                              lodestone_cursor** cursor);
/* Ends a cursor, or does nothing with null. */
LODESTONE_API void lodestone_cursor_destroy(lodestone_cursor* cursor);

/* Goes to a position, or to the last that there is so far. */
LODESTONE_API int32_t lodestone_cursor_seek(lodestone_cursor* cursor, uint32_t position);
/* Gives where to go for levels that deviate by at most `deviation` (mesh units): nowhere while the cursor's is fine
 * enough and not `slack` times too fine. */
LODESTONE_API int32_t lodestone_cursor_choose(lodestone_cursor* cursor, double deviation, uint32_t* position);

typedef struct lodestone_level {
  size_t size;           /* sizeof(lodestone_level) */
  uint32_t position;     /* how many records have been applied */
  uint32_t vertex_count; /* as positions */
  uint32_t wedge_count;  /* of the vertex buffers, the first so many */
  uint32_t face_count;   /* of all groups */
  float deviation;       /* how far it lies from the whole mesh at most, mesh units */
} lodestone_level;

LODESTONE_API int32_t lodestone_cursor_get_level(lodestone_cursor* cursor, lodestone_level* level);

/* Shows the index buffer of a group: three wedges for each face. The pointer holds until the cursor moves. */
LODESTONE_API int32_t lodestone_cursor_get_corners(lodestone_cursor* cursor, uint32_t group, const uint32_t** corners,
                                                   size_t* count);

typedef struct lodestone_range {
  size_t begin, end; /* entries [begin, end) */
} lodestone_range;

/* Gives the ranges of a group's index buffer that may have changed since they were taken last, ascending: those within
 * `gap` entries of each other as one, and as many as there is room for, the last with all that follow. `count`: how
 * many there are. `room` >= 1. */
LODESTONE_API int32_t lodestone_cursor_take_changes(lodestone_cursor* cursor, uint32_t group, size_t gap,
                                                    lodestone_range* ranges, size_t room, size_t* count);
/* Gives the wedges that are to be uploaded and have not been given before. */
LODESTONE_API int32_t lodestone_cursor_take_new_wedges(lodestone_cursor* cursor, lodestone_range* wedges);
/* Gives the ranges of wedges whose positions may have changed since they were taken last, as take_changes does: levels
 * on the way lie closer to the whole mesh than its own vertices would. */
LODESTONE_API int32_t lodestone_cursor_take_moved_wedges(lodestone_cursor* cursor, size_t gap, lodestone_range* ranges,
                                                         size_t room, size_t* count);

/* Copies the positions of wedges [begin, end) of the stream to `out`, three floats each, as the cursor's level has
 * them. `room`: floats that `out` has place for. */
LODESTONE_API int32_t lodestone_cursor_copy_positions(lodestone_cursor* cursor, uint32_t begin, uint32_t end,
                                                      float* out, size_t room);

/* Writes smooth normals of the level for its wedges, three floats each: for streams without the attribute NORMAL.
 * They change wherever faces do. `room`: floats that `out` has place for. */
LODESTONE_API int32_t lodestone_cursor_copy_normals(lodestone_cursor* cursor, float* out, size_t room);

/* ---- Geomorphs: vertices slide between two levels; what is drawn meanwhile is the finer one, the cursor's ----
 * For refinement: seek, upload, then morph_from where it came from; t goes from 0 to 1. To coarsen: morph_from where it
 * is to go; t from 1 to 0; then seek. An engine mixes two vertex buffers: start * (1 - t) + own * t. Which corner of
 * the coarse level a vertex starts at, and how close the faces then lie to it: lodestone/io/geomorph.h. */

/* Names the level that the cursor's begins as, at a position that is not above the cursor's. `wedges`: those that it
 * has not; others start where they lie, but for those of take_morphed_wedges. What is named stays so until the next
 * call, whatever the cursor does. Allocates once, and where the mesh has grown. */
LODESTONE_API int32_t lodestone_cursor_morph_from(lodestone_cursor* cursor, uint32_t position, lodestone_range* wedges);
/* Gives the ranges of wedges that both levels have, whose positions may differ, as take_changes does; since they were
 * taken last. NOT_READY before morph_from, as those that follow. */
LODESTONE_API int32_t lodestone_cursor_take_morphed_wedges(lodestone_cursor* cursor, size_t gap,
                                                           lodestone_range* ranges, size_t room, size_t* count);
/* Copies where wedges [begin, end) of the finer level start, three floats each. `room`: floats. */
LODESTONE_API int32_t lodestone_cursor_copy_start_positions(lodestone_cursor* cursor, uint32_t begin, uint32_t end,
                                                            float* out, size_t room);
/* Copies what an attribute starts with, as lodestone_stream_copy_attribute does what it is. `room`: bytes. */
LODESTONE_API int32_t lodestone_cursor_copy_start_attribute(lodestone_cursor* cursor, uint32_t index, uint32_t begin,
                                                            uint32_t end, void* out, size_t room);
/* Copies the wedges of the coarser level that wedges [begin, end) of the finer one start as; themselves where nothing
 * is to slide. For those who have the vertex buffers at hand, it says all. `room`: numbers. */
LODESTONE_API int32_t lodestone_cursor_copy_origins(lodestone_cursor* cursor, uint32_t begin, uint32_t end,
                                                    uint32_t* out, size_t room);

/* ---- Cameras ---- */

typedef struct lodestone_view {
  size_t size;          /* sizeof(lodestone_view) */
  double screen_height; /* of the picture, pixels */
  double field_of_view; /* from its lower edge to its upper one, radians */
  double distance;      /* from the eye to the object's nearest point, world units */
  double scale;         /* world units in a mesh unit */
} lodestone_view;

/* Returns how many pixels a distance of one mesh unit covers, as pixels_per_unit of detail_choice.h does; infinity in
 * the object; -1 for a view that is none. A level for an error of p pixels is one that deviates by p divided by this.
 */
LODESTONE_API double lodestone_pixels_per_unit(const lodestone_view* view);

#ifdef __cplusplus
}
#endif

#endif /* LODESTONE_LODESTONE_H */
