#pragma once

namespace lodestone::detail {

// The glTF extension that holds the removal stream; docs/stream-format.md describes it.
inline constexpr const char* kStreamExtension = "LODESTONE_removal_stream";
inline constexpr const char* kStreamExtensionVersion = "2.0";

}  // namespace lodestone::detail
