#include "text_table.h"

#include <algorithm>
#include <cstdio>

namespace lodestone::tool {
namespace {

std::vector<std::size_t> column_widths(const std::vector<std::vector<std::string>>& rows) {
  std::vector<std::size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (std::size_t i = 0; i < row.size(); ++i) widths[i] = std::max(widths[i], row[i].size());
  }
  return widths;
}

std::string line_of(const std::vector<std::string>& row, const std::vector<std::size_t>& widths) {
  std::string line;
  for (std::size_t i = 0; i < row.size(); ++i) {
    const std::string padding(widths[i] - row[i].size(), ' ');
    line += i == 0 ? row[i] + padding : "  " + padding + row[i];
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

}  // namespace

void TextTable::print() const {
  const std::vector<std::size_t> widths = column_widths(rows_);
  for (const auto& row : rows_) std::puts(line_of(row, widths).c_str());
}

std::string percent_text(double length, double diagonal) {
  if (length == 0) return "0%";
  return number_text(100 * length / diagonal, 3) + "%";
}

}  // namespace lodestone::tool
