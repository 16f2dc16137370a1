#include <lodestone/io/compact_stream.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <set>
#include <string>

#include <lodestone/core/parallel.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/lod/simplify.h>

#include "codec/attribute_coder.h"
#include "codec/compact_decoder.h"
#include "codec/compact_layout.h"
#include "support/compact.h"
#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

using Face = std::array<Index, 3>;

constexpr CompactCoding kCodings[] = {CompactCoding::Small, CompactCoding::Fast};

ProgressiveMesh progressive(const Mesh& mesh, double dense_rounds) {
  SimplifyOptions options;
  options.dense_rounds = dense_rounds;
  auto result = simplify(mesh, options);
  REQUIRE(result);
  return std::move(result->mesh);
}

ProgressiveMesh progressive(const TriangleSoup& soup, double dense_rounds = 1.5) {
  return progressive(mesh_of(soup), dense_rounds);
}

CompactStream encoded(const ProgressiveMesh& mesh, int grid_bits = 12, CompactCoding coding = CompactCoding::Small) {
  CompactOptions options;
  options.grid_bits = grid_bits;
  options.coding = coding;
  return stream_of(mesh, options);
}

/// A level's faces by their group and wedges, numbered anew; each begins with its least.
std::multiset<std::pair<std::size_t, Face>> faces_at(const Cursor& cursor, std::size_t group_count,
                                                     const std::vector<Index>& numbers) {
  std::multiset<std::pair<std::size_t, Face>> faces;
  for (std::size_t group = 0; group < group_count; ++group) {
    const auto corners = cursor.corners(group);
    for (std::size_t c = 0; c < corners.size(); c += 3) {
      Face face;
      for (std::size_t k = 0; k < 3; ++k) face[k] = numbers[corners[c + k]];
      std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
      faces.emplace(group, face);
    }
  }
  return faces;
}

std::vector<Index> same_numbers(const ProgressiveMesh& mesh) {
  std::vector<Index> numbers(mesh.wedge_vertex.size());
  for (Index i = 0; i < numbers.size(); ++i) numbers[i] = i;
  return numbers;
}

/// How far attributes may be moved: of a float, by half the distance of two values of its grid, where it has one.
double reach_of(const Attribute& attribute, const CompactOptions& options) {
  if (attribute.type != ComponentType::Float32) return 0;
  const std::vector<float> values = attribute_values(attribute);
  const std::size_t size = attribute.component_count;
  double range = 0;
  for (std::size_t c = 0; c < size; ++c) {
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (std::size_t i = c; i < values.size(); i += size) {
      low = std::min(low, static_cast<double>(values[i]));
      high = std::max(high, static_cast<double>(values[i]));
    }
    range = std::max(range, high - low);
  }
  const bool is_direction = attribute.name == "NORMAL" || attribute.name == "TANGENT";
  if (is_direction) return 2.0 / ((1 << (options.normal_bits - 1)) - 1);
  if (attribute.name.starts_with("WEIGHTS_")) return 1.001 / ((1 << options.weight_bits) - 1) + 1e-3;
  const int bits = attribute.name.starts_with("TEXCOORD_") ? options.texture_bits : options.other_bits;
  return range / 2 / ((1 << bits) - 1) * 1.0001 + 1e-6;
}

/// Checks that wedges have the elements that they had, but for rounding.
void check_attributes(const ProgressiveMesh& mesh, const CompactStream& stream, const ProgressiveMesh& coded,
                      const CompactOptions& options) {
  REQUIRE(coded.attributes.size() == mesh.attributes.size());
  for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
    const Attribute &given = mesh.attributes[a], &found = coded.attributes[a];
    INFO(given.name);
    REQUIRE(found.name == given.name);
    REQUIRE(found.type == given.type);
    REQUIRE(found.component_count == given.component_count);
    CHECK(found.normalized == given.normalized);
    const std::vector<float> before = attribute_values(given), after = attribute_values(found);
    REQUIRE(after.size() == before.size());
    const std::size_t size = given.component_count;
    double farthest = 0;
    for (std::size_t w = 0; w < mesh.wedge_vertex.size(); ++w)
      for (std::size_t c = 0; c < size; ++c)
        farthest = std::max(
            farthest, static_cast<double>(std::abs(before[w * size + c] - after[stream.wedge_numbers[w] * size + c])));
    CHECK(farthest <= reach_of(given, options));
  }
}

/// The grid that positions are rounded to where nobody gives one: its step, and the farthest that one is moved.
struct Grid {
  double step = 0;
  double reach() const { return std::sqrt(3.0) / 2 * step * 1.0001; }
};

Grid grid_of(const ProgressiveMesh& mesh, int bits) {
  std::array<double, 3> low{}, high{};
  low.fill(HUGE_VAL);
  high.fill(-HUGE_VAL);
  for (const Vec3f& p : mesh.positions) {
    const std::array<float, 3> values = {p.x, p.y, p.z};
    for (std::size_t c = 0; c < 3; ++c) {
      low[c] = std::min(low[c], static_cast<double>(values[c]));
      high[c] = std::max(high[c], static_cast<double>(values[c]));
    }
  }
  const double range = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  return {range / ((1 << bits) - 1)};
}

