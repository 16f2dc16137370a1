#include <lodestone/io/read_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "support/data.h"
#include "support/mesh_properties.h"
#include "support/random.h"

namespace lodestone::test {
namespace {

MeshFile read(const std::string& source, const char* extension) {
  auto file = read_mesh_bytes(std::as_bytes(std::span(source)), extension);
  INFO((file ? std::string() : file.error().message));
  REQUIRE(file);
  return std::move(*file);
}

Error failure(const std::string& source, const char* extension) {
  const auto file = read_mesh_bytes(std::as_bytes(std::span(source)), extension);
  REQUIRE_FALSE(file);
  return file.error();
}

std::string all_notes(const MeshFile& file) {
  std::string all;
  for (const std::string& note : file.notes) all += note + '\n';
  return all;
}

const std::string kTriangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";

template <class T>
void put(std::string& out, T value, bool big_endian = false) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  if (big_endian) std::reverse(bytes, bytes + sizeof value);
  out.append(bytes, sizeof value);
}

std::string binary_stl(std::uint32_t declared_count, int count) {
  std::string out(80, ' ');
  put(out, declared_count);
  for (int i = 0; i < count; ++i) {
    for (const float f : {0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, static_cast<float>(i)}) put(out, f);
    put(out, std::uint16_t{0});
  }
  return out;
}

std::string ply(const std::string& format, const std::string& body, const std::string& vertex_properties = "") {
  return "ply\nformat " + format + " 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
         vertex_properties + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + body;
}

/// A simple polygon in some plane.
struct Outline {
  std::vector<Vec3f> corners;
  Vec3 normal;
  double area = 0;
};

using Point = std::array<double, 2>;

/// Spikes of random lengths around a centre.
std::vector<Point> star(Random& random, int count) {
  std::vector<Point> points;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * 3.14159265358979 * i / count, radius = 0.1 + random.unit();
    points.push_back({radius * std::cos(angle), radius * std::sin(angle)});
  }
  return points;
}

/// A comb, its back cut into pieces by corners that lie straight between their neighbours.
std::vector<Point> comb(Random& random, int teeth) {
  std::vector<Point> points;
  for (int i = 0; i <= 2 * teeth; ++i) points.push_back({static_cast<double>(i), 0});
  for (int i = 2 * teeth; i >= 0; --i) points.push_back({static_cast<double>(i), 0.2 + random.unit() + (i % 2) * 3});
  return points;
}

/// A spiral band of several turns.
std::vector<Point> spiral(int count) {
  std::vector<Point> points;
  for (int side = 0; side < 2; ++side)
    for (int i = 0; i < count; ++i) {
      const double angle = 0.2 * (side == 0 ? i : count - 1 - i), radius = 1 + 0.15 * angle + 0.4 * side;
      points.push_back({-radius * std::cos(angle), radius * std::sin(angle)});
    }
  return points;
}

Outline make_outline(std::uint64_t seed) {
  Random random(seed);
  const int size = 4 + static_cast<int>(seed);
  std::vector<Point> points = seed % 3 == 0 ? star(random, size) : seed % 3 == 1 ? comb(random, size) : spiral(size);
  std::rotate(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(seed % points.size()), points.end());
  Outline outline;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Point &a = points[i], &b = points[(i + 1) % points.size()];
    outline.area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
  }
  const Vec3 u = normalized({random.signed_unit(), random.signed_unit(), random.signed_unit()});
  const Vec3 v = normalized(cross(u, {random.signed_unit(), random.signed_unit(), random.signed_unit()}));
  outline.normal = outline.area > 0 ? cross(u, v) : -1 * cross(u, v);
  outline.area = std::abs(outline.area);
  for (const Point& p : points) {
    const Vec3 at = u * p[0] + v * p[1];
    outline.corners.push_back({static_cast<float>(at.x), static_cast<float>(at.y), static_cast<float>(at.z)});
  }
  return outline;
}

/// One polygon as a file of a format.
std::string polygon_file(const std::vector<Vec3f>& corners, const std::string& format) {
  std::ostringstream out;
  out.precision(9);
  const std::size_t n = corners.size();
  if (format == "off") out << "OFF\n" << n << " 1 0\n";
  if (format == "ply")
    out << "ply\nformat ascii 1.0\nelement vertex " << n
        << "\nproperty float x\nproperty float y\nproperty float z\n"
           "element face 1\nproperty list int int vertex_indices\nend_header\n";
  for (const Vec3f& p : corners) out << (format == "obj" ? "v " : "") << p.x << ' ' << p.y << ' ' << p.z << '\n';
  out << (format == "obj" ? "f" : std::to_string(n));
  for (std::size_t i = 0; i < n; ++i) out << ' ' << i + (format == "obj" ? 1 : 0);
  out << '\n';
  return out.str();
}

}  // namespace

