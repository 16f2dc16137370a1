#include <lodestone/io/stream_reader.h>

#include <algorithm>
#include <cstring>
#include <utility>
#include <variant>
#include <vector>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "codec/compact_decoder.h"
#include "stream/growing_mesh.h"
#include "stream/stream_layout.h"
#if LODESTONE_REMOVAL_STREAMS
#include "stream/stream_decoder.h"
#endif

namespace lodestone {
namespace {

using namespace detail;

// Where both formats have the same: magic, major and minor version, length of the header.
constexpr std::uint64_t kStartBytes = 16;
constexpr std::size_t kMajorAt = 8, kHeaderBytesAt = 12;

/// The first version that is read: those before the compact stream need zstd, which not every build has.
constexpr std::uint16_t kFirstMajor = LODESTONE_REMOVAL_STREAMS ? 1 : kCompactStreamVersion;

/// Of either format's chunks, the first of which holds no records where that is how the format has it.
template <class Chunk>
std::vector<ReaderChunk> reader_chunks(std::span<const Chunk> chunks) {
  std::vector<ReaderChunk> all;
  for (const Chunk& chunk : chunks)
    all.push_back({{chunk.byte_offset, chunk.byte_offset + chunk.byte_length},
                   chunk.record_begin + chunk.record_count,
                   chunk.vertex_count,
                   chunk.face_count,
                   chunk.deviation});
  return all;
}

}  // namespace

class StreamReader::State {
 public:
  explicit State(const StreamReaderOptions& options) : options_(options) {}

  Result<void> append(std::span<const std::byte> piece);
  Result<void> append_at(std::uint64_t offset, std::span<const std::byte> piece);
  Result<void> finish() const;

  std::uint64_t byte_count() const { return unit_.begin + kept_.size(); }
  ByteRange due() const { return error_ ? ByteRange{} : ByteRange{byte_count(), unit_.end}; }
  std::span<const ReaderChunk> chunks() const { return chunks_; }
  std::size_t chunk_count() const { return chunk_count_; }
  bool done() const { return !chunks_.empty() && chunk_count_ == chunks_.size(); }
  const std::optional<Error>& error() const { return error_; }
  const ProgressiveMesh& mesh() const { return mesh_; }
  ProgressiveMesh take_mesh() { return std::move(mesh_); }

 private:
#if LODESTONE_REMOVAL_STREAMS
  using Decoder = std::variant<std::monostate, CompactDecoder, StreamDecoder>;
#else
  using Decoder = std::variant<std::monostate, CompactDecoder>;
#endif

  void stop(Error error);
  Result<void> take_unit(std::span<const std::byte> bytes);
  Result<void> read_start(std::span<const std::byte> bytes);
  Result<void> read_header(std::span<const std::byte> bytes);
  Result<void> read_chunk(std::span<const std::byte> bytes);
  const char* name() const { return is_compact_ ? "compact stream: " : "stream: "; }