/// Checks a decoded mesh against what was encoded: the finest mesh, and the level after every round.
void check_same(const ProgressiveMesh& mesh, const CompactStream& stream, const ProgressiveMesh& coded, int bits) {
  REQUIRE(coded.groups.size() == mesh.groups.size());
  for (std::size_t g = 0; g < mesh.groups.size(); ++g) CHECK(coded.groups[g].material == mesh.groups[g].material);
  REQUIRE(coded.wedge_vertex.size() == mesh.wedge_vertex.size());
  for (std::size_t w = 0; w < mesh.wedge_vertex.size(); ++w)
    REQUIRE(coded.wedge_vertex[stream.wedge_numbers[w]] == stream.vertex_numbers[mesh.wedge_vertex[w]]);
  REQUIRE(std::set<Index>(stream.wedge_numbers.begin(), stream.wedge_numbers.end()).size() == mesh.wedge_vertex.size());
  check_attributes(mesh, stream, coded, {});
  REQUIRE(coded.positions.size() == mesh.positions.size());
  REQUIRE(coded.record_count() == mesh.record_count());
  REQUIRE(std::set<Index>(stream.vertex_numbers.begin(), stream.vertex_numbers.end()).size() == mesh.positions.size());
  const Grid grid = grid_of(mesh, bits);
  double farthest = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    farthest = std::max(farthest, length(Vec3(mesh.positions[v]) - Vec3(coded.positions[stream.vertex_numbers[v]])));
  CHECK(farthest <= grid.reach() + 1e-6);
  CHECK(coded.round_begin.size() == stream.round_count + 1);
  // Measured bounds may be lower at coarser levels; those of a stream never are.
  std::vector<float> largest = mesh.deviation;
  for (std::size_t i = largest.size(); i-- > 1;) largest[i - 1] = std::max(largest[i - 1], largest[i]);
  Cursor given(mesh), found(coded);
  const std::vector<Index> same = same_numbers(coded);
  const std::size_t each = 1 + mesh.positions.size() / 5000;  // of rounds; of large meshes not all are compared
  for (std::size_t r = 0; r < coded.round_begin.size(); ++r) {
    const Index position = coded.round_begin[r];
    if (r % each != 0 && r + 1 < coded.round_begin.size()) continue;
    given.seek(position);
    found.seek(position);
    // Rounds are stretches of the records given, so that the levels between them are levels of that mesh.
    CHECK(faces_at(given, mesh.groups.size(), stream.wedge_numbers) == faces_at(found, mesh.groups.size(), same));
    CHECK(coded.deviation[position] >= mesh.deviation[position]);
    CHECK(coded.curvature_error[position] >= mesh.curvature_error[position]);
    // Rounded up by an eighth of an octave, and by what the grid moves.
    const double widest = (static_cast<double>(largest[position]) + 2 * grid.reach()) * std::exp2(0.126);
    if (largest[position] > largest[0] * 1e-6F) CHECK(static_cast<double>(coded.deviation[position]) <= widest);
  }
  CHECK(coded.deviation.back() == 0);
}

std::vector<NamedShape> plain_shapes() {
  return {{"triangle", single_triangle(), true, {}},
          {"grid", grid(6, 0.1, 1), true, {}},
          {"flat grid", grid(8, 0, 1), true, {}},
          {"terrain", terrain(12, 3), true, {}},
          {"annulus", annulus(9, 3), true, {}},
          {"cylinder", cylinder(9, 4), true, {}},
          {"fan", fan(9, 0.5), true, {}},
          {"wide fan", fan(120, 0.5), true, {}},
          {"tetrahedron", tetrahedron(), true, {}},
          {"cube", cube(4), true, {}},
          {"sphere", icosphere(3, 0.05, 1), true, {}},
          {"torus", torus(12, 8), true, {}},
          {"double cone", double_cone(12), true, {}}};
}

}  // namespace

TEST_CASE("a compact stream decodes to the mesh it was made of, on the grid, and to its level after every round") {
  for (const NamedShape& shape : plain_shapes())
    for (const double dense_rounds : {0.0, 1.5, 100.0}) {
      const ProgressiveMesh mesh = progressive(shape.soup, dense_rounds);
      for (const CompactCoding coding : kCodings)
        for (const int bits : {8, 12, 16}) {
          CAPTURE(shape.name, dense_rounds, coding, bits);
          const CompactStream stream = encoded(mesh, bits, coding);
          check_same(mesh, stream, decoded(stream.bytes), bits);
        }
    }
}

TEST_CASE("every progressive mesh can be encoded: seams, groups, attributes, borders, sheets, pieces that vanish") {
  for (const NamedShape& shape : all_shapes()) {
    if (mesh_of(shape.soup).face_count() == 0) continue;
    for (const bool vanish : {false, true})
      for (const double dense_rounds : {0.0, 1.5}) {
        SimplifyOptions options;
        options.dense_rounds = dense_rounds;
        options.vanish = vanish;
        const auto result = simplify(mesh_of(shape.soup), options);
        REQUIRE(result);
        for (const CompactCoding coding : kCodings) {
          CAPTURE(shape.name, dense_rounds, vanish, coding);
          const CompactStream stream = encoded(result->mesh, 14, coding);
          check_same(result->mesh, stream, decoded(stream.bytes), 14);
        }
      }
  }
}

