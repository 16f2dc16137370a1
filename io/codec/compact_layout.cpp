#include "codec/compact_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "stream/stream_layout.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kFixedBytes = 16;  // magic, version, header_bytes
constexpr std::size_t kChecksumBytes = 4;
constexpr std::uint64_t kMostFaces = std::uint64_t{1} << 30U;

auto broken(const std::string& message, std::size_t at) { return fail(ErrorCode::Malformed, message, at); }

/// Takes numbers off a header; what is beyond its end reads as 0 and is remembered.
class HeaderReader {
 public:
  HeaderReader(std::span<const std::byte> bytes, std::size_t at) : bytes_(bytes), at_(at) {}

  template <class T>
  T get() {
    if (bytes_.size() - at_ < sizeof(T)) return overrun_ = true, T{};
    const T value = load<T>(bytes_, at_);
    at_ += sizeof(T);
    return value;
  }
  std::uint64_t varint() {
    std::uint64_t value = 0;
    for (unsigned shift = 0; shift < 63; shift += 7) {
      const auto byte = get<std::uint8_t>();
      value |= std::uint64_t{byte & 127U} << shift;
      if (byte < 128) return value;
    }
    overrun_ = true;
    return 0;
  }
  std::uint32_t count() {
    const std::uint64_t value = varint();
    if (value >= kMostFaces) return overrun_ = true, 0;
    return static_cast<std::uint32_t>(value);
  }
  bool overrun() const { return overrun_; }
  std::size_t at() const { return at_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_;
  bool overrun_ = false;
};

Result<void> check_chunk(const CompactChunkEntry& chunk, std::size_t i, std::size_t at) {
  const std::string name = text("chunk ", i);
  if (chunk.record_count > kMostRecordsPerByte * chunk.byte_length)
    return broken(text(name, ": ", chunk.record_count, " records in ", chunk.byte_length, " bytes"), at);
  if (chunk.round_count > chunk.record_count)
    return broken(text(name, ": ", chunk.round_count, " rounds of ", chunk.record_count, " records"), at);
  if (chunk.open_count > chunk.record_count)
    return broken(text(name, ": ", chunk.open_count, " open records of ", chunk.record_count), at);
  if (i > 0 && chunk.round_count == 0) return broken(name + ": no rounds", at);
  return {};
}

bool is_error(float value) { return std::isfinite(value) && value >= 0; }

Result<void> check_header(const CompactHeader& header) {
  const auto wrong = [](const std::string& message) { return broken(message, kFixedBytes); };
  if (header.grid_bits < kLeastGridBits || header.grid_bits > kMostGridBits)
    return wrong(text("grid of ", header.grid_bits, " bits"));
  for (const float value : {header.grid.origin.x, header.grid.origin.y, header.grid.origin.z, header.grid.range})
    if (!std::isfinite(value)) return wrong("grid is not finite");
  if (header.grid.range <= 0) return wrong("grid has no size");
  for (const float origin : {header.grid.origin.x, header.grid.origin.y, header.grid.origin.z})
    if (!std::isfinite(origin + header.grid.range)) return wrong("grid has no end");
  if (!is_error(header.deviation.largest()) || !is_error(header.curvature.largest()))
    return wrong("errors are negative or not finite");
  const std::uint64_t base = std::uint64_t{header.base_point_count} + header.base_face_count;
  if (header.chunks.empty()) return wrong("no chunks");
  if (base > kMostBasePerByte * header.chunks.front().byte_length)
    return wrong(text("base mesh of ", base, " points and faces in ", header.chunks.front().byte_length, " bytes"));
  if (header.base_vertex_count > header.base_point_count)
    return wrong(text("base mesh of ", header.base_vertex_count, " vertices at ", header.base_point_count, " points"));
  if (header.base_face_count + header.face_count() >= kMostFaces)
    return fail(ErrorCode::LimitExceeded, text("more than ", kMostFaces, " faces"), kFixedBytes);
  return {};
}

CompactHeader read_fields(HeaderReader& in) {
  CompactHeader header;
  header.grid_bits = in.get<std::uint8_t>();
  for (float* value : {&header.grid.origin.x, &header.grid.origin.y, &header.grid.origin.z, &header.grid.range})
    *value = in.get<float>();
  header.material = static_cast<Index>(in.varint());
  header.base_point_count = in.count();
  header.base_vertex_count = in.count();
  header.base_face_count = in.count();
  header.deviation = ErrorScale(in.get<float>());
  header.curvature = ErrorScale(in.get<float>());
  return header;
}

}  // namespace

float ErrorScale::value(int code) const {
  constexpr std::array<float, 8> kEighths = {1.0F,       1.0905077F, 1.1892071F, 1.2968396F,
                                             1.4142135F, 1.5422108F, 1.6817928F, 1.8340081F};
  if (code <= 0) return 0;
  const int below = 255 - std::min(code, 255);
  const int octaves = (below + 7) / 8;
  return std::ldexp(largest_, -octaves) * kEighths[static_cast<std::size_t>(8 * octaves - below)];
}

int ErrorScale::code(float error) const {
  if (!(error > 0)) return 0;
  int code = 255;
  while (code > 1 && value(code - 1) >= error) --code;
  return code;
}

