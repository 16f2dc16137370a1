#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

#include "base/files_beside.h"
#include "base/json.h"
#include "mesh/soup_file.h"

namespace lodestone::detail {

/// The bytes a bufferView stands for, decompressed, and the distance of its elements (0: tightly packed).
struct BufferView {
  std::span<const std::byte> bytes;
  std::size_t stride = 0;
};

/// The elements of an accessor, tightly packed, with sparse values applied.
struct AccessorData {
  ComponentType type = ComponentType::Float32;
  std::uint8_t component_count = 1;  ///< 1 to 4, or 16 for a MAT4
  bool normalized = false;
  std::size_t count = 0;
  std::vector<std::byte> bytes;

  std::size_t element_bytes() const { return component_bytes(type) * component_count; }
};

/// A glTF asset in memory: the JSON as it came, everything unknown included, and all buffers.
///
/// Every reference and count is checked against what is really there when it is followed. Copies share the buffers.
class GltfDocument {
 public:
  /// Reads a .glb or .gltf with its buffers. `fetch` gets the files that buffers lie in.
  static Result<GltfDocument> parse(std::span<const std::byte> bytes, const FileFetcher& fetch);

  const Json& json() const { return json_; }
  /// The JSON to change. Pre: bufferViews stay as they are, and top-level arrays stay arrays of objects.
  Json& edit() { return json_; }

  /// The objects of a top-level array, e.g. list("meshes"); an empty one where there is none.
  const Json& list(const char* array) const;
  /// How many objects a top-level array has.
  std::size_t count(const char* array) const;
  /// Returns one of them. `what` and `index` make the message: "node 7 does not exist: the file has 3".
  Result<const Json*> element(const char* array, const char* what, std::size_t index) const;

  Result<BufferView> buffer_view(std::size_t index) const;
  /// How a buffer view lies in the file. Errors: Malformed.
  struct StoredView {
    std::size_t byte_length = 0;
    bool packed = false;  ///< by meshopt
  };
  Result<StoredView> stored_view(std::size_t index) const;
  Result<AccessorData> accessor(std::size_t index) const;
  /// Returns what the accessor declares, without its elements: those of Draco data have none of their own.
  Result<AccessorData> accessor_type(std::size_t index) const;

  /// How many bytes may be made out of the document's own, so that a small file cannot ask for any amount.
  std::size_t expansion_limit() const;

  /// The extension's object on some object of the document, or null.
  static const Json* extension(const Json& object, const char* name);

 private:
  Result<void> load_buffers(std::vector<std::byte> binary_chunk, const FileFetcher& fetch);
  Result<void> decompress_views();
  Result<std::span<const std::byte>> slice_buffer(const Json& object, std::string_view where) const;

  struct Content {
    std::vector<std::vector<std::byte>> buffers;
    std::vector<std::vector<std::byte>> decompressed_views;  ///< by bufferView; empty for plain ones
  };

  Json json_;
  std::shared_ptr<Content> content_ = std::make_shared<Content>();
};

// The extension of a mesh that names its stream, of any version; docs/stream-format.md describes it.
inline constexpr const char* kStreamExtension = "LODESTONE_removal_stream";

/// Returns the elements as floats, one after the other; normalized integers as glTF says.
std::vector<float> to_floats(const AccessorData& data);

/// Returns the elements of an accessor of unsigned scalars as indices; `what` names it in messages.
Result<std::vector<Index>> to_indices(const AccessorData& data, std::string_view what);

}  // namespace lodestone::detail
