#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <span>

#include <lodestone/core/result.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/lod/progressive_mesh.h>

namespace lodestone {

/// A stream that one thread reads while others draw from it.
///
/// The reading thread decodes into a mesh of its own; after each chunk what that has added is appended to a second one,
/// which the others see. Neither decoding nor allocating happens while a thread that draws has to wait: it waits for a
/// copy of what one chunk has added, at about the speed of memory, and never longer. The reading thread waits as long
/// as a Hold lives.
///
/// Costs a second mesh until the last chunk, which gives its own away.
class SharedStream {
 public:
  explicit SharedStream(const StreamReaderOptions& options = {});
  ~SharedStream();

  // ---- The thread that reads: one, and always the same or handed over ----

  /// As StreamReader's; each chunk that they complete can be drawn before the next is decoded.
  Result<void> append(std::span<const std::byte> piece);
  Result<void> append_at(std::uint64_t offset, std::span<const std::byte> piece);
  Result<void> finish();
  /// What reads: how far it is and what it failed with. Its mesh is not to be drawn from.
  const StreamReader& reader() const;

  // ---- Threads that draw ----

  class Hold;
  /// Waits for a chunk that is being published, at most, and for other Holds; the mesh then stays what it is until the
  /// Hold ends.
  Hold hold() const;

 private:
  class State;
  std::unique_ptr<State> state_;
};

/// What has arrived, held still. Cursors over its mesh may be kept from one Hold to the next, but make, move and read
/// them, and whatever else looks at the mesh, only while one lives; what they themselves have, as their corners, may be
/// read at any time.
class SharedStream::Hold {
 public:
  /// As StreamReader's; at the same address as long as the stream lives.
  const ProgressiveMesh& mesh() const;
  ByteRange due() const;
  std::span<const ReaderChunk> chunks() const;
  std::size_t chunk_count() const;
  bool done() const;

 private:
  friend class SharedStream;
  explicit Hold(const State& state);

  const State* state_;
  std::unique_lock<std::mutex> lock_;
};

}  // namespace lodestone
