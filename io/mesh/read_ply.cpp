// PLY: ASCII and binary of both byte orders, after Greg Turk's "The PLY Polygon File Format" (1994); textures as
// MeshLab writes them: `texcoord` and `texnumber` of faces, and the images' names in comments.

#include <algorithm>
#include <array>
#include <bit>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/core/parallel.h>

#include "base/bytes.h"
#include "base/files_beside.h"
#include "base/number_text.h"
#include "mesh/image_file.h"
#include "mesh/polygon_soup.h"
#include "mesh/soup_file.h"
#include "mesh/text_pieces.h"
#include "mesh/vertex_color.h"

namespace lodestone::detail {
namespace {

enum class Format { Ascii, LittleEndian, BigEndian };
enum class Scalar { Int8, UInt8, Int16, UInt16, Int32, UInt32, Float32, Float64 };

struct ScalarName {
  std::string_view name;
  Scalar type;
};
constexpr std::array<ScalarName, 16> kScalarNames = {{{"char", Scalar::Int8},
                                                      {"int8", Scalar::Int8},
                                                      {"uchar", Scalar::UInt8},
                                                      {"uint8", Scalar::UInt8},
                                                      {"short", Scalar::Int16},
                                                      {"int16", Scalar::Int16},
                                                      {"ushort", Scalar::UInt16},
                                                      {"uint16", Scalar::UInt16},
                                                      {"int", Scalar::Int32},
                                                      {"int32", Scalar::Int32},
                                                      {"uint", Scalar::UInt32},
                                                      {"uint32", Scalar::UInt32},
                                                      {"float", Scalar::Float32},
                                                      {"float32", Scalar::Float32},
                                                      {"double", Scalar::Float64},
                                                      {"float64", Scalar::Float64}}};
constexpr std::array<std::size_t, 8> kScalarBytes = {1, 1, 2, 2, 4, 4, 4, 8};

struct Property {
  std::string name;
  Scalar type = Scalar::Float32;
  std::optional<Scalar> list_count;  ///< set: a list, whose length has this type
};

struct Element {
  std::string name;
  std::size_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Format format = Format::Ascii;
  std::vector<Element> elements;
  std::vector<std::string> textures;  ///< of comments "TextureFile NAME"
};

tl::unexpected<Error> broken(std::string message) { return fail(ErrorCode::Malformed, "ply: " + std::move(message)); }

tl::unexpected<Error> too_many_corners() { return fail(ErrorCode::LimitExceeded, "ply: too many corners"); }

Result<Scalar> scalar_named(std::string_view name) {
  for (const ScalarName& known : kScalarNames)
    if (known.name == name) return known.type;
  return broken(text("unknown type '", name, "'"));
}

Result<Format> format_named(std::string_view name) {
  if (name == "ascii") return Format::Ascii;
  if (name == "binary_little_endian") return Format::LittleEndian;
  if (name == "binary_big_endian") return Format::BigEndian;
  return broken(text("unknown format '", name, "'"));
}

Result<Property> parse_property(std::string_view line) {
  Property property;
  std::string_view token = next_token(line);
  if (token == "list") {
    LODESTONE_TRY(property.list_count, scalar_named(next_token(line)));
    token = next_token(line);
  }
  LODESTONE_TRY(property.type, scalar_named(token));
  property.name = next_token(line);
  return property;
}

Result<Element> parse_element(std::string_view line) {
  Element element;
  element.name = next_token(line);
  const std::string_view token = next_token(line);
  const auto count = parse_integer(token);
  if (!count || *count < 0) return broken(text("element ", element.name, ": '", token, "' is not a count"));
  element.count = static_cast<std::size_t>(*count);
  return element;
}

/// Reads up to and including "end_header"; leaves the body in `rest`.
Result<Header> parse_header(std::string_view& rest) {
  Header header;
  while (!rest.empty()) {
    std::string_view line = next_line(rest);
    const std::string_view keyword = next_token(line);
    if (keyword == "end_header") return header;
    if (keyword == "format") {
      LODESTONE_TRY(header.format, format_named(next_token(line)));
    } else if (keyword == "element") {
      LODESTONE_TRY(Element element, parse_element(line));
      header.elements.push_back(std::move(element));
    } else if (keyword == "comment") {
      if (next_token(line) == "TextureFile") header.textures.emplace_back(line);
    } else if (keyword == "property") {
      if (header.elements.empty()) return broken("a property stands before the first element");
      LODESTONE_TRY(Property property, parse_property(line));
      header.elements.back().properties.push_back(std::move(property));
    }
  }
  return broken("the header does not end");
}

/// The numbers of the body, in order. After the first failure every number is 0 and failed() is true.
class Body {
 public:
  Body(Format format, std::string_view rest) : format_(format), rest_(rest) {}

