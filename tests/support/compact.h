#pragma once

#include <span>
#include <string>
#include <utility>

#include <lodestone/io/compact_stream.h>

#include "support/catch.h"

namespace lodestone::test {

/// Encodes a mesh as a compact stream.
inline CompactStream stream_of(const ProgressiveMesh& mesh, const CompactOptions& options,
                               std::span<const PlacedLevel> levels = {}) {
  auto stream = encode_compact(mesh, options, levels);
  INFO((stream ? std::string() : stream.error().message));
  REQUIRE(stream);
  return std::move(*stream);
}

/// Decodes a compact stream, or its first chunks; the mesh is valid.
inline ProgressiveMesh decoded(std::span<const std::byte> bytes) {
  auto mesh = decode_compact(bytes);
  INFO((mesh ? std::string() : mesh.error().message));
  REQUIRE(mesh);
  const auto valid = validate(*mesh);
  INFO((valid ? std::string() : valid.error().message));
  REQUIRE(valid);
  return std::move(*mesh);
}

}  // namespace lodestone::test
