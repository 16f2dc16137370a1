// Tries to break the promise of ProgressiveMesh::deviation: random meshes of every sort, random options, random
// positions, and a referee of its own, which halves triangles where the farthest point may be. LODESTONE_BOUND_TRIALS
// asks for more trials than a normal run makes, and prints how tight the bounds are.

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/deviation.h>
#include <lodestone/lod/simplify.h>

#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/random.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

constexpr int kPositionsPerMesh = 4;
constexpr std::size_t kMostCorners = 3000;               // of a shape that is repeated
constexpr std::size_t kQueries = kReduced ? 300 : 1500;  // of the referee, each way, beside those at vertices

// Distances between points whose coordinates are as large as 1 are rounded by some 2⁻⁵³, more where faces are needles:
// a surface measured against itself can seem to be 3e-14 away. That goes for the referee as for what the bound adds up.
// A float's last digit is five orders of magnitude larger than this.
constexpr double kRounding = 1e-12;

int between(Random& random, int low, int high) {
  return low + static_cast<int>(random.below(static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1));
}

bool one_in(Random& random, std::uint64_t n) { return random.below(n) == 0; }

double power_between(Random& random, double low, double high) {
  return std::pow(10, low + (high - low) * random.unit());
}

// Random meshes.

/// Triangles between a few points: most edges have none or many neighbours.
TriangleSoup tangle(Random& random) {
  TriangleSoup soup;
  const int points = between(random, 4, 30);
  for (int i = 0; i < points; ++i)
    soup.positions.push_back({static_cast<float>(random.signed_unit()), static_cast<float>(random.signed_unit()),
                              static_cast<float>(random.signed_unit())});
  for (int i = between(random, 1, 120) * 3; i > 0; --i)
    soup.indices.push_back(static_cast<Index>(random.below(soup.positions.size())));
  return soup;
}

TriangleSoup random_shape(Random& random) {
  static const std::vector<NamedShape> kAll = all_shapes();
  const double noise = one_in(random, 3) ? 0 : power_between(random, -4, -0.5);
  const std::uint64_t seed = random.next();
  switch (random.below(12)) {
    case 0:
      return grid(between(random, 2, one_in(random, 10) ? 25 : 10), noise, seed);
    case 1:
      return terrain(between(random, 4, 11), seed);
    case 2:
      return icosphere(between(random, 1, one_in(random, 10) ? 3 : 2), noise, seed);
    case 3:
      return torus(between(random, 5, 14), between(random, 4, 8));
    case 4:
      return cube(between(random, 2, 5));
    case 5:
      return many_components(between(random, 2, 5));
    case 6:
      return walled_cube(2 * between(random, 1, 2));
    case 7:
      return seam_sphere(between(random, 6, 12), between(random, 4, 8));
    case 8:
      return mobius_strip(between(random, 6, 16), between(random, 1, 3));
    case 9:
      return mirrored_terrain(2 * between(random, 2, 5));
    case 10:
      return tangle(random);
    default:
      return kAll[random.below(kAll.size())].soup;
  }
}

/// Gives every triangle points of its own; `assemble` joins equal ones again.
void explode(TriangleSoup& soup) {
  std::vector<Vec3f> positions;
  for (const Index i : soup.indices) positions.push_back(soup.positions[i]);
  for (Attribute& attribute : soup.attributes) attribute = pick_elements(attribute, soup.indices);
  soup.positions = std::move(positions);
  std::iota(soup.indices.begin(), soup.indices.end(), Index{0});
}

/// Moves points, equal ones alike: `move(p, noise)` gets numbers that only depend on the point.
template <class Move>
void move_points(TriangleSoup& soup, Move move) {
  for (Vec3f& p : soup.positions) {
    const auto bits = [](float x) { return std::uint64_t{std::bit_cast<std::uint32_t>(x + 0.0F)}; };
    Random noise(bits(p.x) * 0x9e3779b97f4a7c15u ^ bits(p.y) * 0xc2b2ae3d27d4eb4fu ^ bits(p.z) << 20);
    const Vec3 q = move(Vec3(p), noise);
    p = to_float(q);
  }
}

