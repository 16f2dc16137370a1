// What read_mesh and Scene make of the materials, textures and colours of OBJ, PLY, STL and OFF.

#include <lodestone/io/material.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <string>
#include <vector>

#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>
#include <lodestone/io/write_mesh.h>

#include "support/data.h"
#include "support/gltf_file.h"

namespace lodestone::test {
namespace {

using Floats = std::vector<float>;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
const std::string kFace = "f 1/1 2/2 3/3 4/4\n";

/// The first bytes of a PNG of one color type, and something to tell one from another.
std::string png(const std::string& mark, char color_type = 2) {
  std::string bytes("\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\1\0\0\0\1\10", 25);
  return bytes + color_type + mark;
}

/// A folder of files to read as a mesh and as a scene.
struct Folder {
  ScratchDirectory scratch;

  void write(const std::string& name, const std::string& bytes) const {
    std::filesystem::create_directories((scratch / name).parent_path());
    std::ofstream(scratch / name, std::ios::binary) << bytes;
  }
  MeshFile read(const std::string& name) const { return read_mesh(scratch / name).value(); }

  /// Returns the file as a .glb of one level.
  GltfFile glb(const std::string& name) const {
    const Scene scene = Scene::read(scratch / name).value();
    std::vector<LeveledMesh> levels(scene.meshes().size());
    for (std::size_t i = 0; i < levels.size(); ++i)
      levels[i].levels.resize(1), levels[i].levels[0].mesh = scene.meshes()[i].mesh;
    AssetOptions options;
    options.compression = Compression::None;
    return GltfFile::from_glb(encode_scene_level(scene, levels, 0, options).value().glb);
  }
};

/// Reads one material of a library that stands beside a square.
Material material_of(const std::string& statements) {
  const Folder folder;
  folder.write("a.mtl", "newmtl m\n" + statements);
  folder.write("t.png", png("t"));
  folder.write("grey.png", png("g", 0));
  folder.write("u.png", png("u"));
  folder.write("a.obj", "mtllib a.mtl\n" + kSquare + "usemtl m\n" + kFace);
  return folder.read("a.obj").materials.at(0);
}

std::string text_of(const std::vector<std::byte>& bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::string all_notes(const std::vector<std::string>& notes) {
  std::string all;
  for (const std::string& note : notes) all += note + '\n';
  return all;
}

MeshFile read(const std::string& source, const char* extension) {
  return read_mesh_bytes(std::as_bytes(std::span(source)), extension).value();
}

const Attribute& colors_of(const Mesh& mesh) {
  const auto found = std::find_if(mesh.attributes.begin(), mesh.attributes.end(),
                                  [](const Attribute& a) { return a.name == "COLOR_0"; });
  REQUIRE(found != mesh.attributes.end());
  return *found;
}

/// The colour of one corner.
Floats color_at(const Mesh& mesh, Index corner) {
  const Attribute& attribute = colors_of(mesh);
  const Floats values = attribute_values(attribute);
  const auto first = values.begin() + mesh.corner_wedge[corner] * attribute.component_count;
  return {first, first + attribute.component_count};
}

float linear(double srgb) {
  return static_cast<float>(srgb <= 0.04045 ? srgb / 12.92 : std::pow((srgb + 0.055) / 1.055, 2.4));
}

void check_color(const Floats& color, const Floats& expected) {
  REQUIRE(color.size() == expected.size());
  for (std::size_t i = 0; i < color.size(); ++i) CHECK(color[i] == Approx(expected[i]).margin(1e-5));
}

std::string ply_square(const std::string& vertex_properties, const std::string& face_properties,
                       const std::string& body, const std::string& comments = "") {
  return "ply\nformat ascii 1.0\n" + comments +
         "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n" + vertex_properties +
         "element face 2\nproperty list uchar int vertex_indices\n" + face_properties + "end_header\n" + body;
}

/// A text with a colour in place of each @.
std::string coloured(const std::string& text, const std::string& color) {
  std::string result;
  for (const char c : text) {
    if (c == '@')
      result += color;
    else
      result += c;
  }
  return result;
}

}  // namespace

TEST_CASE("obj: materials come by name, with their numbers and images, byte for byte") {
  const Folder folder;
  folder.write("my lib.mtl",
               "# c\n\nnewmtl my red\n\tKd 1 0 0 # comment\nd 0.5\nnewmtl unused\nmap_Kd gone.png\n"
               "newmtl tex#1\r\nKd 0.8 0.8 0.8\r\nmap_Kd -s 2 2 my image.png\r\n");
  folder.write("my image.png", png("image"));
  folder.write("a.obj",
               "mtllib my lib.mtl\n" + kSquare + "usemtl my red\nf 1/1 2/2 3/3\nusemtl tex#1\nf 1/1 3/3 4/4\n");
  const MeshFile file = folder.read("a.obj");
  CHECK(file.notes.empty());
  CHECK(file.mesh.face_material == std::vector<Index>{1, 2});
  REQUIRE(file.materials.size() == 2);
  CHECK(file.materials[0].name == "my red");
  CHECK(file.materials[0].base_color == std::array<float, 4>{1, 0, 0, 0.5F});
  CHECK(file.materials[0].translucent);
  CHECK(file.materials[1].name == "tex#1");
  REQUIRE(file.materials[1].base_color_texture);
  CHECK(file.materials[1].base_color_texture->scale == std::array<float, 2>{2, 2});

  const GltfFile glb = folder.glb("a.obj");
  CHECK(glb.json["materials"][0]["name"] == "my red");
  CHECK(glb.json["materials"][0]["alphaMode"] == "BLEND");
  CHECK(glb.json["materials"][0]["pbrMetallicRoughness"]["baseColorFactor"] == GltfJson({1, 0, 0, 0.5}));
  CHECK_FALSE(glb.json["materials"][1].contains("alphaMode"));
  const GltfJson& info = glb.json["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"];
  CHECK(info["extensions"]["KHR_texture_transform"]["offset"] == GltfJson({0, -1}));
  CHECK(glb.json["textures"][info["index"].get<std::size_t>()]["source"] == 0);
  CHECK(glb.json["images"][0]["mimeType"] == "image/png");
  CHECK(text_of(glb.image_bytes(0)) == png("image"));
  CHECK_THAT(glb.json["extensionsUsed"].dump(), contains("KHR_texture_transform"));
  CHECK(glb.json["meshes"][0]["primitives"][1]["material"] == 1);
}

TEST_CASE("obj: several libraries, paths of other systems, names in another case") {
  const Folder folder;
  folder.write("a.mtl", "newmtl a\nmap_Kd maps\\A.PNG\n");
  folder.write("sub/b.mtl", "newmtl b\nmap_Kd b.png\nnewmtl c\nmap_Kd C:\\work\\c.png\n");
  folder.write("Maps/a.png", png("a"));
  folder.write("sub/b.png", png("b"));
  folder.write("c.png", png("c"));
  folder.write("x.obj", "mtllib a.mtl sub/b.mtl\n" + kSquare + "usemtl a\n" + kFace + "usemtl b\n" + kFace +
                            "usemtl c\n" + kFace);
  const MeshFile file = folder.read("x.obj");
  CHECK(all_notes(file.notes) == "");
  REQUIRE(file.images.size() == 3);
  CHECK(text_of(file.images[0].bytes) == png("a"));
  CHECK(text_of(file.images[1].bytes) == png("b"));
  CHECK(text_of(file.images[2].bytes) == png("c"));
}

TEST_CASE("obj: what is missing or has no place is named, once") {
  const Folder folder;
  folder.write(
      "a.mtl",
      "newmtl m\nmap_Kd gone.png\nmap_Ke gone.png\nmap_Ks s.png\nTf 1 1 1\nPc 0\nmap_Bump old.tga\nKa 1 1 1\nNi 1.5\n");
  folder.write("old.tga", "not an image");
  folder.write("x.obj", "mtllib a.mtl\nmtllib lost.mtl\n" + kSquare + "usemtl m\n" + kFace + "usemtl nobody\n" + kFace);
  const MeshFile file = folder.read("x.obj");
  const std::string notes = all_notes(file.notes);
  CHECK_THAT(notes, contains("texture 'gone.png' is left out") &&
                        contains("texture 'old.tga' is left out: it is neither") &&
                        contains("material library 'lost.mtl' is left out") && contains("plain: 'nobody'") &&
                        contains("left out: map_Ks\n"));
  CHECK(std::count(notes.begin(), notes.end(), '\n') == 5);
  CHECK(folder.glb("x.obj").json["materials"][1]["name"] == "nobody");

  folder.write("up.mtl", "newmtl m\nmap_Kd ../secret.png\n");
  folder.write("y.obj", "mtllib up.mtl\n" + kSquare + "usemtl m\n" + kFace);
  CHECK_THAT(all_notes(folder.read("y.obj").notes), contains("not beside or below"));
}

TEST_CASE("mtl: bumps in colour are normals, and that is said, while grey ones are heights, which are left out") {
  const Folder folder;
  folder.write("normals.png", png("n"));
  folder.write("heights.png", png("h", 0));
  folder.write("a.mtl", "newmtl m\nbump normals.png\nnewmtl h\nmap_bump heights.png\n");
  folder.write("a.obj", "mtllib a.mtl\n" + kSquare + "usemtl m\n" + kFace + "usemtl h\n" + kFace);
  const MeshFile file = folder.read("a.obj");
  CHECK(file.materials.at(0).normal_texture);
  CHECK_FALSE(file.materials.at(1).normal_texture);
  CHECK_THAT(all_notes(file.notes),
             contains("taken for maps of normals: normals.png") && contains("left out: map_bump"));
  CHECK(folder.glb("a.obj").json["images"].size() == 1);
}

TEST_CASE("mtl: statements in glTF's model") {
  CHECK(material_of("Ns 0\n").roughness == Approx(1));
  CHECK(material_of("Ns 1000\nKs 1 1 1\n").roughness == Approx(0.2113).margin(1e-3));
  CHECK(material_of("Ns 1000\nKs 0 0 0\n").roughness == 1);
  CHECK(material_of("Ns 10\nPr 0.25\nPm 1\n").roughness == 0.25F);
  CHECK(material_of("Pm 1\n").metallic == 1);
  CHECK(material_of("Tr 0.25\n").base_color[3] == 0.75F);
  CHECK(material_of("d 1\nTr 1\n").base_color[3] == 1);
  CHECK(material_of("d -halo 0.5\n").base_color[3] == 0.5F);
  CHECK(material_of("Kd 0.25\n").base_color == std::array<float, 4>{0.25F, 0.25F, 0.25F, 1});
  CHECK(material_of("Kd 0 0 0\nmap_Kd t.png\n").base_color == std::array<float, 4>{1, 1, 1, 1});
  CHECK(material_of("Ke 2 1 0\n").emissive == std::array<float, 3>{2, 1, 0});
  CHECK(material_of("map_Ke t.png\n").emissive == std::array<float, 3>{1, 1, 1});
  CHECK(material_of("map_Bump -bm 0.5 t.png\n").normal_scale == 0.5F);
  CHECK(material_of("bump t.png -bm 0.5\n").normal_scale == 0.5F);
  CHECK(material_of("norm t.png\n").normal_texture);
  CHECK_FALSE(material_of("map_Bump grey.png\n").normal_texture);  // heights
  CHECK(material_of("map_Kd -clamp on t.png\n").base_color_texture->clamp);
  CHECK(material_of("map_Kd t.png\nmap_d t.png\n").translucent);
  CHECK_FALSE(material_of("map_Kd t.png\nmap_d u.png\n").translucent);
  CHECK(material_of("map_Pr t.png\nmap_Pm t.png\n").metallic == 1);
  CHECK(material_of("map_Pr t.png\n").metallic_roughness_texture);
  CHECK_FALSE(material_of("map_Pr t.png\nmap_Pm u.png\n").metallic_roughness_texture);
  const Texture moved = *material_of("map_Kd -o 0.25 0.5 0 -s 2 4 1 -mm 0 1 t.png\n").base_color_texture;
  CHECK(moved.offset == std::array<float, 2>{0.25F, -3.5F});
  CHECK(moved.scale == std::array<float, 2>{2, 4});
}

TEST_CASE("emission beyond 1 has a strength") {
  const Folder folder;
  folder.write("a.mtl", "newmtl m\nKe 4 2 0\nmap_Kd -clamp on t.png\n");
  folder.write("t.png", png("t"));
  folder.write("a.obj", "mtllib a.mtl\n" + kSquare + "usemtl m\n" + kFace);
  const GltfFile glb = folder.glb("a.obj");
  CHECK(glb.json["materials"][0]["emissiveFactor"] == GltfJson({1, 0.5, 0}));
  CHECK(glb.json["materials"][0]["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"] == 4);
  CHECK(glb.json["samplers"][glb.json["textures"][0]["sampler"].get<std::size_t>()]["wrapS"] == 33071);
}

TEST_CASE("obj: colours of vertices, behind the coordinates or in ZBrush's comments") {
  const std::string faces = "f 1 2 3\n";
  for (const std::string& source : {"v 0 0 0 1 0.5 0\nv 1 0 0 0 0 1\nv 0 1 0 1 1 1\n" + faces,
                                    "v 0 0 0 255 127.5 0\nv 1 0 0 0 0 255\nv 0 1 0 255 255 255\n" + faces}) {
    const MeshFile file = read(source, "obj");
    CHECK(file.notes.empty());
    check_color(color_at(file.mesh, 0), {1, linear(0.5), 0});
    check_color(color_at(file.mesh, 1), {0, 0, 1});
  }
  const MeshFile painted = read("v 0 0 0\nv 1 0 0\nv 0 1 0\n#MRGB ffff8000ff0000ff\n#MRGB ffffffff\n" + faces, "obj");
  check_color(color_at(painted.mesh, 0), {1, linear(128 / 255.0), 0});
  check_color(color_at(painted.mesh, 1), {0, 0, 1});
  check_color(color_at(read("v 0 0 0 1 0 0 0.5\nv 1 0 0\nv 0 1 0 1 1 1\n" + faces, "obj").mesh, 0), {1, 0, 0, 0.5F});
  check_color(color_at(read("v 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0 1 1 1\n" + faces, "obj").mesh, 1), {1, 1, 1});
}

TEST_CASE("ply: colours under their common names, on vertices and on faces") {
  struct Case {
    std::string properties;
    std::string color;
    Floats expected;
  };
  for (const Case& c :
       {Case{"property uchar red\nproperty uchar green\nproperty uchar blue\n", " 255 51 0", {1, linear(0.2), 0}},
        Case{"property uchar r\nproperty uchar g\nproperty uchar b\n", " 255 51 0", {1, linear(0.2), 0}},
        Case{"property uchar diffuse_red\nproperty uchar diffuse_green\nproperty uchar diffuse_blue\n",
             " 255 51 0",
             {1, linear(0.2), 0}},
        Case{"property ushort red\nproperty ushort green\nproperty ushort blue\n",
             " 65535 13107 0",
             {1, linear(0.2), 0}},
        Case{"property float red\nproperty float green\nproperty float blue\n", " 1 0.2 0", {1, linear(0.2), 0}},
        Case{"property float red\nproperty float green\nproperty float blue\nproperty float alpha\n",
             " 1 0.2 0 0.5",
             {1, linear(0.2), 0, 0.5F}},
        Case{"property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n",
             " 255 51 0 51",
             {1, linear(0.2), 0, 0.2F}}}) {
    INFO(c.properties);
    check_color(color_at(read(ply_square(c.properties, "",
                                         coloured("0 0 0@\n1 0 0@\n1 1 0@\n0 1 0@\n3 0 1 2\n3 0 2 3\n", c.color)),
                              "ply")
                             .mesh,
                         0),
                c.expected);
    const MeshFile faces = read(
        ply_square("", c.properties, coloured("0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2@\n3 0 2 3@\n", c.color)), "ply");
    check_color(color_at(faces.mesh, 5), c.expected);
    CHECK(faces.mesh.wedge_count() == 4);
    CHECK(faces.notes.empty());
  }
}

TEST_CASE("ply: faces of two colours meet in a seam, and what has no place is named") {
  const std::string rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const MeshFile file = read(ply_square("property float confidence\n", rgb + "property float nx\n",
                                        "0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n3 0 1 2 255 0 0 1\n3 0 2 3 0 0 255 1\n"),
                             "ply");
  CHECK(file.mesh.vertex_count() == 4);
  CHECK(file.mesh.wedge_count() == 6);
  check_color(color_at(file.mesh, 0), {1, 0, 0});
  check_color(color_at(file.mesh, 3), {0, 0, 1});
  CHECK_THAT(all_notes(file.notes), contains("confidence of vertex, nx of face"));
}

TEST_CASE("ply: texture coordinates of faces, the textures that comments name") {
  const Folder folder;
  folder.write("one.png", png("1"));
  folder.write("two 2.png", png("2"));
  folder.write("a.ply", ply_square("", "property list uchar float texcoord\nproperty int texnumber\n",
                                   "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2 6 0 0 1 0 1 0.75 0\n3 0 2 3 6 0 0 1 1 0 1 1\n",
                                   "comment TextureFile one.png\ncomment TextureFile two 2.png\n"));
  const MeshFile file = folder.read("a.ply");
  CHECK(file.notes.empty());
  CHECK(file.mesh.face_material == std::vector<Index>{1, 2});
  REQUIRE(file.mesh.attributes.size() == 1);
  const Floats values = attribute_values(file.mesh.attributes[0]);
  CHECK(values[2 * file.mesh.corner_wedge[2] + 1] == 0.25F);  // v points down in glTF
  CHECK(values[2 * file.mesh.corner_wedge[4] + 1] == 0);
  CHECK(file.mesh.vertex_count() == 4);
  const GltfFile glb = folder.glb("a.ply");
  CHECK(text_of(glb.image_bytes(1)) == png("2"));
  CHECK(glb.json["materials"][1]["name"] == "two 2");
}

TEST_CASE("stl: colours of facets in both ways of writing them") {
  const auto stl = [](std::string header, std::uint16_t first, std::uint16_t second) {
    header.resize(80);
    const auto put = [&](auto value) { header.append(reinterpret_cast<const char*>(&value), sizeof value); };
    put(std::uint32_t{2});
    for (int i = 0; i < 2; ++i) {
      for (const float f : {0.F, 0.F, 1.F, 0.F, 0.F, 0.F, 1.F, 0.F, 0.F, 1.F, 1.F, static_cast<float>(i)}) put(f);
      put(i == 0 ? first : second);
    }
    return read(header, "stl");
  };
  const MeshFile viscam = stl("", 0x8000 | 31 << 10, 0x8000 | 31);
  check_color(color_at(viscam.mesh, 0), {1, 0, 0});
  check_color(color_at(viscam.mesh, 3), {0, 0, 1});
  const MeshFile magics = stl(std::string("COLOR=\0\xff\0\xff,MATERIAL=", 20), 31, 0x8000);
  check_color(color_at(magics.mesh, 0), {1, 0, 0});
  check_color(color_at(magics.mesh, 3), {0, 1, 0});
  check_color(color_at(stl(std::string("COLOR=\0\xff\0\x33", 10), 0, 0).mesh, 0), {0, 1, 0, 0.2F});
  const MeshFile other = stl("", 7, 9);
  CHECK(other.mesh.attributes.empty());
  CHECK_THAT(all_notes(other.notes), contains("attribute bytes of facets"));
  CHECK(stl("", 0, 0).notes.empty());
}

TEST_CASE("off: colours of vertices and faces, as bytes and as floats") {
  const std::string faces = "3 0 1 2\n";
  for (const char* color : {" 255 51 0", " 1.0 0.2 0"}) {
    const std::string vertices = coloured("\n3 1 0\n0 0 0@\n1 0 0@ # c\n0 1 0@\n", color);
    for (const char* keyword : {"COFF", "OFF"})
      check_color(color_at(read(std::string(keyword).append(vertices).append(faces), "off").mesh, 0),
                  {1, linear(0.2), 0});
    check_color(color_at(read(coloured("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2@\n", color), "off").mesh, 2),
                {1, linear(0.2), 0});
  }
  CHECK_THAT(all_notes(read("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 5\n", "off").notes), contains("colour map"));
  const MeshFile both = read("COFF\n3 1 0\n0 0 0 0 0 0 255\n1 0 0 0 0 0 255\n0 1 0 0 0 0 0\n3 0 1 2 1 0 0\n", "off");
  check_color(color_at(both.mesh, 2), {0, 0, 0, 0});
  CHECK_THAT(all_notes(both.notes), contains("colours of faces are left out"));
}

TEST_CASE("colours without a material get a plain one, that blends where they do") {
  const Folder folder;
  folder.write("a.off", "COFF\n3 1 0\n0 0 0 255 0 0 128\n1 0 0 255 0 0 255\n0 1 0 255 0 0 255\n3 0 1 2\n");
  const GltfFile glb = folder.glb("a.off");
  CHECK(glb.json["materials"][0]["alphaMode"] == "BLEND");
  CHECK(glb.json["materials"][0]["pbrMetallicRoughness"]["metallicFactor"] == 0);
  folder.write("b.off", "COFF\n3 1 0\n0 0 0 255 0 0 0\n1 0 0 255 0 0 0\n0 1 0 255 0 0 0\n3 0 1 2\n");
  CHECK_FALSE(folder.glb("b.off").json["materials"][0].contains("alphaMode"));
}

TEST_CASE("ply: all bytes of a colour survive the way there and back") {
  std::string body;
  for (int i = 0; i < 256; ++i)
    body += "1 " + std::to_string(i) + " 0 " + std::to_string(i) + " 0 " + std::to_string(255 - i) + "\n";
  for (int i = 0; i < 254; ++i)
    body += "3 " + std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + "\n";
  const Mesh mesh =
      read(
          "ply\nformat ascii 1.0\nelement vertex 256\nproperty float x\nproperty float y\nproperty float z\n"
          "property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 254\n"
          "property list uchar int vertex_indices\nend_header\n" +
              body,
          "ply")
          .mesh;
  const auto written = write_mesh_bytes(mesh, "x.ply").value();
  const Mesh again = read(text_of(written), "ply").mesh;
  CHECK(colors_of(again).data == colors_of(mesh).data);
}

TEST_CASE("assimp: names, colours and textures of materials arrive") {
  const Folder folder;
  folder.write("t.png", png("t"));
  folder.write(
      "a.ac",
      "AC3Db\nMATERIAL \"red\" rgb 1 0 0  amb 0 0 0  emis 0 0 0  spec 0 0 0  shi 0  trans 0.5\nOBJECT world\n"
      "kids 1\nOBJECT poly\nname \"p\"\ntexture \"t.png\"\nnumvert 3\n0 0 0\n1 0 0\n1 1 0\nnumsurf 1\nSURF 0x20\n"
      "mat 0\nrefs 3\n0 0 0\n1 1 0\n2 1 1\nkids 0\n");
  const MeshFile file = folder.read("a.ac");
  const Material& material = file.materials.at(file.mesh.face_material.empty() ? 0 : file.mesh.face_material[0] - 1);
  CHECK(material.name == "red");
  CHECK(material.base_color == std::array<float, 4>{1, 0, 0, 0.5F});
  CHECK(material.base_color_texture);
}

TEST_CASE("field: textures, colours and what is dropped") {
  LODESTONE_SKIP_WITHOUT_MODELS();
  if (const auto path = model("field/cube with material.obj")) {
    const MeshFile file = read_mesh(*path).value();
    REQUIRE(file.materials.size() == 2);
    CHECK(file.materials[0].name == "my red");
    REQUIRE(file.images.size() == 1);
    CHECK(file.images[0].bytes == read_file(path->parent_path() / "05tex.png").value());
  }
  for (const char* name : {"vertex-colours.obj", "coloured.stl", "mesh_with_colors.off"})
    if (const auto path = model(std::string("field/") + name)) colors_of(read_mesh(*path).value().mesh);
  if (const auto path = model("field/face-texcoords.ply")) {
    const MeshFile file = read_mesh(*path).value();
    CHECK(file.mesh.attributes.at(0).name == "TEXCOORD_0");
    CHECK(file.images.size() == 1);
  }
  if (const auto path = model("mesh/spider.obj"))
    CHECK_THAT(all_notes(read_mesh(*path).value().notes), contains("'spider.mtl'") && contains("'Augentex'"));
}

}  // namespace lodestone::test
