#pragma once

#include <optional>
#include <string_view>

namespace lodestone::detail {

/// Returns the float nearest to a decimal number, "inf" or "nan"; a leading '+' is allowed, nothing else may follow.
std::optional<float> parse_float(std::string_view token);

/// Returns a decimal integer that fills the token and fits.
std::optional<long long> parse_integer(std::string_view token);

/// Cuts the next token off the front of `line`: what stands between blanks; empty at the end.
std::string_view next_token(std::string_view& line);

/// Cuts the next line off the front of `rest`, without its end ("\n", "\r\n" or "\r").
std::string_view next_line(std::string_view& rest);

}  // namespace lodestone::detail
