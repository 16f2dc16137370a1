// Bits are mixed from contexts of what is decided around, of degrees, ages and shapes: removed vertices leave long
// edges behind, and fans whose inner edges end at crowded vertices.

#include "codec/mixed_patch_model.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

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

/// Numbers how many of three are plain, and how many in patches.
std::uint32_t number_neighbours(std::uint32_t plain, std::uint32_t patched) {
  constexpr std::array<std::uint32_t, 4> kFirst = {0, 4, 7, 9};
  return kFirst[plain] + patched;
}

}  // namespace

MixedPatchModel::MixedPatchModel()
    : faces_(kFaceContexts, kFaceSeams * kStates), edges_(kEdgeContexts, kSeams * kCorners * 3) {}

void MixedPatchModel::start(const PatchWalk& walk) {
  mesh_ = walk.mesh;
  positions_ = walk.positions;
  const PatchMesh& mesh = *mesh_;
  const std::size_t face_count = mesh.face_count();
  look_at_faces(walk);
  mean_face_log_ = face_count == 0 ? 0 : static_cast<int>(sum_of_face_logs_ / static_cast<std::int64_t>(face_count));
  ages_.resize(face_count);
  for (Index f = 0; f < face_count; ++f)
    ages_[f] = static_cast<std::uint8_t>(std::min(walk.round - mesh.made_in(f), kAges) - 1);
  around_.resize(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const auto degree = static_cast<std::int32_t>(mesh.degree(v));
    around_[v] = {std::min(degree, static_cast<std::int32_t>(kDegrees)), degree, degree, 0};
  }
}

/// Looks anew at the faces that have changed, and forgets what was seen around them.
void MixedPatchModel::look_at_faces(const PatchWalk& walk) {
  const std::size_t face_count = mesh_->face_count();
  normals_.resize(face_count);
  face_logs_.resize(face_count);
  flats_.resize(3 * face_count);
  asked_.assign(3 * face_count, 0);
  looks_.resize(face_count);
  for (const Index face : walk.changed.made) look_at_face(face);
  for (const Index face : walk.changed.moved) look_at_face(face);
  for (Index face = 0; face < face_count && walk.changed.are_all; ++face) look_at_face(face);
  asked_.assign(3 * face_count, 0);
  // Neighbours and seams may be others elsewhere, too.
  if (join_count_ == mesh_->join_count() && has_seams_ == walk.has_seams) return;
  join_count_ = mesh_->join_count();
  has_seams_ = walk.has_seams;
  looks_.assign(face_count, {});
}

void MixedPatchModel::look_at_face(Index face) {
  if (std::exchange(asked_[3 * face], std::uint8_t{1}) != 0) return;  // several times among the changed ones
  const Vec3i a = (*positions_)[mesh_->from(3 * face)];
  Vec3i n = cross((*positions_)[mesh_->from(3 * face + 1)] - a, (*positions_)[mesh_->from(3 * face + 2)] - a);
  const int shift = shorten(n, 30);
  sum_of_face_logs_ -= face_logs_[face];
  face_logs_[face] = static_cast<std::int16_t>(log2_16(squared(n)) + 32 * shift);
  sum_of_face_logs_ += face_logs_[face];
  shorten(n, 15);
  normals_[face] = {static_cast<std::int16_t>(n.x), static_cast<std::int16_t>(n.y), static_cast<std::int16_t>(n.z)};
  forget(face);
}

/// Forgets what was seen of a face and its neighbours.
void MixedPatchModel::forget(Index face) {
  looks_[face].is_known = false;
  for (Index h = 3 * face; h < 3 * face + 3; ++h)
    if (const Index twin = mesh_->twin(h); twin != kNoIndex) looks_[face_of_corner(twin)].is_known = false;
}

const MixedPatchModel::Look& MixedPatchModel::look_at(const PatchWalk& walk, Index face) {
  Look& look = looks_[face];
  if (look.is_known) return look;
  look = {};
  std::uint32_t seams = 0;
  int longest = 0, lengths = 0, areas = 0, neighbours = 0;
  for (Index k = 0; k < 3; ++k) {
    const Index h = 3 * face + k, twin = mesh_->twin(h);
    const int length = mesh_->edge_log(h);
    lengths += length;
    longest = std::max(longest, length);
    if (twin == kNoIndex) continue;
    seams += walk.is_seam(h) ? 1 : 0;
    const Index beyond = face_of_corner(twin);
    areas += face_logs_[beyond];
    ++neighbours;
    if (!looks_[beyond].is_known) measure_flatness(h);
    if (flats_[h] != flats_[twin]) look.uneven = static_cast<std::uint8_t>(look.uneven | 1U << k);
  }
  if (neighbours > 0)
    look.relative = static_cast<std::uint8_t>(bucket(face_logs_[face] - areas / neighbours, -48, 8, kShapes));
  look.shape = static_cast<std::uint8_t>(bucket(longest - lengths / 3, 0, 4, kShapes));
  look.seams = static_cast<std::uint8_t>(std::min(seams, kFaceSeams - 1));
  look.is_known = true;
  return look;
}