TEST_CASE("where floats cannot hold the shape, a note says how far apart they are") {
  const auto square_at = [](const std::string& x, const std::string& further) {
    return "v " + x + " 0 0\nv " + further + " 0 0\nv " + x + " 20 0\nf 1 2 3\n";
  };
  const auto notes_of = [](const std::string& source) {
    return all_notes(read_mesh_bytes(std::as_bytes(std::span(source)), "obj").value());
  };
  CHECK_THAT(notes_of(square_at("5000000", "5000015")), contains("they are 0.5 apart there, 2 % of the object"));
  CHECK(notes_of(square_at("50000", "50015")).empty());
  CHECK(notes_of(square_at("0", "15")).empty());
}

TEST_CASE("obj: coordinates are the nearest floats") {
  // The first lies just above the middle of two floats: rounded to double on the way, it would go to the even one.
  const MeshFile file =
      read("v 1.00000005960464477541 1e-46 -1e-40\nv +2.5 -0 3.4028235e38\nv 0.1 7 .5\nf 1 2 3\n", "obj");
  CHECK(file.mesh.positions[0].x == std::nextafter(1.0F, 2.0F));
  CHECK(file.mesh.positions[0].y == 0);
  CHECK(file.mesh.positions[0].z == -1e-40F);
  CHECK(file.mesh.positions[1].x == 2.5F);
  CHECK(std::signbit(file.mesh.positions[1].y));
  CHECK(file.mesh.positions[1].z == std::numeric_limits<float>::max());
  CHECK(file.mesh.positions[2].x == 0.1F);
}

TEST_CASE("obj: polygons become fans, relative indices count back, lines may continue") {
  const MeshFile file = read("v 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 \\\r\n 0\r\nf -4 -3 -2 -1 # a square", "obj");
  CHECK(file.mesh.vertex_count() == 4);
  CHECK(file.mesh.face_count() == 2);
  CHECK(surface_area(file.mesh) == Approx(1));
}

TEST_CASE("obj: normals and texture coordinates are attributes, materials are numbered in order of use") {
  const MeshFile file = read(kTriangle +
                                 "v 0 0 1\nvt 0.25 0.75\nvn 0 0 2\nf 1/1/1 2/1/1 3/1/1\nusemtl b\nf 1/1/1 3/1/1 4/1/1\n"
                                 "usemtl a\nf 2/1/1 1/1/1 4/1/1\nusemtl b\nf 3/1/1 2/1/1 4/1/1\n",
                             "obj");
  REQUIRE(file.mesh.attributes.size() == 2);
  float values[3];
  CHECK(file.mesh.attributes[0].name == "NORMAL");
  std::memcpy(values, file.mesh.attributes[0].data.data(), 12);
  CHECK(values[2] == 1);
  CHECK(file.mesh.attributes[1].name == "TEXCOORD_0");
  std::memcpy(values, file.mesh.attributes[1].data.data(), 8);
  CHECK(values[0] == 0.25F);
  CHECK(values[1] == 0.25F);  // v points down in glTF
  CHECK(file.mesh.face_material == std::vector<Index>{0, 1, 2, 1});
}

TEST_CASE("obj: broken statements name their line") {
  struct Case {
    const char* source;
    const char* message;
  };
  for (const Case& c :
       {Case{"f 1 2 3\n", "line 4: vertex index 3 is out of range"},
        Case{"f 1 2 9\n", "line 4: vertex index 9 is out of range: the file has 3"},
        Case{"f 1 2 -4\n", "line 4: vertex index -4 is out of range: there are 3 so far"},
        Case{"f 0 1 2\n", "line 4: vertex index 0"}, Case{"f 1 2 x\n", "line 4: 'x' is not a corner"},
        Case{"f 1 2 99999999999999999999\n", "line 4: '99999999999999999999' is not a corner"},
        Case{"v 1 2\n", "line 4: 2 numbers where 3 are needed"}, Case{"v 1 2 3e\n", "line 4: '3e' is not a number"}}) {
    const bool needs_vertices = std::string(c.message).find("index 3") == std::string::npos;
    const std::string source = (needs_vertices ? kTriangle : std::string("v 0 0 0\n#\n#\n")) + c.source;
    INFO(source);
    const Error error = failure(source, "obj");
    CHECK(error.code == ErrorCode::Malformed);
    CHECK_THAT(error.message, contains(c.message));
  }
}

