#include <lodestone/io/compact_stream.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include <lodestone/core/detail/cancelled.h>
#include <lodestone/core/detail/finite.h>
#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/bytes.h"
#include "codec/attribute_rounding.h"
#include "codec/compact_layout.h"
#include "codec/level_coder.h"
#include "codec/rest_coder.h"
#include "codec/round_planner.h"
#include "stream/stream_layout.h"

namespace lodestone {
namespace {

using namespace detail;

// How much of a round is done once its places, or its positions, are coded.
constexpr double kPlacesShare = 0.4, kPositionsShare = 0.7;

// A chunk ends with the first round after so many bytes, or so large a share of what came before it: what is there
// shows as its last whole chunk, and each costs twenty bytes.
constexpr double kLeastChunkBytes = 768;
constexpr double kLeastChunkShare = 0.1;
constexpr double kLeastStageBytes = 64;  // the same of the first one where a placed level is reached; of others, any

auto unsupported(const std::string& message) { return fail(ErrorCode::Unsupported, "compact stream: " + message); }

auto wrong(const std::string& message) { return fail(ErrorCode::InvalidArgument, "compact stream: " + message); }
auto beyond(const std::string& message) { return fail(ErrorCode::LimitExceeded, "compact stream: " + message); }

Result<void> check_options(const CompactOptions& options) {
  if (options.grid_bits < kLeastGridBits || options.grid_bits > kMostGridBits)
    return wrong(text("grid of ", options.grid_bits, " bits is not of ", kLeastGridBits, " to ", kMostGridBits));
  for (const int bits : {options.normal_bits, options.texture_bits, options.weight_bits, options.other_bits})
    if (bits < kLeastAttributeBits || bits > kMostAttributeBits)
      return wrong(text("attributes of ", bits, " bits are not of ", kLeastAttributeBits, " to ", kMostAttributeBits));
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
  return {low, range == 0 ? 1 : range};
}

CompactGrid grid_of(const ProgressiveMesh& mesh, const CompactOptions& options) {
  return options.grid ? *options.grid : box_of(mesh);
}

/// Where a value lies on an axis of a grid, in its steps.
double steps_of(float value, float origin, float range, int bits) {
  const double top = static_cast<double>((1 << bits) - 1);
  return (static_cast<double>(value) - static_cast<double>(origin)) * top / static_cast<double>(range);
}

/// Checks that a grid is one, and holds all positions but for rounding.
Result<void> check_grid(const ProgressiveMesh& mesh, const CompactGrid& grid, int bits) {
  const Vec3f& o = grid.origin;
  if (!(grid.range > 0)) return wrong("grid has no size");
  for (const float value : {o.x, o.y, o.z, grid.range, o.x + grid.range, o.y + grid.range, o.z + grid.range})
    if (!std::isfinite(value)) return wrong("grid goes beyond what floats can say");
  const auto is_within = [&](float value, float origin) {
    const double steps = steps_of(value, origin, grid.range, bits);
    return steps >= -0.5 && steps <= static_cast<double>((1 << bits) - 1) + 0.5;  // not of what is no number
  };
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3f& p = mesh.positions[v];
    if (!is_within(p.x, o.x) || !is_within(p.y, o.y) || !is_within(p.z, o.z))
      return wrong(text("vertex ", v, " lies outside the grid"));
  }
  return {};
}

/// Returns a float that is not less.
float upwards(double x) { return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::max()); }

/// Checks that levels are some of the mesh, one finer than the other.
Result<void> check_levels(const ProgressiveMesh& mesh, std::span<const PlacedLevel> levels) {
  Index last = 0;
  std::uint64_t moves = 0;
  for (const PlacedLevel& level : levels) {
    if (level.position <= last || level.position >= mesh.record_count())
      return wrong(text("placed level ", level.position, " does not lie between ", last, " and ", mesh.record_count()));
    last = level.position;
    if (level.positions.size() != mesh.base_vertex_count + std::size_t{level.position})
      return wrong(text("placed level ", level.position, " of ", mesh.base_vertex_count + std::size_t{level.position},
                        " vertices has ", level.positions.size()));
    moves += level.positions.size();  // each vertex on to the next level
    if (moves > kMostMovesEach * level.positions.size())
      return beyond(text("placed levels up to that at ", level.position, " move vertices ", moves,
                         " times, which is more than ", kMostMovesEach, " times each"));
    if (!(level.deviation >= 0) || !(level.precision >= 0))
      return wrong(text("placed level ", level.position, " has an error of ", level.deviation, " or a precision of ",
                        level.precision));
    for (const Vec3f& p : level.positions)
      if (!is_finite(p)) return wrong(text("placed level ", level.position, " has a position that is not finite"));
  }
  return {};
}

