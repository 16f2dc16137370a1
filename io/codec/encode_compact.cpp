#include <lodestone/io/compact_stream.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <unordered_map>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "codec/compact_layout.h"
#include "codec/level_coder.h"
#include "stream/stream_layout.h"

namespace lodestone {
namespace {

using namespace detail;

// A chunk ends with the first round after so many bytes, or as many as came before it.
constexpr std::size_t kLeastChunkBytes = 1024;

auto unsupported(const std::string& message) { return fail(ErrorCode::Unsupported, "compact stream: " + message); }

Result<void> check(const ProgressiveMesh& mesh, const CompactOptions& options) {
  if (options.grid_bits < kLeastGridBits || options.grid_bits > kMostGridBits)
    return fail(ErrorCode::InvalidArgument, text("compact stream: grid of ", options.grid_bits, " bits is not of ",
                                                 kLeastGridBits, " to ", kMostGridBits));
  if (options.grid && !(options.grid->range > 0 && std::isfinite(options.grid->range)))
    return fail(ErrorCode::InvalidArgument, "compact stream: grid has no size");
  if (!mesh.attributes.empty()) return unsupported(text("mesh has ", mesh.attributes.size(), " attributes"));
  if (mesh.groups.size() != 1) return unsupported(text("mesh has ", mesh.groups.size(), " groups"));
  for (std::size_t k = 0; k < mesh.record_count(); ++k) {
    const Index s = mesh.sector_begin[k];
    const std::string name = text("record ", k);
    if (mesh.sector_begin[k + 1] != s + 1)
      return unsupported(text(name, " has ", mesh.sector_begin[k + 1] - s, " sectors"));
    if (mesh.record_wedge_begin[k + 1] != mesh.record_wedge_begin[k] + 1)
      return unsupported(text(name, " has ", mesh.record_wedge_begin[k + 1] - mesh.record_wedge_begin[k], " wedges"));
    const SectorHeader& sector = mesh.sectors[s];
    if (sector.shape != SectorShape::Open && sector.shape != SectorShape::Closed)
      return unsupported(name + " is of a piece that vanishes, or of lines that meet");
    if (sector.polygon_size > kMostPatchCorners)
      return unsupported(text(name, " has a polygon of ", sector.polygon_size, " corners"));
  }
  return {};
}

CompactGrid box_of(const ProgressiveMesh& mesh) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Vec3f low = {kInfinity, kInfinity, kInfinity}, high = {-kInfinity, -kInfinity, -kInfinity};
  for (const Vec3f& p : mesh.positions) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  if (mesh.positions.empty()) return {};
  const float range = std::max({high.x - low.x, high.y - low.y, high.z - low.z});
  return {low, range > 0 && std::isfinite(range) ? range : 1};
}

/// By position: the largest error there or at a finer one. Measured bounds may be lower at coarser levels.
std::vector<float> largest_from(std::vector<float> errors) {
  for (std::size_t i = errors.size(); i-- > 1;) errors[i - 1] = std::max(errors[i - 1], errors[i]);
  return errors;
}

/// Encodes a progressive mesh. Pre: `check` found nothing.
class CompactEncoder {
 public:
  CompactEncoder(const ProgressiveMesh& mesh, const CompactOptions& options) : mesh_(mesh), levels_(options.grid_bits) {
    header_.grid_bits = options.grid_bits;
    header_.grid = options.grid ? *options.grid : box_of(mesh);
    header_.material = mesh.groups.front().material;
    point_of_.assign(mesh.wedge_vertex.size(), kNoIndex);
    deviation_ = largest_from(mesh.deviation);
    curvature_ = largest_from(mesh.curvature_error);
    face_of_.assign(mesh.groups.front().face_count, kNoIndex);
    made_in_.assign(mesh.groups.front().face_count, 0);
  }

  Result<CompactStream> run();

