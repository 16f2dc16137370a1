// Reads a stream in one thread and draws from it in another, with lodestone::stream alone: the one that draws goes back
// and forth between levels, takes what an engine would upload, and has the same buffers in the end as one that has read
// all of it before.
//
//   draw_threads STREAM …

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <span>
#include <thread>
#include <vector>

#include <lodestone/io/detail_choice.h>
#include <lodestone/io/draw_cursor.h>
#include <lodestone/io/shared_stream.h>

namespace {

/// What stands for an engine's buffers.
struct Buffers {
  std::vector<float> positions;  // three for each wedge
  std::vector<std::vector<lodestone::Index>> corners;
  std::vector<lodestone::EntryRange> ranges;
};

/// Pre: the mesh is held still.
void take_positions(const lodestone::ProgressiveMesh& mesh, lodestone::DrawCursor& cursor, Buffers& buffers) {
  const lodestone::EntryRange wedges = cursor.take_new_wedges();
  buffers.positions.resize(3 * wedges.end);
  cursor.take_moved_wedges(64, buffers.ranges);
  buffers.ranges.push_back(wedges);
  for (const lodestone::EntryRange& range : buffers.ranges)
    lodestone::copy_positions(mesh, cursor, range, buffers.positions.data() + 3 * range.begin);
}

/// What the cursor itself has may be read at any time.
void take_corners(lodestone::DrawCursor& cursor, Buffers& buffers) {
  buffers.corners.resize(cursor.group_count());
  for (std::size_t group = 0; group < cursor.group_count(); ++group) {
    cursor.take_changes(group, 256, buffers.ranges);
    std::vector<lodestone::Index>& corners = buffers.corners[group];
    const std::span<const lodestone::Index> now = cursor.corners(group);
    if (corners.size() < now.size()) corners.resize(now.size());
    for (const lodestone::EntryRange& range : buffers.ranges)
      std::copy(now.begin() + static_cast<std::ptrdiff_t>(range.begin),
                now.begin() + static_cast<std::ptrdiff_t>(range.end),
                corners.begin() + static_cast<std::ptrdiff_t>(range.begin));
  }
}

/// Draws until the stream is whole or given up, every other time from a little farther away.
bool draw(const lodestone::SharedStream& stream, const std::atomic<bool>& ended, Buffers& buffers) {
  std::optional<lodestone::DrawCursor> cursor;
  std::optional<lodestone::DetailChoice> choice;
  for (std::size_t frame = 0;; ++frame) {
    const bool is_last = ended;  // nothing comes after this
    bool is_whole = false;
    {
      const auto held = stream.hold();
      if (held.chunk_count() > 0) {
        const lodestone::ProgressiveMesh& mesh = held.mesh();
        if (!cursor) {
          cursor.emplace(mesh);
          choice.emplace(mesh);
        }
        is_whole = held.done() && is_last;
        const double deviation = is_whole || frame % 2 == 0 ? 0 : static_cast<double>(mesh.deviation.front()) / 10;
        cursor->seek(choice->choose(cursor->position(), deviation));
        take_positions(mesh, *cursor, buffers);
      }
    }
    if (cursor) take_corners(*cursor, buffers);
    if (is_whole || is_last) return is_whole;
    std::this_thread::yield();
  }
}

bool read(std::FILE* file, lodestone::SharedStream& stream) {
  std::byte piece[200];
  while (const std::size_t count = std::fread(piece, 1, sizeof piece, file))
    if (const auto taken = stream.append({piece, count}); !taken) {
      std::fprintf(stderr, "%s\n", taken.error().message.c_str());
      return false;
    }
  return stream.finish().has_value();
}

/// Whether buffers have the finest level.
bool are_whole(const lodestone::ProgressiveMesh& mesh, const Buffers& buffers) {
  lodestone::DrawCursor cursor(mesh);
  cursor.seek(lodestone::DetailChoice(mesh).coarsest(0));
  Buffers expected;
  take_positions(mesh, cursor, expected);
  take_corners(cursor, expected);
  return buffers.positions == expected.positions && buffers.corners == expected.corners;
}

bool draw_while_read(const char* path) {
  std::FILE* const file = std::fopen(path, "rb");
  if (file == nullptr) return false;
  lodestone::SharedStream stream;
  std::atomic<bool> ended = false;
  Buffers buffers;
  bool drawn = false;
  std::thread drawing([&] { drawn = draw(stream, ended, buffers); });
  const bool was_read = read(file, stream);
  ended = true;
  drawing.join();
  std::fclose(file);
  const bool passed = was_read && drawn && are_whole(stream.hold().mesh(), buffers);
  std::printf("%s: %s, %zu wedges\n", path, passed ? "drawn" : "not drawn", buffers.positions.size() / 3);
  return passed;
}

}  // namespace

int main(int argc, char** argv) {
  bool passed = argc > 1;
  for (int i = 1; i < argc; ++i) passed = draw_while_read(argv[i]) && passed;
  return passed ? 0 : 1;
}
