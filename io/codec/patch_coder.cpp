// Vertices that a round brings lie in patches of the coarse mesh. A walk over its faces, from neighbour to neighbour,
// asks of each whether a patch begins there; the patch then grows across its edges, each of which is asked for once.
// That tells place, size and triangulation of the hole at once, in no order but the walk's. The bits are mixed from
// contexts of what is decided around, of degrees, ages and shapes: removed vertices leave long edges behind, and fans
// whose inner edges end at crowded vertices.
//
// The walk is kin to those of Alliez and Desbrun, Progressive compression for lossless transmission of triangle meshes
// (2001), which fix the triangulation by rule in place of coding it.

#include "codec/patch_coder.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>

namespace lodestone::detail {
namespace {

constexpr std::uint32_t kStates = 10;  // of three neighbours: how many are plain, how many in patches
constexpr std::uint32_t kPairs = 9;    // the same of two
constexpr std::uint32_t kAges = 4;
constexpr std::uint32_t kCorners = 8;
constexpr std::uint32_t kSizes = 24;
constexpr std::uint32_t kRatios = 16;
constexpr std::uint32_t kShapes = 12;
constexpr std::uint32_t kDegrees = 20;
constexpr std::uint32_t kFlats = 8;
constexpr std::uint32_t kFaceSeams = 3;  // of a face's edges
constexpr std::uint32_t kSeams = 6;      // whether an edge is one, how many the patch has crossed

constexpr std::array<std::uint32_t, 7> kFaceContexts = {kFaceSeams * kStates * kAges * 4,
                                                        kStates* kSizes,
                                                        kShapes* kShapes * 3,
                                                        kFaceSeams* kDegrees* kStates,
                                                        kAges* kDegrees * 4,
                                                        kFlats* kFlats* kSizes / 3,
                                                        4 * 5 * kRatios* kAges};
constexpr std::array<std::uint32_t, 8> kEdgeContexts = {kCorners * kRatios * kPairs, kRatios* kRatios,
                                                        kSeams* kCorners* kSizes,    kRatios* kAges* kAges * 4,
                                                        kRatios* kFlats* kCorners,   kCorners* kRatios* kRatios,
                                                        kCorners* kDegrees * 3 * 3,  kSeams* kRatios* kRatios* kPairs};

enum Border : std::uint32_t { kCloses, kHasEars, kIsEar, kBorders };

/// Numbers how many of three are plain, and how many in patches.
std::uint32_t number_states(std::uint32_t plain, std::uint32_t patched) {
  constexpr std::array<std::uint32_t, 4> kFirst = {0, 4, 7, 9};
  return kFirst[plain] + patched;
}

}  // namespace

PatchCoder::PatchCoder()
    : faces_(kFaceContexts, kFaceSeams * kStates),
      edges_(kEdgeContexts, kSeams * kCorners * 3),
      borders_(std::array<std::uint32_t, 1>{kBorders}, 1) {}

void PatchCoder::start(const PatchMesh& mesh, std::span<const Vec3i> positions, std::uint32_t round) {
  mesh_ = &mesh;
  positions_ = positions;
  round_ = round;
  const std::size_t face_count = mesh.face_count();
  state_.assign(face_count, kOpen);
  decided_.assign(3 * face_count, 0);
  normals_.resize(face_count);
  face_logs_.resize(face_count);
  std::int64_t logs = 0;
  for (Index f = 0; f < face_count; ++f) {
    const Vec3i& a = positions[mesh.from(3 * f)];
    Vec3i n = cross(positions[mesh.from(3 * f + 1)] - a, positions[mesh.from(3 * f + 2)] - a);
    const int shift = shorten(n, 30);
    face_logs_[f] = static_cast<std::int16_t>(log2_16(squared(n)) + 32 * shift);
    logs += face_logs_[f];
    shorten(n, 15);
    normals_[f] = n;
  }
  flat_.assign(3 * face_count, 0);
  edge_logs_.resize(3 * face_count);
  for (Index h = 0; h < edge_logs_.size(); ++h) {
    const Index other = mesh.twin(h);
    edge_logs_[h] = other < h
                        ? edge_logs_[other]
                        : static_cast<std::int16_t>(log2_16(squared(positions[mesh.from(h)] - positions[mesh.to(h)])));
  }
  mean_face_log_ = face_count == 0 ? 0 : static_cast<int>(logs / static_cast<std::int64_t>(face_count));
  around_.resize(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const auto degree = static_cast<std::int32_t>(mesh.degree(v));
    around_[v] = {degree, degree, 0};
  }
}

std::uint32_t PatchCoder::state_of(Index half) const {
  const Index twin = mesh_->twin(half);
  return twin == kNoIndex ? std::uint32_t{kPlain} : state_[face_of_corner(twin)];
}

/// 0 for faces that the last round made; the oldest are alike.
std::uint32_t PatchCoder::age(Index face) const { return std::min(round_ - mesh_->made_in(face), kAges) - 1; }

std::uint32_t PatchCoder::size_of(Index face) const {
  return bucket(face_logs_[face] - mean_face_log_, -96, 8, kSizes);
}

/// 7 for flat edges, less by one for each doubling of the angle's tangent, 0 from a right angle on and at borders.
std::uint32_t PatchCoder::measure_flatness(Index half) const {
  const Vec3i &a = normals_[face_of_corner(half)], &b = normals_[face_of_corner(mesh_->twin(half))];
  const std::int64_t cosine = dot(a, b);
  if (cosine <= 0) return 0;
  const Vec3i sine = cross(a, b);
  const Vec3i quarter = {sine.x >> 2, sine.y >> 2, sine.z >> 2};
  const int log_tangent = log2_16(squared(quarter) + 1) + 64 - 2 * log2_16(static_cast<std::uint64_t>(cosine));
  return bucket(-log_tangent, 0, 32, kFlats);
}

std::uint32_t PatchCoder::flatness(Index half) {
  const Index other = mesh_->twin(half);
  if (other == kNoIndex) return 0;
  if (flat_[half] == 0) flat_[half] = flat_[other] = static_cast<std::uint8_t>(measure_flatness(half) + 1);
  return flat_[half] - 1U;
}

bool PatchCoder::code_face(BitCoder& coder, Index face, bool begins) {
  std::uint32_t plain = 0, patched = 0, ages = 0, flat = 0, flattest = 0, touched = 0, seams = 0;
  int degrees = 0, new_degrees = 0, tight = 4, longest = 0, lengths = 0, areas = 0, neighbours = 0;
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    const Around& vertex = around_[mesh_->from(h)];
    degrees += static_cast<int>(std::min<Index>(mesh_->degree(mesh_->from(h)), kDegrees));
    new_degrees += std::min(vertex.degree, 64);
    touched += vertex.patches > 0 ? 1 : 0;
    tight = std::min(tight, vertex.open);
    const int length = edge_log(h);
    lengths += length;
    longest = std::max(longest, length);
    plain += state_of(h) == kPlain ? 1 : 0;
    patched += state_of(h) == kPatch ? 1 : 0;
    if (mesh_->twin(h) == kNoIndex) continue;
    const Index beyond = face_of_corner(mesh_->twin(h));
    ages += age(beyond);
    seams += is_seam(h) ? 1 : 0;
    areas += face_logs_[beyond];
    ++neighbours;
    const std::uint32_t flat_here = flatness(h);
    flat += flat_here;
    if (state_[beyond] == kOpen) flattest = std::max(flattest, flat_here);
  }
  const std::uint32_t state = number_states(plain, patched), size = size_of(face), own_age = age(face);
  const std::uint32_t others_age = std::min(ages / 3, kAges - 1);
  const std::uint32_t relative = neighbours == 0 ? 0 : bucket(face_logs_[face] - areas / neighbours, -48, 8, kShapes);
  const std::uint32_t shape = bucket(longest - lengths / 3, 0, 4, kShapes);
  const std::uint32_t degree = bucket(degrees, 9, 1, kDegrees);
  seams = std::min(seams, kFaceSeams - 1);
  const std::uint32_t contexts[] = {
      ((seams * kStates + state) * kAges + own_age) * 4 + others_age,
      state * kSizes + size,
      (relative * kShapes + shape) * 3 + (patched != 0 ? 2
                                          : plain != 0 ? 1
                                                       : 0),
      (seams * kDegrees + degree) * kStates + state,
      (own_age * kDegrees + degree) * 4 + others_age,
      (std::min(flat / 3, kFlats - 1) * kFlats + flattest) * (kSizes / 3) + size / 3,
      ((touched * 5 + static_cast<std::uint32_t>(tight)) * kRatios + bucket(new_degrees, 10, 1, kRatios)) * kAges +
          own_age};
  return faces_.code(coder, begins ? 1 : 0, contexts, seams * kStates + state) != 0;
}

