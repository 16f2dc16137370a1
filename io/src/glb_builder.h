#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/result.h>

#include "json.h"

namespace lodestone::detail {

/// What a bufferView is for: glTF's `target`.
enum class ViewTarget { None = 0, Vertices = 34962, Indices = 34963 };

/// Collects the objects and the binary chunk of a .glb.
class GlbBuilder {
 public:
  /// Appends an object to a top-level array ("nodes", "meshes", …) and returns its index.
  std::size_t add(const char* array, Json object);
  /// Returns an object added before.
  Json& at(const char* array, std::size_t index) { return arrays_[array][index]; }

  /// Appends bytes to the binary chunk on a multiple of 4 and returns the index of a new bufferView of them.
  /// `stride` 0: none is written.
  std::size_t add_view(std::span<const std::byte> bytes, ViewTarget target = ViewTarget::None, std::size_t stride = 0);

  void use_extension(const char* name) { used_.insert(name); }
  void require_extension(const char* name) {
    used_.insert(name);
    required_.insert(name);
  }

  /// Bytes of the binary chunk so far.
  std::uint64_t binary_bytes() const { return binary_.size(); }

  /// Writes the file. Errors: LimitExceeded beyond the 4 GiB a .glb can hold.
  Result<std::vector<std::byte>> finish() const;

 private:
  Json document() const;

  Json arrays_ = Json::object();
  std::set<std::string> used_;
  std::set<std::string> required_;
  std::vector<std::byte> binary_;
};

}  // namespace lodestone::detail