TEST_CASE("weights add up to one, in one set or two") {
  const CompactCoding coding = GENERATE(CompactCoding::Small, CompactCoding::Fast);
  TriangleSoup one = skinned_cylinder(12, 9);
  TriangleSoup two = one;
  for (const Attribute& given : one.attributes) {
    if (!given.name.starts_with("WEIGHTS_") && !given.name.starts_with("JOINTS_")) continue;
    Attribute& second = two.attributes.emplace_back(given);
    second.name.back() = '1';
  }
  for (Attribute& attribute : two.attributes)
    if (attribute.name.starts_with("WEIGHTS_")) {
      std::vector<float> values = attribute_values(attribute);
      for (float& value : values) value *= attribute.name.back() == '1' ? 0.25F : 0.75F;
      std::memcpy(attribute.data.data(), values.data(), attribute.data.size());
    }
  for (const TriangleSoup& soup : {one, two}) {
    const ProgressiveMesh mesh = progressive(soup);
    const CompactStream stream = encoded(mesh, 12, coding);
    const ProgressiveMesh coded = decoded(stream.bytes);
    check_same(mesh, stream, coded, 12);
    std::vector<double> sums(coded.wedge_vertex.size(), 0);
    for (const Attribute& attribute : coded.attributes) {
      if (!attribute.name.starts_with("WEIGHTS_")) continue;
      const std::vector<float> values = attribute_values(attribute);
      for (std::size_t i = 0; i < values.size(); ++i)
        sums[i / attribute.component_count] += static_cast<double>(values[i]);
    }
    for (const double sum : sums) CHECK(std::abs(sum - 1) < 1e-6);
  }
}

TEST_CASE("attributes of every type come back, what is not finite or no unit vector included") {
  const CompactCoding coding = GENERATE(CompactCoding::Small, CompactCoding::Fast);
  TriangleSoup soup = terrain(9, 3);
  const std::size_t count = soup.positions.size();
  Random random(5);
  const auto add = [&](const char* name, ComponentType type, int components, auto value) {
    Attribute attribute{name, type, static_cast<std::uint8_t>(components), false, {}};
    for (std::size_t i = 0; i < count * static_cast<std::size_t>(components); ++i) {
      const auto one = value(i);
      const auto* bytes = reinterpret_cast<const std::byte*>(&one);
      attribute.data.insert(attribute.data.end(), bytes, bytes + sizeof one);
    }
    soup.attributes.push_back(std::move(attribute));
  };
  const auto any = [&](auto zero) {
    return [&random](std::size_t) { return static_cast<decltype(zero)>(random.below(1U << 31U)); };
  };
  add("_A", ComponentType::Int8, 3, any(std::int8_t{}));
  add("_B", ComponentType::UInt8, 1, any(std::uint8_t{}));
  add("_C", ComponentType::Int16, 4, any(std::int16_t{}));
  add("TEXCOORD_0", ComponentType::UInt16, 2, any(std::uint16_t{}));
  add("_D", ComponentType::UInt32, 2, any(std::uint32_t{}));
  add("_E", ComponentType::UInt32, 1, [](std::size_t i) { return std::uint32_t{i % 2 != 0 ? 0xFFFFFFFFU : 0U}; });
  add("_F", ComponentType::Float32, 16, [&](std::size_t i) { return static_cast<float>(i % 7); });
  add("NORMAL", ComponentType::Float32, 3, [](std::size_t i) { return i % 5 == 0 ? 0.0F : 2.0F; });
  const ProgressiveMesh mesh = progressive(soup);
  const CompactStream stream = encoded(mesh, 14, coding);
  const ProgressiveMesh coded = decoded(stream.bytes);
  REQUIRE(coded.attributes.size() == mesh.attributes.size());
  ProgressiveMesh known = mesh, found = coded;
  for (ProgressiveMesh* each : {&known, &found})
    std::erase_if(each->attributes, [](const Attribute& attribute) { return attribute.name == "NORMAL"; });
  check_attributes(known, stream, found, {});

  // Not finite: the least value of its component.
  TriangleSoup odd = terrain(4, 3);
  Attribute broken{"COLOR_0", ComponentType::Float32, 1, false, {}};
  for (std::size_t i = 0; i < odd.positions.size(); ++i) {
    const float value = i % 3 == 0 ? NAN : i % 3 == 1 ? HUGE_VALF : 0.5F;
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    broken.data.insert(broken.data.end(), bytes, bytes + sizeof value);
  }
  odd.attributes.push_back(broken);
  for (const float value : attribute_values(decoded(encoded(progressive(odd), 12, coding).bytes).attributes[0]))
    CHECK(std::isfinite(value));
}

TEST_CASE("seams and materials are told by patches, not face by face") {
  for (const NamedShape& shape :
       {NamedShape{"seam cube", seam_cube(6), true, {}}, NamedShape{"seam sphere", seam_sphere(16, 12), true, {}},
        NamedShape{"two materials", two_material_sphere(3), true, {}}, NamedShape{"slit", slit_grid(12), true, {}},
        NamedShape{"facets", faceted_sphere(2), true, {}}}) {
    INFO(shape.name);
    const ProgressiveMesh mesh = progressive(shape.soup);
    REQUIRE(mesh.record_count() > 10);
    CHECK(encoded(mesh).loose_count == 0);
  }
}

