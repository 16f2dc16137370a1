// STL: binary (80 bytes of header, a count, 50 bytes a triangle) and ASCII. The facets' normals follow from the
// corners and are not kept: as attributes they would make every edge a seam.
//
// The two bytes behind a binary facet hold its colour in two ways. VisCAM and SolidView: red is highest, and bit 15
// says that there is one. Materialise Magics: red is lowest, bit 15 says that there is none but the whole object's,
// which the header has behind "COLOR=".

#include <algorithm>
#include <array>
#include <optional>
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

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50;
constexpr std::uint16_t kFlag = 0x8000;
constexpr float kLargestComponent = 31;

bool says_solid(std::string_view text) {
  text = without_byte_order_mark(text);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  return lower_case(text.substr(0, 5)) == "solid";
}

/// The header may say "solid" in a binary file, too: the size decides.
bool is_binary(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeaderBytes) return false;
  if (bytes.size() == kHeaderBytes + kTriangleBytes * std::uint64_t{load_u32(bytes, 80)}) return true;
  return !says_solid(as_text(bytes));
}

using Rgba = std::array<float, 4>;

/// Returns the whole object's colour, of a file that Magics wrote.
std::optional<Rgba> object_color(std::span<const std::byte> bytes) {
  constexpr std::string_view kKey = "COLOR=";
  const std::size_t at = as_text(bytes.first(kHeaderBytes - 4)).find(kKey);
  if (at == std::string_view::npos || at + kKey.size() + 4 > kHeaderBytes - 4) return std::nullopt;
  Rgba color{};
  for (std::size_t i = 0; i < 4; ++i)
    color[i] = static_cast<float>(std::to_integer<std::uint8_t>(bytes[at + kKey.size() + i])) / 255;
  return color;
}

std::uint16_t facet_bytes(std::span<const std::byte> bytes, std::size_t facet) {
  return load<std::uint16_t>(bytes, kHeaderBytes + kTriangleBytes * facet + 48);
}

/// Returns a component, 0 to 2 from the lowest bits on.
float component(std::uint16_t color, int number) {
  return static_cast<float>(color >> 5 * number & 31) / kLargestComponent;
}

/// The facets' colours. Where not one facet's bytes say anything, all have the object's colour, or none.
class FacetColors {
 public:
  FacetColors(std::span<const std::byte> bytes, std::size_t count)
      : bytes_(bytes), count_(count), object_(object_color(bytes)) {
    for (std::size_t i = 0; i < count_; ++i) {
      const std::uint16_t color = facet_bytes(bytes_, i);
      any_bytes_ |= color != 0;
      any_flag_ |= (color & kFlag) != 0;
    }
  }

  bool empty() const { return !object_ && !any_flag_; }
  /// Bytes that are colours in neither way.
  bool unknown() const { return empty() && any_bytes_; }

  /// Makes an attribute with an element for each facet; those without a colour are white.
  Attribute make() const {
    std::vector<float> components;
    const bool with_alpha = object_ && (*object_)[3] < 1;
    for (std::size_t i = 0; i < count_; ++i) {
      const Rgba color = object_ ? magics_color(facet_bytes(bytes_, i)) : viscam_color(facet_bytes(bytes_, i));
      components.insert(components.end(), color.begin(), color.begin() + (with_alpha ? 4 : 3));
    }
    return color_attribute(components, with_alpha ? 4 : 3);
  }

 private:
  Rgba magics_color(std::uint16_t color) const {
    if ((color & kFlag) || !any_bytes_) return *object_;
    return {component(color, 0), component(color, 1), component(color, 2), (*object_)[3]};
  }
  static Rgba viscam_color(std::uint16_t color) {
    if (!(color & kFlag)) return {1, 1, 1, 1};
    return {component(color, 2), component(color, 1), component(color, 0), 1};
  }

  std::span<const std::byte> bytes_;
  std::size_t count_;
  std::optional<Rgba> object_;
  bool any_bytes_ = false, any_flag_ = false;
};

/// Appends a polygon whose corners are all points of their own.
void append_polygon(PolygonSoup& polygons, std::span<const Vec3f> corners) {
  for (const Vec3f& corner : corners) {
    polygons.corners.push_back(static_cast<Index>(polygons.positions.size()));
    polygons.positions.push_back(corner);
  }
  polygons.sizes.push_back(static_cast<Index>(corners.size()));
}

Result<PolygonSoup> read_binary(std::span<const std::byte> bytes, SoupFile& file) {
  const std::uint64_t count = load_u32(bytes, 80);
  const std::size_t room = bytes.size() - kHeaderBytes;
  if (count * kTriangleBytes > room)
    return fail(ErrorCode::Malformed, text("stl: ", count, " triangles exceed the ", room, " bytes there are"), 80);
  if (count * 3 >= kNoIndex) return fail(ErrorCode::LimitExceeded, text("stl: ", count, " triangles are too many"), 80);
  PolygonSoup polygons;
  for (std::size_t i = 0; i < count; ++i)
    append_polygon(polygons, load<std::array<Vec3f, 3>>(bytes, kHeaderBytes + kTriangleBytes * i + 12));
  const FacetColors colors(bytes, static_cast<std::size_t>(count));
  if (!colors.empty() && count > 0) polygons.face_attributes.push_back(colors.make());
  if (colors.unknown()) file.notes.push_back("the attribute bytes of facets are left out: they are no colours");
  return polygons;
}

Result<Vec3f> read_vertex(std::string_view line, std::size_t line_number) {
  std::array<float, 3> v{};
  for (float& component : v) {
    const std::string_view token = next_token(line);
    const auto value = parse_float(token);
    if (!value) return fail(ErrorCode::Malformed, text("line ", line_number, ": '", token, "' is not a number"));
    component = *value;
  }
  return Vec3f{v[0], v[1], v[2]};
}

bool ends_loop(const std::string& keyword) {
  return keyword == "endloop" || keyword == "outer" || keyword == "endfacet" || keyword == "endsolid";
}

Result<PolygonSoup> read_ascii(std::string_view rest) {
  PolygonSoup polygons;
  std::vector<Vec3f> loop;
  const auto end_loop = [&] {
    if (!loop.empty()) append_polygon(polygons, loop);
    loop.clear();
  };
  for (std::size_t line_number = 1; !rest.empty(); ++line_number) {
    std::string_view line = next_line(rest);
    const std::string keyword = lower_case(next_token(line));
    if (keyword == "vertex") {
      LODESTONE_TRY(const Vec3f v, read_vertex(line, line_number));
      loop.push_back(v);
    } else if (ends_loop(keyword)) {
      end_loop();
    }
  }
  end_loop();
  return polygons;
}

}  // namespace

Result<SoupFile> read_stl(std::span<const std::byte> bytes) {
  const bool binary = is_binary(bytes);
  if (!binary && !says_solid(as_text(bytes)))
    return fail(ErrorCode::Malformed, text("stl: ", bytes.size(), " bytes are neither a binary nor an ASCII file"));
  SoupFile file;
  LODESTONE_TRY(PolygonSoup polygons,
                binary ? read_binary(bytes, file) : read_ascii(without_byte_order_mark(as_text(bytes))));
  LODESTONE_TRY(file.soup, to_triangles(std::move(polygons), file.notes));
  return file;
}

}  // namespace lodestone::detail