  Format format() const { return format_; }
  bool failed() const { return failed_; }
  std::string_view rest() const { return rest_; }
  std::size_t bytes_left() const { return rest_.size(); }

  double number(Scalar type) { return format_ == Format::Ascii ? ascii_number(type) : binary_number(type); }

  void skip(const Property& property) {
    if (!property.list_count) {
      number(property.type);
      return;
    }
    for (double left = number(*property.list_count); left > 0 && !failed_; --left) number(property.type);
  }

  /// Leaves out what stands before a place in the rest.
  void skip_to(const char* at) { rest_.remove_prefix(static_cast<std::size_t>(at - rest_.data())); }

  /// Returns what else stands on the line of an ASCII element that has been read; such files are not what they say.
  std::string_view rest_of_line() const {
    if (format_ != Format::Ascii) return {};
    std::string_view line = rest_.substr(0, line_length(rest_));
    return next_token(line);
  }

  /// The fewest bytes an element can take: what bounds a count before anything is read.
  std::size_t least_bytes(const Element& element) const {
    std::size_t bytes = 0;
    for (const Property& p : element.properties)
      bytes += format_ == Format::Ascii ? 2 : kScalarBytes[static_cast<int>(p.list_count.value_or(p.type))];
    return bytes;
  }

 private:
  double fail_now() {
    failed_ = true;
    rest_ = {};
    return 0;
  }

  double ascii_number(Scalar type) {
    std::size_t blanks = 0;
    while (blanks < rest_.size() && (is_blank(rest_[blanks]) || rest_[blanks] == '\n')) ++blanks;
    rest_.remove_prefix(blanks);
    std::size_t length = 0;
    while (length < rest_.size() && !is_blank(rest_[length]) && rest_[length] != '\n') ++length;
    const std::string_view token = rest_.substr(0, length);
    rest_.remove_prefix(length);
    if (type == Scalar::Float32)  // rounded once, to float
      if (const auto value = parse_float(token)) return static_cast<double>(*value);
    const auto value = parse_double(token);
    return value ? *value : fail_now();
  }

  double binary_number(Scalar type) {
    switch (type) {
      case Scalar::Int8:
        return raw<std::int8_t>();
      case Scalar::UInt8:
        return raw<std::uint8_t>();
      case Scalar::Int16:
        return raw<std::int16_t>();
      case Scalar::UInt16:
        return raw<std::uint16_t>();
      case Scalar::Int32:
        return raw<std::int32_t>();
      case Scalar::UInt32:
        return raw<std::uint32_t>();
      case Scalar::Float32:
        return static_cast<double>(raw<float>());
      case Scalar::Float64:
        return raw<double>();
    }
    return fail_now();
  }

  template <class T>
  T raw() {
    if (rest_.size() < sizeof(T)) return static_cast<T>(fail_now());
    std::array<char, sizeof(T)> bytes;
    std::copy_n(rest_.begin(), sizeof(T), bytes.begin());
    rest_.remove_prefix(sizeof(T));
    if (format_ == Format::BigEndian) std::reverse(bytes.begin(), bytes.end());
    return std::bit_cast<T>(bytes);
  }