TEST_CASE("models cost what they are said to, and come back") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  // Bits for each vertex at 12-bit positions, the whole stream; a little more than what they take.
  struct Limit {
    const char* path;
    CompactCoding coding;
    double bits;
  };
  for (const Limit& limit :
       {Limit{"mesh/cow.obj", CompactCoding::Small, 25.6}, Limit{"mesh/rocker-arm.obj", CompactCoding::Small, 20.7},
        Limit{"mesh/rocker-arm.obj", CompactCoding::Fast, 22.2}}) {
    if (kReduced) continue;
    INFO(limit.path);
    const auto path = model(limit.path);
    REQUIRE(path);
    const auto file = read_mesh(*path);
    REQUIRE(file);
    TriangleSoup soup = to_soup(file->mesh);
    soup.attributes.clear();
    soup.face_material.clear();
    const ProgressiveMesh mesh = progressive(soup);
    const CompactStream stream = encoded(mesh, 12, limit.coding);
    check_same(mesh, stream, decoded(stream.bytes), 12);
    CHECK(8.0 * static_cast<double>(stream.bytes.size()) / static_cast<double>(mesh.positions.size()) < limit.bits);
  }
}

TEST_CASE("the meshes of real scenes come back with all their attributes") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  const std::size_t most_faces = kReduced ? 1000 : 40000;
  std::size_t count = 0;
  for (const char* folder : {"gltf", "skin-morph", "field", "mesh/spot"})
    for (const auto& path : mesh_files(folder)) {
      const auto scene = Scene::read(path);
      if (!scene) continue;
      for (const SceneMesh& given : scene->meshes()) {
        if (given.mesh.face_count() > most_faces) continue;
        INFO(path << ", " << given.name);
        const ProgressiveMesh mesh = progressive(given.mesh, 1.5);
        for (const CompactCoding coding : kCodings) {
          CAPTURE(coding);
          const CompactStream stream = encoded(mesh, 14, coding);
          check_same(mesh, stream, decoded(stream.bytes), 14);
        }
        ++count;
      }
    }
  CHECK(count > 20);
}

TEST_CASE("the sizes of a compact stream's parts add up") {
  const CompactStream stream = encoded(progressive(icosphere(3, 0.05, 1)));
  const CompactSizes& s = stream.sizes;
  for (const double part : {s.header, s.base, s.places, s.wedges, s.loose, s.positions, s.errors}) CHECK(part > 0);
  const double sum = s.header + s.base + s.places + s.wedges + s.loose + s.positions + s.moves + s.errors;
  CHECK(std::abs(sum - 8.0 * static_cast<double>(stream.bytes.size())) < 1e-6);
}

/// All parts of sizes, one after the other.
std::vector<double> all_parts(const CompactSizes& s) {
  std::vector<double> parts = {s.header, s.base, s.places, s.positions, s.wedges, s.loose, s.errors};
  parts.insert(parts.end(), s.attributes.begin(), s.attributes.end());
  return parts;
}

TEST_CASE("what a reader finds the parts of a compact stream to take is what its writer spent on them") {
  const CompactCoding coding = GENERATE(CompactCoding::Small, CompactCoding::Fast);
  for (const ProgressiveMesh& mesh : {progressive(skinned_cylinder(12, 9)), progressive(seam_sphere(16, 12)),
                                      progressive(terrain(40, 3)), progressive(icosphere(2, 0, 1), 0)}) {
    const CompactStream stream = encoded(mesh, 12, coding);
    const auto parts = measure_compact(stream.bytes);
    REQUIRE(parts);
    CHECK(parts->coding == coding);
    const std::vector<double> written = all_parts(stream.sizes), read = all_parts(parts->sizes);
    REQUIRE(read.size() == written.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
      CAPTURE(i);
      CHECK(std::abs(read[i] - written[i]) < 1e-6);
    }
    CHECK(std::abs(parts->sizes.sum() - 8.0 * static_cast<double>(stream.bytes.size())) < 1e-6);
    REQUIRE(parts->attributes.size() == mesh.attributes.size());
    for (std::size_t a = 0; a < mesh.attributes.size(); ++a) CHECK(parts->attributes[a] == mesh.attributes[a].name);
  }
}

TEST_CASE("the rounds of a compact stream fill its chunks, and lead to the levels that they say") {
  const ProgressiveMesh mesh = progressive(seam_sphere(48, 40));
  const CompactStream stream = encoded(mesh);
  const auto chunks = read_compact_chunks(stream.bytes);
  const auto parts = measure_compact(stream.bytes);
  REQUIRE(chunks);
  REQUIRE(parts);
  REQUIRE(chunks->size() > 2);
  CHECK(parts->rounds.size() == stream.round_count + 1);
  CHECK(parts->rounds.front().record_count == 0);
  CHECK(parts->rounds.front().sizes.base > 0);
  std::vector<double> bits(chunks->size());
  std::vector<std::size_t> records(chunks->size());
  std::size_t loose = 0;
  const ProgressiveMesh coded = decoded(stream.bytes);
  std::size_t position = 0;
  for (const CompactRound& round : parts->rounds) {
    REQUIRE(round.chunk < chunks->size());
    CHECK(round.sizes.header == 0);
    bits[round.chunk] += round.sizes.sum();
    records[round.chunk] += round.record_count;
    loose += round.loose_count;
    position += round.record_count;
    CHECK(round.vertex_count == coded.base_vertex_count + position);
    CHECK(round.deviation == coded.deviation[position]);
    CHECK(round.face_count == extract_level(coded, static_cast<Index>(position)).face_count());
  }
  CHECK(position == coded.record_count());
  CHECK(loose == stream.loose_count);
  // A chunk ends within its last byte but two, unless it is filled up.
  for (std::size_t i = 0; i < chunks->size(); ++i) {
    CHECK(records[i] == (*chunks)[i].record_count);
    const double left = 8 * static_cast<double>((*chunks)[i].byte_length) - bits[i];
    CHECK(left > -16);
    CHECK(left < 16);
  }
  const std::uint64_t end = chunks->front().byte_offset + chunks->front().byte_length;
  const auto first = measure_compact(std::span(stream.bytes).first(end));
  REQUIRE(first);
  CHECK(std::abs(first->sizes.sum() - 8.0 * static_cast<double>(end)) < 1e-6);
  CHECK(first->rounds.back().chunk == 0);
  CHECK(!measure_compact(std::span(stream.bytes).first(end - 1)));
}

