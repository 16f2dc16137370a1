#pragma once

#include <concepts>
#include <cstdio>
#include <filesystem>
#include <string>
#include <string_view>

namespace lodestone::detail {

/// Returns a number with at most `digits` significant digits, and without an exponent where it can be had.
inline std::string number_text(double value, int digits = 5) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

inline void append_text(std::string& out, std::string_view part) { out += part; }
inline void append_text(std::string& out, char part) { out += part; }
inline void append_text(std::string& out, std::integral auto part) { out += std::to_string(part); }
inline void append_text(std::string& out, const std::same_as<std::filesystem::path> auto& part) {
  out += part.string();
}
inline void append_text(std::string& out, double part) { out += number_text(part, 6); }

/// Joins strings, characters, numbers and paths: `text("accessor ", 3, ": no bufferView")`.
template <class... Parts>
std::string text(const Parts&... parts) {
  std::string out;
  (append_text(out, parts), ...);
  return out;
}

/// Returns a word with its capital letters A to Z made small.
inline std::string lower_case(std::string_view word) {
  std::string lower(word);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

}  // namespace lodestone::detail
