#include <lodestone/core/mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "support/mesh_properties.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

constexpr ComponentType kTypes[] = {ComponentType::Int8,   ComponentType::UInt8,  ComponentType::Int16,
                                    ComponentType::UInt16, ComponentType::UInt32, ComponentType::Float32};

std::vector<Index> all_faces(const Mesh& mesh) {
  std::vector<Index> faces(mesh.face_count());
  std::iota(faces.begin(), faces.end(), Index{0});
  return faces;
}

/// Some faces in any order, none twice.
std::vector<Index> random_faces(const Mesh& mesh, Random& random) {
  std::vector<Index> faces = all_faces(mesh);
  for (std::size_t i = faces.size(); i > 1; --i) std::swap(faces[i - 1], faces[random.below(i)]);
  faces.resize(random.below(faces.size() + 1));
  return faces;
}

void move_points(Mesh& mesh, double scale, const Vec3& offset) {
  for (Vec3f& p : mesh.positions) {
    const Vec3 q = Vec3(p) * scale + offset;
    p = to_float(q);
  }
}

template <class T>
Attribute attribute_of(ComponentType type, bool normalized, const std::vector<T>& values) {
  Attribute attribute{"_VALUES", type, 1, normalized, {}};
  attribute.data.resize(values.size() * sizeof(T));
  std::memcpy(attribute.data.data(), values.data(), attribute.data.size());
  return attribute;
}

template <class T>
std::vector<float> values_of(ComponentType type, bool normalized, const std::vector<T>& stored) {
  return component_values(type, normalized, std::as_bytes(std::span(stored)));
}

template <class T>
T stored_as(ComponentType type, bool normalized, double value) {
  std::array<std::byte, sizeof(T)> bytes{};
  store_component(type, normalized, value, bytes.data());
  T stored{};
  std::memcpy(&stored, bytes.data(), sizeof stored);
  return stored;
}

/// All values of an integer type come back from their floats, but for the two that stand for −1.
template <class T>
void check_every_value(ComponentType type) {
  const int lowest = std::numeric_limits<T>::is_signed ? -std::numeric_limits<T>::max() - 1 : 0;
  for (int i = lowest; i <= std::numeric_limits<T>::max(); ++i) {
    const T value = static_cast<T>(i);
    const double plain = values_of<T>(type, false, {value})[0];
    const double unit = values_of<T>(type, true, {value})[0];
    const bool back = stored_as<T>(type, false, plain) == value && plain == i && -1 <= unit && unit <= 1 &&
                      stored_as<T>(type, true, unit) == std::max(i, -int{std::numeric_limits<T>::max()});
    if (!back) FAIL_CHECK("value " << i);
  }
}

}  // namespace

TEST_CASE("a component has the bytes of its type, and the largest stands for 1") {
  const std::map<ComponentType, std::pair<std::size_t, double>> expected = {{ComponentType::Int8, {1, 127}},
                                                                            {ComponentType::UInt8, {1, 255}},
                                                                            {ComponentType::Int16, {2, 32767}},
                                                                            {ComponentType::UInt16, {2, 65535}},
                                                                            {ComponentType::UInt32, {4, 4294967295.0}},
                                                                            {ComponentType::Float32, {4, 1}}};
  for (const ComponentType type : kTypes) {
    CHECK(component_bytes(type) == expected.at(type).first);
    CHECK(largest_component(type) == expected.at(type).second);
  }
}

using Floats = std::vector<float>;

TEST_CASE("normalized integers end at exactly 1, 0 and −1") {
  CHECK(values_of<std::int8_t>(ComponentType::Int8, true, {-128, -127, 0, 127}) == Floats{-1, -1, 0, 1});
  CHECK(values_of<std::uint8_t>(ComponentType::UInt8, true, {0, 51, 255}) == Floats{0, 0.2F, 1});
  CHECK(values_of<std::int16_t>(ComponentType::Int16, true, {-32768, -32767, 0, 32767}) == Floats{-1, -1, 0, 1});
  CHECK(values_of<std::uint16_t>(ComponentType::UInt16, true, {0, 13107, 65535}) == Floats{0, 0.2F, 1});
  CHECK(values_of<std::uint32_t>(ComponentType::UInt32, true, {0, 0xffffffff}) == Floats{0, 1});
}

