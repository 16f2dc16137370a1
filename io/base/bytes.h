#pragma once

#include <bit>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string_view>
#include <vector>

namespace lodestone::detail {

static_assert(std::endian::native == std::endian::little, "files are little-endian and are read as they lie in memory");

/// Copies a value out of bytes that need not be aligned. Pre: it lies inside.
template <class T>
T load(std::span<const std::byte> bytes, std::size_t at) {
  assert(at <= bytes.size() && sizeof(T) <= bytes.size() - at);
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

inline std::uint32_t load_u32(std::span<const std::byte> bytes, std::size_t at) {
  return load<std::uint32_t>(bytes, at);
}
inline float load_f32(std::span<const std::byte> bytes, std::size_t at) { return load<float>(bytes, at); }

/// Returns bytes as the floats they are. Pre: they are aligned as those.
inline std::span<const float> as_floats(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const float*>(bytes.data()), bytes.size() / sizeof(float)};
}

/// Appends a value's bytes.
template <class T>
void append(std::vector<std::byte>& out, const T& value) {
  const auto* first = reinterpret_cast<const std::byte*>(&value);
  out.insert(out.end(), first, first + sizeof value);
}

inline void append_bytes(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

/// Returns where the next multiple of 4 is: what glTF aligns views and elements to.
constexpr std::size_t padded_to_four(std::size_t size) { return (size + 3) / 4 * 4; }

/// Appends a number seven bits a byte, the lowest first; all bytes but the last have the highest bit.
inline void append_varint(std::vector<std::byte>& out, std::uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<std::byte>((value & 0x7f) | 0x80));
  out.push_back(static_cast<std::byte>(value));
}

/// Returns the bytes as text, unchecked.
inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Returns the text without UTF-8's byte order mark, where it begins with one.
inline std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xef\xbb\xbf";
  return text.substr(text.starts_with(kMark) ? kMark.size() : 0);
}

}  // namespace lodestone::detail
