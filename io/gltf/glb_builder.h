#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/result.h>

#include "base/json.h"
#include "gltf/meshopt_encode.h"

namespace lodestone::detail {

/// What a bufferView is for: glTF's `target`.
enum class ViewTarget { None = 0, Vertices = 34962, Indices = 34963 };

/// Adds objects to a glTF document and bytes to its one buffer, and writes both as a .glb. A second buffer without
/// bytes stands for what meshopt's views unpack to, as their extension wants it.
class GlbBuilder {
 public:
  /// Objects that nothing needs any more, by top-level array, ascending: their numbers go to new objects first.
  using FreeSlots = std::map<std::string, std::vector<std::size_t>>;

  GlbBuilder(Json document, FreeSlots free_slots);

  Json& document() { return document_; }
  /// Returns one object of a top-level array. Pre: it exists.
  Json& at(const char* array, std::size_t index) { return document_[array][index]; }

  /// Adds an object to a top-level array ("nodes", "meshes", …) and returns its index.
  std::size_t add(const char* array, Json object);

  /// Appends bytes to the binary chunk on a multiple of 4 and returns the index of a new bufferView of them.
  /// `stride` 0: none is written.
  std::size_t add_view(std::span<const std::byte> bytes, ViewTarget target = ViewTarget::None, std::size_t stride = 0);
  /// Appends packed bytes in the same way, and requires the extension of a decoder.
  std::size_t add_packed_view(const MeshoptView& packed, ViewTarget target);
  /// Appends bytes at an offset that leaves `remainder` when divided by `alignment`, and returns that offset.
  std::uint64_t add_bytes(std::span<const std::byte> bytes, std::size_t alignment, std::size_t remainder = 0);

  /// Lists an extension in extensionsUsed, once.
  void use_extension(const char* name);
  /// Lists it in extensionsRequired too.
  void require_extension(const char* name);

  /// Bytes of the binary chunk so far.
  std::uint64_t binary_bytes() const { return binary_.size(); }

  /// Writes the file. Errors: LimitExceeded beyond the 4 GiB a .glb can hold.
  Result<std::vector<std::byte>> finish();

  /// A .gltf and what is in the file beside it, which may be nothing.
  struct SeparateFiles {
    std::string json;
    std::vector<std::byte> binary;
  };
  /// Writes the same as two files, the second under the URI given.
  SeparateFiles finish_separate(const std::string& binary_uri);

 private:
  void close_document();
  void fill_free_slots(const char* array, const Json& filler);

  Json document_;
  FreeSlots free_slots_;
  std::vector<std::byte> binary_;
  std::uint64_t unpacked_bytes_ = 0;  // of all packed views, each on a multiple of 4
};

/// The name and version that stand in asset.generator.
extern const char* const kGenerator;

}  // namespace lodestone::detail