  StreamReaderOptions options_;
  ByteRange unit_ = {0, kStartBytes};  // what is read in one go: the header's beginning, the header, a chunk
  std::vector<std::byte> kept_;        // what has arrived of it
  bool is_compact_ = false;
  std::vector<ReaderChunk> chunks_;
  std::size_t chunk_count_ = 0;
  std::optional<Error> error_;
  ProgressiveMesh mesh_;
  Decoder decoder_;
};

Result<void> StreamReader::State::append(std::span<const std::byte> piece) {
  while (!error_ && !done() && unit_.end - byte_count() <= piece.size()) {
    const auto last = piece.first(static_cast<std::size_t>(unit_.end - byte_count()));
    piece = piece.subspan(last.size());
    kept_.insert(kept_.end(), kept_.empty() ? last.end() : last.begin(), last.end());
    const std::vector<std::byte> kept = std::exchange(kept_, {});
    if (auto taken = take_unit(kept.empty() ? last : kept); !taken) stop(std::move(taken.error()));
  }
  if (!error_ && done() && !piece.empty())
    stop({ErrorCode::Malformed, text(name(), piece.size(), " bytes follow its end"), unit_.end});
  if (error_) return tl::unexpected<Error>(*error_);
  kept_.insert(kept_.end(), piece.begin(), piece.end());
  return {};
}

Result<void> StreamReader::State::append_at(std::uint64_t offset, std::span<const std::byte> piece) {
  if (error_) return tl::unexpected<Error>(*error_);
  const std::uint64_t due = byte_count();
  if (offset > due)
    return fail(ErrorCode::InvalidArgument,
                text(name(), "bytes from ", offset, " on, where those from ", due, " are due"), due);
  return append(piece.subspan(static_cast<std::size_t>(std::min<std::uint64_t>(due - offset, piece.size()))));
}

Result<void> StreamReader::State::finish() const {
  if (error_) return tl::unexpected<Error>(*error_);
  const std::uint64_t end = byte_count();
  if (chunks_.empty()) return fail(ErrorCode::Malformed, text(name(), "ends inside its header: ", end, " bytes"), end);
  if (done() || (chunk_count_ > 0 && kept_.empty())) return {};
  return fail(
      ErrorCode::Malformed,
      text(name(), "ends inside chunk ", chunk_count_, ": ", kept_.size(), " of ", unit_.end - unit_.begin, " bytes"),
      end);
}

void StreamReader::State::stop(Error error) {
  error_ = std::move(error);
  decoder_.emplace<std::monostate>();
}

/// Reads what has arrived as a whole, and says what comes next.
Result<void> StreamReader::State::take_unit(std::span<const std::byte> bytes) {
  if (!chunks_.empty()) return read_chunk(bytes);
  return unit_.end == kStartBytes ? read_start(bytes) : read_header(bytes);
}

Result<void> StreamReader::State::read_start(std::span<const std::byte> bytes) {
  if (!is_stream(bytes)) return fail(ErrorCode::Malformed, "stream: does not begin with the magic number", 0);
  const auto major = load<std::uint16_t>(bytes, kMajorAt);
  if (major < kFirstMajor || major > kCompactStreamVersion)
    return fail(ErrorCode::Unsupported,
                text("stream: version ", major, ", where ", kFirstMajor, " to ", kCompactStreamVersion, " are read"),
                kMajorAt);
  is_compact_ = major == kCompactStreamVersion;
  const std::uint32_t header_bytes = load_u32(bytes, kHeaderBytesAt);
  if (header_bytes <= kStartBytes)
    return fail(ErrorCode::Malformed, text(name(), "header of ", header_bytes, " bytes"), kHeaderBytesAt);
  unit_.end = header_bytes;
  kept_.assign(bytes.begin(), bytes.end());
  return {};
}

Result<void> StreamReader::State::read_header(std::span<const std::byte> bytes) {
#if LODESTONE_REMOVAL_STREAMS
  if (!is_compact_) {
    LODESTONE_TRY(StreamStart start, read_stream_start(bytes));
    chunks_ = reader_chunks<StreamChunk>(start.directory.chunks);
    decoder_.emplace<StreamDecoder>(std::move(start), mesh_, options_.most_bytes);
    unit_ = chunks_.front().bytes;
    return {};
  }
#endif
  auto header = read_compact_header(bytes);
  if (!header) return fail(header.error().code, name() + header.error().message, header.error().byte_offset);
  chunks_ = reader_chunks<CompactChunk>(compact_chunks(*header));
  decoder_.emplace<CompactDecoder>(std::move(*header), mesh_, options_.most_bytes);
  unit_ = chunks_.front().bytes;
  return {};
}

Result<void> StreamReader::State::read_chunk(std::span<const std::byte> bytes) {
  Result<void> added;
  if (auto* const decoder = std::get_if<CompactDecoder>(&decoder_)) added = decoder->add_chunk(bytes);
#if LODESTONE_REMOVAL_STREAMS
  if (auto* const decoder = std::get_if<StreamDecoder>(&decoder_)) added = decoder->add_chunk(bytes);
#endif
  if (!added)
    return fail(added.error().code, text(name(), "chunk ", chunk_count_, ": ", added.error().message), unit_.begin);
  ++chunk_count_;
  if (!done()) {
    unit_ = chunks_[chunk_count_].bytes;
    return {};
  }
  unit_.begin = unit_.end;
  decoder_.emplace<std::monostate>();
  trim(mesh_);
  return {};
}

bool is_stream(std::span<const std::byte> bytes) {
  return bytes.size() >= kStreamMagic.size() &&
         std::memcmp(bytes.data(), kStreamMagic.data(), kStreamMagic.size()) == 0;
}

StreamReader::StreamReader(const StreamReaderOptions& options) : state_(std::make_unique<State>(options)) {}
StreamReader::StreamReader(StreamReader&&) noexcept = default;
StreamReader& StreamReader::operator=(StreamReader&&) noexcept = default;
StreamReader::~StreamReader() = default;

Result<void> StreamReader::append(std::span<const std::byte> piece) { return state_->append(piece); }
Result<void> StreamReader::append_at(std::uint64_t offset, std::span<const std::byte> piece) {
  return state_->append_at(offset, piece);
}
Result<void> StreamReader::finish() { return state_->finish(); }
std::uint64_t StreamReader::byte_count() const { return state_->byte_count(); }
ByteRange StreamReader::due() const { return state_->due(); }
std::span<const ReaderChunk> StreamReader::chunks() const { return state_->chunks(); }
std::size_t StreamReader::chunk_count() const { return state_->chunk_count(); }
bool StreamReader::done() const { return state_->done(); }
const std::optional<Error>& StreamReader::error() const { return state_->error(); }
const ProgressiveMesh& StreamReader::mesh() const { return state_->mesh(); }
ProgressiveMesh StreamReader::take_mesh() && { return state_->take_mesh(); }

std::uint16_t stream_version(std::span<const std::byte> bytes) {
  return is_stream(bytes) && bytes.size() >= kMajorAt + sizeof(std::uint16_t) ? load<std::uint16_t>(bytes, kMajorAt)
                                                                              : 0;
}

Result<ProgressiveMesh> read_stream(std::span<const std::byte> bytes) {
  StreamReader reader;
  LODESTONE_CHECK(reader.append(bytes));
  LODESTONE_CHECK(reader.finish());
  return std::move(reader).take_mesh();
}

}  // namespace lodestone