/// By position: the largest error there or at a finer one. Measured bounds may be lower at coarser levels.
std::vector<float> largest_from(std::vector<float> errors) {
  for (std::size_t i = errors.size(); i-- > 1;) errors[i - 1] = std::max(errors[i - 1], errors[i]);
  return errors;
}

std::uint64_t full_face_count(const ProgressiveMesh& mesh) {
  std::uint64_t count = 0;
  for (const FaceGroup& group : mesh.groups) count += group.face_count;
  return count;
}

/// Checks that there is no more of anything than a stream can hold.
Result<void> check_counts(const ProgressiveMesh& mesh) {
  if (mesh.groups.empty()) return wrong("mesh has no face group");
  if (!mesh.moves.empty()) return unsupported("mesh has records that move vertices");
  if (mesh.groups.size() > kMaxGroups || mesh.attributes.size() > kMaxAttributes)
    return beyond(text(mesh.groups.size(), " groups and ", mesh.attributes.size(), " attributes are too many"));
  for (const Attribute& attribute : mesh.attributes) {
    if (attribute.name.size() > kMaxNameBytes)
      return beyond(text("attribute's name of ", attribute.name.size(), " bytes has more than ", kMaxNameBytes));
    if (attribute.component_count == 0 || attribute.component_count > kMostComponents)
      return beyond(text("attribute ", attribute.name, " of ", int{attribute.component_count},
                         " components has none, or more than ", kMostComponents));
  }
  const std::uint64_t vertices = mesh.positions.size(), wedges = mesh.wedge_vertex.size();
  if (std::max({full_face_count(mesh), vertices, wedges}) >= kEndOfCounts)
    return beyond(text(full_face_count(mesh), " faces, ", vertices, " vertices and ", wedges, " wedges are too many"));
  for (std::size_t r = 0; r < mesh.record_count(); ++r)
    if (const Index count = mesh.record_wedge_begin[r + 1] - mesh.record_wedge_begin[r]; count > kMostWedgesEach)
      return beyond(text("record ", r, " of ", count, " wedges has more than ", kMostWedgesEach));
  return {};
}

LevelLimits limits_of(const ProgressiveMesh& mesh, const CompactOptions& options) {
  LevelLimits limits;
  limits.grid_bits = options.grid_bits;
  limits.is_fast = options.coding == CompactCoding::Fast;
  limits.group_count = static_cast<Index>(mesh.groups.size());
  limits.most_vertices = mesh.positions.size();
  limits.most_wedges = mesh.wedge_vertex.size();
  limits.most_faces = full_face_count(mesh);
  return limits;
}

/// Tells of an encoding that it goes on.
class EncodingListener final : public WorkListener {
 public:
  EncodingListener(const Progress& progress, std::size_t record_count)
      : progress_(progress), record_count_(static_cast<double>(std::max<std::size_t>(record_count, 1))) {}

  bool step() override { return --left_ > 0 || tell(); }
  /// Says that so many records are done.
  bool reach(double records) const { return progress_.reach(records / record_count_); }
  bool is_cancelled() const { return progress_.is_cancelled(); }

 private:
  static constexpr int kSteps = 256;  // between two words: about a millisecond

  bool tell() {
    const bool goes_on = progress_.add(0);
    left_ = goes_on ? kSteps : 1;
    return goes_on;
  }

  Progress progress_;
  double record_count_;
  int left_ = kSteps;
};

/// Encodes a progressive mesh. Pre: the checks found nothing.
class CompactEncoder {
 public:
  CompactEncoder(const ProgressiveMesh& mesh, const CompactOptions& options, std::span<const PlacedLevel> placed)
      : mesh_(mesh),
        placed_(placed),
        specs_(choose_specs(mesh.attributes, options)),
        levels_(limits_of(mesh, options), specs_),
        coded_(mesh),
        planner_(mesh, coded_, levels_.mesh()),
        listener_(options.progress, mesh.record_count()),
        coder_(options.coding == CompactCoding::Fast) {
    coder_.set_listener(&listener_);
    levels_.count_attributes();
    header_.grid_bits = options.grid_bits;
    header_.lossless = options.lossless;
    header_.coding = options.coding;
    header_.grid = grid_of(mesh, options);
    header_.attributes = specs_;
    for (const FaceGroup& group : mesh.groups)
      header_.groups.push_back({group.material, static_cast<Index>(group.base_corners.size() / 3)});
    if (options.lossless) rests_.emplace(static_cast<float>(header_.step()), specs_);
    numbers_ = rounded(mesh.attributes, specs_);
    deviation_ = largest_from(mesh.deviation);
    curvature_ = largest_from(mesh.curvature_error);
    result_.sizes.attributes.assign(specs_.size(), 0);
  }