std::uint32_t MixedPatchModel::size_of(Index face) const {
  return bucket(face_logs_[face] - mean_face_log_, -96, 8, kSizes);
}

/// 7 for flat edges, less by one for each doubling of the angle's tangent, 0 from a right angle on and at borders: as
/// seen from a half-edge, and from its twin. These are mostly alike, but for rounding.
void MixedPatchModel::measure_flatness(Index half) {
  const auto normal = [&](Index h) {
    const Normal& n = normals_[face_of_corner(h)];
    return Vec3i{n.x, n.y, n.z};
  };
  const Index twin = mesh_->twin(half);
  const Vec3i a = normal(half), b = normal(twin);
  flats_[half] = flats_[twin] = 0;
  const std::int64_t cosine = dot(a, b);
  if (cosine <= 0) return;
  const Vec3i sine = cross(a, b);
  const int log_cosine = 2 * log2_16(static_cast<std::uint64_t>(cosine));
  const auto flatness = [&](const Vec3i& s) {
    const Vec3i quarter = {s.x >> 2, s.y >> 2, s.z >> 2};
    const int log_tangent = log2_16(squared(quarter) + 1) + 64 - log_cosine;
    return static_cast<std::uint8_t>(bucket(-log_tangent, 0, 32, kFlats));
  };
  flats_[half] = flatness(sine);
  flats_[twin] = flatness(sine * -1);
}

/// The flatness of a face's k-th edge, which is not a border: as seen from the side that asked for it first in the
/// round.
std::uint32_t MixedPatchModel::flatness(const Look& look, Index face, Index k) {
  const Index half = 3 * face + k;
  if ((look.uneven >> k & 1U) == 0) return flats_[half];
  if (asked_[half] == 0) asked_[half] = asked_[mesh_->twin(half)] = static_cast<std::uint8_t>(flats_[half] + 1);
  return asked_[half] - 1U;
}

bool MixedPatchModel::code_face(BitCoder& coder, const PatchWalk& walk, Index face, bool begins) {
  const Look& look = look_at(walk, face);
  std::uint32_t plain = 0, patched = 0, ages = 0, flat = 0, flattest = 0, touched = 0;
  int degrees = 0, new_degrees = 0, tight = 4;
  for (Index k = 0; k < 3; ++k) {
    const Index h = 3 * face + k, twin = mesh_->twin(h);
    const Around& vertex = around_[mesh_->from(h)];
    degrees += vertex.degree_before;
    new_degrees += std::min(vertex.degree, 64);
    touched += vertex.patches > 0 ? 1 : 0;
    tight = std::min(tight, vertex.open);
    if (twin == kNoIndex) {
      ++plain;
      continue;
    }
    const Index beyond = face_of_corner(twin);
    const std::uint32_t state = walk.state(beyond);
    plain += state == PatchWalk::kPlain ? 1 : 0;
    patched += state == PatchWalk::kPatch ? 1 : 0;
    ages += ages_[beyond];
    const std::uint32_t flat_here = flatness(look, face, k);
    flat += flat_here;
    if (state == PatchWalk::kOpen) flattest = std::max(flattest, flat_here);
  }
  const std::uint32_t state = number_neighbours(plain, patched), size = size_of(face), own_age = ages_[face];
  const std::uint32_t others_age = std::min(ages / 3, kAges - 1);
  const std::uint32_t degree = bucket(degrees, 9, 1, kDegrees);
  const std::array<std::uint32_t, 7> contexts = {
      ((look.seams * kStates + state) * kAges + own_age) * 4 + others_age,
      state * kSizes + size,
      (look.relative * kShapes + look.shape) * 3 + (patched != 0 ? 2
                                                    : plain != 0 ? 1
                                                                 : 0),
      (look.seams * kDegrees + degree) * kStates + state,
      (own_age * kDegrees + degree) * 4 + others_age,
      (std::min(flat / 3, kFlats - 1) * kFlats + flattest) * (kSizes / 3) + size / 3,
      ((touched * 5 + static_cast<std::uint32_t>(tight)) * kRatios + bucket(new_degrees, 10, 1, kRatios)) * kAges +
          own_age};
  return faces_.code(coder, begins ? 1 : 0, contexts, look.seams * kStates + state) != 0;
}