TEST_CASE("an encoding that is cancelled at any call makes no other, and says so") {
  const ProgressiveMesh mesh = progressive(seam_sphere(48, 40));
  const std::vector<std::byte> whole = encoded(mesh).bytes;
  bool ends = false;
  for (int last = 1; !ends; last = 2 * last + 1) {
    CAPTURE(last);
    int calls = 0;
    double done = 0;
    CompactOptions options;
    options.grid_bits = 12;
    options.progress = [&](double now) {
      CHECK(now >= done);
      CHECK(now <= 1);
      done = now;
      return ++calls < last;
    };
    const auto stream = encode_compact(mesh, options);
    CHECK(calls <= last);
    ends = calls < last;
    REQUIRE(stream.has_value() == ends);
    if (!ends) {
      CHECK(stream.error().code == ErrorCode::Cancelled);
      continue;
    }
    CHECK(stream->bytes == whole);
    CHECK(done == 1);
    CHECK(static_cast<std::size_t>(calls) > mesh.record_count() / 100);  // well within a round, too
  }
}

TEST_CASE("a compact stream depends on nothing but the mesh") {
  const Mesh mesh = mesh_of(icosphere(3, 0.05, 1));
  const std::vector<std::byte> bytes = encoded(progressive(mesh, 1.5)).bytes;
  CHECK(encoded(progressive(mesh, 1.5)).bytes == bytes);
  const Vec3f far = {1000, 0, 0};
  Mesh moved = mesh;
  for (Vec3f& p : moved.positions) p = {p.x + far.x, p.y, p.z};
  CHECK(encoded(progressive(moved, 1.5)).bytes != bytes);
}

detail::CompactHeader header_of(const std::vector<std::byte>& stream) {
  auto header = detail::read_compact_header(stream);
  REQUIRE(header);
  return std::move(*header);
}

TEST_CASE("how a stream is coded is in its header, and readers of other flags or of the small coding alone refuse it") {
  const ProgressiveMesh mesh = progressive(icosphere(2, 0.05, 1));
  std::vector<std::byte> small = encoded(mesh).bytes, fast = encoded(mesh, 12, CompactCoding::Fast).bytes;
  constexpr std::size_t kMinorAt = 10, kFlagsAt = 17;
  CHECK(small[kMinorAt] == std::byte{0});
  CHECK(small[kFlagsAt] == std::byte{0});
  CHECK(fast[kMinorAt] == std::byte{1});
  CHECK(fast[kFlagsAt] == std::byte{2});  // readers of version 3.0 take 0 and 1 alone there
  CHECK(header_of(fast).is_fast());
  const ProgressiveMesh one = decoded(small), other = decoded(fast);
  CHECK(one.positions == other.positions);
  CHECK(one.wedge_vertex == other.wedge_vertex);
  CHECK(one.triangles == other.triangles);
  CHECK(one.deviation == other.deviation);
  fast[kFlagsAt] = std::byte{4};
  const std::uint32_t checksum = detail::checksum32(std::span(fast).first(header_of(small).header_bytes - 4));
  std::memcpy(fast.data() + header_of(small).header_bytes - 4, &checksum, sizeof checksum);
  const auto refused = decode_compact(fast);
  REQUIRE(!refused);
  CHECK(refused.error().message == "compact stream: flags are 4");
}