  CompactEncoder(const CompactEncoder&) = delete;
  CompactEncoder& operator=(const CompactEncoder&) = delete;

  Result<CompactStream> run();

 private:
  Result<void> write_rounds();
  Vec3i grid_position(const Vec3f& position, int step) const;
  Vec3i grid_position(Index vertex) const;
  double rounding() const;
  void plan_stages();
  float widened(float deviation, double move) const;
  float widened_within(float deviation, std::size_t stage, double unmoved) const;
  double farthest_unmoved() const;
  Vec3 place(const Vec3i& position) const;
  Result<void> write_base();
  bool begins_stage(Index record) const { return stage_ > 0 && stages_[stage_ - 1].end == record; }
  Result<void> end_stage(Index end);
  void find_targets(Index position);
  BaseMesh number_base();
  void number_base_wedges(const std::vector<Index>& vertices, BaseMesh& base);
  Result<void> write_round(Index first, Index end);
  void number_stars();
  void join_stars();
  void plan_wedges();
  void plan_star(Index star, Index record);
  Index local_number(Index wedge);
  Result<void> write_loose(Index record);
  bool describe_loose(Index record, LooseRecord& loose);
  bool find_start(Index sector, LooseRecord::Sector& loose) const;
  bool write_attributes(bool of_base);
  void write_rests();
  void number_vertex(Index vertex);
  void add_extra(Index record);
  void write_errors(Index position);
  void end_chunk();
  void spend(double& part);

  const ProgressiveMesh& mesh_;
  std::span<const PlacedLevel> placed_;
  /// Rounds that lead to a placed level, or to the full mesh.
  struct Stage {
    Index end = 0;         ///< the level's position
    int step = 0;          ///< positions are multiples of 2^this
    double move = 0;       ///< by how much its vertices lie off the full mesh's at most, mesh units
    double deviation = 0;  ///< of the level at its end
  };
  std::vector<Stage> stages_;
  std::size_t stage_ = 0;            // at hand
  std::size_t stage_of_errors_ = 0;  // the same, up to the end of a stage's last round
  std::vector<Vec3i> targets_;       // by vertex that is coded: where the stage moves it
  double float_rounding_ = 0;        // how far the floats that a reader makes lie off at most
  std::vector<double> off_;          // the same: how far off the full mesh's it lies before that, mesh units
  std::vector<AttributeSpec> specs_;
  std::vector<std::vector<std::int32_t>> numbers_;  // by attribute: of the mesh's wedges
  LevelCoder levels_;
  CodedNumbers coded_;
  RoundPlanner planner_;
  EncodingListener listener_;
  CompactHeader header_;
  ErrorCoder errors_;
  std::optional<RestCoder> rests_;  // of a lossless stream
  BitCoder coder_;
  double bits_at_ = 0;  // where the last part ended
  std::vector<std::byte> body_;
  CompactChunkEntry chunk_;
  int deviation_code_ = 255;
  CompactStream result_;

  std::vector<float> deviation_, curvature_;  // by position; they never rise
  Index vertex_count_ = 0, wedge_count_ = 0;  // that are coded, or numbered for it

  // Of the round at hand.
  std::vector<Index> star_records_;  // by star
  std::vector<Index> first_star_;    // by record
  std::vector<Index> star_corners_;  // by star: where its half-edges begin in the patches' polygons
  std::vector<Index> joins_;         // by star
  WedgePlan wedge_plan_;
  std::vector<Index> new_wedges_;  // of the mesh, in the order of their numbers, that have no attributes yet
  std::vector<Index> rest_vertices_, rest_wedges_;  // the same, of which a lossless stream has no rests yet
  std::vector<Index> own_wedges_;                   // of the vertex at hand, in the order of their numbers
};

Vec3i CompactEncoder::grid_position(const Vec3f& p, int step) const {
  const auto on_axis = [&](float value, float origin) {
    const std::int64_t top = (std::int64_t{1} << header_.grid_bits) - 1;
    const double steps = steps_of(value, origin, header_.grid.range, header_.grid_bits);
    const auto number =
        static_cast<std::int64_t>(std::floor(std::ldexp(std::clamp(steps, 0.0, double(top)), -step) + 0.5));
    return std::min(number, top >> step) << step;
  };
  const Vec3f& origin = header_.grid.origin;
  return {on_axis(p.x, origin.x), on_axis(p.y, origin.y), on_axis(p.z, origin.z)};
}

