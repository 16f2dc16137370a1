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
enum Flags : unsigned { kLossless = 1, kFast = 2 };

constexpr std::uint64_t zigzag(std::int64_t x) {
  return x < 0 ? 2 * static_cast<std::uint64_t>(-(x + 1)) + 1 : 2 * static_cast<std::uint64_t>(x);
}

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
    if (value >= kEndOfCounts) return overrun_ = true, 0;
    return static_cast<std::uint32_t>(value);
  }
  /// A count that lies so far from another, in a direction.
  std::uint32_t count_beside(std::int64_t other, int direction) {
    const std::uint64_t code = varint();
    const auto half = static_cast<std::int64_t>(code >> 1U);
    const std::int64_t value = other + direction * ((code & 1U) != 0 ? -half - 1 : half);
    if (value < 0 || value >= static_cast<std::int64_t>(kEndOfCounts)) return overrun_ = true, 0;
    return static_cast<std::uint32_t>(value);
  }
  bool overrun() const { return overrun_; }
  std::size_t at() const { return at_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_;
  bool overrun_ = false;
};

Result<void> check_chunk(const CompactHeader& header, const CompactChunkEntry& chunk, std::size_t i, std::size_t at) {
  const std::string name = text("chunk ", i);
  if (chunk.byte_length < header.least_bytes(chunk, i == 0))
    return broken(text(name, ": ", chunk.record_count, " records, ", chunk.face_count, " faces and ", chunk.wedge_count,
                       " wedges in ", chunk.byte_length, " bytes"),
                  at);
  if (chunk.round_count > chunk.record_count)
    return broken(text(name, ": ", chunk.round_count, " rounds of ", chunk.record_count, " records"), at);
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
  if (header.chunks.empty()) return wrong("no chunks");
  if (std::max({header.face_count(), header.wedge_count(), header.vertex_count()}) >= kEndOfCounts)
    return fail(ErrorCode::LimitExceeded, text(kEndOfCounts, " or more faces, wedges or vertices"), kFixedBytes);
  return {};
}

Result<void> read_groups(HeaderReader& in, CompactHeader& header) {
  const std::uint64_t count = in.varint();
  if (count == 0 || count > kMaxGroups) return broken(text("mesh of ", count, " groups"), in.at());
  for (std::uint64_t i = 0; i < count && !in.overrun(); ++i) {
    const std::uint64_t material = in.varint();
    if (material > kNoIndex) return broken(text("group ", i, " has material ", material), in.at());
    header.groups.push_back({static_cast<Index>(material), in.count()});
  }
  return {};
}

Result<AttributeSpec> read_attribute(HeaderReader& in) {
  AttributeSpec spec;
  const auto wrong = [&](const std::string& message) { return broken("attribute " + message, in.at()); };
  const std::uint64_t name_bytes = in.varint();
  if (name_bytes > kMaxNameBytes) return wrong(text("has a name of ", name_bytes, " bytes"));
  for (std::uint64_t i = 0; i < name_bytes; ++i) spec.name.push_back(static_cast<char>(in.get<std::uint8_t>()));
  const auto type = in.get<std::uint16_t>();
  spec.type = static_cast<ComponentType>(type);
  if (type < 5120 || type > 5126 || type == 5124) return wrong(text("has components of type ", type));
  spec.component_count = in.get<std::uint8_t>();
  if (spec.component_count == 0 || spec.component_count > kMostComponents)
    return wrong(text("has ", int{spec.component_count}, " components"));
  spec.normalized = in.get<std::uint8_t>() != 0;
  const auto coding = in.get<std::uint8_t>();
  if (coding >= static_cast<std::uint8_t>(AttributeCoding::kCount)) return wrong(text("has coding ", int{coding}));
  spec.coding = static_cast<AttributeCoding>(coding);
  spec.bits = in.get<std::uint8_t>();
  const bool is_float = spec.type == ComponentType::Float32;
  if (is_float ? spec.bits < kLeastAttributeBits || spec.bits > kMostAttributeBits : spec.bits != 0)
    return wrong(text("has ", int{spec.bits}, " bits"));
  const int components = spec.component_count;
  if ((spec.coding == AttributeCoding::Directions && (!is_float || components < 3 || components > 4)) ||
      (spec.coding == AttributeCoding::Texture && (components != 2 || spec.type == ComponentType::UInt32)) ||
      (spec.coding == AttributeCoding::Weights && !is_float))
    return wrong(text("has ", components, " components of type ", type, " for coding ", int{coding}));
  if (!is_float || spec.coding == AttributeCoding::Directions) return spec;
  for (int c = 0; c < components; ++c) spec.low.push_back(in.get<float>());
  spec.range = in.get<float>();
  for (const float low : spec.low)
    if (!std::isfinite(low) || !std::isfinite(low + spec.range) || !(spec.range >= 0))
      return wrong("has a grid that is not finite");
  return spec;
}