 private:
  // A record's sector, which is the only one.
  const SectorHeader& sector(Index record) const { return mesh_.sectors[record]; }
  std::span<const Index> polygon(Index record) const {
    return std::span(mesh_.polygons).subspan(mesh_.polygon_begin[record], sector(record).polygon_size);
  }
  std::span<const Index> slots(Index record) const {
    return std::span(mesh_.slots).subspan(mesh_.slot_begin(record), sector(record).polygon_size - 2U);
  }
  Index point(Index wedge) const { return point_of_[wedge]; }

  Vec3i grid_position(Index wedge) const;
  float widened(float deviation) const;
  Result<void> write_base();
  void find_first_slots();
  Index take_round(Index first);
  bool is_ready(Index record, Index round_first);
  Result<void> write_round(Index first, Index end);
  Result<void> plan_round(Index first, Index end, PatchPlan& plan);
  Result<void> plan_ear(Index record, PatchPlan& plan);
  Index find_border(Index from, Index to);
  Index closing_edge(Index record) const;
  Result<std::vector<Vec3i>> number_round(const PatchPlan& plan, std::size_t count);
  bool number_star(Index record, std::size_t i);
  void write_errors(Index position);
  void end_chunk();
  void spend(double& part);

  const ProgressiveMesh& mesh_;
  CompactHeader header_;
  LevelCoder levels_;
  ErrorCoder errors_;
  BitCoder coder_;
  double bits_at_ = 0;  // where the last part ended
  std::vector<std::byte> body_;
  CompactChunkEntry chunk_;
  int deviation_code_ = 255;
  CompactStream result_;

