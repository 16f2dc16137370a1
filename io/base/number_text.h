#pragma once

#include <optional>
#include <string_view>

namespace lodestone::detail {

/// Returns the float nearest to a decimal number, "inf" or "nan"; a leading '+' is allowed, nothing else may follow.
std::optional<float> parse_float(std::string_view token);

/// Returns the double nearest to a decimal number, as std::from_chars reads one; nothing else may follow, and it fits.
std::optional<double> parse_double(std::string_view token);

/// Returns a decimal integer that fills the token and fits.
std::optional<long long> parse_integer(std::string_view token);

/// What stands between words of a line; line ends count as `next_token` meets them.
constexpr bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r' && c != '\n'); }

/// Cuts the next token off the front of `line`: what stands between blanks; empty at the end.
inline std::string_view next_token(std::string_view& line) {
  const char* at = line.data();
  const char* const end = at + line.size();
  while (at != end && is_blank(*at)) ++at;
  const char* const first = at;
  while (at != end && !is_blank(*at)) ++at;
  line = {at, static_cast<std::size_t>(end - at)};
  return {first, static_cast<std::size_t>(at - first)};
}

/// Returns where the first line end stands in `rest`, its size where there is none.
std::size_t line_length(std::string_view rest);

/// Cuts the next line off the front of `rest`, without its end ("\n", "\r\n" or "\r").
std::string_view next_line(std::string_view& rest);

}  // namespace lodestone::detail