/// `i`: in the polygon.
bool PatchCoder::code_edge(BitCoder& coder, std::size_t i, bool goes_on) {
  const Index half = polygon_[i], twin = mesh_->twin(half), face = face_of_corner(half), beyond = face_of_corner(twin);
  std::uint32_t plain = 0, patched = 0;
  const int length = edge_log(half);
  int lengths = lengths_ - length;
  for (const Index h : {next_corner(twin), previous_corner(twin)}) {
    plain += state_of(h) == kPlain ? 1 : 0;
    patched += state_of(h) == kPatch ? 1 : 0;
    lengths += edge_log(h);
  }
  const Index apex = mesh_->apex(twin);
  const auto corners = static_cast<std::uint32_t>(std::min<std::size_t>(polygon_.size() - 3, kCorners - 1));
  const std::uint32_t pair = plain * 3 + patched;
  const std::uint32_t seam = std::min(crossed_, 2U) * 2 + (is_seam(half) ? 1 : 0);
  const std::uint32_t relative = bucket(length - lengths / static_cast<int>(polygon_.size() + 1), -32, 5, kRatios);
  const int across = log2_16(squared(positions_[mesh_->apex(half)] - positions_[apex]));
  const std::uint32_t flip = bucket(across - length, -40, 5, kRatios);
  // The edge as seen from the polygon's middle, and how far beyond it the patch would reach.
  const std::size_t next = i + 1 < polygon_.size() ? i + 1 : 0;
  const std::int64_t along = dot(radii_[i], radii_[next]);
  const int log_cosine =
      log2_16(static_cast<std::uint64_t>(std::abs(along))) - (radius_logs_[i] + radius_logs_[next]) / 2;
  const auto cosine = static_cast<int>(exp2_16(std::min(log_cosine, 0) + 16 * 6));
  const std::uint32_t angle = bucket(along < 0 ? -cosine : cosine, -64, 8, kRatios);
  const int reach = log2_16(squared(positions_[apex] * 16 - centre_));
  const std::uint32_t far = bucket((reach - mean_radius_log_) / 2, -16, 3, kRatios);
  const Around &a = around_[mesh_->from(half)], &b = around_[mesh_->to(half)], &c = around_[apex];
  const std::uint32_t balance =
      bucket(a.degree + b.degree - c.degree - around_[mesh_->apex(half)].degree, -8, 1, kDegrees);
  const std::uint32_t same = mesh_->made_in(face) == mesh_->made_in(beyond) ? 1 : 0;
  const auto at_most_two = [](std::int32_t x) { return static_cast<std::uint32_t>(std::min(x, 2)); };
  const std::uint32_t contexts[] = {
      (corners * kRatios + relative) * kPairs + pair,
      relative * kRatios + flip,
      (seam * kCorners + corners) * kSizes + size_of(beyond),
      ((relative * kAges + age(face)) * kAges + age(beyond)) * 4 + same * 2 + (face == patch_faces_.front() ? 1 : 0),
      (flip * kFlats + flatness(half)) * kCorners + corners,
      (corners * kRatios + angle) * kRatios + far,
      ((corners * kDegrees + balance) * 3 + at_most_two(c.patches)) * 3 + at_most_two(a.patches + b.patches),
      ((seam * kRatios + angle) * kRatios + relative) * kPairs + pair};
  return edges_.code(coder, goes_on ? 1 : 0, contexts, (seam * kCorners + corners) * 3 + patched) != 0;
}

