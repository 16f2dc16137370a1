// PLY: ASCII and binary of both byte orders, after Greg Turk's "The PLY Polygon File Format" (1994).

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <concepts>
#include <optional>
#include <string>

#include "bytes.h"
#include "number_text.h"
#include "soup_file.h"
#include "text.h"
#include "try.h"

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
};

tl::unexpected<Error> broken(std::string message) { return fail(ErrorCode::Malformed, "ply: " + std::move(message)); }

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

  bool failed() const { return failed_; }
  std::size_t bytes_left() const { return rest_.size(); }

  double number(Scalar type) { return format_ == Format::Ascii ? ascii_number(type) : binary_number(type); }

  void skip(const Property& property) {
    if (!property.list_count) {
      number(property.type);
      return;
    }
    for (double left = number(*property.list_count); left > 0 && !failed_; --left) number(property.type);
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
    constexpr std::string_view kBlanks = " \t\v\f\r\n";
    rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size()));
    const std::string_view token = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(token.size());
    if (type != Scalar::Float64) {
      // Rounded once, to float; integers up to 32 bits do not fit one and go through double.
      const auto value = type == Scalar::Float32 ? parse_float(token) : std::nullopt;
      if (value) return *value;
    }
    double value = 0;
    const auto result = std::from_chars(token.data(), token.data() + token.size(), value);
    return result.ec == std::errc{} && result.ptr == token.data() + token.size() ? value : fail_now();
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

/// Where a vertex property goes: components of one vector of doubles.
enum Slot { kX, kY, kZ, kNx, kNy, kNz, kRed, kGreen, kBlue, kAlpha, kU, kV, kSlotCount };

struct SlotName {
  std::string_view name;
  Slot slot;
};
constexpr std::array<SlotName, 18> kSlotNames = {{{"x", kX},
                                                  {"y", kY},
                                                  {"z", kZ},
                                                  {"nx", kNx},
                                                  {"ny", kNy},
                                                  {"nz", kNz},
                                                  {"red", kRed},
                                                  {"green", kGreen},
                                                  {"blue", kBlue},
                                                  {"alpha", kAlpha},
                                                  {"s", kU},
                                                  {"t", kV},
                                                  {"u", kU},
                                                  {"v", kV},
                                                  {"texture_u", kU},
                                                  {"texture_v", kV},
                                                  {"texture_s", kU},
                                                  {"texture_t", kV}}};

class PlyReader {
 public:
  PlyReader(const Header& header, Body body) : header_(header), body_(body) {}

  Result<SoupFile> read() {
    for (const Element& element : header_.elements) {
      if (element.properties.empty()) continue;
      LODESTONE_CHECK(check_count(element));
      LODESTONE_CHECK(read_element(element));
      if (body_.failed()) return broken(text("element ", element.name, ": the file ends or a number is broken"));
    }
    LODESTONE_CHECK(check_indices());
    if (short_faces_ > 0)
      file_.notes.push_back(text(short_faces_, " faces with fewer than three corners are left out"));
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
    for (std::size_t i = 0; i < element.count && !body_.failed(); ++i)
      for (const Property& property : element.properties) body_.skip(property);
    file_.notes.push_back(text(element.count, " elements '", element.name, "' are left out"));
    return {};
  }

  /// Returns the slot of each property, kSlotCount for those with none.
  static std::vector<Slot> slots_of(const Element& element) {
    std::vector<Slot> slots;
    for (const Property& property : element.properties) {
      const auto* known = std::find_if(kSlotNames.begin(), kSlotNames.end(),
                                       [&](const SlotName& s) { return s.name == property.name; });
      slots.push_back(known == kSlotNames.end() || property.list_count ? kSlotCount : known->slot);
    }
    return slots;
  }

