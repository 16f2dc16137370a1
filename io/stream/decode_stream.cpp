#include <lodestone/io/stream_format.h>

#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "stream/stream_decoder.h"
#include "stream/stream_layout.h"

namespace lodestone {

using detail::text;

Result<ProgressiveMesh> decode_stream(std::span<const std::byte> bytes) {
  LODESTONE_TRY(detail::StreamStart start, detail::read_stream_start(bytes));
  const std::uint64_t total = start.directory.total_bytes;
  if (bytes.size() > total)
    return fail(ErrorCode::Malformed, text("stream: ", bytes.size() - total, " bytes follow its end"), total);
  ProgressiveMesh mesh;
  detail::StreamDecoder decoder(std::move(start), mesh);
  for (std::size_t i = 0; !decoder.done(); ++i) {
    const StreamChunk& chunk = decoder.directory().chunks[i];
    const std::uint64_t room = bytes.size() - chunk.byte_offset;
    if (room == 0 && i > 0 && chunk.byte_length > 0) break;  // a prefix: the level so far is complete
    if (chunk.byte_length > room)
      return fail(ErrorCode::Malformed,
                  text("stream: ends inside chunk ", i, ": ", room, " of ", chunk.byte_length, " bytes"), bytes.size());
    const auto added = decoder.add_chunk(
        bytes.subspan(static_cast<std::size_t>(chunk.byte_offset), static_cast<std::size_t>(chunk.byte_length)));
    if (!added)
      return fail(added.error().code, text("stream: chunk ", i, ": ", added.error().message), chunk.byte_offset);
  }
  return mesh;
}

}  // namespace lodestone