bool PatchCoder::code_border(BitCoder& coder, std::uint32_t what, bool yes) {
  return borders_.code(coder, yes ? 1 : 0, std::array<std::uint32_t, 1>{what}, 0) != 0;
}

void PatchCoder::decide(Index face, State state) {
  state_[face] = state;
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    Around& vertex = around_[mesh_->from(h)];
    --vertex.open;
    if (state == kPatch) --vertex.degree;
  }
}

void PatchCoder::measure_polygon() {
  const auto count = static_cast<std::int64_t>(polygon_.size());
  centre_ = divide(sum_ * 16, count);
  radii_.clear();
  radius_logs_.clear();
  int logs = 0;
  for (const Index h : polygon_) {
    const Vec3i& radius = radii_.emplace_back(positions_[mesh_->from(h)] * 16 - centre_);
    logs += radius_logs_.emplace_back(log2_16(squared(radius)));
  }
  mean_radius_log_ = logs / static_cast<int>(count);
}

bool PatchCoder::has_corner(Index vertex) const {
  return std::any_of(polygon_.begin(), polygon_.end(), [&](Index h) { return mesh_->from(h) == vertex; });
}

/// Lets the patch that begins with a face grow, edge by edge.
void PatchCoder::grow(BitCoder& coder, Index seed, const PatchPlan* plan, RoundPatches& patches) {
  const Index patch = plan != nullptr ? plan->patch_of[seed] : 0;
  polygon_.assign({3 * seed, 3 * seed + 1, 3 * seed + 2});
  patch_faces_.assign(1, seed);
  decide(seed, kPatch);
  sum_ = {};
  lengths_ = 0;
  for (const Index h : polygon_) {
    sum_ = sum_ + positions_[mesh_->from(h)];
    lengths_ += edge_log(h);
  }
  measure_polygon();
  crossed_ = 0;
  std::size_t closing = kNoIndex;
  for (std::size_t i = 0; i < polygon_.size();) {
    const Index half = polygon_[i], twin = mesh_->twin(half);
    if (twin == kNoIndex) {
      if (closing == kNoIndex && code_border(coder, kCloses, plan != nullptr && plan->closing_edge[patch] == half)) {
        closing = i;
        decided_[half] = 1;
      }
      ++i;
      continue;
    }
    const Index beyond = face_of_corner(twin);
    // Corners of a ring are different vertices, and edges are asked for once.
    const bool may_go_on = state_[beyond] == kOpen && decided_[half] == 0 && polygon_.size() < kMostPatchCorners &&
                           !has_corner(mesh_->apex(twin));
    if (!may_go_on || !code_edge(coder, i, plan != nullptr && plan->patch_of[beyond] == patch)) {
      decided_[twin] = 1;
      ++i;
      continue;
    }
    decide(beyond, kPatch);
    crossed_ += is_seam(half) ? 1 : 0;
    patch_faces_.push_back(beyond);
    sum_ = sum_ + positions_[mesh_->apex(twin)];
    lengths_ += edge_log(next_corner(twin)) + edge_log(previous_corner(twin)) - edge_log(half);
    polygon_[i] = next_corner(twin);
    polygon_.insert(polygon_.begin() + static_cast<std::ptrdiff_t>(i) + 1, previous_corner(twin));
    measure_polygon();
  }
  end_patch(closing, patches);
}

