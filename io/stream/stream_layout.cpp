#include "stream/stream_layout.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"

namespace lodestone {
namespace detail {
namespace {

/// Takes values off the front of bytes that are known to suffice.
class Fields {
 public:
  explicit Fields(std::span<const std::byte> bytes) : bytes_(bytes) {}
  template <class T>
  void operator>>(T& value) {
    value = load<T>(bytes_, at_);
    at_ += sizeof(T);
  }
  template <class T>
  T next() {
    T value{};
    *this >> value;
    return value;
  }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

struct FixedHeader {
  StreamHeader counts;
  std::uint16_t major = 0, minor = 0, entry_bytes = 0, encoding = 0;
  std::uint64_t total_bytes = 0;
  std::uint32_t chunk_count = 0;
};

FixedHeader read_fixed(std::span<const std::byte> bytes) {
  FixedHeader h;
  Fields fields(bytes.subspan(kStreamMagic.size()));
  fields >> h.major, fields >> h.minor;
  fields >> h.counts.header_bytes;
  fields >> h.total_bytes;
  fields >> h.chunk_count;
  fields >> h.counts.vertex_count, fields >> h.counts.wedge_count;
  fields >> h.counts.record_count, fields >> h.counts.round_count;
  fields >> h.counts.base_vertex_count, fields >> h.counts.base_wedge_count;
  fields >> h.counts.group_count, fields >> h.counts.attribute_count;
  fields >> h.entry_bytes, fields >> h.encoding;
  return h;
}

StreamChunk read_entry(std::span<const std::byte> bytes, std::uint32_t& wedge_count) {
  StreamChunk chunk;
  Fields fields(bytes);
  fields >> chunk.byte_offset, fields >> chunk.byte_length;
  fields >> chunk.decoded_bytes, fields >> chunk.checksum;
  fields >> chunk.record_begin, fields >> chunk.record_count;
  fields >> chunk.face_count;
  chunk.vertex_count = fields.next<std::uint32_t>();
  fields >> wedge_count;
  fields >> chunk.deviation, fields >> chunk.curvature_error;
  return chunk;
}

tl::unexpected<Error> broken_at(std::string message, std::uint64_t offset) {
  return fail(ErrorCode::Malformed, "stream: " + std::move(message), offset);
}

Result<FixedHeader> check_fixed(std::span<const std::byte> bytes) {
  const auto magic = std::as_bytes(std::span(kStreamMagic));
  if (bytes.size() < magic.size() || !std::equal(magic.begin(), magic.end(), bytes.begin()))
    return broken_at("does not begin with the magic number", 0);
  if (bytes.size() < kFixedHeaderBytes)
    return broken_at(text("ends inside its header after ", bytes.size(), " bytes"), bytes.size());
  const FixedHeader h = read_fixed(bytes);
  if (h.major == 0 || h.major > kStreamMajor)
    return fail(ErrorCode::Unsupported,
                text("stream: version ", h.major, '.', h.minor, ", where 1 to ", kStreamMajor, " are known"), 8);
  if (h.encoding != kColumnEncoding)
    return fail(ErrorCode::Unsupported, text("stream: encoding ", h.encoding, " is not known"), 62);
  if (h.counts.group_count == 0 || h.counts.group_count > kMaxGroups || h.counts.attribute_count > kMaxAttributes)
    return fail(ErrorCode::LimitExceeded,
                text("stream: ", h.counts.group_count, " groups and ", h.counts.attribute_count,
                     " attributes are outside the limits"),
                52);
  const std::uint64_t least = kFixedHeaderBytes + std::uint64_t{h.chunk_count} * h.entry_bytes + kHeaderChecksumBytes;
  if (h.entry_bytes < kDirectoryEntryBytes || h.chunk_count == 0 || h.counts.header_bytes < least)
    return broken_at(text("header of ", h.counts.header_bytes, " bytes cannot hold ", h.chunk_count, " chunks"), 12);
  if (h.counts.header_bytes > bytes.size())
    return broken_at(text("ends inside its header: ", bytes.size(), " of ", h.counts.header_bytes, " bytes"),
                     bytes.size());
  const std::size_t end = h.counts.header_bytes - kHeaderChecksumBytes;
  if (checksum64(bytes.first(end)) != load<std::uint64_t>(bytes, end))
    return broken_at("the header's checksum is wrong", end);
  return h;
}

/// Checks that the entries cover the stream and its records without a gap, and that their levels grow.
Result<void> check_entries(const StreamStart& start) {
  const StreamHeader& h = start.header;
  std::uint64_t offset = h.header_bytes, record = 0;
  for (std::size_t i = 0; i < start.directory.chunks.size(); ++i) {
    const StreamChunk& c = start.directory.chunks[i];
    const std::uint64_t at = kFixedHeaderBytes + i * kDirectoryEntryBytes;
    if (c.byte_offset != offset || c.byte_length > start.directory.total_bytes - offset)
      return broken_at(text("chunk ", i, " does not follow the one before it"), at);
    if (c.record_begin != record || (i == 0) != (c.record_count == 0))
      return broken_at(text("chunk ", i, " has ", c.record_count, " records from ", c.record_begin), at + 32);
    if (c.decoded_bytes / kMaxExpansion > c.byte_length)
      return fail(ErrorCode::LimitExceeded,
                  text("stream: chunk ", i, " of ", c.byte_length, " bytes says it holds ", c.decoded_bytes), at + 16);
    offset += c.byte_length;
    record += c.record_count;
    if (c.vertex_count != h.base_vertex_count + record || start.wedge_counts[i] > h.wedge_count)
      return broken_at(
          text("chunk ", i, " ends with ", c.vertex_count, " vertices and ", start.wedge_counts[i], " wedges"),
          at + 48);
    if (!std::isfinite(c.deviation) || !std::isfinite(c.curvature_error))
      return broken_at(text("chunk ", i, " has no error"), at + 56);
  }
  const bool complete = offset == start.directory.total_bytes && record == h.record_count &&
                        h.vertex_count == std::uint64_t{h.base_vertex_count} + h.record_count &&
                        start.wedge_counts.front() == h.base_wedge_count && start.wedge_counts.back() == h.wedge_count;
  return complete ? Result<void>{} : broken_at("the directory does not add up to the header", 16);
}

}  // namespace

std::vector<std::byte> write_stream_start(const StreamStart& start) {
  const StreamHeader& h = start.header;
  std::vector<std::byte> out;
  for (const unsigned char c : kStreamMagic) append(out, c);
  append(out, kStreamMajor), append(out, kStreamMinor);
  append(out, h.header_bytes);
  append(out, start.directory.total_bytes);
  append(out, static_cast<std::uint32_t>(start.directory.chunks.size()));
  for (const std::uint32_t count : {h.vertex_count, h.wedge_count, h.record_count, h.round_count, h.base_vertex_count,
                                    h.base_wedge_count, h.group_count, h.attribute_count})
    append(out, count);
  append(out, static_cast<std::uint16_t>(kDirectoryEntryBytes)), append(out, kColumnEncoding);
  for (std::size_t i = 0; i < start.directory.chunks.size(); ++i) {
    const StreamChunk& c = start.directory.chunks[i];
    append(out, c.byte_offset), append(out, c.byte_length);
    append(out, c.decoded_bytes), append(out, c.checksum);
    append(out, c.record_begin), append(out, c.record_count);
    append(out, c.face_count);
    append(out, static_cast<std::uint32_t>(c.vertex_count)), append(out, start.wedge_counts[i]);
    append(out, c.deviation), append(out, c.curvature_error);
  }
  append(out, checksum64(out));
  return out;
}

Result<StreamStart> read_stream_start(std::span<const std::byte> bytes) {
  LODESTONE_TRY(const FixedHeader fixed, check_fixed(bytes));
  StreamStart start;
  start.header = fixed.counts;
  start.directory.version_major = fixed.major;
  start.directory.version_minor = fixed.minor;
  start.directory.total_bytes = fixed.total_bytes;
  if (fixed.total_bytes < fixed.counts.header_bytes) return broken_at("is shorter than its header", 16);
  // A later minor version may have grown the fixed part and the entries: the directory ends where the checksum begins.
  const std::size_t directory =
      fixed.counts.header_bytes - kHeaderChecksumBytes - std::size_t{fixed.chunk_count} * fixed.entry_bytes;
  for (std::size_t i = 0; i < fixed.chunk_count; ++i) {
    std::uint32_t wedge_count = 0;
    start.directory.chunks.push_back(read_entry(bytes.subspan(directory + i * fixed.entry_bytes), wedge_count));
    start.wedge_counts.push_back(wedge_count);
  }
  LODESTONE_CHECK(check_entries(start));
  return start;
}

}  // namespace detail

Result<StreamDirectory> read_stream_directory(std::span<const std::byte> bytes) {
  LODESTONE_TRY(detail::StreamStart start, detail::read_stream_start(bytes));
  return std::move(start.directory);
}

}  // namespace lodestone