std::uint32_t checksum32(std::span<const std::byte> bytes) { return static_cast<std::uint32_t>(checksum64(bytes)); }

std::uint64_t CompactHeader::face_count() const {
  std::uint64_t count = base_face_count;
  for (const CompactChunkEntry& chunk : chunks) count += chunk.added_faces();
  return count;
}

std::vector<CompactChunk> compact_chunks(const CompactHeader& header) {
  std::vector<CompactChunk> chunks;
  std::uint64_t offset = header.header_bytes, faces = header.base_face_count;
  Index record = 0;
  for (const CompactChunkEntry& entry : header.chunks) {
    CompactChunk chunk;
    chunk.byte_offset = offset;
    chunk.byte_length = entry.byte_length;
    chunk.record_begin = record;
    chunk.record_count = entry.record_count;
    offset += entry.byte_length;
    record += entry.record_count;
    faces += entry.added_faces();
    chunk.vertex_count = std::uint64_t{header.base_vertex_count} + record;
    chunk.face_count = faces;
    chunk.deviation = header.deviation.value(entry.deviation_code);
    chunks.push_back(chunk);
  }
  return chunks;
}

std::vector<std::byte> write_compact_header(const CompactHeader& header) {
  std::vector<std::byte> out;
  for (const unsigned char c : kStreamMagic) out.push_back(std::byte{c});
  append(out, kCompactMajor);
  append(out, kCompactMinor);
  append(out, std::uint32_t{0});
  append(out, static_cast<std::uint8_t>(header.grid_bits));
  for (const float value : {header.grid.origin.x, header.grid.origin.y, header.grid.origin.z, header.grid.range})
    append(out, value);
  for (const Index count : {header.material, header.base_point_count, header.base_vertex_count, header.base_face_count})
    append_varint(out, count);
  append(out, header.deviation.largest());
  append(out, header.curvature.largest());
  append_varint(out, header.chunks.size());
  for (const CompactChunkEntry& chunk : header.chunks) {
    append_varint(out, chunk.byte_length);
    append_varint(out, chunk.round_count);
    append_varint(out, chunk.record_count);
    append_varint(out, chunk.open_count);
    append(out, chunk.deviation_code);
    append(out, chunk.checksum);
  }
  const auto header_bytes = static_cast<std::uint32_t>(out.size() + kChecksumBytes);
  std::memcpy(out.data() + 12, &header_bytes, sizeof header_bytes);
  append(out, checksum32(out));
  return out;
}

Result<CompactHeader> read_compact_header(std::span<const std::byte> bytes) {
  if (bytes.size() < kFixedBytes) return broken(text("ends inside the header: ", bytes.size(), " bytes"), bytes.size());
  if (std::memcmp(bytes.data(), kStreamMagic.data(), kStreamMagic.size()) != 0)
    return broken("does not begin as a stream", 0);
  if (const auto major = load<std::uint16_t>(bytes, 8); major != kCompactMajor)
    return fail(ErrorCode::Unsupported, text("version ", major, " is not ", kCompactMajor), 8);
  const std::uint32_t header_bytes = load_u32(bytes, 12);
  if (header_bytes < kFixedBytes + kChecksumBytes || header_bytes > bytes.size())
    return broken(text("header of ", header_bytes, " bytes in ", bytes.size()), 12);
  const auto covered = bytes.first(header_bytes - kChecksumBytes);
  if (load_u32(bytes, covered.size()) != checksum32(covered))
    return broken("header's checksum is wrong", covered.size());

  HeaderReader in(covered, kFixedBytes);
  CompactHeader header = read_fields(in);
  header.header_bytes = header_bytes;
  const std::uint64_t chunk_count = in.varint();
  for (std::uint64_t i = 0; i < chunk_count && !in.overrun(); ++i) {
    CompactChunkEntry chunk;
    chunk.byte_length = in.varint();
    chunk.round_count = in.count();
    chunk.record_count = in.count();
    chunk.open_count = in.count();
    chunk.deviation_code = in.get<std::uint8_t>();
    chunk.checksum = in.get<std::uint32_t>();
    if (chunk.byte_length >= std::uint64_t{1} << 40U)
      return broken(text("chunk ", i, " of ", chunk.byte_length, " bytes"), in.at());
    LODESTONE_CHECK(check_chunk(chunk, static_cast<std::size_t>(i), in.at()));
    header.chunks.push_back(chunk);
  }
  if (in.overrun()) return broken("header's numbers go beyond its end", covered.size());
  LODESTONE_CHECK(check_header(header));
  return header;
}

bool ErrorCoder::code(BitCoder& coder, NumberCoder& numbers, int& last, int& error) {
  NumberCoder::Guess guess;
  guess.value = 48;
  guess.scale = 48;
  const std::int64_t fall = numbers.code(coder, last - error, guess);
  if (fall < 0 || fall > last) return false;
  error = last -= static_cast<int>(fall);
  return true;
}

bool ErrorCoder::code(BitCoder& coder, int& deviation, int& curvature) {
  return code(coder, deviations_, deviation_, deviation) && code(coder, curvatures_, curvature_, curvature);
}

}  // namespace lodestone::detail