TEST_CASE("obj: faces that name texture coordinates or normals the file lacks keep their shape, with a warning") {
  for (const char* face : {"f 1/7 2/7 3/7\n", "f 1//2 2//2 3//2\n", "f 1/-1 2/-1 3/-1\n", "f 1/1/1 2/2/2 3/3/3\n"}) {
    INFO(face);
    const MeshFile file = read(kTriangle + face, "obj");
    CHECK(file.mesh.face_count() == 1);
    CHECK(file.mesh.attributes.empty());
    CHECK_THAT(all_notes(file),
               contains("3 corners of faces name a ") && contains("that the file lacks, as in line 4"));
  }
  const MeshFile partly = read(kTriangle + "v 1 1 0\nvt 0.5 0.5\nf 1/1 2/1 3/1\nf 2/1 4/9 3/1\n", "obj");
  CHECK(partly.mesh.face_count() == 2);
  REQUIRE(partly.mesh.attributes.size() == 1);
  CHECK_THAT(all_notes(partly), contains("1 corners of faces name a texture coordinate"));
}

TEST_CASE("obj: faces may stand before their vertices") {
  CHECK(read("f 1 2 3\n" + kTriangle, "obj").mesh.face_count() == 1);
}

TEST_CASE("obj: what is left out is noted") {
  const MeshFile file = read(kTriangle + "f 1 2 3\nf 1 2\nl 1 2\np 3\nsurf 0 1 0 1 1 2 3\n", "obj");
  CHECK_THAT(all_notes(file), contains("1 faces with fewer than three corners") && contains("2 point and line") &&
                                  contains("1 free-form"));
}

TEST_CASE("obj: NaN and infinity drop the face, not the file") {
  const MeshFile file = read("v nan inf +inf\nv -nan -Inf 0\nv 3 NaN -NaN\nf 1 2 3\n", "obj");
  CHECK(file.mesh.face_count() == 0);
  CHECK(file.assembly.nonfinite_faces == 1);
}

TEST_CASE("stl: binary and ASCII, whatever the header says") {
  CHECK(read(binary_stl(2, 2), "stl").mesh.face_count() == 2);
  std::string misleading = binary_stl(2, 2);
  misleading.replace(0, 5, "solid");
  CHECK(read(misleading, "stl").mesh.face_count() == 2);
  const MeshFile ascii = read(
      "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 0.1 0 0\nvertex 0 1e0 0\n"
      "endloop\nendfacet\nendsolid a\n",
      "stl");
  CHECK(ascii.mesh.face_count() == 1);
  CHECK(ascii.mesh.attributes.empty());
  CHECK(read("solid Empty\nendsolid Empty", "stl").mesh.face_count() == 0);
}

TEST_CASE("stl: counts and numbers that are not there are errors") {
  CHECK_THAT(failure(binary_stl(3, 2), "stl").message, contains("3 triangles exceed the 100 bytes"));
  CHECK_THAT(failure(binary_stl(0xffffffff, 1), "stl").message, contains("exceed"));
  CHECK_THAT(failure("garbage", "stl").message, contains("neither"));
  CHECK_THAT(failure("solid\nvertex 0 0 x\n", "stl").message, contains("line 2: 'x'"));
}

TEST_CASE("ply: ASCII and binary of both byte orders agree") {
  const std::string text = ply("ascii", "0 0 0\n0.1 0 0\n0 1 0\n3 0 1 2\n");
  const Mesh mesh = read(text, "ply").mesh;
  CHECK(mesh.face_count() == 1);
  for (const bool big_endian : {false, true}) {
    std::string body;
    for (const float f : {0.F, 0.F, 0.F, 0.1F, 0.F, 0.F, 0.F, 1.F, 0.F}) put(body, f, big_endian);
    body.push_back(3);
    for (const std::int32_t i : {0, 1, 2}) put(body, i, big_endian);
    const Mesh other = read(ply(big_endian ? "binary_big_endian" : "binary_little_endian", body), "").mesh;
    CHECK(triangle_set(other) == triangle_set(mesh));
  }
}

