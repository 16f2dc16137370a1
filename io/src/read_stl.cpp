// STL: binary (80 bytes of header, a count, 50 bytes a triangle) and ASCII. The facets' normals follow from the
// corners and are not kept: as attributes they would make every edge a seam.

#include <array>
#include <cstring>

#include "bytes.h"
#include "number_text.h"
#include "soup_file.h"
#include "text.h"
#include "try.h"

namespace lodestone::detail {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50;

/// The header may say "solid" in a binary file, too: the size decides.
bool is_binary(std::span<const std::byte> bytes) {
  if (bytes.size() < kHeaderBytes) return false;
  if (bytes.size() == kHeaderBytes + kTriangleBytes * std::uint64_t{load_u32(bytes, 80)}) return true;
  return !as_text(bytes).starts_with("solid");
}

Result<SoupFile> read_binary(std::span<const std::byte> bytes) {
  const std::uint64_t count = load_u32(bytes, 80);
  const std::size_t room = bytes.size() - kHeaderBytes;
  if (count * kTriangleBytes > room)
    return fail(ErrorCode::Malformed, text("stl: ", count, " triangles exceed the ", room, " bytes there are"), 80);
  if (count * 3 >= kNoIndex) return fail(ErrorCode::LimitExceeded, text("stl: ", count, " triangles are too many"), 80);
  SoupFile file;
  file.soup.positions.resize(static_cast<std::size_t>(count) * 3);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = kHeaderBytes + kTriangleBytes * i + 12 * (k + 1);
      file.soup.positions[3 * i + k] = {load_f32(bytes, at), load_f32(bytes, at + 4), load_f32(bytes, at + 8)};
    }
  return file;
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

Result<SoupFile> read_ascii(std::string_view rest) {
  SoupFile file;
  auto& positions = file.soup.positions;
  std::size_t loop_begin = 0, skipped = 0;
  for (std::size_t line_number = 1; !rest.empty(); ++line_number) {
    std::string_view line = next_line(rest);
    const std::string_view keyword = next_token(line);
    if (keyword == "vertex") {
      LODESTONE_TRY(const Vec3f v, read_vertex(line, line_number));
      positions.push_back(v);
    } else if (keyword == "endloop" || keyword == "outer" || keyword == "endsolid") {
      skipped += positions.size() != loop_begin && positions.size() != loop_begin + 3;
      if (positions.size() != loop_begin + 3) positions.resize(loop_begin);
      loop_begin = positions.size();
    }
  }
  if (positions.size() != loop_begin) ++skipped;
  positions.resize(loop_begin);
  if (positions.size() >= kNoIndex) return fail(ErrorCode::LimitExceeded, "stl: too many triangles");
  if (skipped > 0) file.notes.push_back(text(skipped, " facets without three corners are left out"));
  return file;
}

}  // namespace

Result<SoupFile> read_stl(std::span<const std::byte> bytes) {
  const bool binary = is_binary(bytes);
  if (!binary && !as_text(bytes).starts_with("solid"))
    return fail(ErrorCode::Malformed, text("stl: ", bytes.size(), " bytes are neither a binary nor an ASCII file"));
  LODESTONE_TRY(SoupFile file, binary ? read_binary(bytes) : read_ascii(as_text(bytes)));
  file.soup.indices.resize(file.soup.positions.size());
  for (std::size_t i = 0; i < file.soup.indices.size(); ++i) file.soup.indices[i] = static_cast<Index>(i);
  return file;
}

}  // namespace lodestone::detail