/// Where the stage at hand has a vertex.
Vec3i CompactEncoder::grid_position(Index vertex) const {
  const std::vector<Vec3f>& positions = stage_ < placed_.size() ? placed_[stage_].positions : mesh_.positions;
  return grid_position(positions[vertex], stage_ < stages_.size() ? stages_[stage_].step : 0);
}

/// How far rounding moves a point of the full mesh at most, mesh units.
double CompactEncoder::rounding() const { return header_.lossless ? 0 : std::sqrt(3.0) / 2 * header_.step(); }

Vec3 CompactEncoder::place(const Vec3i& n) const {
  return Vec3(header_.grid.origin) +
         Vec3{static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)} * header_.step();
}

/// Finds how coarsely each stage rounds, and how far that and its level move vertices at most.
void CompactEncoder::plan_stages() {
  const Vec3f& o = header_.grid.origin;
  const double widest = std::max({std::abs(o.x), std::abs(o.y), std::abs(o.z)}) + header_.grid.range;
  float_rounding_ = 2 * widest * std::numeric_limits<float>::epsilon();
  for (const PlacedLevel& level : placed_) {
    Stage& stage = stages_.emplace_back();
    stage.end = level.position;
    while (stage.step < header_.grid_bits - kLeastStepBits &&
           std::ldexp(header_.step(), stage.step + 1) <= static_cast<double>(level.precision))
      ++stage.step;
    double rounding = 0;
    for (std::size_t v = 0; v < level.positions.size(); ++v) {
      const Vec3i n = grid_position(level.positions[v], stage.step);
      const Vec3 p = place(n);
      stage.move = std::max(stage.move, length(p - Vec3(mesh_.positions[v])));
      rounding = std::max(rounding, length(p - Vec3(level.positions[v])));
    }
    stage.move += float_rounding_;
    stage.deviation = static_cast<double>(level.deviation) + rounding + float_rounding_;
  }
  Stage& last = stages_.emplace_back();
  last.end = static_cast<Index>(mesh_.record_count());
  last.move = rounding();
}

/// The deviation of a level whose vertices lie so far off at most: its points and those of the full mesh both move.
float CompactEncoder::widened(float deviation, double move) const {
  if (deviation <= 0 && stages_.size() == 1) return 0;
  return upwards(static_cast<double>(deviation) + move + rounding());
}

/// The same within a stage, where some vertices lie where the stage before has them, so far off at most. It never rises
/// while these get fewer.
float CompactEncoder::widened_within(float deviation, std::size_t stage, double unmoved) const {
  return widened(deviation, std::max(stages_[stage].move, unmoved));
}

/// How far off those vertices lie at most that the stage has not moved yet.
double CompactEncoder::farthest_unmoved() const {
  double farthest = 0;
  for (Index v = 0; v < off_.size(); ++v)
    if (!levels_.is_placed(v)) farthest = std::max(farthest, off_[v]);
  return farthest;
}

/// Adds what was written since the last call to a part.
void CompactEncoder::spend(double& part) {
  const double now = coder_.bits();
  part += now - bits_at_;
  bits_at_ = now;
}

void CompactEncoder::write_errors(Index position) {
  const bool is_last = stage_ == stages_.size();  // what follows it is nothing
  const float own = deviation_[position];
  const double unmoved = stage_of_errors_ < stage_ ? 0 : farthest_unmoved();
  deviation_code_ = header_.deviation.code(widened_within(own, stage_of_errors_, unmoved));
  int curvature = header_.curvature.code(curvature_[position]);
  errors_.code(coder_, deviation_code_, curvature);
  if (stage_of_errors_ < stage_) {
    const Stage& stage = stages_[stage_of_errors_];
    const float placed = std::min(upwards(stage.deviation + rounding()), widened(own, stage.move));
    deviation_code_ = is_last ? 0 : header_.deviation.code(placed);
    int after = is_last ? 0 : header_.deviation.code(widened_within(own, stage_, stage.move));
    errors_.code_stage_end(coder_, deviation_code_, after);
    stage_of_errors_ = stage_;
  }
  spend(result_.sizes.errors);
}

