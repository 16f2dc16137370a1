#include "mesh/obj_piece.h"

#include <charconv>
#include <cstdint>
#include <utility>

#include <lodestone/core/detail/text.h>

#include "base/number_text.h"
#include "mesh/read_mtl.h"

namespace lodestone::detail {
namespace {

class PieceReader {
 public:
  explicit PieceReader(std::string_view rest) : rest_(rest) {}

  ObjPiece read() {
    while (!rest_.empty() && !piece_.failure) read_statement(logical_line());
    piece_.line_count = line_number_;
    return std::move(piece_);
  }

 private:
  /// A line, with those it continues on after a backslash.
  std::string_view logical_line() {
    ++line_number_;
    std::string_view line = next_line(rest_);
    if (!line.ends_with('\\')) return line;
    joined_.clear();
    while (line.ends_with('\\')) {
      joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
      line = next_line(rest_);
      ++line_number_;
    }
    return joined_.append(line);
  }

  void read_statement(std::string_view line) {
    if (line.starts_with("#MRGB")) return read_mrgb(line.substr(5));
    const std::string_view whole = line;
    line = line.substr(0, line.find('#'));
    const std::string_view keyword = next_token(line);
    if (keyword == "v") return read_position(line);
    if (keyword == "f" || keyword == "fo") return read_face(line);
    if (keyword == "vt") return read_texcoord(line);
    if (keyword == "vn") return read_normal(line);
    if (keyword == "usemtl") {
      piece_.materials.push_back({piece_.sizes.size(), std::string(trimmed(words(whole)))});
    } else if (keyword == "mtllib") {
      piece_.libraries.emplace_back(words(whole));
    } else if (keyword == "p" || keyword == "l") {
      ++piece_.points_and_lines;
    } else if (keyword == "curv" || keyword == "curv2" || keyword == "surf") {
      ++piece_.free_forms;
    }
  }

  /// Returns what stands behind the keyword: names may hold a '#'.
  static std::string_view words(std::string_view line) {
    line = without_comment(line);
    next_token(line);
    return line;
  }

  void fail_here(ErrorCode code, std::string message) {
    if (!piece_.failure) piece_.failure = ObjPiece::Failure{code, line_number_, std::move(message)};
  }
  void broken(std::string message) { fail_here(ErrorCode::Malformed, std::move(message)); }

  /// Reads `required` to `values.size()` numbers and returns how many; those not there stay as they are.
  template <std::size_t N>
  std::size_t read_numbers(std::string_view& line, std::array<float, N>& values, std::size_t required) {
    std::size_t count = 0;
    for (std::string_view token; count < N && !(token = next_token(line)).empty(); ++count) {
      const auto value = parse_float(token);
      if (!value) {
        broken(text("'", token, "' is not a number"));
        return count;
      }
      values[count] = *value;
    }
    if (count < required) broken(text(count, " numbers where ", required, " are needed"));
    return count;
  }

  /// Three coordinates, with a weight that is not looked at, or a colour of three or four components.
  void read_position(std::string_view line) {
    std::array<float, 7> v{0, 0, 0, 1, 1, 1, 1};
    const std::size_t count = read_numbers(line, v, 3);
    piece_.positions.push_back({v[0], v[1], v[2]});
    if (count >= 6) {
      piece_.colors.resize(piece_.positions.size() - 1, kNoColor);
      piece_.colors.push_back({v[3], v[4], v[5], count == 7 ? v[6] : -1});
    }
    check_room(piece_.positions.size());
  }

  /// Blocks of eight hexadecimal digits, one for each vertex: a mask, red, green and blue.
  void read_mrgb(std::string_view line) {
    const std::string_view digits = next_token(line);
    for (std::size_t at = 0; at + 8 <= digits.size(); at += 8) {
      std::uint32_t value = 0;
      const auto result = std::from_chars(digits.data() + at, digits.data() + at + 8, value, 16);
      if (result.ptr != digits.data() + at + 8) return broken(text("'", digits.substr(at, 8), "' is not a colour"));
      const auto component = [&](int shift) { return static_cast<float>(value >> shift & 0xff) / 255; };
      piece_.painted.push_back({component(16), component(8), component(0), -1});
    }
  }

  void read_texcoord(std::string_view line) {
    std::array<float, 3> v{};
    read_numbers(line, v, 1);
    piece_.texcoords.push_back({v[0], 1 - v[1]});  // OBJ's v points up, that of TEXCOORD_0 down.
    check_room(piece_.texcoords.size());
  }

  void read_normal(std::string_view line) {
    std::array<float, 3> v{};
    read_numbers(line, v, 3);
    piece_.normals.push_back(v);
    check_room(piece_.normals.size());
  }

  void check_room(std::size_t count) {
    if (count >= kNoIndex) fail_here(ErrorCode::LimitExceeded, "more elements than 32-bit indices can name");
  }

  Index element_count(ObjKind kind) const {
    return static_cast<Index>(kind == kPosition   ? piece_.positions.size()
                              : kind == kTexcoord ? piece_.texcoords.size()
                                                  : piece_.normals.size());
  }

  /// Turns a corner's 1-based index into a 0-based one. An element may stand after its use, so the largest is noted,
  /// with its line.
  Index resolve(long long index, ObjKind kind, std::size_t corner) {
    if (index <= 0 || index >= static_cast<long long>(kNoIndex)) {
      piece_.relative.push_back({kind, index, corner, element_count(kind), line_number_});
      return kNoIndex;
    }
    const auto resolved = static_cast<Index>(index - 1);
    ObjPiece::Reference& last = piece_.last_reference[kind];
    if (last.line == 0 || resolved > last.index) last = {resolved, line_number_};
    return resolved;
  }

  std::size_t corner_count() const { return piece_.corners[kPosition].size(); }

  /// Reads "1", "1/2", "1//3" or "1/2/3"; false for anything else.
  bool read_corner(std::string_view token) {
    const std::size_t corner = corner_count();
    bool has_position = false;
    for (int kind = 0; kind < kObjKindCount; ++kind) {
      std::size_t length = 0;
      while (length < token.size() && token[length] != '/') ++length;
      if (length > 0) {
        const auto index = parse_integer(token.substr(0, length));
        if (!index) return false;
        std::vector<Index>& elements = piece_.corners[kind];
        const Index element = resolve(*index, static_cast<ObjKind>(kind), corner);
        elements.resize(corner, kNoIndex);
        elements.push_back(element);
        has_position |= kind == kPosition;
      }
      if (length == token.size()) return has_position;
      token.remove_prefix(length + 1);
    }
    return has_position && token.empty();
  }

  void read_face(std::string_view line) {
    const std::size_t first = corner_count();
    for (std::string_view token; !(token = next_token(line)).empty();)
      if (!read_corner(token)) return broken(text("'", token, "' is not a corner of a face"));
    piece_.sizes.push_back(static_cast<Index>(corner_count() - first));
    check_room(corner_count());
  }

  std::string_view rest_;
  std::string joined_;
  std::size_t line_number_ = 0;
  ObjPiece piece_;
};

}  // namespace

ObjPiece read_obj_piece(std::string_view text) { return PieceReader(text).read(); }

}  // namespace lodestone::detail
