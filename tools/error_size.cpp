#include "error_size.h"

#include <charconv>
#include <cmath>
#include <string>

#include "messages.h"

namespace lodestone::tool {

Result<double> parse_number(std::string_view text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end || !std::isfinite(value)) {
    return fail(ErrorCode::InvalidArgument, quoted(text) + " is not a number");
  }
  return value;
}

Result<ErrorSize> parse_error_size(std::string_view text) {
  const bool relative = text.ends_with('%');
  const Result<double> number = parse_number(relative ? text.substr(0, text.size() - 1) : text);
  if (!number || *number < 0) {
    return fail(ErrorCode::InvalidArgument, quoted(text) +
                                                " is not an error: write 0.1% of the bounding-box diagonal, or a plain "
                                                "number of 0 or more in the file's units");
  }
  return ErrorSize{relative ? *number / 100 : *number, relative};
}

}  // namespace lodestone::tool
