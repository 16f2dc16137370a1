#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include <lodestone/io/stream_reader.h>

#include "support/catch.h"
#include "support/random.h"

namespace lodestone::test {

/// Has a stream arrive in pieces of up to `most` bytes; calls `visit` after each from which on there is a mesh.
template <class Visit>
void arrive(std::span<const std::byte> bytes, std::size_t most, Random& random, StreamReader& reader,
            const Visit& visit) {
  while (!bytes.empty()) {
    const auto piece = bytes.first(std::min<std::size_t>(1 + random.below(most), bytes.size()));
    REQUIRE(reader.append(piece));
    bytes = bytes.subspan(piece.size());
    if (reader.chunk_count() > 0) visit();
  }
}

}  // namespace lodestone::test
