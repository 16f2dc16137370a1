// Wavefront OBJ: v, vt, vn, f, usemtl and mtllib, after the format's description in "Advanced Visualizer", appendix B1
// (1992); colours of vertices as MeshLab writes them, behind the coordinates, and as ZBrush does, in comments (#MRGB).
//
// Parsed here and not by a library because positions have to be the correctly rounded floats of what the file says,
// and because a broken file has to name its line.

#include <array>
#include <charconv>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "base/files_beside.h"
#include "base/number_text.h"
#include "mesh/polygon_soup.h"
#include "mesh/read_mtl.h"
#include "mesh/soup_file.h"
#include "mesh/vertex_color.h"

namespace lodestone::detail {
namespace {

enum Kind { kPosition, kTexcoord, kNormal, kKindCount };
constexpr std::array<const char*, kKindCount> kKindNames = {"vertex", "texture coordinate", "normal"};

/// A face's corner: an element of each kind, 0-based, or kNoIndex.
using Corner = std::array<Index, kKindCount>;

using Rgba = std::array<float, 4>;
constexpr Rgba kNoColor = {-1, -1, -1, -1};

class ObjReader {
 public:
  ObjReader(std::string_view rest, const FileFetcher& fetch) : rest_(rest), libraries_(fetch, file_) {}