  Format format_;
  std::string_view rest_;
  bool failed_ = false;
};

/// Where a property goes: components of one vector of doubles.
enum Slot { kX, kY, kZ, kNx, kNy, kNz, kRed, kGreen, kBlue, kAlpha, kU, kV, kSlotCount };

struct SlotName {
  std::string_view name;
  Slot slot;
};
constexpr std::array kSlotNames = std::to_array<SlotName>({
    {"x", kX},
    {"y", kY},
    {"z", kZ},
    {"nx", kNx},
    {"ny", kNy},
    {"nz", kNz},
    {"red", kRed},
    {"green", kGreen},
    {"blue", kBlue},
    {"alpha", kAlpha},
    {"r", kRed},
    {"g", kGreen},
    {"b", kBlue},
    {"a", kAlpha},
    {"diffuse_red", kRed},
    {"diffuse_green", kGreen},
    {"diffuse_blue", kBlue},
    {"diffuse_alpha", kAlpha},
    {"s", kU},
    {"t", kV},
    {"u", kU},
    {"v", kV},
    {"texture_u", kU},
    {"texture_v", kV},
    {"texture_s", kU},
    {"texture_t", kV},
});

/// What to divide a colour's components by; of a type whose range says nothing, only the values can tell.
float color_divisor(Scalar type, std::span<const float> components) {
  if (type == Scalar::UInt8) return 255;
  if (type == Scalar::UInt16) return 65535;
  return color_range(components);
}

/// The single numbers of an element's properties, by slot.
class Slots {
 public:
  explicit Slots(const Element& element) : element_(element) {
    for (const Property& property : element.properties) {
      const auto known = std::find_if(kSlotNames.begin(), kSlotNames.end(),
                                      [&](const SlotName& s) { return s.name == property.name; });
      slots_.push_back(known == kSlotNames.end() || property.list_count ? kSlotCount : known->slot);
    }
  }

  bool has(std::initializer_list<Slot> wanted) const {
    return std::all_of(wanted.begin(), wanted.end(),
                       [&](Slot slot) { return std::find(slots_.begin(), slots_.end(), slot) != slots_.end(); });
  }
  bool known(std::size_t property) const { return slots_[property] != kSlotCount; }
  bool is_color(std::size_t property) const { return slots_[property] >= kRed && slots_[property] <= kAlpha; }
  void set(std::size_t property, double value) { values_[slots_[property]] = value; }
  float operator[](Slot slot) const { return static_cast<float>(values_[slot]); }

  /// Appends red, green and blue, and alpha where there is one.
  void append_color(std::vector<float>& colors) const {
    colors.insert(colors.end(), {(*this)[kRed], (*this)[kGreen], (*this)[kBlue]});
    if (has({kAlpha})) colors.push_back((*this)[kAlpha]);
  }

  Attribute make_colors(std::vector<float> components) const {
    const auto red = std::find(slots_.begin(), slots_.end(), kRed) - slots_.begin();
    const float divisor = color_divisor(element_.properties[static_cast<std::size_t>(red)].type, components);
    for (float& component : components) component /= divisor;
    return color_attribute(components, has({kAlpha}) ? 4 : 3);
  }

 private:
  const Element& element_;
  std::vector<Slot> slots_;
  std::array<double, kSlotCount + 1> values_{};
};

/// Reads an element's last line to its end.
Result<void> check_end(const Body& body, const Element& element, std::size_t number) {
  const std::string_view more = body.rest_of_line();
  if (more.empty()) return {};
  return broken(text("element ", element.name, ' ', number, ": '", more, "' stands behind the ",
                     element.properties.size(), " properties that the header says"));
}

void read_single(Body& body, const Property& property, std::size_t number, Slots& slots) {
  if (property.list_count)
    body.skip(property);
  else
    slots.set(number, body.number(property.type));
}

/// Consecutive vertices.
struct VertexRows {
  std::vector<Vec3f> positions;
  std::vector<float> normals, texcoords, colors;  ///< empty, or of every vertex

