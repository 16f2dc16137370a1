#include <lodestone/io/shared_stream.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "stream/growing_mesh.h"

namespace lodestone {

/// The second mesh is changed by the reading thread alone, so that this may look at it without the lock; all that it
/// changes it changes with the lock.
class SharedStream::State {
 public:
  explicit State(const StreamReaderOptions& options) : reader(options) {}

  Result<void> append(std::span<const std::byte> piece);
  void publish();

  StreamReader reader;

  mutable std::mutex mutex;
  ProgressiveMesh mesh;
  ByteRange due;
  std::vector<ReaderChunk> chunks;
  std::size_t chunk_count = 0;

 private:
  detail::MeshCopy copy_;
};

/// Stops at the end of each chunk, to publish it.
Result<void> SharedStream::State::append(std::span<const std::byte> piece) {
  Result<void> taken;
  do {
    const auto due_bytes = static_cast<std::size_t>(reader.due().end - reader.due().begin);
    const auto part = due_bytes > 0 ? piece.first(std::min(piece.size(), due_bytes)) : piece;
    piece = piece.subspan(part.size());
    taken = reader.append(part);
    publish();
  } while (taken && !piece.empty());
  return taken;
}

void SharedStream::State::publish() {
  const std::size_t chunks_ready = reader.chunk_count();
  const ByteRange due_now = reader.due();
  const bool has_grown = chunks_ready > chunk_count, is_last = has_grown && reader.done();
  std::vector<ReaderChunk> all;
  if (chunks.empty()) all.assign(reader.chunks().begin(), reader.chunks().end());
  ProgressiveMesh last;  // what it leaves behind is freed when nobody waits any more
  if (is_last)
    last = std::move(reader).take_mesh();
  else if (has_grown)
    copy_.prepare(reader.mesh(), mesh);
  {
    const std::lock_guard lock(mutex);
    if (is_last)
      std::swap(mesh, last);
    else if (has_grown)
      copy_.finish(reader.mesh(), mesh);
    if (chunks.empty()) chunks.swap(all);
    due = due_now;
    chunk_count = chunks_ready;
  }
  copy_ = {};
}

SharedStream::SharedStream(const StreamReaderOptions& options) : state_(std::make_unique<State>(options)) {
  state_->publish();
}
SharedStream::~SharedStream() = default;

Result<void> SharedStream::append(std::span<const std::byte> piece) { return state_->append(piece); }

Result<void> SharedStream::append_at(std::uint64_t offset, std::span<const std::byte> piece) {
  const std::uint64_t taken = state_->reader.byte_count();
  if (offset > taken || state_->reader.error()) return state_->reader.append_at(offset, piece);  // says why
  return state_->append(piece.subspan(static_cast<std::size_t>(std::min<std::uint64_t>(taken - offset, piece.size()))));
}

Result<void> SharedStream::finish() { return state_->reader.finish(); }
const StreamReader& SharedStream::reader() const { return state_->reader; }
SharedStream::Hold SharedStream::hold() const { return Hold(*state_); }

SharedStream::Hold::Hold(const State& state) : state_(&state), lock_(state.mutex) {}
const ProgressiveMesh& SharedStream::Hold::mesh() const { return state_->mesh; }
ByteRange SharedStream::Hold::due() const { return state_->due; }
std::span<const ReaderChunk> SharedStream::Hold::chunks() const { return state_->chunks; }
std::size_t SharedStream::Hold::chunk_count() const { return state_->chunk_count; }
bool SharedStream::Hold::done() const { return !state_->chunks.empty() && chunk_count() == state_->chunks.size(); }

}  // namespace lodestone