TEST_CASE("ply: normals and colours are attributes") {
  const std::string properties =
      "property float nx\nproperty float ny\nproperty float nz\n"
      "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const Mesh mesh =
      read(ply("ascii", "0 0 0 0 0 1 255 0 9\n1 0 0 0 0 1 1 2 3\n0 1 0 0 0 1 4 5 6\n3 0 1 2\n", properties), "ply")
          .mesh;
  REQUIRE(mesh.attributes.size() == 2);
  CHECK(mesh.attributes[1].name == "COLOR_0");
  CHECK(mesh.attributes[1].normalized);
  CHECK(mesh.attributes[1].component_count == 3);
  CHECK(attribute_values(mesh.attributes[1])[0] == 1);
}

TEST_CASE("ply: broken files name what is broken") {
  CHECK_THAT(failure(ply("ascii", "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), "ply").message, contains("vertex index 3"));
  CHECK_THAT(failure(ply("ascii", "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), "ply").message,
             contains("face 0: vertex index -1"));
  CHECK_THAT(failure(ply("ascii", "0 0 0\n1 0 0\n"), "ply").message, contains("element vertex"));
  CHECK_THAT(
      failure("ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n0\n", "ply").message,
      contains("count 4000000000 exceeds"));
  CHECK_THAT(failure("ply\nformat ascii 1.0\n", "ply").message, contains("header does not end"));
  CHECK_THAT(failure("ply\nformat ascii 1.0\nelement vertex 1\nproperty quad x\nend_header\n", "ply").message,
             contains("unknown type 'quad'"));
}

TEST_CASE("ply: ASCII lines with more values than the header says are an error") {
  CHECK_THAT(failure(ply("ascii", "0 0 0\n1 0 0 7\n0 1 0\n3 0 1 2\n"), "ply").message,
             contains("element vertex 1: '7' stands behind the 3 properties"));
  CHECK_THAT(failure(ply("ascii", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 9 9\n"), "ply").message,
             contains("element face 0: '9'"));
}

TEST_CASE("ply: strips become triangles of one side, without their stitches") {
  const MeshFile file = read(
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n10 0 1 2 3 -1 2 3 4 5 5\n",
      "ply");
  CHECK(file.mesh.face_count() == 4);
  CHECK(file.assembly.degenerate_faces == 0);
  for (Index face = 0; face < file.mesh.face_count(); ++face) CHECK(area_vector(file.mesh, face).z == Approx(1));
}

TEST_CASE("polygons become triangles that cover them and nothing else") {
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const Outline outline = make_outline(seed);
    for (const char* format : {"obj", "off", "ply"}) {
      INFO("seed " << seed << ", " << format << ", " << outline.corners.size() << " corners");
      const MeshFile file = read(polygon_file(outline.corners, format), format);
      CHECK(surface_area(file.mesh) == Approx(outline.area).epsilon(1e-4));
      CHECK(file.mesh.face_count() == outline.corners.size() - 2);
      CHECK(file.mesh.vertex_count() == outline.corners.size());  // no corner is left out: a neighbour may need it
      for (Index face = 0; face < file.mesh.face_count(); ++face)
        CHECK(dot(area_vector(file.mesh, face), outline.normal) > -1e-6);
    }
  }
}

TEST_CASE("polygons that cross themselves, have no area or hold NaN still end") {
  for (const char* source :
       {"v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 4\n", "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 1 0 0\nf 1 2 3 4\n",
        "v 0 0 0\nv nan 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n",
        "v 0 0 0\nv 1e38 0 0\nv 1e38 1e38 0\nv 4e37 1e37 0\nf 1 2 3 4\n", "v 0 0 0\nv 1 0 0\nf 1 2 1 2 1 2 1\n"}) {
    INFO(source);
    CHECK(read(source, "obj").mesh.face_count() <= 5);
  }
}

TEST_CASE("off: what a header and its lines may look like") {
  struct Case {
    const char* source;
    std::size_t faces;
  };
  for (const Case& c : {
           Case{"OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n", 2},
           Case{"OFF 4 1 4\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n", 2},
           Case{"# c\r\n\r\nOFF # c\r\n4 2 # no edges\r\n0 0 0 # a\r\n\r\n1 0 0\r\n1 1 0#b\r\n0 1 0\r\n3 0 1 2\r\n3 0 "
                "2 3",
                2},
           Case{"4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n", 2},
           Case{"OFF\n4\n1\n0\n0\n0 0\n1 0 0 1 1 0\n0 1 0\n4\n0 1\n2 3\n", 2},
           Case{"\xef\xbb\xbfOFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", 1},
           Case{"OFF\n3 3 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1\n1 2\n3 0 1 2\n", 1},
           Case{"NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n", 1},
           Case{"STNCOFF\n3 1 0\n0 0 0 0 0 1 255 0 0 255 0 0\n1 0 0 0 0 1 0 255 0 255 1 0\n0 1 0 0 0 1 0 0 9 255 0 "
                "1\n3 0 1 2\n",
                1},
           Case{"OFF\n0 0 0\n", 0},
       }) {
    INFO(c.source);
    CHECK(read(c.source, "off").mesh.face_count() == c.faces);
  }
}

TEST_CASE("off: coordinates are the nearest floats") {
  const Mesh mesh = read("OFF\n3 1 0\n1.00000005960464477541 0 0\n0.1 7 .5\n0 1 0\n3 0 1 2\n", "off").mesh;
  CHECK(mesh.positions[0].x == std::nextafter(1.0F, 2.0F));
  CHECK(mesh.positions[1].x == 0.1F);
}

TEST_CASE("off: broken files name what is broken, at once") {
  const std::string points = "0 0 0\n1 0 0\n0 1 0\n";
  struct Case {
    std::string source;
    const char* message;
  };
  for (const Case& c :
       {Case{"OFF\n353535235358 6 0\n" + points, "353535235358 vertices exceed the "},
        Case{"OFF\n3 4000000000 0\n" + points, "4000000000 faces exceed the "},
        Case{"OFF\n3 1 0\n" + points + "999999999 0 1 2\n", "999999999 corners exceed the "},
        Case{"OFF\n3 1 0\n" + points + "3 0 1 7\n", "line 6: vertex index 7 is out of range: there are 3"},
        Case{"OFF\n3 1 0\n" + points + "3 0 1 -1\n", "vertex index -1 is out of range"},
        Case{"OFF\n3 1 0\n" + points + "3 0 1\n", "is not a vertex's number"},
        Case{"OFF\n3 2 0\n" + points + "3 0 1 2\n", "the file ends after 1 of 2 faces"},
        Case{"OFF\n-3 1 0\n" + points, "'-3' is not a count of vertices"},
        Case{"OFF\n3 1 0\n0 0 x\n0 0 0\n0 0 0\n", "line 3: 'x' is not a number"},
        Case{"4OFF\n3 1 0\n", "'4OFF': only vertices of three dimensions"},
        Case{"nOFF\n5\n3 1 0\n", "'nOFF': only vertices of three dimensions"},
        Case{"OFF BINARY\n", "binary files are not supported"}, Case{"solid\n", "begins with 'solid'"}}) {
    INFO(c.source);
    CHECK_THAT(failure(c.source, "off").message, contains(c.message));
  }
}

TEST_CASE("text of two bytes a character is named, a byte order mark of UTF-8 is passed over") {
  for (const char* extension : {"obj", "off", "ply", "gltf"})
    for (const std::string& start :
         {std::string("\xfe\xff\0v", 4), std::string("\xff\xfev\0", 4), std::string("v\0 \0", 4)}) {
      const Error error = failure(start, extension);
      CHECK(error.code == ErrorCode::Unsupported);
      CHECK_THAT(error.message, contains("UTF-16"));
    }
  const std::string mark = "\xef\xbb\xbf";
  CHECK(read(mark + kTriangle + "f 1 2 3\n", "obj").mesh.face_count() == 1);
  CHECK(read(mark + ply("ascii", "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "").mesh.face_count() == 1);
  CHECK(read(mark + "solid\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n", "stl").mesh.face_count() == 1);
}

TEST_CASE("stl: keywords in any case, loops of any size") {
  const MeshFile file = read(
      "  SOLID A\n FACET NORMAL 0 0 0\n OUTER LOOP\n VERTEX 0 0 0\n VERTEX 1 0 0\n VERTEX 1 1 0\n VERTEX 0 1 0\n "
      "ENDLOOP\n"
      " ENDFACET\nENDSOLID A\n",
      "stl");
  CHECK(file.mesh.face_count() == 2);
  CHECK(surface_area(file.mesh) == Approx(1));
}

TEST_CASE("neighbours that wind otherwise are turned, unless the normals speak for both") {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
  const std::string facets =
      "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\nendfacet\n"
      "facet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 0 1 0\nvertex 1 1 0\nendloop\nendfacet\nendsolid\n";
  const std::string off = "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 3 2\n";
  for (const MeshFile& file : {read(square + "f 1 2 3\nf 1 4 3\n", "obj"), read(facets, "stl"), read(off, "off"),
                               read(square + "vn 0 0 1\nf 1//1 2//1 3//1\nf 1//1 4//1 3//1\n", "obj")}) {
    CHECK(file.assembly.turned_faces == 1);
    CHECK(file.assembly.nonmanifold_edges == 0);
    CHECK(file.mesh.vertex_count() == 4);
    CHECK(area_vector(file.mesh, 0).z > 0);
    CHECK(area_vector(file.mesh, 1).z > 0);
  }
  const std::string two_sides = square + "vn 0 0 1\nvn 0 0 -1\nf 1//1 2//1 3//1\nf 1//2 4//2 3//2\n";
  CHECK(read(two_sides, "obj").assembly.turned_faces == 0);
  CHECK(read(two_sides, "obj").assembly.nonmanifold_edges == 1);
}

TEST_CASE("other formats go through assimp, unknown ones are named") {
  const MeshFile file = read("0 0 0 1 0 0 0 1 0\n0 0 0 0 1 0 0 0 1\n", "raw");
  CHECK(file.mesh.face_count() == 2);
  CHECK(file.mesh.vertex_count() == 4);
  const MeshFile concave = read("p 8\n0 0 0\n3 0 0\n3 3 0\n2 3 0\n2 1 0\n1 1 0\n1 3 0\n0 3 0\n", "nff");
  CHECK(surface_area(concave.mesh) == Approx(7));
  const Error error = failure("x", "nonsense");
  CHECK(error.code == ErrorCode::Unsupported);
  CHECK_THAT(error.message, contains("'nonsense'"));
}

TEST_CASE("assimp: what a file asks for is bounded, what its importers do cannot end this process") {
  const Error error = failure("p 4000000000\n0 0 0\n", "nff");  // reads one corner again and again
  CHECK_THAT(error.message, contains("nff: "));
  if (kReduced) return;  // A sanitizer's allocator ends the child before the limit does.
  CHECK(error.code == ErrorCode::LimitExceeded);
  CHECK_THAT(error.message, contains("nff: it takes more than 10 s or 1024 MiB"));
}

TEST_CASE("files of the field are read as they are meant") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  struct Known {
    const char* name;
    std::size_t faces;
    double area;
  };
  for (const Known& known :
       {Known{"concave-u.obj", 28, 30}, Known{"concave.ply", 6, 7}, Known{"bom.obj", 2, 1}, Known{"cubevt.obj", 12, 6},
        Known{"face_in_group_name_mid_file.obj", 2, 113.318}, Known{"mpi.off", 180, 1873.52},
        Known{"comment.off", 2, 1}, Known{"mesh_with_colors.off", 6, 4}, Known{"capitals.stl", 4, 2.36603}}) {
    const auto path = model(std::string("field/") + known.name);
    if (!path) continue;
    INFO(known.name);
    const MeshFile file = read_mesh(*path).value();
    CHECK(file.mesh.face_count() == known.faces);
    CHECK(surface_area(file.mesh) == Approx(known.area).epsilon(1e-5));
  }
  for (const char* name : {"OutOfMemory.off", "oobidx.off", "fuze_ascii.ply", "box_UTF16BE.obj"})
    if (const auto path = model(std::string("field/") + name)) CHECK_FALSE(read_mesh(*path));
  if (const auto path = model("field/stitched-strip.glb"))
    CHECK(read_mesh(*path).value().assembly.degenerate_faces == 0);
}

TEST_CASE("every broken model ends in a mesh or in an error that names its file") {
  for (const char* folder : {"nasty", "gltf-invalid"})
    for (const auto& path : mesh_files(folder)) {
      INFO(path);
      const auto file = read_mesh(path);
      if (!file) CHECK_THAT(file.error().message, contains(path.filename().string()) && !contains("terminate"));
    }
}

TEST_CASE("models have the faces they are known for") {
  struct Known {
    const char* path;
    std::size_t faces;
  };
  for (const Known& known :
       {Known{"paper/fandisk.obj", 12946}, Known{"mesh/torus.STL", 8700}, Known{"mesh/beast.obj", 64618},
        Known{"gltf/FlightHelmet/FlightHelmet.gltf", 94722}, Known{"gltf/SheenCloth.glb", 115200},
        Known{"gltf/DenseSphere.glb", 30720}, Known{"gltf/pmndrs-suzi.glb", 14842}}) {
    const auto path = model(known.path);
    if (!path) continue;
    INFO(known.path);
    const auto file = read_mesh(*path);
    REQUIRE(file);
    CHECK(file->mesh.face_count() == known.faces);
  }
}

}  // namespace lodestone::test
