#include "error_size.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string>

#include <lodestone/io/screen_coverage.h>

#include "messages.h"

namespace lodestone::tool {
namespace {

/// What one of a unit is.
struct UnitSize {
  double value = 1;
  ErrorUnit unit = ErrorUnit::File;
};

struct NamedUnit {
  std::string_view name;
  UnitSize size;
};

constexpr NamedUnit kUnits[] = {
    {"", {1, ErrorUnit::File}},       {"%", {0.01, ErrorUnit::Diagonal}}, {"um", {1e-6, ErrorUnit::Metre}},
    {"mm", {1e-3, ErrorUnit::Metre}}, {"cm", {1e-2, ErrorUnit::Metre}},   {"m", {1, ErrorUnit::Metre}},
    {"km", {1e3, ErrorUnit::Metre}},  {"in", {0.0254, ErrorUnit::Metre}}, {"ft", {0.3048, ErrorUnit::Metre}},
};

/// A number at the beginning of a text, and what follows it.
struct LeadingNumber {
  double value = 0;
  std::string_view rest;
};

std::optional<LeadingNumber> read_number(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || !std::isfinite(value)) return std::nullopt;
  return LeadingNumber{value, trimmed({stop, static_cast<std::size_t>(end - stop)})};
}

/// Reads the height of a screen: `1080p`, `1080`, `1920x1080`, `4k`.
std::optional<double> read_height(std::string_view text) {
  if (text == "4k" || text == "4K") return 2160;
  if (const std::size_t by = text.find('x'); by != text.npos) text.remove_prefix(by + 1);
  const auto height = read_number(text);
  if (!height || !(height->value >= 1) || (height->rest != "" && height->rest != "p")) return std::nullopt;
  return height->value;
}

std::optional<UnitSize> read_unit(std::string_view text) {
  if (text.starts_with("px")) {
    const std::string_view screen = trimmed(text.substr(2));
    const auto height = screen.empty()     ? kScreenHeight
                        : screen[0] == '@' ? read_height(trimmed(screen.substr(1)))
                                           : std::nullopt;
    if (!height) return std::nullopt;
    return UnitSize{1 / *height, ErrorUnit::Diagonal};
  }
  const auto* found =
      std::find_if(std::begin(kUnits), std::end(kUnits), [&](const NamedUnit& unit) { return unit.name == text; });
  return found == std::end(kUnits) ? std::nullopt : std::optional(found->size);
}

}  // namespace

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpaces = " \t\r\n";
  text.remove_prefix(std::min(text.find_first_not_of(kSpaces), text.size()));
  return text.substr(0, text.find_last_not_of(kSpaces) + 1);
}

Result<double> parse_number(std::string_view text) {
  const auto number = read_number(text);
  if (!number || !number->rest.empty()) return fail(ErrorCode::InvalidArgument, quoted(text) + " is not a number");
  return number->value;
}

Result<double> parse_share(std::string_view text) {
  const auto number = read_number(text);
  if (!number || (number->rest != "" && number->rest != "%"))
    return fail(ErrorCode::InvalidArgument, quoted(text) + " is not a share: write 0.5 or 50%");
  return number->rest == "%" ? number->value / 100 : number->value;
}

Result<ErrorSize> parse_error_size(std::string_view text) {
  const auto number = read_number(text);
  const auto unit = number ? read_unit(number->rest) : std::nullopt;
  if (!unit || number->value < 0) {
    return fail(
        ErrorCode::InvalidArgument,
        quoted(text) +
            " is not an error: write 0.1% of the bounding box's diagonal, 1px@1080p, a length such as 1mm, or a "
            "plain number of 0 or more in the file's units");
  }
  return ErrorSize{number->value * unit->value, unit->unit};
}

bool is_quantity(std::string_view text) {
  const auto number = read_number(text);
  return number && read_unit(number->rest).has_value();
}

bool is_unit(std::string_view text) { return !text.empty() && read_unit(text).has_value(); }

}  // namespace lodestone::tool