  std::vector<float> deviation_, curvature_;  // by position; they never rise
  std::vector<Index> point_of_;               // by wedge of the mesh
  std::vector<Index> face_of_;                // by slot of the mesh
  std::vector<Index> made_in_;                // by slot: the round that wrote it last
  std::vector<Index> first_slot_;             // by record: of the faces it appends
  Index round_ = 0;
  std::vector<Index> patch_records_;                  // of the round at hand: by planned patch
  std::unordered_map<Index, Index> ear_records_;      // by half-edge
  std::unordered_map<std::uint64_t, Index> borders_;  // of the level before a round: half-edges by their ends
  Index borders_of_ = 0;                              // which round's
};

Vec3i CompactEncoder::grid_position(Index wedge) const {
  const auto on_axis = [&](float value, float origin) {
    const double top = static_cast<double>((1 << header_.grid_bits) - 1);
    const double steps =
        (static_cast<double>(value) - static_cast<double>(origin)) * top / static_cast<double>(header_.grid.range);
    return static_cast<std::int64_t>(std::floor(std::clamp(steps, 0.0, top) + 0.5));
  };
  const Vec3f& p = mesh_.positions[mesh_.wedge_vertex[wedge]];
  const Vec3f& origin = header_.grid.origin;
  return {on_axis(p.x, origin.x), on_axis(p.y, origin.y), on_axis(p.z, origin.z)};
}

/// A level's deviation with rounded positions: its points and those of the full mesh both move.
float CompactEncoder::widened(float deviation) const {
  if (deviation <= 0) return 0;
  const double step = static_cast<double>(header_.grid.range) / static_cast<double>((1 << header_.grid_bits) - 1);
  const double wide = static_cast<double>(deviation) + std::sqrt(3.0) * step;
  return std::nextafter(static_cast<float>(wide), std::numeric_limits<float>::max());
}

/// Adds what was written since the last call to a part.
void CompactEncoder::spend(double& part) {
  const double now = coder_.bits();
  part += now - bits_at_;
  bits_at_ = now;
}

void CompactEncoder::write_errors(Index position) {
  deviation_code_ = header_.deviation.code(widened(deviation_[position]));
  int curvature = header_.curvature.code(curvature_[position]);
  errors_.code(coder_, deviation_code_, curvature);
  spend(result_.sizes.errors);
}

/// Numbers base points in the order in which faces use them; those without faces come last.
Result<void> CompactEncoder::write_base() {
  BaseMesh base;
  std::vector<Index> wedges;
  const auto number = [&](Index wedge) {
    if (point_of_[wedge] != kNoIndex) return;
    point_of_[wedge] = static_cast<Index>(wedges.size());
    wedges.push_back(wedge);
  };
  const std::vector<Index>& corners = mesh_.groups.front().base_corners;
  for (const Index wedge : corners) number(wedge);
  for (Index wedge = 0; wedge < mesh_.base_wedge_count; ++wedge) number(wedge);
  for (const Index wedge : corners) base.corners.push_back(point(wedge));
  std::unordered_map<Index, Index> first_of_vertex;
  for (Index i = 0; i < wedges.size(); ++i) {
    base.positions.push_back(grid_position(wedges[i]));
    base.same_as.push_back(first_of_vertex.try_emplace(mesh_.wedge_vertex[wedges[i]], i).first->second);
  }
  header_.base_point_count = static_cast<Index>(wedges.size());
  header_.base_vertex_count = static_cast<Index>(first_of_vertex.size());
  header_.base_face_count = static_cast<Index>(corners.size() / 3);
  for (Index face = 0; face < header_.base_face_count; ++face) face_of_[face] = face;
  header_.deviation = ErrorScale(widened(deviation_.front()));
  header_.curvature = ErrorScale(curvature_.front());
  if (!levels_.code_base(coder_, base)) return unsupported("base mesh is not manifold");
  spend(result_.sizes.base);
  write_errors(0);
  return {};
}

void CompactEncoder::find_first_slots() {
  auto count = static_cast<Index>(mesh_.groups.front().base_corners.size() / 3);
  for (Index k = 0; k < mesh_.record_count(); ++k) {
    first_slot_.push_back(count);
    count += static_cast<Index>(appended_face_count(sector(k).shape));
  }
}

/// Whether what a record needs was there before the round.
bool CompactEncoder::is_ready(Index record, Index round_first) {
  const auto was_there = [&](Index wedge) { return wedge < mesh_.record_wedge_begin[round_first]; };
  const std::span<const Index> ring = polygon(record);
  if (!std::all_of(ring.begin(), ring.end(), was_there)) return false;
  if (ring.size() == 2) return find_border(point(ring[1]), point(ring[0])) != kNoIndex;
  const std::span<const Index> faces = slots(record);
  return std::none_of(faces.begin(), faces.end(), [&](Index slot) { return made_in_[slot] == round_; });
}

/// Takes records, from one on, while none needs what another of them makes; returns the first of the next round.
Index CompactEncoder::take_round(Index first) {
  ++round_;
  Index record = first;
  for (; record < mesh_.record_count() && is_ready(record, first); ++record) {
    const auto appended = static_cast<Index>(appended_face_count(sector(record).shape));
    for (const Index slot : slots(record)) made_in_[slot] = round_;
    for (Index i = 0; i < appended; ++i) made_in_[first_slot_[record] + i] = round_;
  }
  return record;
}

/// Returns the border half-edge between two points of the level before the round, or kNoIndex.
Index CompactEncoder::find_border(Index from, Index to) {
  const auto key = [](Index a, Index b) { return std::uint64_t{a} << 32U | b; };
  if (borders_of_ != round_) {
    borders_of_ = round_;
    borders_.clear();
    const PatchMesh& level = levels_.mesh();
    for (Index h = 0; h < 3 * level.face_count(); ++h)
      if (level.twin(h) == kNoIndex) borders_[key(level.from(h), level.to(h))] = h;
  }
  const auto found = borders_.find(key(from, to));
  return found == borders_.end() ? kNoIndex : found->second;
}

Index CompactEncoder::closing_edge(Index record) const {
  const PatchMesh& level = levels_.mesh();
  const std::span<const Index> ring = polygon(record);
  for (const Index slot : slots(record))
    for (Index h = 3 * face_of_[slot]; h < 3 * face_of_[slot] + 3; ++h)
      if (level.from(h) == point(ring.back()) && level.to(h) == point(ring.front()) && level.twin(h) == kNoIndex)
        return h;
  return kNoIndex;
}

Result<void> CompactEncoder::plan_ear(Index record, PatchPlan& plan) {
  const std::span<const Index> ring = polygon(record);
  const Index half = find_border(point(ring[1]), point(ring[0]));
  if (half == kNoIndex) return unsupported(text("record ", record, " is at no border"));
  plan.is_ear[half] = 1;
  ++plan.ear_count;
  ear_records_[half] = record;
  return {};
}

Result<void> CompactEncoder::plan_round(Index first, Index end, PatchPlan& plan) {
  plan.patch_of.assign(levels_.mesh().face_count(), kNoIndex);
  plan.is_ear.assign(3 * levels_.mesh().face_count(), 0);
  patch_records_.clear();
  ear_records_.clear();
  for (Index record = first; record < end; ++record) {
    if (slots(record).empty()) {
      LODESTONE_CHECK(plan_ear(record, plan));
      continue;
    }
    const bool closed = sector(record).shape == SectorShape::Closed;
    const Index closing = closed ? kNoIndex : closing_edge(record);
    if (!closed && closing == kNoIndex) return unsupported(text("record ", record, " is at no border"));
    for (const Index slot : slots(record)) plan.patch_of[face_of_[slot]] = static_cast<Index>(patch_records_.size());
    plan.closing_edge.push_back(closing);
    patch_records_.push_back(record);
  }
  return {};
}

/// Notes where the faces of a record lie among those coded; false where it was coded otherwise.
bool CompactEncoder::number_star(Index record, std::size_t i) {
  const PatchMesh& level = levels_.mesh();
  const std::span<const Index> star = levels_.round().star(i), ring = polygon(record), replaced = slots(record);
  const bool closed = sector(record).shape == SectorShape::Closed;
  if (levels_.round().vertices[i].closed != closed || star.size() != ring.size() - (closed ? 0 : 1)) return false;
  const auto start =
      std::find_if(star.begin(), star.end(), [&](Index f) { return level.from(3 * f + 1) == point(ring[0]); });
  if (start == star.end()) return false;
  const auto turn = static_cast<std::size_t>(start - star.begin());
  for (std::size_t j = 0; j < star.size(); ++j) {
    const Index face = star[(turn + j) % star.size()];
    if (level.from(3 * face + 1) != point(ring[j])) return false;
    face_of_[j < replaced.size() ? replaced[j] : first_slot_[record] + static_cast<Index>(j - replaced.size())] = face;
  }
  return true;
}

/// Numbers the round's vertices as they were coded; returns their positions.
Result<std::vector<Vec3i>> CompactEncoder::number_round(const PatchPlan& plan, std::size_t count) {
  const RoundPatches& patches = levels_.patches();
  std::vector<Index> records;
  for (const Index half : patches.ears) records.push_back(ear_records_.at(half));
  Index begin = 0;
  for (const RoundPatches::Patch& patch : patches.patches) {
    records.push_back(patch_records_[plan.patch_of[patches.faces[begin]]]);
    begin = patch.face_end;
  }
  if (records.size() != count) return unsupported(text("a round of ", count, " records does not fit its level"));
  std::vector<Vec3i> positions;
  auto next = static_cast<Index>(levels_.positions().size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const Index wedge = mesh_.record_wedge_begin[records[i]];
    point_of_[wedge] = next++;
    positions.push_back(grid_position(wedge));
    if (!number_star(records[i], i)) return unsupported(text("record ", records[i], " does not fit its level"));
    chunk_.open_count += levels_.round().vertices[i].closed ? 0 : 1;
  }
  return positions;
}

Result<void> CompactEncoder::write_round(Index first, Index end) {
  PatchPlan plan;
  LODESTONE_CHECK(plan_round(first, end, plan));
  levels_.code_places(coder_, &plan);
  spend(result_.sizes.places);
  LODESTONE_TRY(const std::vector<Vec3i> positions, number_round(plan, end - first));
  levels_.code_points(coder_, positions);
  spend(result_.sizes.positions);
  write_errors(end);
  ++chunk_.round_count;
  chunk_.record_count += end - first;
  ++result_.round_count;
  return {};
}

void CompactEncoder::end_chunk() {
  std::vector<std::byte> bytes = coder_.finish();
  coder_ = BitCoder();
  bits_at_ = coder_.bits();
  std::uint64_t least = (chunk_.record_count + kMostRecordsPerByte - 1) / kMostRecordsPerByte;
  if (header_.chunks.empty())
    least = std::max<std::uint64_t>(
        least, (header_.base_point_count + header_.base_face_count + kMostBasePerByte - 1) / kMostBasePerByte);
  if (bytes.size() < least) bytes.resize(least);  // zeros follow anyway
  chunk_.byte_length = bytes.size();
  chunk_.deviation_code = static_cast<std::uint8_t>(deviation_code_);
  chunk_.checksum = checksum32(bytes);
  header_.chunks.push_back(chunk_);
  chunk_ = {};
  append_bytes(body_, bytes);
}

Result<CompactStream> CompactEncoder::run() {
  find_first_slots();
  LODESTONE_CHECK(write_base());
  const std::uint64_t most_walked = kMostFacesWalked * (std::uint64_t{mesh_.groups.front().face_count} + 1);
  std::uint64_t walked = 0;
  const auto record_count = static_cast<Index>(mesh_.record_count());
  for (Index first = 0, end = 0; first < record_count; first = end) {
    if (coder_.bits() / 8 >= static_cast<double>(std::max(kLeastChunkBytes, body_.size()))) end_chunk();
    walked += levels_.mesh().face_count();
    if (walked > most_walked)
      return fail(ErrorCode::LimitExceeded, text("compact stream: more than ", result_.round_count, " rounds of ",
                                                 record_count, " records are too many"));
    end = take_round(first);
    if (end == first) return unsupported(text("record ", first, " does not fit its level"));
    LODESTONE_CHECK(write_round(first, end));
  }
  end_chunk();
  result_.bytes = write_compact_header(header_);
  append_bytes(result_.bytes, body_);
  const CompactSizes& s = result_.sizes;
  result_.sizes.header = 8 * static_cast<double>(result_.bytes.size()) - s.base - s.places - s.positions - s.errors;
  // Points of the base mesh that are one vertex have one number.
  result_.vertex_numbers.assign(mesh_.positions.size(), kNoIndex);
  const Index copies = header_.base_point_count - header_.base_vertex_count;
  std::vector<Index> base_order(header_.base_point_count, kNoIndex);
  for (Index wedge = 0; wedge < mesh_.base_wedge_count; ++wedge) base_order[point(wedge)] = mesh_.wedge_vertex[wedge];
  Index number = 0;
  for (const Index vertex : base_order)
    if (result_.vertex_numbers[vertex] == kNoIndex) result_.vertex_numbers[vertex] = number++;
  for (auto wedge = mesh_.base_wedge_count; wedge < mesh_.wedge_vertex.size(); ++wedge)
    result_.vertex_numbers[mesh_.wedge_vertex[wedge]] = point(wedge) - copies;
  return std::move(result_);
}

}  // namespace

Result<CompactStream> encode_compact(const ProgressiveMesh& mesh, const CompactOptions& options) {
  LODESTONE_CHECK(check(mesh, options));
  return CompactEncoder(mesh, options).run();
}

}  // namespace lodestone