void distort(TriangleSoup& soup, Random& random) {
  if (one_in(random, 3)) {
    const double size = power_between(random, -5, -0.5);
    move_points(soup, [&](const Vec3& p, Random& noise) {
      return p + Vec3{noise.signed_unit(), noise.signed_unit(), noise.signed_unit()} * size;
    });
  }
  if (one_in(random, 4)) {  // Spikes.
    const double length = power_between(random, 0, 2);
    move_points(soup,
                [&](const Vec3& p, Random& noise) { return one_in(noise, 15) ? p * (1 + length * noise.unit()) : p; });
  }
  if (one_in(random, 4)) {  // Faces and edges in line, walls that stand upright, triangles of no area.
    const double step = 1.0 / between(random, 1, 8);
    move_points(soup, [&](const Vec3& p, Random&) {
      return Vec3{std::round(p.x / step) * step, std::round(p.y / step) * step, std::round(p.z / step) * step};
    });
  }
  if (one_in(random, 5)) {  // Needles.
    const double x = power_between(random, -7, 0), y = power_between(random, -7, 0);
    move_points(soup, [&](const Vec3& p, Random&) { return Vec3{p.x * x, p.y * y, p.z}; });
  }
}

/// Leaves faces out and turns others over: borders, cuts and pieces. Pre: exploded.
void tear(TriangleSoup& soup, Random& random) {
  const double gone = one_in(random, 3) ? 0.3 * random.unit() : 0;
  const double turned = one_in(random, 6) ? 0.3 * random.unit() : 0;
  std::vector<Index> indices, materials;
  for (std::size_t f = 0; f < soup.indices.size() / 3; ++f) {
    if (random.unit() < gone) continue;
    Index a = soup.indices[3 * f], b = soup.indices[3 * f + 1];
    if (random.unit() < turned) std::swap(a, b);
    indices.insert(indices.end(), {a, b, soup.indices[3 * f + 2]});
    if (!soup.face_material.empty()) materials.push_back(soup.face_material[f]);
  }
  soup.indices = std::move(indices);
  soup.face_material = std::move(materials);
}

/// Adds the shape once more, moved and smaller: it cuts itself, or lies beside itself as a piece that may vanish.
void repeat(TriangleSoup& soup, Random& random) {
  const Vec3 shift =
      Vec3{random.signed_unit(), random.signed_unit(), random.signed_unit()} * power_between(random, -3, 1);
  const double size = one_in(random, 2) ? 1 : power_between(random, -2, 0);
  const auto count = static_cast<Index>(soup.positions.size());
  const std::size_t corners = soup.indices.size();
  for (Index i = 0; i < count; ++i) {
    const Vec3 p = Vec3(soup.positions[i]) * size + shift;
    soup.positions.push_back(to_float(p));
  }
  for (Attribute& a : soup.attributes) {
    const std::vector<std::byte> once = a.data;
    a.data.insert(a.data.end(), once.begin(), once.end());
  }
  for (std::size_t i = 0; i < corners; ++i) soup.indices.push_back(soup.indices[i] + count);
  const std::vector<Index> materials = soup.face_material;
  soup.face_material.insert(soup.face_material.end(), materials.begin(), materials.end());
}

/// Splits the surface into regions of different textures, so that seams run between them. Pre: exploded.
void add_seams(TriangleSoup& soup, Random& random) {
  const double x = random.unit(), y = random.unit();
  const auto region = [&](std::size_t corner) {
    const std::size_t first = corner / 3 * 3;
    const Vec3 centre = Vec3(soup.positions[soup.indices[first]]) + Vec3(soup.positions[soup.indices[first + 1]]) +
                        Vec3(soup.positions[soup.indices[first + 2]]);
    return (centre.x > 3 * x ? 1 : 0) + (centre.y > 3 * y ? 2 : 0);
  };
  std::vector<float> values(2 * soup.positions.size());
  for (std::size_t c = 0; c < soup.indices.size(); ++c) {
    const Vec3f& p = soup.positions[soup.indices[c]];
    values[2 * std::size_t{soup.indices[c]}] = p.x + static_cast<float>(2 * region(c));
    values[2 * std::size_t{soup.indices[c]} + 1] = p.y;
  }
  Attribute attribute{"TEXCOORD_0", ComponentType::Float32, 2, false, {}};
  const auto bytes = std::as_bytes(std::span(values));
  attribute.data.assign(bytes.begin(), bytes.end());
  soup.attributes.clear();
  soup.attributes.push_back(std::move(attribute));
}

