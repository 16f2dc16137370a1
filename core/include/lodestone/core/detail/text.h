#pragma once

#include <concepts>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace lodestone::detail {

inline void append_text(std::string& out, std::string_view part) { out += part; }
inline void append_text(std::string& out, char part) { out += part; }
inline void append_text(std::string& out, std::integral auto part) { out += std::to_string(part); }
inline void append_text(std::string& out, const std::same_as<std::filesystem::path> auto& part) {
  out += part.string();
}
inline void append_text(std::string& out, double part) {
  char buffer[32];
  std::snprintf(buffer, sizeof buffer, "%g", part);
  out += buffer;
}

/// Joins strings, characters, numbers and paths: `text("accessor ", 3, ": no bufferView")`.
template <class... Parts>
std::string text(const Parts&... parts) {
  std::string out;
  (append_text(out, parts), ...);
  return out;
}

}  // namespace lodestone::detail
