#pragma once

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <span>

#include <lodestone/io/geomorph.h>
#include <lodestone/io/stream_reader.h>

#include "support/same_mesh.h"

namespace lodestone::test {

inline void require_valid(const ProgressiveMesh& mesh) {
  if (const auto valid = validate(mesh); !valid) {
    std::fputs(valid.error().message.c_str(), stderr);
    std::abort();
  }
}

/// Aborts where what a level begins as is not there.
inline void require_morph(const ProgressiveMesh& mesh) {
  const auto last = static_cast<Index>(mesh.record_count());
  Geomorph morph(mesh);
  for (const Index coarse : {Index{0}, last / 2}) {
    morph.set(coarse, last);
    for (Index wedge = 0; wedge < morph.new_wedges().end; ++wedge)
      if (morph.origin(morph.origin(wedge)) != morph.origin(wedge)) std::abort();
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
  if (reader.chunk_count() == 0) return;
  require_valid(reader.mesh());
  require_morph(reader.mesh());
}

}  // namespace lodestone::test