  void append(VertexRows&& more) {
    append_moved(positions, std::move(more.positions));
    append_moved(normals, std::move(more.normals));
    append_moved(texcoords, std::move(more.texcoords));
    append_moved(colors, std::move(more.colors));
  }
};

Result<VertexRows> read_vertex_rows(Body& body, const Element& element, std::size_t count) {
  Slots v(element);
  const bool with_normals = v.has({kNx, kNy, kNz}), with_texcoords = v.has({kU, kV});
  const bool with_colors = v.has({kRed, kGreen, kBlue});
  VertexRows rows;
  for (std::size_t i = 0; i < count && !body.failed(); ++i) {
    for (std::size_t p = 0; p < element.properties.size(); ++p) read_single(body, element.properties[p], p, v);
    rows.positions.push_back({v[kX], v[kY], v[kZ]});
    if (with_normals)
      for (const Slot slot : {kNx, kNy, kNz}) rows.normals.push_back(v[slot]);
    if (with_texcoords)
      for (const float value : {v[kU], 1 - v[kV]}) rows.texcoords.push_back(value);  // PLY's v points up.
    if (with_colors) v.append_color(rows.colors);
    LODESTONE_CHECK(check_end(body, element, i));
  }
  return rows;
}

/// Returns which property lists an element's vertices; the number of properties where none does.
std::size_t corner_list(const Element& element) {
  const auto found = std::find_if(element.properties.begin(), element.properties.end(), [](const Property& p) {
    return p.list_count && (p.name == "vertex_indices" || p.name == "vertex_index");
  });
  return static_cast<std::size_t>(found - element.properties.begin());
}

bool is_texture(const Property& property) { return property.name == (property.list_count ? "texcoord" : "texnumber"); }

/// Consecutive faces.
struct FaceRows {
  std::vector<Index> corners, sizes;
  std::vector<double> textures;       ///< one per face: which of the textures
  std::vector<float> texcoords;       ///< of the first corners
  std::vector<float> colors;          ///< empty, or of every face
  std::size_t without_texcoords = 0;  ///< corners

  void append(FaceRows&& more) {
    if (!more.texcoords.empty()) {
      texcoords.resize(2 * corners.size());
      append_moved(texcoords, std::move(more.texcoords));
    }
    append_moved(corners, std::move(more.corners));
    append_moved(sizes, std::move(more.sizes));
    append_moved(textures, std::move(more.textures));
    append_moved(colors, std::move(more.colors));
    without_texcoords += more.without_texcoords;
  }
};

/// Reads faces, one after the other.
class FaceReader {
 public:
  FaceReader(Body& body, const Element& element) : body_(body), element_(element), slots_(element) {}

  Result<FaceRows> read(std::size_t count) {
    const std::size_t corners = corner_list(element_);
    const bool with_colors = slots_.has({kRed, kGreen, kBlue});
    for (std::size_t i = 0; i < count && !body_.failed(); ++i) {
      const std::size_t first = rows_.corners.size();
      texcoords_of_face_.clear();
      texture_of_face_ = 0;
      for (std::size_t p = 0; p < element_.properties.size(); ++p) {
        if (p == corners) {
          LODESTONE_CHECK(read_polygon(i, element_.properties[p]));
        } else {
          read_property(element_.properties[p], p);
        }
      }
      end_face(first);
      if (with_colors) slots_.append_color(rows_.colors);
      LODESTONE_CHECK(check_end(body_, element_, i));
    }
    return std::move(rows_);
  }

 private:
  void read_property(const Property& property, std::size_t number) {
    if (!is_texture(property))
      read_single(body_, property, number, slots_);
    else if (property.list_count)
      read_list(property, texcoords_of_face_);
    else
      texture_of_face_ = body_.number(property.type);
  }