bool MixedPatchModel::code_edge(BitCoder& coder, const PatchWalk& walk, std::size_t i, bool goes_on) {
  const Index half = walk.polygon[i], twin = mesh_->twin(half), face = face_of_corner(half),
              beyond = face_of_corner(twin);
  std::uint32_t plain = 0, patched = 0;
  const int length = mesh_->edge_log(half);
  int lengths = walk.lengths - length;
  for (const Index h : {next_corner(twin), previous_corner(twin)}) {
    plain += walk.state_of(h) == PatchWalk::kPlain ? 1 : 0;
    patched += walk.state_of(h) == PatchWalk::kPatch ? 1 : 0;
    lengths += mesh_->edge_log(h);
  }
  const Index apex = mesh_->apex(twin);
  const auto corners = static_cast<std::uint32_t>(std::min<std::size_t>(walk.polygon.size() - 3, kCorners - 1));
  const std::uint32_t pair = plain * 3 + patched;
  const std::uint32_t seam = std::min(walk.crossed, 2U) * 2 + (walk.is_seam(half) ? 1 : 0);
  const std::uint32_t relative = bucket(length - lengths / static_cast<int>(walk.polygon.size() + 1), -32, 5, kRatios);
  const int across = log2_16(squared((*positions_)[mesh_->apex(half)] - (*positions_)[apex]));
  const std::uint32_t flip = bucket(across - length, -40, 5, kRatios);
  // The edge as seen from the polygon's middle, and how far beyond it the patch would reach.
  const std::size_t next = i + 1 < walk.polygon.size() ? i + 1 : 0;
  const std::int64_t along = dot(radii_[i], radii_[next]);
  const int log_cosine =
      log2_16(static_cast<std::uint64_t>(std::abs(along))) - (radius_logs_[i] + radius_logs_[next]) / 2;
  const auto cosine = static_cast<int>(exp2_16(std::min(log_cosine, 0) + 16 * 6));
  const std::uint32_t angle = bucket(along < 0 ? -cosine : cosine, -64, 8, kRatios);
  const int reach = log2_16(squared((*positions_)[apex] * 16 - centre_));
  const std::uint32_t far = bucket((reach - mean_radius_log_) / 2, -16, 3, kRatios);
  const Around &a = around_[mesh_->from(half)], &b = around_[mesh_->to(half)], &c = around_[apex];
  const std::uint32_t balance =
      bucket(a.degree + b.degree - c.degree - around_[mesh_->apex(half)].degree, -8, 1, kDegrees);
  const std::uint32_t same = mesh_->made_in(face) == mesh_->made_in(beyond) ? 1 : 0;
  const auto at_most_two = [](std::int32_t x) { return static_cast<std::uint32_t>(std::min(x, 2)); };
  const std::array<std::uint32_t, 8> contexts = {
      (corners * kRatios + relative) * kPairs + pair,
      relative * kRatios + flip,
      (seam * kCorners + corners) * kSizes + size_of(beyond),
      ((relative * kAges + ages_[face]) * kAges + ages_[beyond]) * 4 + same * 2 + (face == walk.faces.front() ? 1 : 0),
      (flip * kFlats + flatness(look_at(walk, face), face, half % 3)) * kCorners + corners,
      (corners * kRatios + angle) * kRatios + far,
      ((corners * kDegrees + balance) * 3 + at_most_two(c.patches)) * 3 + at_most_two(a.patches + b.patches),
      ((seam * kRatios + angle) * kRatios + relative) * kPairs + pair};
  return edges_.code(coder, goes_on ? 1 : 0, contexts, (seam * kCorners + corners) * 3 + patched) != 0;
}

void MixedPatchModel::decide(const PatchWalk& walk, Index face) {
  for (Index h = 3 * face; h < 3 * face + 3; ++h) {
    Around& vertex = around_[mesh_->from(h)];
    --vertex.open;
    if (walk.state(face) == PatchWalk::kPatch) --vertex.degree;
  }
}

void MixedPatchModel::change_polygon(const PatchWalk& walk) {
  Vec3i sum;
  for (const Index corner : walk.corners) sum = sum + (*positions_)[corner];
  const auto count = static_cast<std::int64_t>(walk.polygon.size());
  centre_ = divide(sum * 16, count);
  radii_.clear();
  radius_logs_.clear();
  int logs = 0;
  for (const Index corner : walk.corners) {
    const Vec3i& radius = radii_.emplace_back((*positions_)[corner] * 16 - centre_);
    logs += radius_logs_.emplace_back(log2_16(squared(radius)));
  }
  mean_radius_log_ = logs / static_cast<int>(count);
}

void MixedPatchModel::end_polygon(const PatchWalk& walk) {
  for (const Index vertex : walk.corners) {
    Around& corner = around_[vertex];
    corner.degree += 2;
    ++corner.patches;
  }
}

}  // namespace lodestone::detail