  Result<SoupFile> read() {
    while (!rest_.empty()) LODESTONE_CHECK(read_statement(logical_line()));
    if (last_reference_[kPosition].line > 0 && last_reference_[kPosition].index >= positions_.size())
      return fail(ErrorCode::Malformed, missing_text(kPosition));
    drop_missing_references();
    return make_soup();
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

  Result<void> read_statement(std::string_view line) {
    if (line.starts_with("#MRGB")) return read_mrgb(line.substr(5));
    std::string_view words = without_comment(line);
    line = line.substr(0, line.find('#'));
    const std::string_view keyword = next_token(line);
    next_token(words);
    if (keyword == "v") return read_position(line);
    if (keyword == "vt") return read_texcoord(line);
    if (keyword == "vn") return read_normal(line);
    if (keyword == "f" || keyword == "fo") return read_face(line);
    if (keyword == "usemtl") return use_material(std::string(trimmed(words)));
    if (keyword == "mtllib") libraries_.add(words);
    if (keyword == "p" || keyword == "l") ++points_and_lines_;
    if (keyword == "curv" || keyword == "curv2" || keyword == "surf") ++free_forms_;
    return {};
  }

  tl::unexpected<Error> broken(std::string message) const {
    return fail(ErrorCode::Malformed, text("line ", line_number_, ": ", message));
  }

  /// Reads `required` to `values.size()` numbers; those not there stay as they are.
  template <std::size_t N>
  Result<std::size_t> read_numbers(std::string_view& line, std::array<float, N>& values, std::size_t required) const {
    std::size_t count = 0;
    for (std::string_view token; count < N && !(token = next_token(line)).empty(); ++count) {
      const auto value = parse_float(token);
      if (!value) return broken(text("'", token, "' is not a number"));
      values[count] = *value;
    }
    if (count < required) return broken(text(count, " numbers where ", required, " are needed"));
    return count;
  }

  /// Three coordinates, with a weight that is not looked at, or a colour of three or four components.
  Result<void> read_position(std::string_view line) {
    std::array<float, 7> v{0, 0, 0, 1, 1, 1, 1};
    LODESTONE_TRY(const std::size_t count, read_numbers(line, v, 3));
    positions_.push_back({v[0], v[1], v[2]});
    if (count >= 6) {
      colors_.resize(positions_.size() - 1, kNoColor);
      colors_.push_back({v[3], v[4], v[5], count == 7 ? v[6] : -1});
    }
    return check_room(positions_.size());
  }

  /// Blocks of eight hexadecimal digits, one for each vertex: a mask, red, green and blue.
  Result<void> read_mrgb(std::string_view line) {
    const std::string_view digits = next_token(line);
    for (std::size_t at = 0; at + 8 <= digits.size(); at += 8) {
      std::uint32_t value = 0;
      const auto result = std::from_chars(digits.data() + at, digits.data() + at + 8, value, 16);
      if (result.ptr != digits.data() + at + 8) return broken(text("'", digits.substr(at, 8), "' is not a colour"));
      const auto component = [&](int shift) { return static_cast<float>(value >> shift & 0xff) / 255; };
      painted_.push_back({component(16), component(8), component(0), -1});
    }
    return {};
  }

  Result<void> read_texcoord(std::string_view line) {
    std::array<float, 3> v{};
    LODESTONE_CHECK(read_numbers(line, v, 1));
    texcoords_.push_back({v[0], 1 - v[1]});  // OBJ's v points up, that of TEXCOORD_0 down.
    return check_room(texcoords_.size());
  }

  Result<void> read_normal(std::string_view line) {
    std::array<float, 3> v{};
    LODESTONE_CHECK(read_numbers(line, v, 3));
    normals_.push_back(v);
    return check_room(normals_.size());
  }

  Result<void> check_room(std::size_t count) const {
    if (count < kNoIndex) return {};
    return fail(ErrorCode::LimitExceeded, text("line ", line_number_, ": more elements than 32-bit indices can name"));
  }

  std::size_t element_count(int kind) const {
    return kind == kPosition ? positions_.size() : kind == kTexcoord ? texcoords_.size() : normals_.size();
  }

  /// Turns a 1-based or, if negative, relative index into a 0-based one. An element may stand after its use, so an
  /// index beyond the elements so far is only noted here, with its line. Faces whose texture coordinate or normal
  /// cannot be there keep their shape.
  Result<Index> resolve(long long index, int kind) {
    const auto count = static_cast<long long>(element_count(kind));
    if (index == 0 || index < -count || index >= static_cast<long long>(kNoIndex)) {
      if (kind == kPosition)
        return broken(text(kKindNames[kind], " index ", index, " is out of range: there are ", count, " so far"));
      if (missing_[kind]++ == 0) first_missing_[kind] = line_number_;
      return kNoIndex;
    }
    const Index resolved = static_cast<Index>(index > 0 ? index - 1 : count + index);
    Reference& last = last_reference_[kind];
    if (last.line == 0 || resolved > last.index) last = {resolved, line_number_};
    return resolved;
  }

  /// Reads "1", "1/2", "1//3" or "1/2/3".
  Result<Corner> read_corner(std::string_view token) {
    Corner corner{kNoIndex, kNoIndex, kNoIndex};
    std::string_view rest = token;
    for (int kind = 0; kind < kKindCount; ++kind) {
      const std::string_view part = rest.substr(0, rest.find('/'));
      const bool last = part.size() == rest.size();
      rest.remove_prefix(last ? rest.size() : part.size() + 1);
      if (!part.empty()) {
        const auto index = parse_integer(part);
        if (!index) return broken(text("'", token, "' is not a corner of a face"));
        LODESTONE_TRY(corner[kind], resolve(*index, kind));
      }
      if (last) break;
    }
    if (corner[kPosition] == kNoIndex || !rest.empty()) return broken(text("'", token, "' is not a corner of a face"));
    return corner;
  }

  Result<void> read_face(std::string_view line) {
    const std::size_t first = corners_.size();
    for (std::string_view token; !(token = next_token(line)).empty();) {
      LODESTONE_TRY(const Corner corner, read_corner(token));
      corners_.push_back(corner);
    }
    sizes_.push_back(static_cast<Index>(corners_.size() - first));
    face_material_.push_back(material_);
    return check_room(corners_.size());
  }

  Result<void> use_material(const std::string& name) {
    const auto next = static_cast<Index>(materials_.size() + 1);
    material_ = name.empty() ? 0 : materials_.try_emplace(name, next).first->second;
    return {};
  }

  std::string missing_text(int kind) const {
    const Reference& last = last_reference_[kind];
    return text("line ", last.line, ": ", kKindNames[kind], " index ", std::uint64_t{last.index} + 1,
                " is out of range: the file has ", element_count(kind));
  }

  /// Takes texture coordinates and normals that the file lacks from the corners that name them.
  void drop_missing_references() {
    for (const int kind : {kTexcoord, kNormal}) {
      for (Corner& corner : corners_) {
        if (corner[kind] == kNoIndex || corner[kind] < element_count(kind)) continue;
        corner[kind] = kNoIndex;
        ++missing_[kind];
      }
      if (missing_[kind] == 0) continue;
      const std::size_t line = first_missing_[kind] > 0 ? first_missing_[kind] : last_reference_[kind].line;
      file_.notes.push_back(text(missing_[kind], " corners of faces name a ", kKindNames[kind],
                                 " that the file lacks, as in line ", line, ": it has ", element_count(kind)));
    }
  }

  /// How many corners name an element of this kind.
  std::size_t uses(int kind) const {
    std::size_t count = 0;
    for (const Corner& corner : corners_) count += corner[kind] != kNoIndex;
    return count;
  }

  Result<SoupFile> make_soup() {
    const std::size_t texcoord_uses = uses(kTexcoord);
    const bool with_normals = !corners_.empty() && uses(kNormal) == corners_.size();
    note_partial_attributes(texcoord_uses, with_normals);

    PolygonSoup polygons;
    polygons.corners.reserve(corners_.size());
    for (const Corner& corner : corners_) polygons.corners.push_back(corner[kPosition]);
    if (with_normals) polygons.corner_attributes.push_back(corner_attribute("NORMAL", kNormal, normals_));
    if (texcoord_uses > 0) polygons.corner_attributes.push_back(corner_attribute("TEXCOORD_0", kTexcoord, texcoords_));
    add_colors(polygons);
    polygons.positions = std::move(positions_);
    polygons.sizes = std::move(sizes_);
    if (!materials_.empty()) polygons.face_material = std::move(face_material_);
    LODESTONE_TRY(file_.soup, to_triangles(std::move(polygons), file_.notes));
    make_materials();
    note_left_out();
    return std::move(file_);
  }

  template <std::size_t N>
  Attribute corner_attribute(const char* name, Kind kind, const std::vector<std::array<float, N>>& elements) const {
    std::vector<float> values;
    values.reserve(N * corners_.size());
    for (const Corner& corner : corners_) {
      const std::array<float, N> value = corner[kind] == kNoIndex ? std::array<float, N>{} : elements[corner[kind]];
      values.insert(values.end(), value.begin(), value.end());
    }
    return float_attribute(name, N, values);
  }

  /// Vertices without a colour are white. Only where some vertex has an alpha do the others get one.
  void add_colors(PolygonSoup& polygons) {
    const bool painted = colors_.empty() && !painted_.empty();
    std::vector<Rgba>& colors = painted ? painted_ : colors_;
    if (colors.empty()) return;
    colors.resize(positions_.size(), kNoColor);
    std::uint8_t component_count = 3;
    std::vector<float> components;
    for (const Rgba& color : colors) {
      if (color[3] >= 0) component_count = 4;
      components.insert(components.end(), color.begin(), color.end());
    }
    const float range = color_range(components);
    components.clear();
    std::size_t uncolored = 0;
    for (const Rgba& color : colors) {
      uncolored += color == kNoColor;
      for (std::size_t i = 0; i < component_count; ++i)
        components.push_back(color == kNoColor || (i == 3 && color[i] < 0) ? 1 : color[i] / range);
    }
    polygons.vertex_attributes.push_back(color_attribute(components, component_count));
    if (uncolored > 0) file_.notes.push_back(text(uncolored, " vertices without a colour are white"));
  }

  void make_materials() {
    std::vector<const std::string*> names(materials_.size());
    for (const auto& [name, number] : materials_) names[number - 1] = &name;
    for (const std::string* name : names) file_.materials.push_back(libraries_.material(*name));
    libraries_.finish();
  }

  void note_partial_attributes(std::size_t texcoord_uses, bool with_normals) {
    if (texcoord_uses > 0 && texcoord_uses < corners_.size())
      file_.notes.push_back(text(corners_.size() - texcoord_uses, " corners without texture coordinates got 0, 0"));
    if (!with_normals && uses(kNormal) > 0)
      file_.notes.push_back("the normals are left out, since not every corner has one");
  }

  void note_left_out() {
    const auto note = [&](std::size_t count, const char* what) {
      if (count > 0) file_.notes.push_back(text(count, what));
    };
    note(points_and_lines_, " point and line elements are left out");
    note(free_forms_, " free-form curves and surfaces are left out");
  }

  struct Reference {
    Index index = 0;
    std::size_t line = 0;  ///< 0: there was none
  };

  std::string_view rest_;
  std::string joined_;
  std::size_t line_number_ = 0;

  std::vector<Vec3f> positions_;
  std::vector<std::array<float, 2>> texcoords_;
  std::vector<std::array<float, 3>> normals_;
  std::vector<Rgba>
      colors_;  ///< of the first vertices; kNoColor where a vertex has none, alpha −1 where a colour has none
  std::vector<Rgba> painted_;  ///< ZBrush's, in the vertices' order
  std::vector<Corner> corners_;
  std::vector<Index> sizes_;  ///< one per face, as the next
  std::vector<Index> face_material_;
  std::map<std::string, Index> materials_;  ///< numbers from 1, in order of first use; 0: faces before any usemtl
  Index material_ = 0;
  std::array<Reference, kKindCount> last_reference_{};
  std::array<std::size_t, kKindCount> missing_{};        ///< corners that name what the file lacks
  std::array<std::size_t, kKindCount> first_missing_{};  ///< the line of a relative one

  std::size_t points_and_lines_ = 0;
  std::size_t free_forms_ = 0;
  SoupFile file_;
  MaterialLibraries libraries_;
};

}  // namespace

Result<SoupFile> read_obj(std::span<const std::byte> bytes, const FileFetcher& fetch) {
  return ObjReader(without_byte_order_mark(as_text(bytes)), fetch).read();
}

}  // namespace lodestone::detail