/// Writes the attributes of the newest wedges.
bool CompactEncoder::write_attributes(bool of_base) {
  std::vector<std::vector<std::int32_t>> given;
  for (std::size_t a = 0; a < specs_.size(); ++a) {
    const std::size_t size = specs_[a].component_count;
    std::vector<std::int32_t>& numbers = given.emplace_back();
    for (const Index wedge : new_wedges_)
      numbers.insert(numbers.end(), numbers_[a].begin() + static_cast<std::ptrdiff_t>(wedge * size),
                     numbers_[a].begin() + static_cast<std::ptrdiff_t>((wedge + 1) * size));
  }
  const bool is_done = of_base ? levels_.code_base_attributes(coder_, given) : levels_.code_attributes(coder_, given);
  if (rests_) rest_wedges_.insert(rest_wedges_.end(), new_wedges_.begin(), new_wedges_.end());
  new_wedges_.clear();
  bits_at_ = coder_.bits();
  return is_done;
}

/// Writes what rounding took from the newest vertices and wedges, in a lossless stream.
void CompactEncoder::write_rests() {
  if (!rests_) return;
  for (const Index vertex : rest_vertices_) {
    const Vec3i point = levels_.positions()[coded_.vertex[vertex]];
    Vec3f position = header_.place(point);
    rests_->code_position(coder_, point, mesh_.positions[vertex], position);
  }
  std::vector<std::byte> element;
  for (std::size_t a = 0; a < specs_.size(); ++a) {
    const std::size_t size = mesh_.attributes[a].element_bytes();
    for (const Index wedge : rest_wedges_) {
      element.clear();
      const std::span<const std::int32_t> numbers = levels_.attributes().attribute(a).numbers(coded_.wedge[wedge]);
      append_element(specs_[a], numbers, element);
      rests_->code_element(coder_, a, numbers, std::span(mesh_.attributes[a].data).subspan(wedge * size, size),
                           element);
    }
  }
  rest_vertices_.clear();
  rest_wedges_.clear();
  spend(result_.sizes.rests);
}

/// Numbers the wedges of base vertices, those of each together, faces' first.
void CompactEncoder::number_base_wedges(const std::vector<Index>& vertices, BaseMesh& base) {
  std::vector<std::vector<Index>> wedges_of(mesh_.base_vertex_count);
  const auto add = [&](Index wedge) {
    std::vector<Index>& wedges = wedges_of[mesh_.wedge_vertex[wedge]];
    if (std::find(wedges.begin(), wedges.end(), wedge) == wedges.end()) wedges.push_back(wedge);
  };
  for (const FaceGroup& group : mesh_.groups)
    for (const Index wedge : group.base_corners) add(wedge);
  for (Index wedge = 0; wedge < mesh_.base_wedge_count; ++wedge) add(wedge);
  for (const Index vertex : vertices) {
    base.wedge_counts.push_back(static_cast<Index>(wedges_of[vertex].size()));
    for (const Index wedge : wedges_of[vertex]) {
      coded_.wedge[wedge] = wedge_count_++;
      new_wedges_.push_back(wedge);
    }
  }
  for (const FaceGroup& group : mesh_.groups)
    for (const Index wedge : group.base_corners) {
      const std::vector<Index>& wedges = wedges_of[mesh_.wedge_vertex[wedge]];
      base.wedges.push_back(static_cast<Index>(std::find(wedges.begin(), wedges.end(), wedge) - wedges.begin()));
    }
}

/// Numbers a vertex, the next to be coded.
void CompactEncoder::number_vertex(Index vertex) {
  coded_.vertex[vertex] = vertex_count_++;
  if (rests_) rest_vertices_.push_back(vertex);
}

/// Numbers base vertices in the order in which faces use them; those without faces come last.
BaseMesh CompactEncoder::number_base() {
  BaseMesh base;
  std::vector<Index> vertices;
  const auto number = [&](Index vertex) {
    if (coded_.vertex[vertex] != kNoIndex) return;
    number_vertex(vertex);
    vertices.push_back(vertex);
  };
  for (Index g = 0; g < mesh_.groups.size(); ++g) {
    const std::vector<Index>& corners = mesh_.groups[g].base_corners;
    for (Index c = 0; c < corners.size(); ++c) {
      number(mesh_.wedge_vertex[corners[c]]);
      base.corners.push_back(coded_.vertex[mesh_.wedge_vertex[corners[c]]]);
      if (c % 3 == 0) coded_.face[g][c / 3] = static_cast<Index>(base.groups.size());
      if (c % 3 == 0) base.groups.push_back(g);
    }
  }
  for (Index vertex = 0; vertex < mesh_.base_vertex_count; ++vertex) number(vertex);
  for (const Index vertex : vertices) base.positions.push_back(grid_position(vertex));
  number_base_wedges(vertices, base);
  return base;
}

