// OFF, after the description of Geomview's "Object File Format" (OOGL): ASCII with normals, colours and texture
// coordinates of vertices, and colours of faces.
//
// Read here and not through Assimp, which loses triangles of files with comments or colours. Line ends count only
// behind what a vertex or a face must have: what still stands there is a colour. Files that say OFF and have a colour
// behind the first vertex's coordinates are taken as COFF.

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "base/number_text.h"
#include "mesh/polygon_soup.h"
#include "mesh/soup_file.h"
#include "mesh/vertex_color.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kLeastVertexBytes = 6;  // "0 0 0\n"
constexpr std::size_t kLeastFaceBytes = 2;

/// The words of a file, comments left out.
class Words {
 public:
  explicit Words(std::string_view rest) : rest_(rest) {}

  std::size_t line_number() const { return line_number_; }
  std::size_t bytes_left() const { return rest_.size() + line_.size(); }

  /// The next word on this line; empty at its end.
  std::string_view next_on_line() { return next_token(line_); }

  /// The next word, on whatever line; empty at the file's end.
  std::string_view next() {
    for (;;) {
      const std::string_view word = next_on_line();
      if (!word.empty() || rest_.empty()) return word;
      line_ = next_line(rest_);
      line_ = line_.substr(0, line_.find('#'));
      ++line_number_;
    }
  }

  /// Returns how many words are left on this line.
  std::size_t count_on_line() const {
    std::string_view line = line_;
    std::size_t count = 0;
    while (!next_token(line).empty()) ++count;
    return count;
  }

 private:
  std::string_view rest_, line_;
  std::size_t line_number_ = 0;
};

/// What the header's keyword says of vertices.
struct Keyword {
  bool normals = false, colors = false, texcoords = false;
  bool four_dimensions = false, any_dimensions = false;
};

/// Letters before "OFF", in whatever order they stand. Nothing for another word.
std::optional<Keyword> parse_keyword(std::string_view word) {
  if (!word.ends_with("OFF") && !word.ends_with("off")) return std::nullopt;
  word.remove_suffix(3);
  Keyword keyword;
  const auto take = [&](std::string_view letters, bool& flag) {
    if (flag || !word.starts_with(letters)) return false;
    word.remove_prefix(letters.size());
    return flag = true;
  };
  while (take("ST", keyword.texcoords) || take("st", keyword.texcoords) || take("C", keyword.colors) ||
         take("c", keyword.colors) || take("N", keyword.normals) || take("4", keyword.four_dimensions) ||
         take("n", keyword.any_dimensions)) {
  }
  return word.empty() ? std::optional(keyword) : std::nullopt;
}

/// Colours of the elements of one kind; those without one are white.
class ColorList {
 public:
  void add(std::size_t element, std::span<const float> color) {
    if (color.size() < 3) return;
    components_.resize(4 * element, kNone);
    components_.insert(components_.end(), color.begin(), color.begin() + 3);
    components_.push_back(color.size() > 3 ? color[3] : kNone);
    has_alpha_ |= color.size() > 3;
  }

  bool empty() const { return components_.empty(); }

  Attribute make(std::size_t element_count) {
    components_.resize(4 * element_count, kNone);
    const float range = color_range(components_);
    std::vector<float> kept;
    for (std::size_t i = 0; i < components_.size(); ++i)
      if (i % 4 < 3 || has_alpha_) kept.push_back(components_[i] == kNone ? 1 : components_[i] / range);
    return color_attribute(kept, has_alpha_ ? 4 : 3);
  }

 private:
  static constexpr float kNone = -1;
  std::vector<float> components_;
  bool has_alpha_ = false;
};

class OffReader {
 public:
  explicit OffReader(std::string_view text) : words_(text) {}

  Result<SoupFile> read() {
    LODESTONE_CHECK(read_header());
    LODESTONE_CHECK(read_vertices());
    LODESTONE_CHECK(read_faces());
    if (!words_.next().empty())
      file_.notes.push_back(text("what stands behind the ", face_count_, " faces that the header counts is left out"));
    add_attributes();
    if (color_map_faces_ > 0)
      file_.notes.push_back(text(color_map_faces_, " faces with a number of a colour map have no colour"));
    LODESTONE_TRY(file_.soup, to_triangles(std::move(polygons_), file_.notes));
    return std::move(file_);
  }

 private:
  tl::unexpected<Error> broken(const std::string& message) const {
    return fail(ErrorCode::Malformed, text("off: line ", words_.line_number(), ": ", message));
  }

  /// The keyword may lack; the counts may stand behind it, and that of edges may lack.
  Result<void> read_header() {
    std::string_view word = words_.next();
    if (const auto keyword = parse_keyword(word)) {
      keyword_ = *keyword;
      if (keyword_.four_dimensions || keyword_.any_dimensions)
        return fail(ErrorCode::Unsupported, text("off: '", word, "': only vertices of three dimensions are supported"));
      word = words_.next();
      if (word == "BINARY") return fail(ErrorCode::Unsupported, "off: binary files are not supported");
    } else if (!parse_integer(word)) {
      return fail(ErrorCode::Malformed, text("off: the file begins with '", word.substr(0, 16), "', not with 'OFF'"));
    }
    LODESTONE_TRY(vertex_count_, parse_count(word, "vertices", kLeastVertexBytes));
    const bool one_line = words_.count_on_line() > 0;
    LODESTONE_TRY(face_count_, parse_count(words_.next(), "faces", kLeastFaceBytes));
    if (one_line)
      while (!words_.next_on_line().empty()) continue;
    else
      words_.next();
    return {};
  }