Result<void> read_attributes(HeaderReader& in, CompactHeader& header) {
  const std::uint64_t count = in.varint();
  if (count > kMaxAttributes) return broken(text("mesh of ", count, " attributes"), in.at());
  for (std::uint64_t i = 0; i < count; ++i) {
    LODESTONE_TRY(AttributeSpec spec, read_attribute(in));
    header.attributes.push_back(std::move(spec));
  }
  return {};
}

Result<void> read_fields(HeaderReader& in, CompactHeader& header) {
  header.grid_bits = in.get<std::uint8_t>();
  const auto flags = in.get<std::uint8_t>();
  if (flags > (kLossless | kFast)) return broken(text("flags are ", int{flags}), in.at());
  header.lossless = (flags & kLossless) != 0;
  header.coding = (flags & kFast) != 0 ? CompactCoding::Fast : CompactCoding::Small;
  for (float* value : {&header.grid.origin.x, &header.grid.origin.y, &header.grid.origin.z, &header.grid.range})
    *value = in.get<float>();
  LODESTONE_CHECK(read_groups(in, header));
  LODESTONE_CHECK(read_attributes(in, header));
  header.base_vertex_count = in.count();
  header.base_wedge_count = in.count();
  header.deviation = ErrorScale(in.get<float>());
  header.curvature = ErrorScale(in.get<float>());
  return {};
}

