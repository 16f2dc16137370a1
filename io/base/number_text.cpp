// Numbers of few digits, as files have them, are read here: what their digits say is a whole number, which a power of
// ten scales. Where a double holds both exactly, one multiplication or division rounds correctly (W. D. Clinger, "How
// to Read Floating Point Numbers Accurately", PLDI 1990). Rounding that double to float is right, too, unless it lies
// in the middle of two floats, since it may have been rounded to there. All others are for std::from_chars.

#include "base/number_text.h"

#include <array>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>

namespace lodestone::detail {
namespace {

constexpr int kMostDigits = 19;  // that 64 bits hold, whichever they are
constexpr std::uint64_t kLargestExact = std::uint64_t{1} << 53;
constexpr std::array<double, 23> kPowersOfTen = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                                 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

constexpr bool is_digit(char c) { return c >= '0' && c <= '9'; }

/// (−1)^negative · digits · 10^exponent
struct Decimal {
  std::uint64_t digits = 0;
  int exponent = 0;
  bool negative = false;
};

/// Reads the characters of digits, of which there may be none, and returns where they end.
const char* read_digits(const char* at, const char* end, std::uint64_t& digits) {
  for (; at != end && is_digit(*at); ++at) digits = 10 * digits + static_cast<std::uint64_t>(*at - '0');
  return at;
}

/// Returns an exponent of one or two digits behind its 'e'; nothing else may follow.
std::optional<int> read_exponent(std::string_view text) {
  const bool negative = text.starts_with('-');
  if (negative || text.starts_with('+')) text.remove_prefix(1);
  if (text.empty() || text.size() > 2) return std::nullopt;
  std::uint64_t value = 0;
  if (read_digits(text.data(), text.data() + text.size(), value) != text.data() + text.size()) return std::nullopt;
  return negative ? -static_cast<int>(value) : static_cast<int>(value);
}

/// Reads a token such as "-12.5e-3". Nothing for one that is too long, or no number as they mostly look.
std::optional<Decimal> read_decimal(std::string_view token) {
  const char* at = token.data();
  const char* const end = at + token.size();
  Decimal decimal;
  if (at != end && *at == '-') decimal.negative = true, ++at;
  const char* const first = at;
  at = read_digits(at, end, decimal.digits);
  std::ptrdiff_t digit_count = at - first;
  if (at != end && *at == '.') {
    const char* const point = at++;
    at = read_digits(at, end, decimal.digits);
    decimal.exponent = static_cast<int>(point + 1 - at);
    digit_count += at - point - 1;
  }
  if (digit_count == 0 || digit_count > kMostDigits) return std::nullopt;
  if (at == end) return decimal;
  if (*at != 'e' && *at != 'E') return std::nullopt;
  const auto exponent = read_exponent({at + 1, static_cast<std::size_t>(end - at - 1)});
  if (!exponent) return std::nullopt;
  decimal.exponent += *exponent;
  return decimal;
}

/// Returns the nearest double, where digits and power are exact ones.
std::optional<double> nearest_double(const Decimal& decimal) {
  constexpr int kLargestPower = static_cast<int>(kPowersOfTen.size()) - 1;
  if (decimal.digits > kLargestExact || decimal.exponent < -kLargestPower || decimal.exponent > kLargestPower)
    return std::nullopt;
  auto value = static_cast<double>(decimal.digits);
  if (decimal.exponent < 0)
    value /= kPowersOfTen[static_cast<std::size_t>(-decimal.exponent)];
  else if (decimal.exponent > 0)
    value *= kPowersOfTen[static_cast<std::size_t>(decimal.exponent)];
  return decimal.negative ? -value : value;
}

/// Whether a double lies in the middle of two floats, among those that `nearest_double` makes: none is too small to be
/// a float of full precision, or too large for one.
bool is_between_floats(double value) {
  constexpr std::uint64_t kBeyondFloat = (std::uint64_t{1} << 29) - 1, kHalf = std::uint64_t{1} << 28;
  return (std::bit_cast<std::uint64_t>(value) & kBeyondFloat) == kHalf;
}

template <class T>
std::from_chars_result parse(std::string_view token, T& value) {
  return std::from_chars(token.data(), token.data() + token.size(), value);
}

bool filled(const std::from_chars_result& result, std::string_view token) {
  return result.ptr == token.data() + token.size();
}

/// Reads any number, to float at once.
std::optional<float> parse_any_float(std::string_view token) {
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

}  // namespace

std::optional<float> parse_float(std::string_view token) {
  if (const auto decimal = read_decimal(token))
    if (const auto value = nearest_double(*decimal); value && !is_between_floats(*value))
      return static_cast<float>(*value);
  return parse_any_float(token);
}

std::optional<double> parse_double(std::string_view token) {
  if (const auto decimal = read_decimal(token))
    if (const auto value = nearest_double(*decimal)) return *value;
  double value = 0;
  const auto result = parse(token, value);
  if (result.ec != std::errc{} || !filled(result, token)) return std::nullopt;
  return value;
}

std::optional<long long> parse_integer(std::string_view token) {
  if (token.starts_with('+')) token.remove_prefix(1);
  constexpr std::size_t kAlwaysFits = 18;  // digits
  if (!token.empty() && token.size() <= kAlwaysFits) {
    std::uint64_t digits = 0;
    const char* const end = token.data() + token.size();
    if (read_digits(token.data(), end, digits) == end) return static_cast<long long>(digits);
  }
  long long value = 0;
  const auto result = parse(token, value);
  if (result.ec != std::errc{} || !filled(result, token)) return std::nullopt;
  return value;
}

std::size_t line_length(std::string_view rest) {
  // Eight characters at a time: a byte of `word ^ pattern` is zero where they agree, and the highest bits tell whether
  // one is, by the lowest that does.
  constexpr std::uint64_t kOnes = 0x0101010101010101, kHighest = 0x8080808080808080;
  const auto agreeing = [](std::uint64_t word, char c) {
    const std::uint64_t different = word ^ kOnes * static_cast<std::uint64_t>(c);
    return (different - kOnes) & ~different & kHighest;
  };
  std::size_t at = 0;
  for (; at + sizeof(std::uint64_t) <= rest.size(); at += sizeof(std::uint64_t)) {
    std::uint64_t word;
    std::memcpy(&word, rest.data() + at, sizeof word);
    const std::uint64_t found = agreeing(word, '\n') | agreeing(word, '\r');
    if (found != 0) return at + static_cast<std::size_t>(std::countr_zero(found)) / 8;
  }
  while (at < rest.size() && rest[at] != '\n' && rest[at] != '\r') ++at;
  return at;
}

std::string_view next_line(std::string_view& rest) {
  const std::string_view line = rest.substr(0, line_length(rest));
  rest.remove_prefix(line.size());
  if (rest.starts_with("\r\n"))
    rest.remove_prefix(2);
  else if (!rest.empty())
    rest.remove_prefix(1);
  return line;
}

}  // namespace lodestone::detail
