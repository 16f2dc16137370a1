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

LevelLimits limits_of(const CompactHeader& header) {
  return {header.grid_bits,         header.is_fast(),        static_cast<Index>(header.groups.size()),
          header.base_vertex_count, header.base_wedge_count, header.base_face_count()};
}

}  // namespace

CompactDecoder::CompactDecoder(CompactHeader header, ProgressiveMesh& mesh, std::uint64_t most_bytes)
    : header_(std::move(header)),
      levels_(limits_of(header_), header_.attributes),
      mesh_(mesh),
      most_bytes_(most_bytes) {
  if (header_.lossless) rests_.emplace(static_cast<float>(header_.step()), header_.attributes);
}

void CompactDecoder::count_rounds(std::vector<CompactRound>& rounds) {
  rounds_ = &rounds;
  levels_.count_attributes();
}

void CompactDecoder::start_round() {
  if (rounds_ == nullptr) return;
  CompactRound& round = rounds_->emplace_back();
  round.chunk = chunk_count_;
  for (const double bits : levels_.attributes().bits) round.sizes.attributes.push_back(-bits);
}

/// Adds what was read since the last call to a part of the round.
void CompactDecoder::spend(const BitCoder& coder, double CompactSizes::*part) {
  if (rounds_ == nullptr) return;
  const double now = coder.bits();
  rounds_->back().sizes.*part += now - bits_at_;
  bits_at_ = now;
}

/// Passes over what was read of attributes: that is counted where it is.
void CompactDecoder::pass_attributes(const BitCoder& coder) {
  if (rounds_ != nullptr) bits_at_ = coder.bits();
}

void CompactDecoder::end_round() {
  if (rounds_ == nullptr) return;
  CompactRound& round = rounds_->back();
  const std::vector<double>& bits = levels_.attributes().bits;
  for (std::size_t a = 0; a < bits.size(); ++a) round.sizes.attributes[a] += bits[a];
  round.record_count = levels_.vertices().count();
  round.vertex_count = mesh_.positions.size();
  round.face_count = levels_.mesh().face_count();
  round.deviation = mesh_.deviation.back();
}

/// Reads the errors of the last position.
Result<void> CompactDecoder::read_errors(BitCoder& coder) {
  int curvature = 0;
  if (!errors_.code(coder, deviation_code_, curvature)) return broken("errors rise");
  within_code_ = deviation_code_;
  if (stage_ends_ && !errors_.code_stage_end(coder, deviation_code_, within_code_))
    return broken("a placed level is worse");
  mesh_.deviation.back() = header_.deviation.value(deviation_code_);
  mesh_.curvature_error.back() = header_.curvature.value(curvature);
  spend(coder, &CompactSizes::errors);
  return {};
}

/// Adds where vertices go in a round whose records are there.
void CompactDecoder::add_moves() {
  if (levels_.moves().empty() && mesh_.move_begin.empty()) return;
  const std::size_t count = levels_.vertices().count(), first = mesh_.record_count() - count;
  mesh_.move_begin.resize(first + count + 1, 0);            // where none has moved before
  Index* const ends = mesh_.move_begin.data() + first + 1;  // by record of the round
  const auto end_of = [&](const CodedMove& move) -> Index& {
    return ends[move.star == kNoIndex
                    ? count - 1
                    : levels_.stars().stars[move.star].vertex - mesh_.base_vertex_count - static_cast<Index>(first)];
  };
  for (const CodedMove& move : levels_.moves()) ++end_of(move);
  auto begin = static_cast<Index>(mesh_.moves.size());
  for (std::size_t i = 0; i < count; ++i) begin += std::exchange(ends[i], begin);
  mesh_.moves.resize(begin);
  // Where a record's begin moves to where they end.
  for (const CodedMove& move : levels_.moves())
    mesh_.moves[end_of(move)++] = {move.vertex, header_.place(move.from), header_.place(move.to)};
}

/// Adds the positions of the newest vertices and the attributes of the newest wedges.
Result<void> CompactDecoder::add_values(BitCoder& coder) {
  for (std::size_t v = mesh_.positions.size(); v < levels_.positions().size(); ++v) {
    const Vec3i point = levels_.positions()[v];
    Vec3f& position = mesh_.positions.emplace_back(header_.place(point));
    if (rests_ && !rests_->code_position(coder, point, {}, position)) return broken("a position is no number");
  }
  for (std::size_t a = 0; a < mesh_.attributes.size(); ++a) {
    const ElementCoder& coded = levels_.attributes().attribute(a);
    const std::size_t size = mesh_.attributes[a].element_bytes();
    std::vector<std::byte>& data = mesh_.attributes[a].data;
    for (auto w = static_cast<Index>(data.size() / size); w < levels_.wedges().size(); ++w) {
      append_element(coded.spec(), coded.numbers(w), data);
      if (rests_ && !rests_->code_element(coder, a, coded.numbers(w), {}, std::span(data).last(size)))
        return broken("an attribute is no float");
    }
  }
  spend(coder, &CompactSizes::rests);
  return {};
}

