#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <lodestone/core/detail/text.h>

namespace lodestone::tool {

/// Rows of text, printed with their columns aligned: the first to the left, the others to the right.
class TextTable {
 public:
  explicit TextTable(std::vector<std::string> header) { add(std::move(header)); }
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  /// Prints to standard output.
  void print() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

using detail::number_text;

/// Returns a length as a share of the diagonal, e.g. `0.083%`.
std::string percent_text(double length, double diagonal);

}  // namespace lodestone::tool