  void read_list(const Property& property, std::vector<float>& out) {
    for (double left = body_.number(*property.list_count); left > 0 && !body_.failed(); --left)
      out.push_back(static_cast<float>(body_.number(property.type)));
  }

  Result<void> read_polygon(std::size_t face, const Property& property) {
    for (double left = body_.number(*property.list_count); left > 0 && !body_.failed(); --left) {
      const double corner = body_.number(property.type);
      if (!(corner >= 0 && corner < kNoIndex)) return broken(text("face ", face, ": vertex index ", corner));
      rows_.corners.push_back(static_cast<Index>(corner));
    }
    if (rows_.corners.size() >= kNoIndex) return too_many_corners();
    return {};
  }

  /// Ends the face whose corners begin with number `first`; corners before them without texture coordinates get 0, 0.
  void end_face(std::size_t first) {
    const std::size_t corner_count = rows_.corners.size() - first;
    rows_.sizes.push_back(static_cast<Index>(corner_count));
    rows_.textures.push_back(texture_of_face_);
    if (texcoords_of_face_.size() < 2 * corner_count || corner_count == 0) {
      rows_.without_texcoords += corner_count;
      return;
    }
    rows_.texcoords.resize(2 * first);
    for (std::size_t i = 0; i < corner_count; ++i)
      for (const float value : {texcoords_of_face_[2 * i], 1 - texcoords_of_face_[2 * i + 1]})
        rows_.texcoords.push_back(value);
  }

  Body& body_;
  const Element& element_;
  Slots slots_;
  FaceRows rows_;
  std::vector<float> texcoords_of_face_;  ///< of the face being read, as the next
  double texture_of_face_ = 0;
};

Result<FaceRows> read_face_rows(Body& body, const Element& element, std::size_t count) {
  return FaceReader(body, element).read(count);
}

class PlyReader {
 public:
  PlyReader(const Header& header, Body body, const FileFetcher& fetch, std::size_t piece_bytes)
      : header_(header), body_(body), piece_bytes_(piece_bytes), images_(fetch, file_) {}

  Result<SoupFile> read() {
    for (const Element& element : header_.elements) {
      if (element.properties.empty()) continue;
      LODESTONE_CHECK(check_count(element));
      LODESTONE_CHECK(read_element(element));
      if (body_.failed()) return broken(text("element ", element.name, ": the file ends or a number is broken"));
    }
    LODESTONE_CHECK(check_indices());
    add_face_attributes();
    make_materials();
    if (!ignored_.empty()) file_.notes.push_back(text("properties that have no place are left out: ", ignored_));
    polygons_.corners = std::move(faces_.corners);
    polygons_.sizes = std::move(faces_.sizes);
    LODESTONE_TRY(file_.soup, to_triangles(std::move(polygons_), file_.notes));
    return std::move(file_);
  }

 private:
  Result<void> check_count(const Element& element) const {
    const std::size_t least = body_.least_bytes(element);
    if (element.count <= body_.bytes_left() / least + 1) return {};
    return broken(text("element ", element.name, ": count ", element.count, " exceeds the ", body_.bytes_left(),
                       " bytes that are left"));
  }

  Result<void> read_element(const Element& element) {
    if (element.name == "vertex") return read_vertices(element);
    if (element.name == "face") return read_faces(element);
    text_rows_.reset();  // what follows is read one after the other
    if (element.name == "tristrips") return read_strips(element);
    for (std::size_t i = 0; i < element.count && !body_.failed(); ++i) {
      for (const Property& property : element.properties) body_.skip(property);
      LODESTONE_CHECK(check_end(body_, element, i));
    }
    file_.notes.push_back(text(element.count, " elements '", element.name, "' are left out"));
    return {};
  }

  void ignore(const Element& element, const std::string& property) {
    ignored_ += text(ignored_.empty() ? "" : ", ", property, " of ", element.name);
  }

  template <class Rows>
  using RowReader = Result<Rows> (*)(Body& body, const Element& element, std::size_t count);

