#include <lodestone/io/read_mesh.h>

#include <cstring>
#include <limits>
#include <string>

#include "support/data.h"
#include "support/mesh_properties.h"

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

}  // namespace

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
        Case{"f 0 1 2\n", "line 4: vertex index 0"}, Case{"f 1/7 2/7 3/7\n", "line 4: texture coordinate index 7"},
        Case{"f 1//2 2//2 3//2\n", "line 4: normal index 2"}, Case{"f 1 2 x\n", "line 4: 'x' is not a corner"},
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

TEST_CASE("obj: faces may stand before their vertices") {
  CHECK(read("f 1 2 3\n" + kTriangle, "obj").mesh.face_count() == 1);
}

TEST_CASE("obj: what is left out is noted") {
  const MeshFile file = read(kTriangle + "f 1 2 3\nf 1 2\nl 1 2\np 3\nsurf 0 1 0 1 1 2 3\n", "obj");
  CHECK_THAT(all_notes(file), contains("1 face statements") && contains("2 point and line") && contains("1 free-form"));
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
  CHECK(mesh.attributes[1].type == ComponentType::UInt8);
  CHECK(mesh.attributes[1].normalized);
  CHECK(mesh.attributes[1].data.size() == 9);
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

TEST_CASE("other formats go through assimp, unknown ones are named") {
  const MeshFile file = read("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n", "off");
  CHECK(file.mesh.face_count() == 2);
  CHECK(file.mesh.vertex_count() == 4);
  const Error error = failure("x", "nonsense");
  CHECK(error.code == ErrorCode::Unsupported);
  CHECK_THAT(error.message, contains("'nonsense'"));
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