  /// Refuses at once what the file has no room for.
  Result<std::size_t> parse_count(std::string_view word, const char* what, std::size_t least_bytes) const {
    const auto count = parse_integer(word);
    if (!count || *count < 0) return broken(text('\'', word, "' is not a count of ", what));
    const auto value = static_cast<std::size_t>(*count);
    if (value > words_.bytes_left() / least_bytes + 1)
      return broken(text(value, ' ', what, " exceed the ", words_.bytes_left(), " bytes that are left"));
    if (value >= kNoIndex) return fail(ErrorCode::LimitExceeded, text("off: ", value, ' ', what, " are too many"));
    return value;
  }

  Result<float> next_float() {
    const std::string_view word = words_.next();
    const auto value = parse_float(word);
    if (word.empty()) return broken("the file ends");
    if (!value) return broken(text('\'', word, "' is not a number"));
    return *value;
  }

  Result<std::array<float, 3>> next_vector() {
    std::array<float, 3> v{};
    for (float& component : v) {
      LODESTONE_TRY(component, next_float());
    }
    return v;
  }

  Result<std::vector<float>> rest_of_line() {
    std::vector<float> numbers;
    for (std::string_view word; !(word = words_.next_on_line()).empty();) {
      const auto value = parse_float(word);
      if (!value) return broken(text('\'', word, "' is not a number"));
      numbers.push_back(*value);
    }
    return numbers;
  }

  Result<void> read_vertices() {
    for (std::size_t i = 0; i < vertex_count_; ++i) {
      LODESTONE_TRY(const auto p, next_vector());
      polygons_.positions.push_back({p[0], p[1], p[2]});
      if (keyword_.normals) {
        LODESTONE_TRY(const auto n, next_vector());
        normals_.insert(normals_.end(), n.begin(), n.end());
      }
      LODESTONE_CHECK(read_vertex_extras(i));
    }
    return {};
  }

  /// A colour of three or four components, then texture coordinates.
  Result<void> read_vertex_extras(std::size_t vertex) {
    const std::size_t texcoord_words = keyword_.texcoords ? 2 : 0, count = words_.count_on_line();
    if (vertex == 0) keyword_.colors |= count == 3 || count == 4;
    if (!keyword_.colors && !keyword_.texcoords) return {};  // what else is on the line is another vertex
    LODESTONE_TRY(const std::vector<float> extras, rest_of_line());
    if (extras.size() < texcoord_words) return broken(text("a vertex without texture coordinates"));
    const std::size_t color_words = extras.size() - texcoord_words;
    if (color_words != 0 && color_words != 3 && color_words != 4)
      return broken(text(color_words, " numbers where a colour of 3 or 4 is expected"));
    vertex_colors_.add(vertex, std::span(extras).first(color_words));
    if (keyword_.texcoords) texcoords_.insert(texcoords_.end(), {extras[color_words], 1 - extras[color_words + 1]});
    return {};
  }

  Result<void> read_faces() {
    for (std::size_t i = 0; i < face_count_; ++i) {
      const std::string_view word = words_.next();
      if (word.empty()) return broken(text("the file ends after ", i, " of ", face_count_, " faces"));
      LODESTONE_TRY(const std::size_t corner_count, parse_count(word, "corners", 2));
      for (std::size_t k = 0; k < corner_count; ++k) LODESTONE_CHECK(read_corner());
      if (polygons_.corners.size() >= kNoIndex) return fail(ErrorCode::LimitExceeded, "off: too many corners");
      polygons_.sizes.push_back(static_cast<Index>(corner_count));
      LODESTONE_TRY(const std::vector<float> color, rest_of_line());
      if (color.size() == 1) ++color_map_faces_;
      face_colors_.add(i, color);
    }
    return {};
  }

  Result<void> read_corner() {
    const std::string_view word = words_.next();
    const auto index = parse_integer(word);
    if (!index) return broken(text('\'', word, "' is not a vertex's number"));
    if (*index < 0 || *index >= static_cast<long long>(vertex_count_))
      return broken(text("vertex index ", *index, " is out of range: there are ", vertex_count_));
    polygons_.corners.push_back(static_cast<Index>(*index));
    return {};
  }

  void add_attributes() {
    auto& attributes = polygons_.vertex_attributes;
    if (keyword_.normals) attributes.push_back(float_attribute("NORMAL", 3, normals_));
    if (keyword_.texcoords) attributes.push_back(float_attribute("TEXCOORD_0", 2, texcoords_));
    if (!vertex_colors_.empty()) attributes.push_back(vertex_colors_.make(vertex_count_));
    if (face_colors_.empty()) return;
    if (vertex_colors_.empty())
      polygons_.face_attributes.push_back(face_colors_.make(face_count_));
    else
      file_.notes.push_back("the colours of faces are left out, since vertices have colours, too");
  }

  Words words_;
  Keyword keyword_;
  std::size_t vertex_count_ = 0, face_count_ = 0;
  PolygonSoup polygons_;
  std::vector<float> normals_, texcoords_;
  ColorList vertex_colors_, face_colors_;
  std::size_t color_map_faces_ = 0;
  SoupFile file_;
};

}  // namespace

Result<SoupFile> read_off(std::span<const std::byte> bytes) {
  return OffReader(without_byte_order_mark(as_text(bytes))).read();
}

}  // namespace lodestone::detail