TEST_CASE("integers that are not normalized, and floats, are what they are") {
  CHECK(values_of<std::int8_t>(ComponentType::Int8, false, {-128, 127}) == Floats{-128, 127});
  CHECK(values_of<std::int16_t>(ComponentType::Int16, false, {-32768, 32767}) == Floats{-32768, 32767});
  CHECK(values_of<std::uint16_t>(ComponentType::UInt16, false, {65535}) == Floats{65535});
  CHECK(values_of<float>(ComponentType::Float32, false, {-3.5F, 7e30F}) == Floats{-3.5F, 7e30F});
  CHECK(values_of<float>(ComponentType::Float32, true, {-3.5F}) == Floats{-3.5F});
}

TEST_CASE("components are stored as the nearest value that there is") {
  check_every_value<std::int8_t>(ComponentType::Int8);
  check_every_value<std::uint8_t>(ComponentType::UInt8);
  check_every_value<std::int16_t>(ComponentType::Int16);
  check_every_value<std::uint16_t>(ComponentType::UInt16);
  CHECK(stored_as<std::uint8_t>(ComponentType::UInt8, true, 1.5) == 255);
  CHECK(stored_as<std::uint8_t>(ComponentType::UInt8, true, -0.1) == 0);
  CHECK(stored_as<std::uint8_t>(ComponentType::UInt8, true, 0.299 / 255) == 0);
  CHECK(stored_as<std::int16_t>(ComponentType::Int16, false, 1e9) == 32767);
  CHECK(stored_as<std::uint32_t>(ComponentType::UInt32, false, 4294967295.0) == 0xffffffff);
  CHECK(stored_as<float>(ComponentType::Float32, true, 1.5) == 1.5F);
}

TEST_CASE("floats come through bit for bit, normalized or not") {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> values = {0, -0.0F, 1, -300.25F, 1e-42F, std::numeric_limits<float>::infinity(), nan};
  for (const bool normalized : {false, true}) {
    const auto found = attribute_values(attribute_of(ComponentType::Float32, normalized, values));
    REQUIRE(found.size() == values.size());
    CHECK(std::memcmp(found.data(), values.data(), values.size() * sizeof(float)) == 0);
  }
  CHECK(largest_component(ComponentType::Float32) == 1);
}

TEST_CASE("elements are picked with all their bytes, in the order given, as often as given") {
  Random random(1);
  for (const ComponentType type : kTypes)
    for (const int component_count : {1, 3, 16}) {
      Attribute all{"_A", type, static_cast<std::uint8_t>(component_count), type != ComponentType::Float32, {}};
      CHECK(all.element_bytes() == component_bytes(type) * static_cast<std::size_t>(component_count));
      for (std::size_t i = 0; i < 20 * all.element_bytes(); ++i)
        all.data.push_back(static_cast<std::byte>(random.next()));
      std::vector<Index> first, second, both;
      for (int i = 0; i < 30; ++i) first.push_back(static_cast<Index>(random.below(20)));
      for (int i = 0; i < 12; ++i) second.push_back(static_cast<Index>(random.below(30)));
      for (const Index i : second) both.push_back(first[i]);
      const Attribute once = pick_elements(all, first), twice = pick_elements(once, second);
      CHECK(once.name == all.name);
      CHECK(once.type == type);
      CHECK(once.component_count == component_count);
      CHECK(once.normalized == all.normalized);
      REQUIRE(once.data.size() == 30 * all.element_bytes());
      for (std::size_t i = 0; i < 30; ++i)
        REQUIRE(std::memcmp(&once.data[i * all.element_bytes()], &all.data[first[i] * all.element_bytes()],
                            all.element_bytes()) == 0);
      CHECK(twice.data == pick_elements(all, both).data);
      CHECK(pick_elements(all, {}).data.empty());
    }
}

