#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <span>

#include <lodestone/io/stream_reader.h>

#include "support/same_mesh.h"

namespace lodestone::test {

inline void require_valid(const ProgressiveMesh& mesh) {
  if (const auto valid = validate(mesh); !valid) {
    std::fputs(valid.error().message.c_str(), stderr);
    std::abort();
  }
}

/// Reads a stream in pieces, aborts where what that gives is not what the whole gives: the same mesh, or an error and a
/// valid mesh.
inline void check_in_pieces(std::span<const std::byte> bytes, const Result<ProgressiveMesh>& whole) {
  StreamReader reader;
  Result<void> read;
  for (std::size_t at = 0, length = 1; at < bytes.size() && read; at += length, length = 1 + (length * 7 + at) % 61)
    read = reader.append(bytes.subspan(at, std::min(length, bytes.size() - at)));
  if (read) read = reader.finish();
  if (read.has_value() != whole.has_value()) std::abort();
  if (whole && !same(reader.mesh(), *whole)) std::abort();
  if (reader.chunk_count() > 0) require_valid(reader.mesh());
}

}  // namespace lodestone::test