/// Finds where the stage at hand moves the vertices of the level that it begins with.
void CompactEncoder::find_targets(Index position) {
  targets_.assign(vertex_count_, {});
  off_.assign(vertex_count_, 0);
  for (Index v = 0; v < mesh_.base_vertex_count + position; ++v) {
    const Index coded = coded_.vertex[v];
    targets_[coded] = grid_position(v);
    off_[coded] = length(place(levels_.positions()[coded]) - Vec3(mesh_.positions[v])) + float_rounding_;
  }
}

/// Ends a stage with the round that ends it. The last one needs no end where there is no other.
Result<void> CompactEncoder::end_stage(Index end) {
  bool ends = stages_.size() > 1 && stages_[stage_].end == end;
  if (!levels_.code_stage_end(coder_, ends, targets_)) return unsupported(text("level ", end, " cannot be placed"));
  if (ends) {
    ++stage_;
    int step = stage_ < stages_.size() ? stages_[stage_].step : 0;
    levels_.code_step(coder_, step);
    find_targets(end);
  }
  spend(result_.sizes.moves);
  return {};
}

Result<void> CompactEncoder::write_base() {
  BaseMesh base = number_base();
  header_.base_vertex_count = vertex_count_;
  header_.base_wedge_count = wedge_count_;
  float largest = widened(deviation_.front(), stages_.front().move);
  for (std::size_t k = 1; k < stages_.size(); ++k)
    largest = std::max(largest, widened_within(deviation_[stages_[k - 1].end], k, stages_[k - 1].move));
  header_.deviation = ErrorScale(largest);
  header_.curvature = ErrorScale(curvature_.front());
  int step = stages_.front().step;
  levels_.code_step(coder_, step);
  if (!levels_.code_base(coder_, base)) return unsupported("base mesh names no wedges");
  spend(result_.sizes.base);
  if (!write_attributes(true)) return unsupported("attributes of the base mesh are out of their ranges");
  write_rests();
  write_errors(0);
  return {};
}

/// Finds which record each star is of.
void CompactEncoder::number_stars() {
  const RoundPatches& patches = levels_.patches();
  star_records_.clear();
  star_corners_.clear();
  for (const Index half : patches.ears) {
    star_records_.push_back(planner_.fine_face(half, true).record);
    star_corners_.push_back(kNoIndex);
  }
  Index begin = 0;
  for (const RoundPatches::Patch& patch : patches.patches) {
    star_records_.push_back(planner_.fine_face(patches.polygons[begin], false).record);
    star_corners_.push_back(begin);
    begin = patch.polygon_end;
  }
}

void CompactEncoder::join_stars() {
  std::unordered_map<Index, Index> first;
  joins_.clear();
  for (Index i = 0; i < star_records_.size(); ++i)
    joins_.push_back(first.try_emplace(star_records_[i], i).first->second);
}

/// Numbers a wedge within the vertex at hand.
Index CompactEncoder::local_number(Index wedge) {
  const auto found = std::find(own_wedges_.begin(), own_wedges_.end(), wedge);
  const auto number = static_cast<Index>(found - own_wedges_.begin());
  if (found != own_wedges_.end()) return number;
  own_wedges_.push_back(wedge);
  new_wedges_.push_back(wedge);
  coded_.wedge[wedge] = wedge_count_++;
  return number;
}

/// Numbers those wedges of a record that no face uses; they come last.
void CompactEncoder::add_extra(Index record) {
  for (Index w = mesh_.record_wedge_begin[record]; w < mesh_.record_wedge_begin[record + 1]; ++w) local_number(w);
}

void CompactEncoder::plan_star(Index star, Index record) {
  const NewStars& stars = levels_.stars();
  const std::span<const Index> faces = stars.star(star);
  for (std::size_t i = 0; i < faces.size(); ++i) {
    const bool is_ear = star_corners_[star] == kNoIndex;
    const Index half = is_ear ? levels_.patches().ears[star] : levels_.patches().polygons[star_corners_[star] + i];
    const RoundPlanner::FineFace& fine = planner_.fine_face(half, is_ear);
    const SectorHeader& sector = mesh_.sectors[fine.sector];
    const std::span<const Index> polygon = planner_.polygon(fine.sector);
    const Index centre = local_number(mesh_.record_wedge_begin[record] + sector.wedge);
    wedge_plan_.faces[stars.face_begin(star) + i] = {faces[i], sector.group, centre, coded_.wedge[polygon[fine.number]],
                                                     coded_.wedge[polygon[(fine.number + 1) % polygon.size()]]};
    coded_.face[sector.group][planner_.fine_slot(fine.sector, fine.number)] = faces[i];
  }
}

