// Draws from a stream with lodestone::stream alone, while it arrives: reads it in pieces, uploads what changes, goes to
// the level that a camera asks for, and prints what that took.
//
//   draw STREAM

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <optional>
#include <vector>

#include <lodestone/io/detail_choice.h>
#include <lodestone/io/draw_cursor.h>
#include <lodestone/io/stream_reader.h>

namespace {

/// What stands for an engine's buffers: they are as long as what has been uploaded.
struct Buffers {
  std::vector<float> positions;  // three for each wedge
  std::vector<std::vector<lodestone::Index>> corners;
  std::size_t uploaded_bytes = 0;
};

void upload(const lodestone::ProgressiveMesh& mesh, lodestone::DrawCursor& cursor, Buffers& buffers) {
  const lodestone::EntryRange wedges = cursor.take_new_wedges();
  buffers.positions.resize(3 * wedges.end);
  std::vector<lodestone::EntryRange> ranges;
  cursor.take_moved_wedges(64, ranges);
  ranges.push_back(wedges);
  for (const lodestone::EntryRange& range : ranges) {
    lodestone::copy_positions(mesh, cursor, range, buffers.positions.data() + 3 * range.begin);
    buffers.uploaded_bytes += 3 * range.size() * sizeof(float);
  }
  buffers.corners.resize(cursor.group_count());
  for (std::size_t group = 0; group < cursor.group_count(); ++group) {
    cursor.take_changes(group, 256, ranges);
    for (const lodestone::EntryRange& range : ranges) {
      std::vector<lodestone::Index>& corners = buffers.corners[group];
      if (corners.size() < range.end) corners.resize(range.end);
      const auto changed = cursor.corners(group).subspan(range.begin, range.size());
      std::copy(changed.begin(), changed.end(), corners.begin() + static_cast<std::ptrdiff_t>(range.begin));
      buffers.uploaded_bytes += range.size() * sizeof(lodestone::Index);
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::FILE* const file = argc == 2 ? std::fopen(argv[1], "rb") : nullptr;
  if (file == nullptr) return 2;
  lodestone::StreamReader reader;
  std::optional<lodestone::DrawCursor> cursor;
  std::optional<lodestone::DetailChoice> choice;
  Buffers buffers;
  std::size_t base = 0;
  std::byte piece[512];
  while (const std::size_t count = std::fread(piece, 1, sizeof piece, file)) {
    if (const auto taken = reader.append({piece, count}); !taken) {
      std::fprintf(stderr, "%s\n", taken.error().message.c_str());
      return 1;
    }
    if (reader.chunk_count() == 0) continue;
    if (!cursor) {
      cursor.emplace(reader.mesh());
      choice.emplace(reader.mesh());
      base = cursor->face_count();
    }
    cursor->seek(choice->choose(cursor->position(), 0));  // as fine as there is
    upload(reader.mesh(), *cursor, buffers);
  }
  std::fclose(file);
  if (!cursor || !reader.done()) return 1;

  const std::size_t whole = cursor->face_count(), bytes = buffers.uploaded_bytes;
  lodestone::ObjectView far;
  far.distance = 200;
  const double two_pixels = 2 / lodestone::pixels_per_unit(far);
  cursor->seek(choice->choose(cursor->position(), two_pixels));
  upload(reader.mesh(), *cursor, buffers);
  std::printf("%zu faces, base mesh %zu; %zu bytes uploaded for all of it, from afar %zu more for %zu faces\n", whole,
              base, bytes, buffers.uploaded_bytes - bytes, cursor->face_count());
  return base < whole && cursor->face_count() <= whole ? 0 : 1;
}
