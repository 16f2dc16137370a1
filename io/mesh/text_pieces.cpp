#include "mesh/text_pieces.h"

#include <lodestone/core/parallel.h>

#include "base/number_text.h"

namespace lodestone::detail {
namespace {

/// Returns the end of a line that ends at `from` or behind it, and that no backslash continues.
std::size_t next_cut(std::string_view text, std::size_t from) {
  for (;;) {
    const std::size_t newline = text.find('\n', from);
    if (newline == text.npos) return text.size();
    std::string_view line = text.substr(0, newline);
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (!line.ends_with('\\')) return newline + 1;
    from = newline + 1;
  }
}

bool is_blank_line(std::string_view line) { return next_token(line).empty(); }

std::size_t count_rows(std::string_view text) {
  std::size_t count = 0;
  while (!text.empty()) count += !is_blank_line(next_line(text));
  return count;
}

/// Cuts off the front of `text` what ends with row number `count`.
std::string_view cut_rows(std::string_view& text, std::size_t count) {
  const char* const begin = text.data();
  while (count > 0) count -= !is_blank_line(next_line(text));
  return {begin, static_cast<std::size_t>(text.data() - begin)};
}

}  // namespace

TextRows::TextRows(std::string_view text, std::size_t piece_bytes) {
  for (const std::string_view piece : split_at_lines(text, piece_bytes)) pieces_.push_back({piece, 0});
  for_each_in_parallel(pieces_.size(), [&](std::size_t i) { pieces_[i].count = count_rows(pieces_[i].text); });
}

std::optional<std::vector<Rows>> TextRows::take(std::size_t count) {
  std::vector<Rows> taken;
  while (count > 0) {
    if (next_ == pieces_.size()) return std::nullopt;
    Rows& piece = pieces_[next_];
    if (piece.count > count) {
      taken.push_back({cut_rows(piece.text, count), count});
      piece.count -= count;
    } else {
      taken.push_back(piece);
      ++next_;
    }
    count -= taken.back().count;
  }
  return taken;
}

std::vector<std::string_view> split_at_lines(std::string_view text, std::size_t piece_bytes) {
  std::vector<std::string_view> pieces;
  while (!text.empty()) {
    const std::size_t size = text.size() <= piece_bytes ? text.size() : next_cut(text, piece_bytes - 1);
    pieces.push_back(text.substr(0, size));
    text.remove_prefix(size);
  }
  return pieces;
}

}  // namespace lodestone::detail