void add_materials(TriangleSoup& soup, Random& random) {
  const std::uint64_t count = 1 + random.below(3);
  const bool stripes = one_in(random, 2);
  soup.face_material.clear();
  for (std::size_t f = 0; f < soup.indices.size() / 3; ++f)
    soup.face_material.push_back(static_cast<Index>(stripes ? f / 9 % (count + 1) : random.below(count + 1)));
}

TriangleSoup random_soup(Random& random) {
  TriangleSoup soup = random_shape(random);
  explode(soup);
  distort(soup, random);
  tear(soup, random);
  while (soup.indices.size() < kMostCorners && one_in(random, 4)) repeat(soup, random);
  if (one_in(random, 3)) add_seams(soup, random);
  if (one_in(random, 5)) add_materials(soup, random);
  if (one_in(random, 3)) {
    const double scale = power_between(random, -12, 12);
    const Vec3 offset = Vec3{random.signed_unit(), random.signed_unit(), random.signed_unit()} *
                        (one_in(random, 2) ? scale * power_between(random, 0, 6) : 0);
    move_points(soup, [&](const Vec3& p, Random&) { return p * scale + offset; });
  }
  return soup;
}

SimplifyOptions random_options(Random& random, std::size_t vertex_count) {
  SimplifyOptions options;
  if (one_in(random, 3))
    options.metric = std::array{Metric::Gaussian, Metric::Mean, Metric::Principal}[random.below(3)];
  if (one_in(random, 5)) options.normalisation = Normalisation::Density;
  if (one_in(random, 5)) options.reference = Reference::Current;
  if (one_in(random, 3)) options.crease_angle = 3 * random.unit();
  options.lock_border = one_in(random, 6);
  options.vanish = one_in(random, 4);
  options.measure_step = std::array{0.0, 0.0, 0.01, 0.1, 0.1, 0.5}[random.below(6)];
  if (one_in(random, 4))
    for (double* weight : {&options.weights.normal, &options.weights.texcoord, &options.weights.color,
                           &options.weights.skin, &options.weights.target})
      *weight = one_in(random, 2) ? 0 : power_between(random, -2, 2);
  if (one_in(random, 6))
    for (std::size_t v = 0; v < vertex_count; ++v)
      options.importance.push_back(static_cast<float>(power_between(random, -2, 3.05)));
  if (one_in(random, 8)) options.stop.max_deviation = power_between(random, -4, 0);
  return options;
}

// The referee.

/// Looks for the point of one surface that is farthest from another.
class Search {
 public:
  Search(const Mesh& from, const Mesh& to) : to_(to) {
    std::vector<Corner> corners;
    for (const Vec3f& p : from.positions) corners.push_back(corner_at(Vec3(p)));
    for (Index c = 0; c < from.corner_wedge.size(); c += 3)
      add({corners[from.corner_vertex(c)], corners[from.corner_vertex(c + 1)], corners[from.corner_vertex(c + 2)]});
  }

  /// Returns the largest distance found with so many queries.
  double run(std::size_t queries) {
    for (; queries > 0 && !pieces_.empty(); --queries) {
      std::pop_heap(pieces_.begin(), pieces_.end(), is_less_promising);
      const Piece piece = pieces_.back();
      pieces_.pop_back();
      if (piece.bound > farthest_) split(piece.corners);
    }
    return farthest_;
  }

 private:
  struct Corner {
    Vec3 point;
    double distance;
  };
  using Corners = std::array<Corner, 3>;
  struct Piece {
    Corners corners;
    double bound;    // No point of it is farther.
    double promise;  // Points are likely that far.
  };

  static bool is_less_promising(const Piece& a, const Piece& b) { return a.promise < b.promise; }

  Corner corner_at(const Vec3& point) {
    const Corner corner{point, to_.nearest(point, std::numeric_limits<double>::infinity()).distance};
    farthest_ = std::max(farthest_, corner.distance);
    return corner;
  }

  void add(const Corners& c) {
    const double ab = length(c[0].point - c[1].point), bc = length(c[1].point - c[2].point),
                 ca = length(c[2].point - c[0].point);
    // A distance changes by no more than the way.
    const double bound = std::min(
        {c[0].distance + std::max(ab, ca), c[1].distance + std::max(ab, bc), c[2].distance + std::max(bc, ca)});
    if (bound <= farthest_) return;
    const double largest = std::max({c[0].distance, c[1].distance, c[2].distance});
    pieces_.push_back({c, bound, largest + (bound - largest) / 4});
    std::push_heap(pieces_.begin(), pieces_.end(), is_less_promising);
  }

