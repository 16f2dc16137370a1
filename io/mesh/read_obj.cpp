// Wavefront OBJ: v, vt, vn, f, usemtl and mtllib, after the format's description in "Advanced Visualizer", appendix B1
// (1992); colours of vertices as MeshLab writes them, behind the coordinates, and as ZBrush does, in comments (#MRGB).
//
// Parsed here and not by a library because positions have to be the correctly rounded floats of what the file says,
// and because a broken file has to name its line. Pieces of the file are parsed side by side, each as if nothing stood
// before it; what hangs on that is settled when they are joined, in their order.

#include <algorithm>
#include <array>
#include <map>
#include <string>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/core/parallel.h>

#include "base/bytes.h"
#include "base/files_beside.h"
#include "mesh/obj_piece.h"
#include "mesh/polygon_soup.h"
#include "mesh/read_mtl.h"
#include "mesh/soup_file.h"
#include "mesh/text_pieces.h"
#include "mesh/vertex_color.h"

namespace lodestone::detail {
namespace {

constexpr std::array<const char*, kObjKindCount> kKindNames = {"vertex", "texture coordinate", "normal"};
constexpr std::size_t kLeastElementBytes = 2;  // " 1"

class ObjReader {
 public:
  explicit ObjReader(const FileFetcher& fetch) : libraries_(fetch, file_) {}

  Result<SoupFile> read(std::string_view text, std::size_t piece_bytes) {
    // In one piece, it is known in which line there are too many elements.
    if (text.size() / kLeastElementBytes >= kNoIndex) piece_bytes = text.size();
    const std::vector<std::string_view> texts = split_at_lines(text, piece_bytes);
    std::vector<ObjPiece> pieces(texts.size());
    for_each_in_parallel(texts.size(), [&](std::size_t i) { pieces[i] = read_obj_piece(texts[i]); });
    for (ObjPiece& piece : pieces) LODESTONE_CHECK(append(std::move(piece)));
    if (last_reference_[kPosition].line > 0 && last_reference_[kPosition].index >= positions_.size())
      return fail(ErrorCode::Malformed, missing_text(kPosition));
    for (std::vector<Index>& elements : corners_)
      if (!elements.empty()) elements.resize(corners_[kPosition].size(), kNoIndex);
    drop_missing_references();
    return make_soup();
  }

 private:
  Result<void> append(ObjPiece piece) {
    for (const ObjPiece::Relative& relative : piece.relative) {
      LODESTONE_TRY(piece.corners[relative.kind][relative.corner], resolve(relative));
    }
    if (piece.failure)
      return fail(piece.failure->code, text("line ", line_count_ + piece.failure->line, ": ", piece.failure->message));
    for (std::size_t kind = 0; kind < kObjKindCount; ++kind) note_reference(kind, piece.last_reference[kind]);
    append_colors(std::move(piece.colors));
    append_faces(piece);
    append_moved(positions_, std::move(piece.positions));
    append_moved(texcoords_, std::move(piece.texcoords));
    append_moved(normals_, std::move(piece.normals));
    append_moved(painted_, std::move(piece.painted));
    for (const std::string& names : piece.libraries) libraries_.add(names);
    points_and_lines_ += piece.points_and_lines;
    free_forms_ += piece.free_forms;
    line_count_ += piece.line_count;
    return {};
  }

  std::size_t element_count(int kind) const {
    return kind == kPosition ? positions_.size() : kind == kTexcoord ? texcoords_.size() : normals_.size();
  }

  /// Turns a number that counts back from the last element into a 0-based one. Faces whose texture coordinate or normal
  /// cannot be there keep their shape. The next piece is being appended.
  Result<Index> resolve(const ObjPiece::Relative& relative) {
    const ObjKind kind = relative.kind;
    const long long index = relative.index;
    const std::size_t so_far = element_count(kind) + relative.element_count;
    const auto count = static_cast<long long>(so_far);
    const std::size_t line = line_count_ + relative.line;
    if (index >= 0 || index < -count) {
      if (kind == kPosition)
        return fail(ErrorCode::Malformed, text("line ", line, ": ", kKindNames[kind], " index ", index,
                                               " is out of range: there are ", count, " so far"));
      if (missing_[kind]++ == 0) first_missing_[kind] = line;
      return kNoIndex;
    }
    const auto resolved = static_cast<Index>(count + index);
    note_reference(kind, {resolved, relative.line});
    return resolved;
  }

  /// Notes what the piece being appended names.
  void note_reference(std::size_t kind, const ObjPiece::Reference& reference) {
    if (reference.line == 0) return;
    ObjPiece::Reference& last = last_reference_[kind];
    const std::size_t line = line_count_ + reference.line;
    const bool is_first = reference.index == last.index && line < last.line;
    if (last.line == 0 || reference.index > last.index || is_first) last = {reference.index, line};
  }

  void append_colors(std::vector<Rgba>&& colors) {
    if (colors.empty()) return;
    colors_.resize(positions_.size(), kNoColor);
    append_moved(colors_, std::move(colors));
  }

  void append_faces(ObjPiece& piece) {
    const std::size_t first_face = sizes_.size();
    const std::size_t first_corner = corners_[kPosition].size();
    append_moved(sizes_, std::move(piece.sizes));
    append_materials(piece.materials, first_face);
    for (std::size_t kind = 0; kind < kObjKindCount; ++kind) {
      if (piece.corners[kind].empty()) continue;
      corners_[kind].resize(first_corner, kNoIndex);
      append_moved(corners_[kind], std::move(piece.corners[kind]));
    }
  }