TEST_CASE("a compact stream that ends with a chunk is the level it leads to, and any other cut is an error") {
  const CompactCoding coding = GENERATE(CompactCoding::Small, CompactCoding::Fast);
  const ProgressiveMesh mesh = progressive(terrain(40, 3));
  const CompactStream stream = encoded(mesh, 12, coding);
  const auto chunks = read_compact_chunks(stream.bytes);
  REQUIRE(chunks);
  REQUIRE(chunks->size() >= 3);
  CHECK(read_compact_chunks(std::span(stream.bytes).first(chunks->front().byte_offset)));
  std::set<std::uint64_t> ends;
  for (const CompactChunk& chunk : *chunks) {
    const std::uint64_t end = chunk.byte_offset + chunk.byte_length;
    ends.insert(end);
    const ProgressiveMesh prefix = decoded(std::span(stream.bytes).first(end));
    CHECK(prefix.record_count() == chunk.record_begin + chunk.record_count);
    CHECK(prefix.positions.size() == chunk.vertex_count);
    CHECK(prefix.groups[0].face_count == chunk.face_count);
    CHECK(prefix.deviation.back() == chunk.deviation);
    const auto position = static_cast<Index>(prefix.record_count());
    Cursor given(mesh), found(prefix);
    given.seek(position);
    found.seek(position);
    CHECK(faces_at(found, 1, same_numbers(prefix)) == faces_at(given, 1, stream.wedge_numbers));
  }
  CHECK(*ends.rbegin() == stream.bytes.size());
  // Each decodes what it can, so not every one is tried.
  for (std::size_t size = 0; size < stream.bytes.size();
       size += ends.contains(size + 1) || ends.contains(size) ? 1 : 29) {
    const auto cut = decode_compact(std::span(stream.bytes).first(size));
    INFO(size);
    CHECK(cut.has_value() == ends.contains(size));
    if (!cut) {
      CHECK(cut.error().message.starts_with("compact stream: "));
      CHECK(cut.error().byte_offset);
    }
  }
}

TEST_CASE("a flipped bit anywhere in a compact stream is a named error, and so are bytes behind its end") {
  const CompactCoding coding = GENERATE(CompactCoding::Small, CompactCoding::Fast);
  std::vector<std::byte> bytes = encoded(progressive(icosphere(2, 0.05, 1)), 12, coding).bytes;
  for (std::size_t at = 0; at < bytes.size(); ++at)
    for (int bit = 0; bit < 8; bit += kReduced ? 3 : 1) {
      bytes[at] ^= std::byte{1} << bit;
      const auto mesh = decode_compact(bytes);
      INFO("byte " << at << ", bit " << bit);
      CHECK(!mesh);
      if (!mesh) CHECK(mesh.error().message.starts_with("compact stream: "));
      bytes[at] ^= std::byte{1} << bit;
    }
  CHECK(decode_compact(bytes));
  bytes.push_back({});
  CHECK(!decode_compact(bytes));
}

/// A stream with another header, and after it what followed the old one; `size` bytes of that.
std::vector<std::byte> with_header(const std::vector<std::byte>& stream, const detail::CompactHeader& header,
                                   std::uint64_t size = ~std::uint64_t{0}) {
  const auto old = detail::read_compact_header(stream);
  REQUIRE(old);
  std::vector<std::byte> bytes = detail::write_compact_header(header);
  const auto body = std::span(stream).subspan(old->header_bytes);
  const auto kept = body.first(static_cast<std::size_t>(std::min<std::uint64_t>(size, body.size())));
  bytes.insert(bytes.end(), kept.begin(), kept.end());
  return bytes;
}

TEST_CASE("a chunk may add what it says of itself, whatever chunks say that never come") {
  const std::vector<std::byte> bytes = encoded(progressive(terrain(40, 3))).bytes;
  detail::CompactHeader header = header_of(bytes);
  REQUIRE(header.chunks.size() >= 3);
  detail::CompactChunkEntry& first = header.chunks.front();
  REQUIRE(first.round_count > 1);
  const auto refused = [&](const char* message) {
    const auto mesh = decode_compact(with_header(bytes, header, first.byte_length));
    REQUIRE(!mesh);
    INFO(mesh.error().message);
    CHECK(mesh.error().message == message);
  };
  // Its first rounds end it, not the comparison after the last.
  const detail::CompactChunkEntry known = first;
  first.face_count = 2;
  refused("compact stream: chunk 0: a round has wedges that do not fit");
  first = known;
  first.wedge_count = 1;
  refused("compact stream: chunk 0: a round has wedges that do not fit");
  first = known;
  first.record_count = first.round_count;
  refused("compact stream: chunk 0: a round has wedges that do not fit");
}

/// A stream of one chunk: a vertex, and rounds of one vertex each without faces, of so many wedges.
std::vector<std::byte> cloud_of(Index rounds, Index wedges_each) {
  using namespace detail;
  LevelCoder levels({}, {});
  ErrorCoder errors;
  BitCoder coder(false);
  int deviation = 0, curvature = 0;
  BaseMesh base;
  base.positions.resize(1);
  base.wedge_counts.push_back(1);
  int step = 0;
  REQUIRE(levels.code_step(coder, step));
  REQUIRE(levels.code_base(coder, base));
  REQUIRE(errors.code(coder, deviation, curvature));
  const PatchPlan no_patches;
  const WedgePlan no_wedges;
  for (Index round = 0; round < rounds; ++round) {
    REQUIRE(levels.code_patches(coder, &no_patches));
    REQUIRE(levels.code_places(coder, {}));
    REQUIRE(levels.code_wedges(coder, &no_wedges));
    REQUIRE(levels.code_points(coder, {}));
    Index count = 1;
    REQUIRE(levels.code_loose_count(coder, count));
    LooseVertex vertex;
    vertex.extra = wedges_each;
    if (!levels.code_loose_vertex(coder, vertex)) return {};
    bool ends = false;
    REQUIRE(levels.code_stage_end(coder, ends, {}));
    REQUIRE(errors.code(coder, deviation, curvature));
  }
  CompactHeader header;
  header.grid_bits = 14;
  header.groups.push_back({});
  header.base_vertex_count = header.base_wedge_count = 1;
  CompactChunkEntry chunk;
  chunk.round_count = chunk.record_count = rounds;
  chunk.wedge_count = rounds * wedges_each;
  std::vector<std::byte> body = coder.finish();
  body.resize(std::max<std::size_t>(body.size(), static_cast<std::size_t>(header.least_bytes(chunk, true))));
  chunk.byte_length = body.size();
  chunk.checksum = checksum32(body);
  header.chunks.push_back(chunk);
  std::vector<std::byte> bytes = write_compact_header(header);
  bytes.insert(bytes.end(), body.begin(), body.end());
  return bytes;
}