void CompactDecoder::begin_mesh() {
  const PatchMesh& level = levels_.mesh();
  const std::span<const Index> wedge_vertices = levels_.wedges().vertices();
  mesh_.wedge_vertex.assign(wedge_vertices.begin(), wedge_vertices.end());
  mesh_.base_vertex_count = header_.base_vertex_count;
  mesh_.base_wedge_count = header_.base_wedge_count;
  for (const CompactGroup& group : header_.groups) mesh_.groups.push_back({group.material, 0, {}});
  group_faces_.assign(header_.groups.size(), 0);
  for (Index face = 0; face < level.face_count(); ++face) {
    slots_.push_back(group_faces_[level.group(face)]++);
    for (Index c = 3 * face; c < 3 * face + 3; ++c)
      mesh_.groups[level.group(face)].base_corners.push_back(level.wedge(c));
  }
  for (const AttributeSpec& spec : header_.attributes)
    mesh_.attributes.push_back({spec.name, spec.type, spec.component_count, spec.normalized, {}});
  mesh_.record_wedge_begin.push_back(mesh_.base_wedge_count);
  mesh_.sector_begin.push_back(0);
  mesh_.polygon_begin.push_back(0);
  mesh_.round_begin.push_back(0);
}

/// Checks what the arrays of the base mesh take before there are any.
Result<void> CompactDecoder::check_base_bytes() const {
  std::uint64_t bytes_each = sizeof(Index);
  for (const AttributeSpec& spec : header_.attributes)
    bytes_each += std::uint64_t{component_bytes(spec.type)} * spec.component_count;
  return check_held_bytes(header_.base_vertex_count * std::uint64_t{sizeof(Vec3f)} +
                              header_.base_wedge_count * bytes_each + 3 * sizeof(Index) * header_.base_face_count(),
                          most_bytes_);
}

Result<void> CompactDecoder::read_base(BitCoder& coder) {
  LODESTONE_CHECK(check_base_bytes());
  start_round();
  BaseMesh base;
  const auto face_count = static_cast<std::size_t>(header_.base_face_count());
  base.corners.resize(3 * face_count);
  base.wedges.resize(3 * face_count);
  base.positions.resize(header_.base_vertex_count);
  base.wedge_counts.resize(header_.base_vertex_count);
  for (Index g = 0; g < header_.groups.size(); ++g)
    base.groups.insert(base.groups.end(), header_.groups[g].base_face_count, g);
  int step = 0;
  if (!levels_.code_step(coder, step)) return broken("its grid is too coarse");
  if (header_.lossless && step != 0) return broken("lossless, it begins on a coarser grid");
  if (!levels_.code_base(coder, base)) return broken("base mesh is none");
  if (levels_.wedges().size() != header_.base_wedge_count)
    return broken(
        text("base mesh has ", levels_.wedges().size(), " wedges where ", header_.base_wedge_count, " are due"));
  spend(coder, &CompactSizes::base);
  if (!levels_.code_base_attributes(coder, {})) return broken("an attribute of the base mesh is out of its range");
  pass_attributes(coder);
  begin_mesh();
  LODESTONE_CHECK(add_values(coder));
  mesh_.deviation.push_back(0);
  mesh_.curvature_error.push_back(0);
  LODESTONE_CHECK(read_errors(coder));
  end_round();
  return check_held_bytes(mesh_, most_bytes_);
}

/// Adds a sector but for its corners, triangles and slots.
void CompactDecoder::add_sector(const SectorList::Sector& sector) {
  const std::uint64_t end = polygon_base_ + sector.polygon_end;
  mesh_.sectors.push_back({static_cast<std::uint16_t>(end - mesh_.polygon_begin.back()),
                           static_cast<std::uint16_t>(sector.group),
                           static_cast<std::uint16_t>(sector.wedge - mesh_.record_wedge_begin.back()), sector.shape});
  mesh_.polygon_begin.push_back(end);
}

/// Adds the record with these sectors of the round, of the next vertex.
void CompactDecoder::add_record(std::size_t begin, std::size_t end) {
  const SectorList& sectors = levels_.sectors();
  const auto vertex = mesh_.base_vertex_count + static_cast<Index>(mesh_.record_count());
  std::size_t freed = mesh_.slots.size();
  for (std::size_t s = begin; s < end; ++s) {
    add_sector(sectors.sectors[s]);
    for (const Index face : sectors.coarse_of(s)) mesh_.slots.push_back(slots_[face]);
  }
  for (std::size_t s = begin; s < end; ++s) {
    const std::span<const Index> fine = sectors.fine_of(s);
    const std::size_t kept = sectors.coarse_of(s).size();
    Index& group_faces = group_faces_[sectors.sectors[s].group];
    for (std::size_t k = 0; k < fine.size(); ++k) slots_[fine[k]] = k < kept ? mesh_.slots[freed++] : group_faces++;
  }
  mesh_.sector_begin.push_back(static_cast<Index>(mesh_.sectors.size()));
  mesh_.record_wedge_begin.push_back(levels_.wedges().end(vertex));
}