void PatchCoder::end_patch(std::size_t closing, RoundPatches& patches) {
  for (const Index half : polygon_) {
    Around& corner = around_[mesh_->from(half)];
    corner.degree += 2;
    ++corner.patches;
    if (mesh_->twin(half) != kNoIndex) queue_.push_back(face_of_corner(mesh_->twin(half)));
  }
  const bool closed = closing == kNoIndex;
  if (!closed) {
    std::rotate(polygon_.begin(), polygon_.begin() + static_cast<std::ptrdiff_t>(closing) + 1, polygon_.end());
    polygon_.pop_back();
  }
  patches.polygons.insert(patches.polygons.end(), polygon_.begin(), polygon_.end());
  patches.faces.insert(patches.faces.end(), patch_faces_.begin(), patch_faces_.end());
  patches.patches.push_back(
      {static_cast<Index>(patches.polygons.size()), static_cast<Index>(patches.faces.size()), closed});
}

void PatchCoder::walk(BitCoder& coder, const PatchPlan* plan, Index count, RoundPatches& patches) {
  const auto face_count = static_cast<Index>(mesh_->face_count());
  for (Index first = 0; first < face_count && patches.patches.size() < count; ++first) {
    if (state_[first] != kOpen) continue;
    queue_.assign(1, first);
    for (std::size_t at = 0; at < queue_.size() && patches.patches.size() < count; ++at) {
      const Index face = queue_[at];
      if (state_[face] != kOpen) continue;
      if (!coder.goes_on()) return;
      if (code_face(coder, face, plan != nullptr && plan->patch_of[face] != kNoIndex)) {
        grow(coder, face, plan, patches);
        continue;
      }
      decide(face, kPlain);
      for (Index h = 3 * face; h < 3 * face + 3; ++h)
        if (mesh_->twin(h) != kNoIndex) queue_.push_back(face_of_corner(mesh_->twin(h)));
    }
  }
}