TEST_CASE("a corner names a wedge, which names a vertex, and without materials every face has material 0") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    Mesh mesh = mesh_of(shape.soup);
    CHECK(mesh.vertex_count() == mesh.positions.size());
    CHECK(mesh.wedge_count() == mesh.wedge_vertex.size());
    REQUIRE(mesh.corner_wedge.size() == 3 * mesh.face_count());
    for (Index c = 0; c < mesh.corner_wedge.size(); ++c) {
      REQUIRE(mesh.corner_vertex(c) == mesh.wedge_vertex[mesh.corner_wedge[c]]);
      REQUIRE(mesh.corner_position(c) == Vec3(mesh.positions[mesh.corner_vertex(c)]));
    }
    for (Index f = 0; f < mesh.face_count(); ++f)
      REQUIRE(mesh.material_of(f) == (mesh.face_material.empty() ? 0 : mesh.face_material[f]));
    mesh.face_material.clear();
    for (Index f = 0; f < mesh.face_count(); ++f) REQUIRE(mesh.material_of(f) == 0);
  }
}

TEST_CASE("picked faces are those faces in that order, with the vertices and wedges they use and no others") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const Mesh mesh = mesh_of(shape.soup);
    Random random(mesh.face_count());
    for (int round = 0; round < 3; ++round) {
      const std::vector<Index> faces = random_faces(mesh, random);
      std::vector<Index> source = {77};  // what it held before goes
      const Mesh picked = pick_faces(mesh, faces, &source);
      REQUIRE(picked.face_count() == faces.size());
      REQUIRE(picked.face_material.size() == (mesh.face_material.empty() ? 0 : faces.size()));
      REQUIRE(picked.attributes.size() == mesh.attributes.size());
      REQUIRE(source.size() == picked.vertex_count());
      Index vertices = 0, wedges = 0;
      std::map<Index, Index> wedge_now;
      for (Index c = 0; c < picked.corner_wedge.size(); ++c) {
        const Index was = 3 * faces[c / 3] + c % 3;
        REQUIRE(corner_bytes(picked, c) == corner_bytes(mesh, was));
        REQUIRE(picked.material_of(c / 3) == mesh.material_of(was / 3));
        REQUIRE(source[picked.corner_vertex(c)] == mesh.corner_vertex(was));
        REQUIRE(wedge_now.emplace(mesh.corner_wedge[was], picked.corner_wedge[c]).first->second ==
                picked.corner_wedge[c]);
        // Numbers go up by one where something is used for the first time.
        REQUIRE(picked.corner_vertex(c) <= vertices);
        REQUIRE(picked.corner_wedge[c] <= wedges);
        vertices = std::max(vertices, picked.corner_vertex(c) + 1);
        wedges = std::max(wedges, picked.corner_wedge[c] + 1);
      }
      CHECK(picked.vertex_count() == vertices);
      CHECK(picked.wedge_count() == wedges);
      CHECK(std::set<Index>(source.begin(), source.end()).size() == source.size());
    }
    CHECK(triangle_set(pick_faces(mesh, all_faces(mesh))) == triangle_set(mesh));
  }
}