TEST_CASE("rounds cost what the level has, vertices without faces too") {
  CHECK(decoded(cloud_of(200, 1)).record_count() == 200);
  const auto slow = decode_compact(cloud_of(2000, 1));
  REQUIRE(!slow);
  CHECK(slow.error().code == ErrorCode::LimitExceeded);
}

TEST_CASE("a record has no more wedges than its sectors can name") {
  CHECK(decoded(cloud_of(1, 65536)).wedge_vertex.size() == 65537);
  CHECK(cloud_of(1, 65537).empty());
}

TEST_CASE("of a wide star, the first faces tell of its wedges") {
  using namespace detail;
  constexpr Index kFaces = 600;
  std::vector<Index> corners, groups(kFaces, 0), faces;
  PatchMesh mesh;
  WedgeTable wedges;
  for (Index i = 0; i <= kFaces; ++i) {
    wedges.add_vertex();
    wedges.add_wedge();
  }
  for (Index i = 0; i < kFaces; ++i) {
    faces.push_back(i);
    corners.insert(corners.end(), {kFaces, i, (i + 1) % kFaces});
  }
  mesh.start(corners, corners, groups, kFaces + 1);
  GridPoints positions;
  positions.resize(kFaces + 1);
  // Far from the first face all have the same value, the new vertex too; the next ones have others.
  const auto bits_of = [&](Index first_same) {
    AttributeSpec spec;
    spec.type = ComponentType::UInt16;
    spec.component_count = 1;
    AttributeCoder attributes(std::array{spec}, false);
    std::vector<std::int32_t> numbers;
    for (Index i = 0; i <= kFaces; ++i)
      numbers.push_back(i < first_same ? static_cast<std::int32_t>(40503 * i % 65536) : 12345);
    BitCoder coder(false);
    REQUIRE(attributes.code_base(coder, mesh, wedges, positions, std::array{numbers}));
    const double before = coder.bits();
    attributes.look(mesh, wedges, positions);
    REQUIRE(attributes.code_vertex(coder, mesh, wedges, positions, kFaces, faces, std::array{numbers}, 0));
    return coder.bits() - before;
  };
  CHECK(bits_of(250) < 4);
  CHECK(bits_of(300) > 8);
}

TEST_CASE("a base mesh may take no more bytes than a mesh may") {
  TriangleSoup soup = single_triangle();
  const std::vector<std::byte> bytes = encoded(progressive(soup)).bytes;
  const detail::CompactHeader header = header_of(bytes);
  REQUIRE(header.chunks.size() == 1);
  REQUIRE(header.chunks.front().round_count == 0);
  const auto add_to = [&](ProgressiveMesh& mesh, std::uint64_t most) {
    detail::CompactDecoder decoder(header, mesh, most);
    return decoder.add_chunk(std::span(bytes).subspan(header.header_bytes));
  };
  ProgressiveMesh small, large;
  const auto refused = add_to(small, 90);  // 3 · (12 + 4 + 4) without the arrays of records
  REQUIRE(!refused);
  CHECK(refused.error().code == ErrorCode::LimitExceeded);
  CHECK(small.positions.empty());
  CHECK(add_to(large, 10000));
  // Before its arrays are made, where these alone take more: what it says of itself is told.
  ProgressiveMesh none;
  const auto early = add_to(none, 59);
  REQUIRE(!early);
  CHECK(early.error().message == "mesh takes 60 bytes, where it may take 59");
}

TEST_CASE("texture coordinates of 32 bits are coded as numbers, and not read as texture coordinates") {
  TriangleSoup soup = terrain(9, 3);
  Random random(5);
  Attribute attribute{"TEXCOORD_0", ComponentType::UInt32, 2, false, {}};
  for (std::size_t i = 0; i < 2 * soup.positions.size(); ++i) {
    const std::uint32_t value = random.below(2) != 0 ? 0xFFFFFFFFU : 0U;
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    attribute.data.insert(attribute.data.end(), bytes, bytes + sizeof value);
  }
  soup.attributes.push_back(attribute);
  const ProgressiveMesh mesh = progressive(soup);
  const CompactStream stream = encoded(mesh);
  check_attributes(mesh, stream, decoded(stream.bytes), {});
  detail::CompactHeader header = header_of(stream.bytes);
  CHECK(header.attributes[0].coding == detail::AttributeCoding::Numbers);
  header.attributes[0].coding = detail::AttributeCoding::Texture;
  CHECK(!read_compact_chunks(with_header(stream.bytes, header)));
}

