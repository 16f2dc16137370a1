#include "base/number_text.h"

#include <algorithm>
#include <charconv>

namespace lodestone::detail {
namespace {

template <class T>
std::from_chars_result parse(std::string_view token, T& value) {
  return std::from_chars(token.data(), token.data() + token.size(), value);
}

bool filled(const std::from_chars_result& result, std::string_view token) {
  return result.ptr == token.data() + token.size();
}

}  // namespace

std::optional<float> parse_float(std::string_view token) {
  if (token.starts_with('+')) token.remove_prefix(1);
  if (token.starts_with("-+") || token.starts_with('+')) return std::nullopt;
  float value = 0;
  const auto result = parse(token, value);
  if (!filled(result, token)) return std::nullopt;
  if (result.ec == std::errc{}) return value;
  if (result.ec != std::errc::result_out_of_range) return std::nullopt;
  // Beyond float's range from_chars gives no value. A double tells which end it is, and rounds to 0 or infinity.
  double wide = 0;
  if (parse(token, wide).ec != std::errc{}) return std::nullopt;
  return static_cast<float>(wide);
}

std::optional<long long> parse_integer(std::string_view token) {
  if (token.starts_with('+')) token.remove_prefix(1);
  long long value = 0;
  const auto result = parse(token, value);
  if (result.ec != std::errc{} || !filled(result, token)) return std::nullopt;
  return value;
}

std::string_view next_token(std::string_view& line) {
  constexpr std::string_view kBlanks = " \t\v\f\r";
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view token = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(token.size());
  return token;
}

std::string_view next_line(std::string_view& rest) {
  const std::string_view line = rest.substr(0, rest.find_first_of("\r\n"));
  rest.remove_prefix(line.size());
  if (rest.starts_with("\r\n"))
    rest.remove_prefix(2);
  else if (!rest.empty())
    rest.remove_prefix(1);
  return line;
}

}  // namespace lodestone::detail
