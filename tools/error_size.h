#pragma once

#include <string_view>

#include <lodestone/core/result.h>

namespace lodestone::tool {

/// A distance as a user writes it: `0.1%` of the bounding-box diagonal, or a plain number in the file's units.
struct ErrorSize {
  double value = 0;       ///< a share (0.001 for 0.1%) if relative, otherwise file units; ≥ 0
  bool relative = false;  ///< to the diagonal
};

/// Parses an error size. Errors: InvalidArgument, quoting the text.
Result<ErrorSize> parse_error_size(std::string_view text);

/// Parses a finite number that fills the whole text, whatever the locale. Errors: InvalidArgument, quoting the text.
Result<double> parse_number(std::string_view text);

}  // namespace lodestone::tool