  template <class Rows>
  Result<Rows> read_rows(const Element& element, RowReader<Rows> read_some) {
    if (body_.format() == Format::Ascii && body_.bytes_left() > piece_bytes_)
      if (auto rows = read_side_by_side(element, read_some)) return std::move(*rows);
    text_rows_.reset();
    return read_some(body_, element, element.count);
  }

  /// Reads an element whose rows have a line each, as they should. Nothing where they do not, or where anything is
  /// wrong: reading them one after the other then tells what.
  template <class Rows>
  std::optional<Rows> read_side_by_side(const Element& element, RowReader<Rows> read_some) {
    if (!text_rows_) text_rows_.emplace(body_.rest(), piece_bytes_);
    const auto texts = text_rows_->take(element.count);
    if (!texts) return std::nullopt;
    std::vector<std::optional<Rows>> pieces(texts->size());
    std::vector<const char*> ends(texts->size());
    for_each_in_parallel(texts->size(), [&](std::size_t i) {
      Body body(Format::Ascii, (*texts)[i].text);
      if (auto rows = read_some(body, element, (*texts)[i].count); rows && !body.failed()) pieces[i] = std::move(*rows);
      ends[i] = body.rest().data();
    });
    Rows all;
    for (std::optional<Rows>& piece : pieces) {
      if (!piece) return std::nullopt;
      all.append(std::move(*piece));
    }
    if (!ends.empty()) body_.skip_to(ends.back());
    return all;
  }

  Result<void> read_vertices(const Element& element) {
    const Slots v(element);
    if (!v.has({kX, kY, kZ})) return broken("vertices have no x, y and z");
    if (element.count >= kNoIndex) return fail(ErrorCode::LimitExceeded, text("ply: ", element.count, " vertices"));
    LODESTONE_TRY(VertexRows rows, read_rows<VertexRows>(element, read_vertex_rows));
    for (std::size_t p = 0; p < element.properties.size(); ++p)
      if (!v.known(p)) ignore(element, element.properties[p].name);
    append_moved(polygons_.positions, std::move(rows.positions));
    auto& attributes = polygons_.vertex_attributes;
    if (v.has({kNx, kNy, kNz})) attributes.push_back(float_attribute("NORMAL", 3, rows.normals));
    if (v.has({kU, kV})) attributes.push_back(float_attribute("TEXCOORD_0", 2, rows.texcoords));
    if (v.has({kRed, kGreen, kBlue})) attributes.push_back(v.make_colors(std::move(rows.colors)));
    return {};
  }

  Result<void> read_faces(const Element& element) {
    const Slots f(element);
    LODESTONE_TRY(FaceRows rows, read_rows<FaceRows>(element, read_face_rows));
    if (f.has({kRed, kGreen, kBlue})) face_colors_ = f.make_colors(std::move(rows.colors));
    faces_.append(std::move(rows));
    if (faces_.corners.size() >= kNoIndex) return too_many_corners();
    const std::size_t corners = corner_list(element);
    for (std::size_t p = 0; p < element.properties.size(); ++p)
      if (p != corners && !f.is_color(p) && !is_texture(element.properties[p]))
        ignore(element, element.properties[p].name);
    return {};
  }

  /// Lists of vertices of which every three in a row are a triangle, each turned the other way; −1 begins anew.
  Result<void> read_strips(const Element& element) {
    const std::size_t corners = corner_list(element);
    for (std::size_t i = 0; i < element.count && !body_.failed(); ++i) {
      for (std::size_t p = 0; p < element.properties.size(); ++p) {
        if (p == corners) {
          LODESTONE_CHECK(read_strip(i, element.properties[p]));
        } else {
          body_.skip(element.properties[p]);
        }
      }
      LODESTONE_CHECK(check_end(body_, element, i));
    }
    return {};
  }