/// Numbers the vertices and wedges of the round's stars.
void CompactEncoder::plan_wedges() {
  const NewVertices& vertices = levels_.vertices();
  wedge_plan_.faces.assign(levels_.stars().faces.size(), {});
  wedge_plan_.extra.clear();
  for (std::size_t i = 0; i < vertices.count(); ++i) {
    const Index record = star_records_[vertices.stars_of(i).front()];
    number_vertex(mesh_.base_vertex_count + record);
    own_wedges_.clear();
    for (const Index star : vertices.stars_of(i)) plan_star(star, record);
    const std::size_t used = own_wedges_.size();
    add_extra(record);
    wedge_plan_.extra.push_back(static_cast<Index>(own_wedges_.size() - used));
  }
}

/// Finds with which outer edge the polygon of a sector begins.
bool CompactEncoder::find_start(Index sector, LooseRecord::Sector& loose) const {
  std::vector<Index> wanted, found;
  std::vector<std::array<std::uint8_t, 3>> triangles;
  for (const Index wedge : planner_.polygon(sector)) wanted.push_back(coded_.wedge[wedge]);
  for (loose.start = 0; loose.start < wanted.size(); ++loose.start) {
    found.clear();
    triangles.clear();
    if (trace_polygon(levels_.mesh(), loose.coarse, loose.start, found, triangles) && found == wanted) return true;
  }
  return false;
}

bool CompactEncoder::describe_loose(Index record, LooseRecord& loose) {
  own_wedges_.clear();
  for (Index s = mesh_.sector_begin[record]; s < mesh_.sector_begin[record + 1]; ++s) {
    const SectorHeader& header = mesh_.sectors[s];
    LooseRecord::Sector& sector = loose.sectors.emplace_back();
    sector.shape = header.shape;
    sector.group = header.group;
    sector.centre = local_number(mesh_.record_wedge_begin[record] + header.wedge);
    for (Index i = 0; i + 2 < header.polygon_size; ++i) sector.coarse.push_back(planner_.coarse_face(s, i));
    if (sector.coarse.empty())
      sector.polygon = {coded_.wedge[planner_.polygon(s)[0]], coded_.wedge[planner_.polygon(s)[1]]};
    else if (!find_start(s, sector))
      return false;
  }
  return loose.sectors.size() <= kMostLooseSectors;
}

Result<void> CompactEncoder::write_loose(Index record) {
  const auto wrong = [&] { return unsupported(text("record ", record, " does not fit its level")); };
  LooseVertex vertex;
  if (!describe_loose(record, vertex.record)) return wrong();
  const std::size_t used = own_wedges_.size();
  add_extra(record);
  vertex.extra = static_cast<Index>(own_wedges_.size() - used);
  number_vertex(mesh_.base_vertex_count + record);
  vertex.position = grid_position(mesh_.base_vertex_count + record);
  const std::size_t first_sector = levels_.sectors().sectors.size();
  if (!levels_.code_loose_vertex(coder_, vertex)) return wrong();
  for (Index s = mesh_.sector_begin[record]; s < mesh_.sector_begin[record + 1]; ++s) {
    const std::span<const Index> fine = levels_.sectors().fine_of(first_sector + s - mesh_.sector_begin[record]);
    for (Index i = 0; i < fine.size(); ++i) coded_.face[mesh_.sectors[s].group][planner_.fine_slot(s, i)] = fine[i];
  }
  return {};
}

Result<void> CompactEncoder::write_round(Index first, Index end) {
  const auto wrong = [&] { return unsupported(text("the round of record ", first, " does not fit its level")); };
  const std::size_t faces = levels_.mesh().face_count(), wedges = levels_.wedges().size();
  const auto reach = [&](double share) { return listener_.reach(first + share * (end - first)); };
  planner_.plan(first, end, listener_);
  if (!levels_.code_patches(coder_, &planner_.patches())) return wrong();
  spend(result_.sizes.places);
  if (!levels_.code_moves(coder_, targets_)) return wrong();
  spend(result_.sizes.moves);
  number_stars();
  join_stars();
  if (!levels_.code_places(coder_, joins_)) return wrong();
  spend(result_.sizes.places);
  if (!reach(kPlacesShare)) return cancelled();
  plan_wedges();
  if (!levels_.code_wedges(coder_, &wedge_plan_)) return wrong();
  spend(result_.sizes.wedges);
  std::vector<Vec3i> positions;
  for (std::size_t i = 0; i < levels_.vertices().count(); ++i)
    positions.push_back(grid_position(mesh_.base_vertex_count + star_records_[levels_.vertices().stars_of(i).front()]));
  if (!levels_.code_points(coder_, positions)) return wrong();
  spend(result_.sizes.positions);
  if (!reach(kPositionsShare)) return cancelled();
  if (!write_attributes(false)) return wrong();
  auto loose = static_cast<Index>(planner_.loose().size());
  result_.loose_count += loose;
  if (!levels_.code_loose_count(coder_, loose)) return wrong();
  for (const Index record : planner_.loose()) LODESTONE_CHECK(write_loose(record));
  spend(result_.sizes.loose);
  if (!write_attributes(false)) return wrong();
  write_rests();
  LODESTONE_CHECK(end_stage(end));
  write_errors(end);
  ++chunk_.round_count;
  chunk_.record_count += end - first;
  chunk_.face_count += static_cast<Index>(levels_.mesh().face_count() - faces);
  chunk_.wedge_count += static_cast<Index>(levels_.wedges().size() - wedges);
  ++result_.round_count;
  if (!reach(1)) return cancelled();
  return {};
}

