#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <lodestone/core/ids.h>
#include <lodestone/core/result.h>
#include <lodestone/core/vec.h>

namespace lodestone::detail {

/// What a face's corner names.
enum ObjKind { kPosition, kTexcoord, kNormal, kObjKindCount };

using Rgba = std::array<float, 4>;
constexpr Rgba kNoColor = {-1, -1, -1, -1};

/// What consecutive lines of an OBJ file say, as far as they say it without those before them. Lines count from 1, at
/// the piece's first one.
struct ObjPiece {
  /// The largest element that a corner names, and the first line in which one does.
  struct Reference {
    Index index = 0;
    std::size_t line = 0;  ///< 0: there was none
  };
  /// A corner's number of an element that hangs on how many stand before it, or is out of range wherever it stands.
  struct Relative {
    ObjKind kind = kPosition;
    long long index = 0;
    std::size_t corner = 0;
    Index element_count = 0;  ///< of its kind, before it in this piece
    std::size_t line = 0;
  };
  /// A statement `usemtl`.
  struct MaterialUse {
    std::size_t first_face = 0;
    std::string name;  ///< "": none
  };
  struct Failure {
    ErrorCode code = ErrorCode::Malformed;
    std::size_t line = 0;
    std::string message;
  };

  std::vector<Vec3f> positions;
  std::vector<std::array<float, 2>> texcoords;
  std::vector<std::array<float, 3>> normals;
  /// Of the first vertices; kNoColor where a vertex has none, alpha −1 where a colour has none.
  std::vector<Rgba> colors;
  std::vector<Rgba> painted;  ///< ZBrush's, in the vertices' order
  /// What corners name, numbered from 0 through the whole file; of texture coordinates and normals those of the first
  /// corners. kNoIndex: none. An entry of `relative` has its place, but no value.
  std::array<std::vector<Index>, kObjKindCount> corners;
  std::vector<Relative> relative;
  std::array<Reference, kObjKindCount> last_reference{};  ///< among those of `corners`
  std::vector<Index> sizes;                               ///< of each face: its number of corners
  std::vector<MaterialUse> materials;
  std::vector<std::string> libraries;  ///< what statements `mtllib` name
  std::size_t points_and_lines = 0;
  std::size_t free_forms = 0;
  std::size_t line_count = 0;
  std::optional<Failure> failure;  ///< where reading ended
};

/// Reads a piece, up to the first error in it.
ObjPiece read_obj_piece(std::string_view text);

}  // namespace lodestone::detail