  /// Halves a piece across its longest edge.
  void split(Corners c) {
    const auto edge = [&](std::size_t i) { return squared_length(c[(i + 1) % 3].point - c[i].point); };
    std::size_t longest = 0;
    for (std::size_t i = 1; i < 3; ++i)
      if (edge(i) > edge(longest)) longest = i;
    std::rotate(c.begin(), c.begin() + static_cast<std::ptrdiff_t>(longest), c.end());
    const Corner middle = corner_at((c[0].point + c[1].point) * 0.5);
    add({c[0], middle, c[2]});
    add({middle, c[1], c[2]});
  }

  SurfaceIndex to_;
  double farthest_ = 0;
  std::vector<Piece> pieces_;
};

double largest_coordinate(const Mesh& mesh) {
  const Box box = bounding_box(mesh);
  double largest = 0;
  for (const Vec3& p : {box.low, box.high}) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

// Trials.

/// Any position; or one where the bound is likely tight: the base mesh, after a few removals, or just measured, so that
/// the bound is lower than that of the finer position before it.
Index random_position(Random& random, const ProgressiveMesh& mesh) {
  const auto count = static_cast<Index>(mesh.record_count());
  auto position = static_cast<Index>(random.below(std::uint64_t{count} + 1));
  switch (random.below(6)) {
    case 0:
      return 0;
    case 1:
      return count - std::min(position, static_cast<Index>(random.below(10)));
    case 2:
      while (position < count && mesh.deviation[position] >= mesh.deviation[position + 1]) ++position;
      return position;
    default:
      return position;
  }
}

struct Tally {
  std::size_t trials = 0;
  std::size_t violations = 0;
  std::vector<double> looseness;  ///< bound / measured, where something was measured
};

void try_position(const Mesh& full, const ProgressiveMesh& mesh, Index position, Tally& tally) {
  INFO("position " << position << " of " << mesh.record_count());
  Cursor cursor(mesh);
  cursor.seek(position);
  const Mesh level = extract_level(mesh, cursor);
  const auto bound = static_cast<double>(mesh.deviation[position]);
  ++tally.trials;
  if (level.face_count() == 0) {
    CHECK(bound >= bounding_box(full).diagonal());
    return;
  }
  const double measured = std::max(Search(full, level).run(kQueries), Search(level, full).run(kQueries));
  const double rounding = kRounding * largest_coordinate(full);
  INFO("measured " << measured << ", bound " << bound << ", rounding " << rounding);
  CHECK(measured <= bound + rounding);
  if (measured > bound + rounding) ++tally.violations;
  if (measured > rounding) tally.looseness.push_back(bound / measured);
}

void try_mesh(std::uint64_t seed, Tally& tally) {
  INFO("seed " << seed);
  Random random(seed);
  const auto assembled = assemble(random_soup(random));
  REQUIRE(assembled);
  const Mesh& mesh = assembled->mesh;
  if (mesh.face_count() == 0) return;
  const auto simplified = simplify(mesh, random_options(random, mesh.vertex_count()));
  REQUIRE(simplified);
  for (int i = 0; i < kPositionsPerMesh; ++i)
    try_position(mesh, simplified->mesh, random_position(random, simplified->mesh), tally);
}

double looseness_at(const Tally& tally, double share) {
  return tally.looseness[static_cast<std::size_t>(share * static_cast<double>(tally.looseness.size()))];
}

}  // namespace

TEST_CASE("no point of a level, and none of the full mesh, is farther from the other than the record's bound") {
  const char* const wanted = std::getenv("LODESTONE_BOUND_TRIALS");
  const std::size_t count = wanted != nullptr ? std::strtoul(wanted, nullptr, 10) : 400;
  Tally tally;
  for (std::uint64_t seed = 0; tally.trials < count; ++seed) try_mesh(seed, tally);
  REQUIRE(tally.looseness.size() > count / 2);
  std::sort(tally.looseness.begin(), tally.looseness.end());
  const double median = looseness_at(tally, 0.5), most = looseness_at(tally, 0.8);
  if (wanted != nullptr)
    std::printf("%zu trials, %zu violations; bound / measured: median %.3f, 80 %% below %.3f\n", tally.trials,
                tally.violations, median, most);
  // A bound that is many times too large could be trusted, but would be of no use.
  CHECK(median < 1.5);
  CHECK(most < 5);
}

}  // namespace lodestone::test
