// Wavefront OBJ: v, vt, vn, f and usemtl, after the format's description in "Advanced Visualizer", appendix B1 (1992).
//
// Parsed here and not by a library because positions have to be the correctly rounded floats of what the file says,
// and because a broken file has to name its line.

#include <array>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>

#include "number_text.h"
#include "soup_file.h"
#include "text.h"
#include "try.h"

namespace lodestone::detail {
namespace {

enum Kind { kPosition, kTexcoord, kNormal, kKindCount };
constexpr std::array<const char*, kKindCount> kKindNames = {"vertex", "texture coordinate", "normal"};

/// A face's corner: an element of each kind, 0-based, or kNoIndex.
using Corner = std::array<Index, kKindCount>;

struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    std::uint64_t h = c[0];
    for (int kind = 1; kind < kKindCount; ++kind) h = h * 0x9e3779b97f4a7c15ULL + c[kind] + 1;
    return static_cast<std::size_t>(h ^ (h >> 29));
  }
};

class ObjReader {
 public:
  explicit ObjReader(std::string_view rest) : rest_(rest) {}

  Result<SoupFile> read() {
    while (!rest_.empty()) LODESTONE_CHECK(read_statement(logical_line()));
    LODESTONE_CHECK(check_forward_references());
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
    line = line.substr(0, line.find('#'));
    const std::string_view keyword = next_token(line);
    if (keyword == "v") return read_position(line);
    if (keyword == "vt") return read_texcoord(line);
    if (keyword == "vn") return read_normal(line);
    if (keyword == "f" || keyword == "fo") return read_face(line);
    if (keyword == "usemtl") return use_material(line);
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

  Result<void> read_position(std::string_view line) {
    std::array<float, 6> v{};
    LODESTONE_TRY(const std::size_t count, read_numbers(line, v, 3));
    has_vertex_colors_ |= count == 6;
    positions_.push_back({v[0], v[1], v[2]});
    return check_room(positions_.size());
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
  /// index beyond the elements so far is only noted here, with its line.
  Result<Index> resolve(long long index, int kind) {
    const auto count = static_cast<long long>(element_count(kind));
    const auto broken_index = [&] {
      return broken(text(kKindNames[kind], " index ", index, " is out of range: there are ", count, " so far"));
    };
    if (index == 0 || index < -count || index >= static_cast<long long>(kNoIndex)) return broken_index();
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

  /// Reads a polygon and splits it into a fan around its first corner.
  Result<void> read_face(std::string_view line) {
    polygon_.clear();
    for (std::string_view token; !(token = next_token(line)).empty();) {
      LODESTONE_TRY(const Corner corner, read_corner(token));
      polygon_.push_back(corner);
    }
    if (polygon_.size() < 3) {
      ++short_faces_;
      return {};
    }
    for (std::size_t i = 1; i + 1 < polygon_.size(); ++i) {
      corners_.insert(corners_.end(), {polygon_[0], polygon_[i], polygon_[i + 1]});
      face_material_.push_back(material_);
    }
    return check_room(corners_.size());
  }

  Result<void> use_material(std::string_view line) {
    const std::string name(next_token(line));
    material_ = materials_.try_emplace(name, static_cast<Index>(materials_.size() + 1)).first->second;
    return {};
  }

  Result<void> check_forward_references() const {
    for (int kind = 0; kind < kKindCount; ++kind) {
      const Reference& last = last_reference_[kind];
      if (last.line == 0 || last.index < element_count(kind)) continue;
      return fail(ErrorCode::Malformed,
                  text("line ", last.line, ": ", kKindNames[kind], " index ", std::uint64_t{last.index} + 1,
                       " is out of range: the file has ", element_count(kind)));
    }
    return {};
  }

  /// How many corners name an element of this kind.
  std::size_t uses(int kind) const {
    std::size_t count = 0;
    for (const Corner& corner : corners_) count += corner[kind] != kNoIndex;
    return count;
  }

  /// Makes a point of each distinct corner.
  SoupFile make_soup() {
    const std::size_t texcoord_uses = uses(kTexcoord);
    const bool with_texcoords = texcoord_uses > 0;
    const bool with_normals = !corners_.empty() && uses(kNormal) == corners_.size();
    note_partial_attributes(texcoord_uses, with_normals);

    TriangleSoup& soup = file_.soup;
    std::vector<float> texcoords, normals;
    std::unordered_map<Corner, Index, CornerHash> points;
    soup.indices.reserve(corners_.size());
    for (Corner corner : corners_) {
      if (!with_normals) corner[kNormal] = kNoIndex;
      const auto [entry, inserted] = points.try_emplace(corner, static_cast<Index>(soup.positions.size()));
      soup.indices.push_back(entry->second);
      if (!inserted) continue;
      soup.positions.push_back(positions_[corner[kPosition]]);
      if (with_texcoords) append(texcoords, corner[kTexcoord], texcoords_);
      if (with_normals) append(normals, corner[kNormal], normals_);
    }
    if (with_normals) soup.attributes.push_back(float_attribute("NORMAL", 3, normals));
    if (with_texcoords) soup.attributes.push_back(float_attribute("TEXCOORD_0", 2, texcoords));
    if (!materials_.empty()) soup.face_material = std::move(face_material_);
    note_left_out();
    return std::move(file_);
  }

  template <std::size_t N>
  static void append(std::vector<float>& out, Index element, const std::vector<std::array<float, N>>& elements) {
    const std::array<float, N> value = element == kNoIndex ? std::array<float, N>{} : elements[element];
    out.insert(out.end(), value.begin(), value.end());
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
    note(short_faces_, " face statements with fewer than three corners are left out");
    note(points_and_lines_, " point and line elements are left out");
    note(free_forms_, " free-form curves and surfaces are left out");
    if (has_vertex_colors_) file_.notes.push_back("the vertex colours are left out");
    if (!materials_.empty())
      file_.notes.push_back(
          text("what ", materials_.size() == 1 ? "the material looks" : text(materials_.size(), " materials look"),
               " like is left out; faces keep apart by material"));
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
  std::vector<Corner> corners_;
  std::vector<Corner> polygon_;
  std::vector<Index> face_material_;
  std::map<std::string, Index> materials_;  ///< numbers from 1, in order of first use; 0: faces before any usemtl
  Index material_ = 0;
  std::array<Reference, kKindCount> last_reference_{};

  std::size_t short_faces_ = 0;
  std::size_t points_and_lines_ = 0;
  std::size_t free_forms_ = 0;
  bool has_vertex_colors_ = false;
  SoupFile file_;
};

}  // namespace

Result<SoupFile> read_obj(std::span<const std::byte> bytes) { return ObjReader(as_text(bytes)).read(); }

}  // namespace lodestone::detail