  Result<void> read_strip(std::size_t strip, const Property& property) {
    std::array<Index, 2> last{};
    std::size_t length = 0;
    for (double left = body_.number(*property.list_count); left > 0 && !body_.failed(); --left) {
      const double corner = body_.number(property.type);
      if (corner == -1) {
        length = 0;
        continue;
      }
      if (!(corner >= 0 && corner < kNoIndex)) return broken(text("strip ", strip, ": vertex index ", corner));
      const auto index = static_cast<Index>(corner);
      if (length >= 2 && last[0] != last[1] && last[1] != index && last[0] != index) add_triangle(last, index, length);
      last = {last[1], index};
      ++length;
    }
    if (faces_.corners.size() >= kNoIndex) return too_many_corners();
    return {};
  }

  void add_triangle(const std::array<Index, 2>& last, Index index, std::size_t length) {
    const bool turned = length % 2 != 0;
    faces_.corners.insert(faces_.corners.end(), {last[turned], last[!turned], index});
    faces_.sizes.push_back(3);
    faces_.textures.push_back(0);
    faces_.without_texcoords += 3;
  }

  Result<void> check_indices() const {
    for (const Index index : faces_.corners)
      if (index >= polygons_.positions.size())
        return broken(text("vertex index ", index, " is out of range: there are ", polygons_.positions.size()));
    return {};
  }

  static bool has_colors(const std::vector<Attribute>& attributes) {
    return std::any_of(attributes.begin(), attributes.end(), [](const Attribute& a) { return a.name == "COLOR_0"; });
  }

  /// What corners say of texture coordinates is finer than what vertices do, their colours finer than those of faces.
  void add_face_attributes() {
    if (!faces_.texcoords.empty()) {
      std::erase_if(polygons_.vertex_attributes, [](const Attribute& a) { return a.name == "TEXCOORD_0"; });
      faces_.texcoords.resize(2 * faces_.corners.size());
      polygons_.corner_attributes.push_back({float_attribute("TEXCOORD_0", 2, faces_.texcoords), {}});
      if (faces_.without_texcoords > 0)
        file_.notes.push_back(text(faces_.without_texcoords, " corners without texture coordinates got 0, 0"));
    }
    if (!face_colors_) return;
    if (has_colors(polygons_.vertex_attributes))
      file_.notes.push_back("the colours of faces are left out, since vertices have colours, too");
    else if (face_colors_->data.size() == faces_.sizes.size() * face_colors_->element_bytes())  // no strips among them
      polygons_.face_attributes.push_back(std::move(*face_colors_));
  }

  /// One material for each texture that a comment names; faces go by `texnumber`, else take the first.
  void make_materials() {
    if (header_.textures.empty()) return;
    for (const std::string& name : header_.textures) {
      Material material;
      material.name = std::filesystem::path(tidy_path(name)).stem().string();
      if (const auto image = images_.load(name, ""))
        material.base_color_texture = Texture{*image, {1, 1}, {0, 0}, false};
      file_.materials.push_back(std::move(material));
    }
    for (const double texture : faces_.textures) {
      const bool known = texture >= 0 && texture < static_cast<double>(header_.textures.size());
      polygons_.face_material.push_back(known ? static_cast<Index>(texture) + 1 : 0);
    }
  }

  const Header& header_;
  Body body_;
  std::size_t piece_bytes_;
  std::optional<TextRows> text_rows_;  ///< of the body, from where it stands
  SoupFile file_;
  ImageLoader images_;
  PolygonSoup polygons_;
  FaceRows faces_;                        ///< and strips
  std::optional<Attribute> face_colors_;  ///< one element per element 'face'
  std::string ignored_;
};

}  // namespace

Result<SoupFile> read_ply(std::span<const std::byte> bytes, const FileFetcher& fetch, std::size_t piece_bytes) {
  std::string_view rest = without_byte_order_mark(as_text(bytes));
  LODESTONE_TRY(const Header header, parse_header(rest));
  return PlyReader(header, Body(header.format, rest), fetch, piece_bytes).read();
}

}  // namespace lodestone::detail