void append_attribute(std::vector<std::byte>& out, const AttributeSpec& spec) {
  append_varint(out, spec.name.size());
  for (const char c : spec.name) append(out, c);
  append(out, static_cast<std::uint16_t>(spec.type));
  append(out, spec.component_count);
  append(out, static_cast<std::uint8_t>(spec.normalized ? 1 : 0));
  append(out, static_cast<std::uint8_t>(spec.coding));
  append(out, spec.bits);
  for (const float low : spec.low) append(out, low);
  if (!spec.low.empty()) append(out, spec.range);
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

double CompactHeader::step() const {
  return static_cast<double>(grid.range) / static_cast<double>((1 << grid_bits) - 1);
}

Vec3f CompactHeader::place(const Vec3i& point) const {
  const double top = static_cast<double>((1 << grid_bits) - 1);
  const auto on_axis = [&](std::int64_t steps, float origin) {
    return static_cast<float>(static_cast<double>(origin) +
                              static_cast<double>(steps) * static_cast<double>(grid.range) / top);
  };
  return {on_axis(point.x, grid.origin.x), on_axis(point.y, grid.origin.y), on_axis(point.z, grid.origin.z)};
}

std::uint64_t CompactHeader::base_face_count() const {
  std::uint64_t count = 0;
  for (const CompactGroup& group : groups) count += group.base_face_count;
  return count;
}

std::vector<CompactChunk> compact_chunks(const CompactHeader& header) {
  std::vector<CompactChunk> chunks;
  std::uint64_t offset = header.header_bytes, faces = header.base_face_count(), wedges = header.base_wedge_count;
  Index record = 0;
  for (const CompactChunkEntry& entry : header.chunks) {
    CompactChunk chunk;
    chunk.byte_offset = offset;
    chunk.byte_length = entry.byte_length;
    chunk.record_begin = record;
    chunk.record_count = entry.record_count;
    offset += entry.byte_length;
    record += entry.record_count;
    faces += entry.face_count;
    wedges += entry.wedge_count;
    chunk.vertex_count = std::uint64_t{header.base_vertex_count} + record;
    chunk.wedge_count = wedges;
    chunk.face_count = faces;
    chunk.deviation = header.deviation.value(entry.deviation_code);
    chunks.push_back(chunk);
  }
  return chunks;
}

std::uint64_t CompactHeader::face_count() const {
  std::uint64_t count = base_face_count();
  for (const CompactChunkEntry& chunk : chunks) count += chunk.face_count;
  return count;
}

std::uint64_t CompactHeader::wedge_count() const {
  std::uint64_t count = base_wedge_count;
  for (const CompactChunkEntry& chunk : chunks) count += chunk.wedge_count;
  return count;
}

std::uint64_t CompactHeader::vertex_count() const {
  std::uint64_t count = base_vertex_count;
  for (const CompactChunkEntry& chunk : chunks) count += chunk.record_count;
  return count;
}

std::uint64_t CompactHeader::numbers_each() const {
  std::uint64_t count = 0;
  for (const AttributeSpec& spec : attributes) count += spec.component_count;
  return count;
}

std::uint64_t CompactHeader::least_bytes(const CompactChunkEntry& chunk, bool is_first) const {
  const auto bytes_for = [](std::uint64_t count, std::uint64_t per_byte) { return (count + per_byte - 1) / per_byte; };
  const std::uint64_t wedges = chunk.wedge_count + std::uint64_t{is_first ? base_wedge_count : 0};
  std::uint64_t least = std::max(
      {bytes_for(chunk.record_count, kMostRecordsPerByte), bytes_for(chunk.face_count, 2 * kMostRecordsPerByte),
       bytes_for(chunk.wedge_count, kMostWedgesPerByte), bytes_for(wedges * numbers_each(), kMostNumbersPerByte)});
  if (is_first)
    least = std::max(
        least, bytes_for(std::uint64_t{base_vertex_count} + base_wedge_count + base_face_count(), kMostBasePerByte));
  return least;
}

std::vector<std::byte> write_compact_header(const CompactHeader& header) {
  std::vector<std::byte> out;
  for (const unsigned char c : kStreamMagic) out.push_back(std::byte{c});
  append(out, kCompactStreamVersion);
  append(out, header.is_fast() ? kFastMinor : kSmallMinor);
  append(out, std::uint32_t{0});
  append(out, static_cast<std::uint8_t>(header.grid_bits));
  append(out, static_cast<std::uint8_t>((header.lossless ? kLossless : 0U) | (header.is_fast() ? kFast : 0U)));
  for (const float value : {header.grid.origin.x, header.grid.origin.y, header.grid.origin.z, header.grid.range})
    append(out, value);
  append_varint(out, header.groups.size());
  for (const CompactGroup& group : header.groups) {
    append_varint(out, group.material);
    append_varint(out, group.base_face_count);
  }
  append_varint(out, header.attributes.size());
  for (const AttributeSpec& spec : header.attributes) append_attribute(out, spec);
  append_varint(out, header.base_vertex_count);
  append_varint(out, header.base_wedge_count);
  append(out, header.deviation.largest());
  append(out, header.curvature.largest());
  append_varint(out, header.chunks.size());
  for (const CompactChunkEntry& chunk : header.chunks) {
    append_varint(out, chunk.byte_length);
    append_varint(out, chunk.round_count);
    append_varint(out, chunk.record_count);
    append_varint(out, zigzag(2 * std::int64_t{chunk.record_count} - std::int64_t{chunk.face_count}));
    append_varint(out, zigzag(std::int64_t{chunk.wedge_count} - std::int64_t{chunk.record_count}));
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
  if (const auto major = load<std::uint16_t>(bytes, 8); major != kCompactStreamVersion)
    return fail(ErrorCode::Unsupported, text("version ", major, " is not ", kCompactStreamVersion), 8);
  const std::uint32_t header_bytes = load_u32(bytes, 12);
  if (header_bytes < kFixedBytes + kChecksumBytes || header_bytes > bytes.size())
    return broken(text("header of ", header_bytes, " bytes in ", bytes.size()), 12);
  const auto covered = bytes.first(header_bytes - kChecksumBytes);
  if (load_u32(bytes, covered.size()) != checksum32(covered))
    return broken("header's checksum is wrong", covered.size());

  HeaderReader in(covered, kFixedBytes);
  CompactHeader header;
  LODESTONE_CHECK(read_fields(in, header));
  header.header_bytes = header_bytes;
  const std::uint64_t chunk_count = in.varint();
  for (std::uint64_t i = 0; i < chunk_count && !in.overrun(); ++i) {
    CompactChunkEntry chunk;
    chunk.byte_length = in.varint();
    chunk.round_count = in.count();
    chunk.record_count = in.count();
    chunk.face_count = in.count_beside(2 * std::int64_t{chunk.record_count}, -1);
    chunk.wedge_count = in.count_beside(chunk.record_count, 1);
    chunk.deviation_code = in.get<std::uint8_t>();
    chunk.checksum = in.get<std::uint32_t>();
    if (chunk.byte_length >= std::uint64_t{1} << 40U)
      return broken(text("chunk ", i, " of ", chunk.byte_length, " bytes"), in.at());
    LODESTONE_CHECK(check_chunk(header, chunk, static_cast<std::size_t>(i), in.at()));
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

bool ErrorCoder::code_stage_end(BitCoder& coder, int& deviation, int& after) {
  deviation = static_cast<int>(coder.code_raw(static_cast<std::uint32_t>(deviation), 8));
  after = static_cast<int>(coder.code_raw(static_cast<std::uint32_t>(after), 8));
  deviation_ = after;
  return deviation <= after;
}

bool ErrorCoder::code(BitCoder& coder, int& deviation, int& curvature) {
  return code(coder, deviations_, deviation_, deviation) && code(coder, curvatures_, curvature_, curvature);
}

}  // namespace lodestone::detail