void PatchCoder::code_ears(BitCoder& coder, const PatchPlan* plan, RoundPatches& patches) {
  const bool any = code_border(coder, kHasEars, plan != nullptr && plan->ear_count > 0);
  const auto half_count = static_cast<Index>(3 * mesh_->face_count());
  const Index count = any ? coder.code_raw(plan != nullptr ? plan->ear_count : 0, std::bit_width(half_count)) : 0;
  for (Index h = 0; h < half_count && patches.ears.size() < count; ++h)
    if (mesh_->twin(h) == kNoIndex && decided_[h] == 0 &&
        code_border(coder, kIsEar, plan != nullptr && plan->is_ear[h] != 0))
      patches.ears.push_back(h);
}

bool PatchCoder::code(BitCoder& coder, const PatchMesh& mesh, bool has_seams, std::span<const Vec3i> positions,
                      std::uint32_t round, const PatchPlan* plan, RoundPatches& patches) {
  has_seams_ = has_seams;
  start(mesh, positions, round);
  patches.patches.clear();
  patches.polygons.clear();
  patches.faces.clear();
  patches.ears.clear();
  const auto face_count = static_cast<std::int64_t>(mesh.face_count());
  NumberCoder::Guess guess;
  guess.value = 16 * face_count / 6;
  guess.scale = 16 * face_count / 12;
  const auto planned = static_cast<std::int64_t>(plan != nullptr ? plan->closing_edge.size() : 0);
  const std::int64_t count = counts_.code(coder, planned, guess);
  if (count < 0 || count > face_count) return false;
  walk(coder, plan, static_cast<Index>(count), patches);
  code_ears(coder, plan, patches);
  return static_cast<std::int64_t>(patches.patches.size()) == count;
}

}  // namespace lodestone::detail