  Result<void> read_vertices(const Element& element) {
    const std::vector<Slot> slots = slots_of(element);
    const auto has = [&](Slot slot) { return std::find(slots.begin(), slots.end(), slot) != slots.end(); };
    if (!has(kX) || !has(kY) || !has(kZ)) return broken("vertices have no x, y and z");
    if (element.count >= kNoIndex) return fail(ErrorCode::LimitExceeded, text("ply: ", element.count, " vertices"));

    std::vector<float> normals, texcoords;
    std::vector<double> colors;
    std::array<double, kSlotCount + 1> v{};
    for (std::size_t i = 0; i < element.count && !body_.failed(); ++i) {
      for (std::size_t p = 0; p < slots.size(); ++p) {
        if (element.properties[p].list_count)
          body_.skip(element.properties[p]);
        else
          v[slots[p]] = body_.number(element.properties[p].type);
      }
      const auto f = [&](Slot slot) { return static_cast<float>(v[slot]); };
      file_.soup.positions.push_back({f(kX), f(kY), f(kZ)});
      if (has(kNz)) normals.insert(normals.end(), {f(kNx), f(kNy), f(kNz)});
      if (has(kU) && has(kV)) texcoords.insert(texcoords.end(), {f(kU), 1 - f(kV)});  // PLY's v points up.
      if (has(kBlue)) colors.insert(colors.end(), {v[kRed], v[kGreen], v[kBlue], v[kAlpha]});
    }
    if (has(kNz)) file_.soup.attributes.push_back(float_attribute("NORMAL", 3, normals));
    if (has(kU) && has(kV)) file_.soup.attributes.push_back(float_attribute("TEXCOORD_0", 2, texcoords));
    if (has(kBlue)) add_colors(element, slots, colors, has(kAlpha));
    return {};
  }

  void add_colors(const Element& element, const std::vector<Slot>& slots, std::span<const double> colors, bool alpha) {
    const auto red = std::find(slots.begin(), slots.end(), kRed);
    const Scalar type = red == slots.end() ? Scalar::Float64 : element.properties[red - slots.begin()].type;
    if (type != Scalar::UInt8 && type != Scalar::Float32) {
      file_.notes.push_back("the colours are left out: they are neither bytes nor floats");
      return;
    }
    const std::uint8_t component_count = alpha ? 4 : 3;
    const bool bytes = type == Scalar::UInt8;
    Attribute attribute{"COLOR_0", bytes ? ComponentType::UInt8 : ComponentType::Float32, component_count, bytes, {}};
    for (std::size_t i = 0; i < colors.size(); ++i) {
      if (i % 4 == 3 && !alpha) continue;
      if (bytes)
        append(attribute.data, static_cast<std::uint8_t>(colors[i] > 0 ? std::min(colors[i], 255.0) : 0));
      else
        append(attribute.data, static_cast<float>(colors[i]));
    }
    file_.soup.attributes.push_back(std::move(attribute));
  }

  Result<void> read_faces(const Element& element) {
    for (std::size_t i = 0; i < element.count && !body_.failed(); ++i)
      for (const Property& property : element.properties) {
        const bool corners =
            property.list_count && (property.name == "vertex_indices" || property.name == "vertex_index");
        if (!corners) {
          body_.skip(property);
          continue;
        }
        LODESTONE_CHECK(read_polygon(i, property));
      }
    if (file_.soup.indices.size() >= kNoIndex) return fail(ErrorCode::LimitExceeded, "ply: too many triangles");
    return {};
  }

  /// Splits a polygon into a fan around its first corner.
  Result<void> read_polygon(std::size_t face, const Property& property) {
    const double count = body_.number(*property.list_count);
    std::array<Index, 2> kept{};  // the first corner and the last
    for (double i = 0; i < count && !body_.failed(); ++i) {
      const double corner = body_.number(property.type);
      if (!(corner >= 0 && corner < kNoIndex)) return broken(text("face ", face, ": vertex index ", corner));
      const auto index = static_cast<Index>(corner);
      if (i >= 2) file_.soup.indices.insert(file_.soup.indices.end(), {kept[0], kept[1], index});
      kept[i > 0 ? 1 : 0] = index;
    }
    short_faces_ += !(count >= 3);
    return {};
  }

  Result<void> check_indices() const {
    const TriangleSoup& soup = file_.soup;
    for (std::size_t i = 0; i < soup.indices.size(); ++i)
      if (soup.indices[i] >= soup.positions.size())
        return broken(text("vertex index ", soup.indices[i], " is out of range: there are ", soup.positions.size()));
    return {};
  }

  const Header& header_;
  Body body_;
  SoupFile file_;
  std::size_t short_faces_ = 0;
};

}  // namespace

Result<SoupFile> read_ply(std::span<const std::byte> bytes) {
  std::string_view rest = as_text(bytes);
  LODESTONE_TRY(const Header header, parse_header(rest));
  return PlyReader(header, Body(header.format, rest)).read();
}

}  // namespace lodestone::detail