  /// Gives the piece's faces, which have been appended, their materials.
  void append_materials(const std::vector<ObjPiece::MaterialUse>& uses, std::size_t first_face) {
    if (uses.empty() && materials_.empty()) return;
    face_material_.resize(first_face, 0);
    for (const ObjPiece::MaterialUse& use : uses) {
      face_material_.resize(first_face + use.first_face, material_);
      const auto next = static_cast<Index>(materials_.size() + 1);
      material_ = use.name.empty() ? 0 : materials_.try_emplace(use.name, next).first->second;
    }
    face_material_.resize(sizes_.size(), material_);
  }

  std::string missing_text(int kind) const {
    const ObjPiece::Reference& last = last_reference_[kind];
    return text("line ", last.line, ": ", kKindNames[kind], " index ", std::uint64_t{last.index} + 1,
                " is out of range: the file has ", element_count(kind));
  }

  /// Takes texture coordinates and normals that the file lacks from the corners that name them.
  void drop_missing_references() {
    for (const int kind : {kTexcoord, kNormal}) {
      for (Index& element : corners_[kind]) {
        if (element == kNoIndex || element < element_count(kind)) continue;
        element = kNoIndex;
        ++missing_[kind];
      }
      if (missing_[kind] == 0) continue;
      const std::size_t line = first_missing_[kind] > 0 ? first_missing_[kind] : last_reference_[kind].line;
      file_.notes.push_back(text(missing_[kind], " corners of faces name a ", kKindNames[kind],
                                 " that the file lacks, as in line ", line, ": it has ", element_count(kind)));
    }
  }

  std::size_t corner_count() const { return corners_[kPosition].size(); }

  /// How many corners name an element of this kind.
  std::size_t uses(int kind) const {
    const std::vector<Index>& elements = corners_[kind];
    return elements.size() - static_cast<std::size_t>(std::count(elements.begin(), elements.end(), kNoIndex));
  }

  Result<SoupFile> make_soup() {
    const std::size_t texcoord_uses = uses(kTexcoord), normal_uses = uses(kNormal);
    const bool with_normals = corner_count() > 0 && normal_uses == corner_count();
    if (texcoord_uses > 0 && texcoord_uses < corner_count())
      file_.notes.push_back(text(corner_count() - texcoord_uses, " corners without texture coordinates got 0, 0"));
    if (!with_normals && normal_uses > 0)
      file_.notes.push_back("the normals are left out, since not every corner has one");

    PolygonSoup polygons;
    if (with_normals) polygons.corner_attributes.push_back(corner_attribute("NORMAL", kNormal, normals_));
    if (texcoord_uses > 0) polygons.corner_attributes.push_back(corner_attribute("TEXCOORD_0", kTexcoord, texcoords_));
    add_colors(polygons);
    polygons.corners = std::move(corners_[kPosition]);
    polygons.positions = std::move(positions_);
    polygons.sizes = std::move(sizes_);
    if (!materials_.empty()) polygons.face_material = std::move(face_material_);
    LODESTONE_TRY(file_.soup, to_triangles(std::move(polygons), file_.notes));
    make_materials();
    note_left_out();
    return std::move(file_);
  }

  /// Corners that name no element have zeros.
  template <std::size_t N>
  CornerAttribute corner_attribute(const char* name, ObjKind kind, std::vector<std::array<float, N>>& elements) {
    std::vector<Index> numbers = std::move(corners_[kind]);
    std::replace(numbers.begin(), numbers.end(), kNoIndex, static_cast<Index>(elements.size()));
    elements.push_back({});
    return {float_attribute(name, N, {elements[0].data(), N * elements.size()}), std::move(numbers)};
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

  void note_left_out() {
    const auto note = [&](std::size_t count, const char* what) {
      if (count > 0) file_.notes.push_back(text(count, what));
    };
    note(points_and_lines_, " point and line elements are left out");
    note(free_forms_, " free-form curves and surfaces are left out");
  }

  std::size_t line_count_ = 0;  ///< of the pieces appended, as all that follows
  std::vector<Vec3f> positions_;
  std::vector<std::array<float, 2>> texcoords_;
  std::vector<std::array<float, 3>> normals_;
  std::vector<Rgba> colors_;                               ///< of the first vertices
  std::vector<Rgba> painted_;                              ///< ZBrush's, in the vertices' order
  std::array<std::vector<Index>, kObjKindCount> corners_;  ///< of texture coordinates and normals those of the first
  std::vector<Index> sizes_;                               ///< one per face
  std::vector<Index> face_material_;                       ///< empty until there is a material
  std::map<std::string, Index> materials_;  ///< numbers from 1, in order of first use; 0: faces before any usemtl
  Index material_ = 0;
  std::array<ObjPiece::Reference, kObjKindCount> last_reference_{};
  std::array<std::size_t, kObjKindCount> missing_{};        ///< corners that name what the file lacks
  std::array<std::size_t, kObjKindCount> first_missing_{};  ///< the line of a relative one

  std::size_t points_and_lines_ = 0;
  std::size_t free_forms_ = 0;
  SoupFile file_;
  MaterialLibraries libraries_;
};

}  // namespace

Result<SoupFile> read_obj(std::span<const std::byte> bytes, const FileFetcher& fetch, std::size_t piece_bytes) {
  return ObjReader(fetch).read(without_byte_order_mark(as_text(bytes)), piece_bytes);
}

}  // namespace lodestone::detail