/// Adds the records of a round.
void CompactDecoder::add_records() {
  const SectorList& sectors = levels_.sectors();
  const std::vector<Index>& ends = levels_.vertices().sector_end;
  slots_.resize(levels_.mesh().face_count());
  polygon_base_ = mesh_.polygons.size();
  mesh_.polygons.insert(mesh_.polygons.end(), sectors.polygons.begin(), sectors.polygons.end());
  static_assert(sizeof(sectors.triangles[0]) == 3);
  const auto* const places = reinterpret_cast<const std::uint8_t*>(sectors.triangles.data());
  mesh_.triangles.insert(mesh_.triangles.end(), places, places + 3 * sectors.triangles.size());
  for (std::size_t i = 0; i < ends.size(); ++i) add_record(i == 0 ? 0 : ends[i - 1], ends[i]);
  const std::span<const Index> wedge_vertices = levels_.wedges().vertices();
  mesh_.wedge_vertex.insert(mesh_.wedge_vertex.end(), wedge_vertices.begin() + mesh_.wedge_vertex.size(),
                            wedge_vertices.end());
  // Up to its end, all of a round has the errors that it begins with, or that its stage does.
  mesh_.deviation.resize(mesh_.deviation.size() + ends.size(), header_.deviation.value(within_code_));
  mesh_.curvature_error.resize(mesh_.curvature_error.size() + ends.size(), mesh_.curvature_error.back());
}

Result<void> CompactDecoder::read_round(BitCoder& coder) {
  walked_ += levels_.size();
  if (walked_ > most_walked_) return fail(ErrorCode::LimitExceeded, "too many rounds for so small a mesh");
  start_round();
  if (!levels_.code_patches(coder, nullptr)) return broken("a round has no patches");
  spend(coder, &CompactSizes::places);
  if (!levels_.code_moves(coder, {})) return broken("a vertex moves off the grid");
  spend(coder, &CompactSizes::moves);
  if (!levels_.code_places(coder, {})) return broken("a round's patches do not belong together");
  spend(coder, &CompactSizes::places);
  if (!levels_.code_wedges(coder, nullptr)) return broken("a round has wedges that do not fit");
  spend(coder, &CompactSizes::wedges);
  if (!levels_.code_points(coder, {})) return broken("a position lies off the grid");
  spend(coder, &CompactSizes::positions);
  if (!levels_.code_attributes(coder, {})) return broken("an attribute is out of its range");
  pass_attributes(coder);
  Index loose = 0;
  if (!levels_.code_loose_count(coder, loose)) return broken("a round has no vertices, or too many");
  if (rounds_ != nullptr) rounds_->back().loose_count = loose;
  for (; loose > 0; --loose)
    if (LooseVertex read; !levels_.code_loose_vertex(coder, read)) return broken("a loose record does not fit");
  spend(coder, &CompactSizes::loose);
  if (!levels_.code_attributes(coder, {})) return broken("an attribute is out of its range");
  pass_attributes(coder);
  LODESTONE_CHECK(add_values(coder));
  if (!levels_.code_stage_end(coder, stage_ends_, {})) return broken("a vertex moves off the grid");
  if (header_.lossless && stage_ends_) return broken("lossless, it has placed levels");
  if (int step = 0; stage_ends_ && !levels_.code_step(coder, step)) return broken("its grid is too coarse");
  spend(coder, &CompactSizes::moves);
  add_records();
  add_moves();
  mesh_.round_begin.push_back(static_cast<Index>(mesh_.record_count()));
  LODESTONE_CHECK(check_held_bytes(mesh_, most_bytes_));
  LODESTONE_CHECK(read_errors(coder));
  end_round();
  return {};
}

Result<void> CompactDecoder::read_chunk(const CompactChunkEntry& chunk, std::span<const std::byte> bytes) {
  if (checksum32(bytes) != chunk.checksum) return broken("checksum is wrong");
  BitCoder coder(bytes, header_.is_fast());
  bits_at_ = 0;
  if (chunk_count_ == 0) LODESTONE_CHECK(read_base(coder));
  const std::size_t records = mesh_.record_count(), faces = levels_.mesh().face_count();
  const std::size_t wedges = levels_.wedges().size();
  levels_.allow(chunk.record_count, chunk.wedge_count, chunk.face_count);
  most_walked_ =
      kMostWalked * (levels_.size() + std::uint64_t{chunk.record_count} + chunk.wedge_count + chunk.face_count);
  for (std::uint32_t round = 0; round < chunk.round_count; ++round) LODESTONE_CHECK(read_round(coder));
  if (mesh_.record_count() - records != chunk.record_count)
    return broken(text("has ", mesh_.record_count() - records, " records where ", chunk.record_count, " are due"));
  if (levels_.mesh().face_count() - faces != chunk.face_count)
    return broken("adds another number of faces than is due");
  if (levels_.wedges().size() - wedges != chunk.wedge_count) return broken("adds another number of wedges than is due");
  if (deviation_code_ != chunk.deviation_code) return broken("ends with another deviation than is due");
  for (std::size_t g = 0; g < mesh_.groups.size(); ++g) mesh_.groups[g].face_count = group_faces_[g];
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
