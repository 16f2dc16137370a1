#include "codec/compact_decoder.h"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

namespace lodestone::detail {
namespace {

auto broken(const std::string& message) { return fail(ErrorCode::Malformed, message); }

}  // namespace

CompactDecoder::CompactDecoder(CompactHeader header, ProgressiveMesh& mesh, std::uint64_t most_bytes)
    : header_(std::move(header)),
      levels_(header_.grid_bits),
      faces_left_(kMostFacesWalked * (header_.face_count() + 1)),
      mesh_(mesh),
      most_bytes_(most_bytes) {}

/// Reads the errors of the last position.
Result<void> CompactDecoder::read_errors(BitCoder& coder) {
  int curvature = 0;
  if (!errors_.code(coder, deviation_code_, curvature)) return broken("errors rise");
  mesh_.deviation.back() = header_.deviation.value(deviation_code_);
  mesh_.curvature_error.back() = header_.curvature.value(curvature);
  return {};
}

void CompactDecoder::add_position(const Vec3i& position) {
  const auto on_axis = [&](std::int64_t steps, float origin) {
    const double top = static_cast<double>((1 << header_.grid_bits) - 1);
    return static_cast<float>(static_cast<double>(origin) +
                              static_cast<double>(steps) * static_cast<double>(header_.grid.range) / top);
  };
  const Vec3f& origin = header_.grid.origin;
  mesh_.positions.push_back(
      {on_axis(position.x, origin.x), on_axis(position.y, origin.y), on_axis(position.z, origin.z)});
}

Result<void> CompactDecoder::read_base(BitCoder& coder) {
  BaseMesh base;
  base.corners.resize(3 * std::size_t{header_.base_face_count});
  base.positions.resize(header_.base_point_count);
  base.same_as.resize(header_.base_point_count);
  if (!levels_.code_base(coder, base)) return broken("base mesh is none");
  mesh_.deviation.push_back(0);
  mesh_.curvature_error.push_back(0);
  LODESTONE_CHECK(read_errors(coder));
  for (Index point = 0; point < header_.base_point_count; ++point) {
    const bool is_copy = base.same_as[point] != point;
    const auto next = static_cast<Index>(mesh_.positions.size());
    mesh_.wedge_vertex.push_back(is_copy ? mesh_.wedge_vertex[base.same_as[point]] : next);
    if (!is_copy) add_position(base.positions[point]);
  }
  if (mesh_.positions.size() != header_.base_vertex_count)
    return broken(
        text("base mesh has ", mesh_.positions.size(), " vertices where ", header_.base_vertex_count, " are due"));
  mesh_.base_vertex_count = header_.base_vertex_count;
  mesh_.base_wedge_count = header_.base_point_count;
  mesh_.groups.push_back({header_.material, 0, std::move(base.corners)});
  mesh_.record_wedge_begin.push_back(mesh_.base_wedge_count);
  mesh_.sector_begin.push_back(0);
  mesh_.polygon_begin.push_back(0);
  mesh_.round_begin.push_back(0);
  return {};
}

/// Notes the coarse faces that a record replaces, by their corners' places in its polygon.
void CompactDecoder::add_triangles(std::size_t i, std::span<const Index> polygon) {
  const NewVertices& round = levels_.round();
  const Index begin = i == 0 ? 0 : round.vertices[i - 1].replaced_end;
  for (Index f = begin; f < round.vertices[i].replaced_end; ++f) {
    mesh_.slots.push_back(round.replaced[f]);
    std::array<std::uint8_t, 3> places{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto found = std::find(polygon.begin(), polygon.end(), round.replaced_corners[f][k]);
      places[k] = static_cast<std::uint8_t>(found - polygon.begin());
    }
    std::sort(places.begin(), places.end());
    mesh_.triangles.insert(mesh_.triangles.end(), places.begin(), places.end());
  }
}

void CompactDecoder::add_record(std::size_t i) {
  const std::span<const Index> star = levels_.round().star(i);
  const bool closed = levels_.round().vertices[i].closed;
  const std::size_t begin = mesh_.polygons.size();
  for (const Index face : star) mesh_.polygons.push_back(levels_.mesh().from(3 * face + 1));
  if (!closed) mesh_.polygons.push_back(levels_.mesh().to(3 * star.back() + 1));
  const std::size_t size = mesh_.polygons.size() - begin;
  add_triangles(i, std::span(mesh_.polygons).subspan(begin));
  mesh_.sectors.push_back({static_cast<std::uint16_t>(size), 0, 0, closed ? SectorShape::Closed : SectorShape::Open});
  mesh_.polygon_begin.push_back(mesh_.polygons.size());
  mesh_.sector_begin.push_back(static_cast<Index>(mesh_.sectors.size()));
  mesh_.wedge_vertex.push_back(static_cast<Index>(mesh_.positions.size()));
  mesh_.record_wedge_begin.push_back(static_cast<Index>(mesh_.wedge_vertex.size()));
  // Up to its end, all of a round has the errors that it begins with.
  mesh_.deviation.push_back(mesh_.deviation.back());
  mesh_.curvature_error.push_back(mesh_.curvature_error.back());
  add_position(levels_.positions()[mesh_.wedge_vertex.size() - 1]);
}

Result<void> CompactDecoder::read_round(BitCoder& coder) {
  const std::uint64_t face_count = levels_.mesh().face_count();
  if (face_count > faces_left_) return fail(ErrorCode::LimitExceeded, "too many rounds for so few faces");
  faces_left_ -= face_count;
  if (!levels_.code_places(coder, nullptr)) return broken("a round has no patches");
  if (levels_.mesh().face_count() > header_.face_count()) return broken("a round has too many patches");
  if (!levels_.code_points(coder, {})) return broken("a position lies off the grid");
  for (std::size_t i = 0; i < levels_.round().vertices.size(); ++i) add_record(i);
  mesh_.round_begin.push_back(static_cast<Index>(mesh_.record_count()));
  LODESTONE_CHECK(check_held_bytes(mesh_, most_bytes_));
  return read_errors(coder);
}

Result<void> CompactDecoder::read_chunk(const CompactChunkEntry& chunk, std::span<const std::byte> bytes) {
  if (checksum32(bytes) != chunk.checksum) return broken("checksum is wrong");
  BitCoder coder(bytes);
  if (chunk_count_ == 0) LODESTONE_CHECK(read_base(coder));
  const std::size_t records = mesh_.record_count(), faces = levels_.mesh().face_count();
  for (std::uint32_t round = 0; round < chunk.round_count; ++round) LODESTONE_CHECK(read_round(coder));
  if (mesh_.record_count() - records != chunk.record_count)
    return broken(text("has ", mesh_.record_count() - records, " records where ", chunk.record_count, " are due"));
  if (levels_.mesh().face_count() - faces != chunk.added_faces())
    return broken("adds another number of faces than is due");
  if (deviation_code_ != chunk.deviation_code) return broken("ends with another deviation than is due");
  mesh_.groups.front().face_count = static_cast<Index>(levels_.mesh().face_count());
  return {};
}

Result<void> CompactDecoder::add_chunk(std::span<const std::byte> bytes) {
  const MeshMark before(mesh_);
  Result<void> added = read_chunk(header_.chunks[chunk_count_], bytes);
  if (added)
    ++chunk_count_;
  else
    before.restore(mesh_);
  return added;
}

}  // namespace lodestone::detail