TEST_CASE("the box is that of the faces: no corner is outside, each side touches one, unused points do not count") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    Mesh mesh = mesh_of(shape.soup);
    if (mesh.face_count() == 0) continue;
    move_points(mesh, 1, {3, -4, 5});  // so that the origin is outside
    mesh.positions.push_back({1e9F, -1e9F, 1e9F});
    mesh.wedge_vertex.push_back(static_cast<Index>(mesh.vertex_count() - 1));
    const Box box = bounding_box(mesh);
    std::set<double> x, y, z;
    for (Index c = 0; c < mesh.corner_wedge.size(); ++c) {
      const Vec3 p = mesh.corner_position(c);
      x.insert(p.x), y.insert(p.y), z.insert(p.z);
    }
    CHECK(box.low == Vec3{*x.begin(), *y.begin(), *z.begin()});
    CHECK(box.high == Vec3{*x.rbegin(), *y.rbegin(), *z.rbegin()});
    CHECK(box.diagonal() == length(box.high - box.low));
  }
  for (const Mesh& mesh : {Mesh{}, Mesh{{{1, 2, 3}}, {0}, {}, {}, {}}}) {
    CHECK(bounding_box(mesh).low == Vec3{});
    CHECK(bounding_box(mesh).high == Vec3{});
    CHECK(bounding_box(mesh).diagonal() == 0);
  }
}

TEST_CASE("an area vector is perpendicular to its face, the same from each corner, and turns with the winding") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    Mesh mesh = mesh_of(shape.soup);
    for (Index f = 0; f < mesh.face_count(); ++f) {
      const Vec3 a = mesh.corner_position(3 * f), b = mesh.corner_position(3 * f + 1),
                 c = mesh.corner_position(3 * f + 2);
      const Vec3 n = area_vector(mesh, f);
      REQUIRE(std::abs(dot(n, b - a)) < 1e-12);
      REQUIRE(std::abs(dot(n, c - a)) < 1e-12);
      REQUIRE(length(n) == Approx(length(b - a) * length(c - a) * std::sin(angle_between(b - a, c - a))).margin(1e-12));
      std::rotate(mesh.corner_wedge.begin() + 3 * f, mesh.corner_wedge.begin() + 3 * f + 1,
                  mesh.corner_wedge.begin() + 3 * f + 3);
      REQUIRE(length(area_vector(mesh, f) - n) < 1e-12);
      std::swap(mesh.corner_wedge[3 * f], mesh.corner_wedge[3 * f + 1]);
      REQUIRE(length(area_vector(mesh, f) + n) < 1e-12);
    }
  }
}

TEST_CASE("the area vectors of a closed surface add up to zero, and look outwards") {
  for (const NamedShape& shape : manifold_shapes()) {
    const Mesh mesh = mesh_of(shape.soup);
    if (mesh.face_count() == 0 || !open_places(mesh).empty()) continue;
    INFO(shape.name);
    Vec3 sum;
    double volume = 0;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      sum += area_vector(mesh, f);
      volume += dot(area_vector(mesh, f), mesh.corner_position(3 * f)) / 6;
    }
    CHECK(length(sum) < 1e-12 * static_cast<double>(mesh.face_count()));
    CHECK(volume > 0);
  }
}

TEST_CASE("area is that of the parts together, stays where a mesh is moved, and grows with the square of its size") {
  for (const NamedShape& shape : all_shapes()) {
    INFO(shape.name);
    const Mesh mesh = mesh_of(shape.soup);
    const double area = surface_area(mesh);
    Random random(2);
    const std::vector<Index> some = random_faces(mesh, random);
    const std::set<Index> taken(some.begin(), some.end());
    std::vector<Index> others;
    for (const Index f : all_faces(mesh))
      if (taken.count(f) == 0) others.push_back(f);
    CHECK(surface_area(pick_faces(mesh, some)) + surface_area(pick_faces(mesh, others)) == Approx(area));
    Mesh moved = mesh;
    move_points(moved, 1, {1, -2, 3});
    CHECK(surface_area(moved) == Approx(area).epsilon(1e-4));
    move_points(moved, 4, {});
    CHECK(surface_area(moved) == Approx(16 * area).epsilon(1e-4));
  }
  CHECK(surface_area(mesh_of(grid(6, 0, 1))) == Approx(1));
  CHECK(surface_area(mesh_of(two_sided(grid(6, 0, 1)))) == Approx(2));
  CHECK(surface_area(Mesh{}) == 0);
}

}  // namespace lodestone::test
