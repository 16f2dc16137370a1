#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace lodestone::detail {

/// How long the pieces are about that a text is read in, side by side. Their number must not hang on that of threads.
inline constexpr std::size_t kPieceBytes = std::size_t{1} << 20;

/// Cuts a text behind line ends into pieces of about so many bytes that together are all of it, in its order; none
/// behind a line that a backslash continues. Texts without "\n" stay whole. Pre: piece_bytes > 0.
std::vector<std::string_view> split_at_lines(std::string_view text, std::size_t piece_bytes);

/// Lines that follow one another, of which some number are not blank.
struct Rows {
  std::string_view text;
  std::size_t count = 0;
};

/// The lines of a text that are not blank, counted in pieces side by side.
class TextRows {
 public:
  TextRows(std::string_view text, std::size_t piece_bytes);

  /// Cuts the next so many rows off the front, in their pieces; nothing where there are fewer.
  std::optional<std::vector<Rows>> take(std::size_t count);

 private:
  std::vector<Rows> pieces_;
  std::size_t next_ = 0;  ///< the first of them that is not taken
};

/// Moves what a piece has to the end of what those before it have.
template <class T>
void append_moved(std::vector<T>& all, std::vector<T>&& piece) {
  if (all.empty())
    all = std::move(piece);
  else
    all.insert(all.end(), piece.begin(), piece.end());
}

}  // namespace lodestone::detail
