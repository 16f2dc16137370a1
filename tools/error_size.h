#pragma once

#include <string_view>

#include <lodestone/core/result.h>

namespace lodestone::tool {

/// What the number of an error is in.
enum class ErrorUnit {
  File,      ///< the file's own unit: 0.1
  Diagonal,  ///< a share of the bounding box's diagonal: 0.1%, or pixels: 1px@1080p
  Metre,     ///< a length in the world: 1mm, 2cm, 0.5in
};

/// A distance as a user writes it.
///
/// `1px@1080p` is the error that covers one pixel where the bounding box's diagonal covers the 1,080 pixels of the
/// screen's height: 1/1080 of the diagonal. Nearer, it covers more of them, farther away fewer.
struct ErrorSize {
  double value = 0;  ///< a share (0.001 for 0.1%) of the diagonal, otherwise file units or metres; ≥ 0
  ErrorUnit unit = ErrorUnit::File;
};

/// Parses an error size: a number and, with or without a space between, `%`, `px@HEIGHT`, a unit of length, or nothing.
/// Errors: InvalidArgument, quoting the text.
Result<ErrorSize> parse_error_size(std::string_view text);

/// Whether a text is what may follow the number of an error size.
bool is_unit(std::string_view text);

/// Whether a text is a number of any sign, alone or with its unit.
bool is_quantity(std::string_view text);

/// Parses a share: `0.1` or `10%`. Errors: InvalidArgument, quoting the text.
Result<double> parse_share(std::string_view text);

/// Parses a finite number that fills the whole text, whatever the locale; spaces around it do not count.
/// Errors: InvalidArgument, quoting the text.
Result<double> parse_number(std::string_view text);

/// Returns a text without the spaces around it.
std::string_view trimmed(std::string_view text);

}  // namespace lodestone::tool
