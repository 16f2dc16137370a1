#include <lodestone/io/compact_stream.h>

#include <numeric>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "codec/compact_decoder.h"
#include "codec/compact_layout.h"

namespace lodestone {

using detail::text;

Result<std::vector<CompactChunk>> read_compact_chunks(std::span<const std::byte> bytes) {
  LODESTONE_TRY(const detail::CompactHeader header, detail::read_compact_header(bytes));
  return detail::compact_chunks(header);
}

double CompactSizes::sum() const {
  return std::accumulate(attributes.begin(), attributes.end(),
                         header + base + places + positions + moves + wedges + loose + rests + errors);
}

namespace {

/// Decodes a stream; its coding and its rounds are noted where there is a place for them.
Result<ProgressiveMesh> decode(std::span<const std::byte> bytes, CompactParts* parts) {
  const auto in_stream = [](const Error& error, std::uint64_t offset) {
    return fail(error.code, "compact stream: " + error.message, error.byte_offset.value_or(offset));
  };
  auto header = detail::read_compact_header(bytes);
  if (!header) return in_stream(header.error(), 0);
  std::uint64_t offset = header->header_bytes;
  ProgressiveMesh mesh;
  detail::CompactDecoder decoder(std::move(*header), mesh);
  if (parts != nullptr) {
    parts->coding = decoder.header().coding;
    decoder.count_rounds(parts->rounds);
  }
  for (std::size_t i = 0; !decoder.done(); ++i) {
    const std::uint64_t length = decoder.header().chunks[i].byte_length, room = bytes.size() - offset;
    if (room == 0 && i > 0) return mesh;  // a prefix: the level so far is complete
    if (length > room)
      return in_stream({ErrorCode::Malformed, text("ends inside chunk ", i, ": ", room, " of ", length, " bytes"), {}},
                       bytes.size());
    const auto added =
        decoder.add_chunk(bytes.subspan(static_cast<std::size_t>(offset), static_cast<std::size_t>(length)));
    if (!added) return in_stream({added.error().code, text("chunk ", i, ": ", added.error().message), {}}, offset);
    offset += length;
  }
  if (offset < bytes.size())
    return in_stream({ErrorCode::Malformed, text(bytes.size() - offset, " bytes follow its end"), {}}, offset);
  return mesh;
}

void add(const CompactSizes& more, CompactSizes& sizes) {
  for (const auto part : {&CompactSizes::base, &CompactSizes::places, &CompactSizes::positions, &CompactSizes::moves,
                          &CompactSizes::wedges, &CompactSizes::loose, &CompactSizes::rests, &CompactSizes::errors})
    sizes.*part += more.*part;
  for (std::size_t a = 0; a < sizes.attributes.size(); ++a) sizes.attributes[a] += more.attributes[a];
}

}  // namespace

Result<ProgressiveMesh> decode_compact(std::span<const std::byte> bytes) { return decode(bytes, nullptr); }

Result<CompactParts> measure_compact(std::span<const std::byte> bytes) {
  CompactParts parts;
  LODESTONE_TRY(const ProgressiveMesh mesh, decode(bytes, &parts));
  for (const Attribute& attribute : mesh.attributes) parts.attributes.push_back(attribute.name);
  CompactSizes& sizes = parts.sizes;
  sizes.attributes.assign(mesh.attributes.size(), 0);
  for (const CompactRound& round : parts.rounds) add(round.sizes, sizes);
  sizes.header = 8 * static_cast<double>(bytes.size()) - sizes.sum();
  return parts;
}

}  // namespace lodestone