TEST_CASE("a material is a number of 32 bits") {
  detail::CompactHeader header = header_of(encoded(progressive(single_triangle())).bytes);
  header.groups[0].material = kNoIndex;
  std::vector<std::byte> bytes = detail::write_compact_header(header);
  CHECK(read_compact_chunks(bytes));
  constexpr std::size_t kLastOfMaterial = 16 + 18 + 1 + 4;  // behind the fixed part, the grid and the count
  REQUIRE(bytes[kLastOfMaterial] == std::byte{0x0F});
  bytes[kLastOfMaterial] = std::byte{0x1F};
  const std::size_t covered = bytes.size() - sizeof(std::uint32_t);
  const std::uint32_t checksum = detail::checksum32(std::span(bytes).first(covered));
  std::memcpy(bytes.data() + covered, &checksum, sizeof checksum);
  const auto chunks = read_compact_chunks(bytes);
  REQUIRE(!chunks);
  CHECK(chunks.error().message.find("material") != std::string::npos);
}

TEST_CASE("meshes on one grid meet where they met") {
  CompactOptions options;
  options.grid_bits = 10;
  options.grid = CompactGrid{{-1, -1, -1}, 3};
  const ProgressiveMesh left = progressive(grid(6, 0.1, 1));
  TriangleSoup beside = grid(6, 0.1, 1);
  for (Vec3f& p : beside.positions) p.x += 1;
  const ProgressiveMesh right = progressive(beside);
  const auto first = encode_compact(left, options), second = encode_compact(right, options);
  REQUIRE(first);
  REQUIRE(second);
  const double step = 3.0 / 1023;
  for (const CompactStream* stream : {&*first, &*second})
    for (const Vec3f& p : decoded(stream->bytes).positions)
      for (const float value : {p.x, p.y, p.z}) {
        const double steps = (static_cast<double>(value) + 1) / step;
        CHECK(std::abs(steps - std::round(steps)) < 1e-3);
      }
}

TEST_CASE("options of compact streams out of range are refused") {
  const ProgressiveMesh mesh = progressive(tetrahedron());
  for (const int bits : {0, 7, 17, 30}) {
    CompactOptions options;
    options.grid_bits = bits;
    const auto stream = encode_compact(mesh, options);
    REQUIRE(!stream);
    CHECK(stream.error().code == ErrorCode::InvalidArgument);
  }
  CompactOptions options;
  options.grid = CompactGrid{{0, 0, 0}, 0};
  CHECK(!encode_compact(mesh, options));
}

ErrorCode refusal_of(const ProgressiveMesh& mesh, const CompactOptions& options = {}) {
  const auto stream = encode_compact(mesh, options);
  REQUIRE(!stream);
  CHECK(stream.error().message.starts_with("compact stream: "));
  return stream.error().code;
}

TEST_CASE("a grid holds all positions, or the mesh is not encoded") {
  const ProgressiveMesh mesh = progressive(grid(6, 0, 1));  // from 0 to 1
  CompactOptions options;
  options.grid_bits = 8;
  const auto refused_on = [&](CompactGrid grid) {
    options.grid = grid;
    return refusal_of(mesh, options) == ErrorCode::InvalidArgument;
  };
  CHECK(refused_on({{0, 0, 0}, 0.9F}));
  CHECK(refused_on({{0.1F, 0, 0}, 2}));
  CHECK(refused_on({{0, 0, 0.1F}, 2}));
  CHECK(refused_on({{NAN, 0, 0}, 2}));
  CHECK(refused_on({{-3e38F, 0, 0}, HUGE_VALF}));
  CHECK(refused_on({{-1, -1, 1e38F}, 3.4e38F}));
  // Within half a step they are on the grid.
  options.grid = CompactGrid{{0.4F / 255, 0, 0}, 1};
  CHECK(encode_compact(mesh, options));

  for (const float value : {NAN, HUGE_VALF, 3e38F}) {
    ProgressiveMesh wide = mesh;
    wide.positions.front().x = value;
    wide.positions.back().x = -value;
    CHECK(refusal_of(wide) == ErrorCode::InvalidArgument);
  }
}

TEST_CASE("what a reader refuses is not written") {
  const ProgressiveMesh mesh = progressive(grid(6, 0.1F, 1));
  const auto with_attribute = [&](std::size_t name_bytes, std::uint8_t components) {
    ProgressiveMesh other = mesh;
    other.attributes.push_back({std::string(name_bytes, 'A'), ComponentType::UInt8, components, false, {}});
    other.attributes.back().data.resize(mesh.wedge_vertex.size() * components);
    return other;
  };
  CHECK(encode_compact(with_attribute(255, 16)));
  CHECK(refusal_of(with_attribute(256, 1)) == ErrorCode::LimitExceeded);
  CHECK(refusal_of(with_attribute(1, 17)) == ErrorCode::LimitExceeded);
  CHECK(refusal_of(with_attribute(1, 0)) == ErrorCode::LimitExceeded);
  ProgressiveMesh large = mesh;
  large.groups[0].face_count = Index{1} << 30U;
  CHECK(refusal_of(large) == ErrorCode::LimitExceeded);
  ProgressiveMesh split = mesh;
  split.wedge_vertex.resize(split.wedge_vertex.size() + 65536, split.wedge_vertex.back());
  split.record_wedge_begin.back() += 65536;
  CHECK(refusal_of(split) == ErrorCode::LimitExceeded);
  ProgressiveMesh lost = mesh;
  lost.curvature_error.front() = HUGE_VALF;
  CHECK(refusal_of(lost) == ErrorCode::InvalidArgument);
}

}  // namespace lodestone::test