void CompactEncoder::end_chunk() {
  std::vector<std::byte> bytes = coder_.finish();
  coder_ = BitCoder(header_.is_fast());
  coder_.set_listener(&listener_);
  bits_at_ = coder_.bits();
  const std::uint64_t least = header_.least_bytes(chunk_, header_.chunks.empty());
  if (bytes.size() < least) bytes.resize(least);  // zeros follow anyway
  chunk_.byte_length = bytes.size();
  chunk_.deviation_code = static_cast<std::uint8_t>(deviation_code_);
  chunk_.checksum = checksum32(bytes);
  header_.chunks.push_back(chunk_);
  chunk_ = {};
  append_bytes(body_, bytes);
}

Result<void> CompactEncoder::write_rounds() {
  plan_stages();
  LODESTONE_CHECK(write_base());
  const std::uint64_t most_walked = kMostWalked * (full_face_count(mesh_) + mesh_.positions.size() +
                                                   mesh_.wedge_vertex.size() + mesh_.groups.size() + 1);
  std::uint64_t walked = 0;
  const auto record_count = static_cast<Index>(mesh_.record_count());
  for (Index first = 0, end = 0; first < record_count; first = end) {
    const double bytes = coder_.bits() / 8;
    const bool is_long = bytes >= std::max(kLeastChunkBytes, kLeastChunkShare * static_cast<double>(body_.size())) ||
                         (begins_stage(first) && bytes >= (header_.chunks.empty() ? kLeastStageBytes : 1));
    if (is_long && levels_.may_end_chunk() && walked <= kMostWalked * levels_.size()) end_chunk();
    walked += levels_.size();
    if (walked > most_walked)
      return fail(ErrorCode::LimitExceeded, text("compact stream: more than ", result_.round_count, " rounds of ",
                                                 record_count, " records are too many"));
    end = planner_.take_round(first, stages_[stage_].end);
    if (end == first) return unsupported(text("record ", first, " does not fit its level"));
    LODESTONE_CHECK(write_round(first, end));
  }
  if (!levels_.may_end_chunk()) return beyond("polygons of records have too many corners");
  end_chunk();
  return {};
}

Result<CompactStream> CompactEncoder::run() {
  if (const auto written = write_rounds(); !written) {
    if (listener_.is_cancelled()) return cancelled();  // as whatever it looked like where it stopped
    return tl::unexpected(written.error());
  }
  result_.bytes = write_compact_header(header_);
  append_bytes(result_.bytes, body_);
  // What is left that a reader would refuse, as errors that are not finite.
  if (const auto read = read_compact_header(result_.bytes); !read)
    return fail(ErrorCode::InvalidArgument, "compact stream: " + read.error().message);
  CompactSizes& s = result_.sizes;
  s.attributes = levels_.attributes().bits;
  s.header = 8 * static_cast<double>(result_.bytes.size()) - s.sum();
  result_.vertex_numbers = std::move(coded_.vertex);
  result_.wedge_numbers = std::move(coded_.wedge);
  return std::move(result_);
}

}  // namespace

Result<CompactStream> encode_compact(const ProgressiveMesh& mesh, const CompactOptions& options,
                                     std::span<const PlacedLevel> levels) {
  LODESTONE_CHECK(check_options(options));
  LODESTONE_CHECK(check_counts(mesh));
  if (options.lossless && !levels.empty()) return wrong("levels of a lossless stream cannot be placed");
  LODESTONE_CHECK(check_levels(mesh, levels));
  LODESTONE_CHECK(check_grid(mesh, grid_of(mesh, options), options.grid_bits));
  return CompactEncoder(mesh, options, levels).run();
}

}  // namespace lodestone
