// Formats without a reader of their own, through Assimp. Its joining of vertices is not used: `assemble` joins exactly.
// Its importers allocate what files ask for, loop and crash on some: they work in a process of their own.

#include <algorithm>
#include <new>
#include <utility>

#include <assimp/material.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/files_beside.h"
#include "base/transform.h"
#include "mesh/child_process.h"
#include "mesh/image_file.h"
#include "mesh/polygon_soup.h"
#include "mesh/soup_file.h"
#include "mesh/soup_pack.h"
#include "mesh/vertex_color.h"

namespace lodestone::detail {
namespace {

Transform to_transform(const aiMatrix4x4& m) {
  return Transform{{{{m.a1, m.a2, m.a3, m.a4}, {m.b1, m.b2, m.b3, m.b4}, {m.c1, m.c2, m.c3, m.c4}}}};
}

struct Instance {
  const aiMesh* mesh;
  Transform world;
};

/// Lists the meshes of all nodes with their place in the world. A stack, not recursion: depth comes from the file.
std::vector<Instance> collect_instances(const aiScene& scene) {
  std::vector<Instance> instances;
  std::vector<std::pair<const aiNode*, Transform>> stack{{scene.mRootNode, Transform{}}};
  while (!stack.empty()) {
    const auto [node, parent] = stack.back();
    stack.pop_back();
    const Transform world = parent * to_transform(node->mTransformation);
    for (unsigned i = 0; i < node->mNumMeshes; ++i)
      if (node->mMeshes[i] < scene.mNumMeshes) instances.push_back({scene.mMeshes[node->mMeshes[i]], world});
    for (unsigned i = node->mNumChildren; i-- > 0;) stack.emplace_back(node->mChildren[i], world);
  }
  return instances;
}

/// Joins the meshes of all instances. An attribute that not all have is left out.
class SoupBuilder {
 public:
  explicit SoupBuilder(const std::vector<Instance>& instances) {
    for (const Instance& instance : instances) {
      see(instance.mesh->HasNormals(), "normals", with_normals_);
      see(instance.mesh->HasTextureCoords(0), "texture coordinates", with_texcoords_);
      see(instance.mesh->HasVertexColors(0), "colours", with_colors_);
    }
  }

  Result<void> add(const Instance& instance) {
    const aiMesh& mesh = *instance.mesh;
    const std::size_t first = polygons_.positions.size();
    if (first + mesh.mNumVertices >= kNoIndex) return fail(ErrorCode::LimitExceeded, "too many vertices");
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) add_point(mesh, i, instance.world);
    const bool mirrored = instance.world.mirrors();
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      for (unsigned k = 0; k < face.mNumIndices; ++k)
        LODESTONE_CHECK(add_corner(mesh, first, face.mIndices[mirrored ? face.mNumIndices - 1 - k : k]));
      polygons_.sizes.push_back(face.mNumIndices);
      polygons_.face_material.push_back(mesh.mMaterialIndex + 1);
    }
    return {};
  }

  Result<SoupFile> finish() {
    auto& attributes = polygons_.vertex_attributes;
    if (with_normals_.all) attributes.push_back(float_attribute("NORMAL", 3, normals_));
    if (with_texcoords_.all) attributes.push_back(float_attribute("TEXCOORD_0", 2, texcoords_));
    if (with_colors_.all) attributes.push_back(color_attribute(colors_, 4));
    SoupFile file;
    for (const Seen& seen : {with_normals_, with_texcoords_, with_colors_})
      if (seen.any && !seen.all)
        file.notes.push_back(text("the ", seen.name, " are left out, since not every mesh has them"));
    LODESTONE_TRY(file.soup, to_triangles(std::move(polygons_), file.notes));
    return file;
  }

 private:
  struct Seen {
    const char* name = "";
    bool any = false, all = true;
  };

  static void see(bool has, const char* name, Seen& seen) {
    seen.name = name;
    seen.any |= has;
    seen.all &= has;
  }

  void add_point(const aiMesh& mesh, unsigned i, const Transform& world) {
    const aiVector3D& p = mesh.mVertices[i];
    polygons_.positions.push_back(world.point({p.x, p.y, p.z}));
    if (with_normals_.all) {
      const Vec3f n = world.normal({mesh.mNormals[i].x, mesh.mNormals[i].y, mesh.mNormals[i].z});
      normals_.insert(normals_.end(), {n.x, n.y, n.z});
    }
    if (with_texcoords_.all) {
      const aiVector3D& t = mesh.mTextureCoords[0][i];
      texcoords_.insert(texcoords_.end(), {t.x, 1 - t.y});  // Assimp's v points up, that of TEXCOORD_0 down.
    }
    if (with_colors_.all) {
      const aiColor4D& c = mesh.mColors[0][i];
      colors_.insert(colors_.end(), {c.r, c.g, c.b, c.a});
    }
  }

  Result<void> add_corner(const aiMesh& mesh, std::size_t first, unsigned index) {
    if (index >= mesh.mNumVertices)
      return fail(ErrorCode::Malformed,
                  text("vertex index ", index, " is out of range: there are ", mesh.mNumVertices));
    polygons_.corners.push_back(static_cast<Index>(first + index));
    return {};
  }

  PolygonSoup polygons_;
  std::vector<float> normals_, texcoords_, colors_;
  Seen with_normals_, with_texcoords_, with_colors_;
};

/// Imports without any post-processing.
Result<const aiScene*> import(Assimp::Importer& importer, std::span<const std::byte> bytes, const std::string& hint) {
  const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, hint.c_str());
  if (scene != nullptr && scene->mRootNode != nullptr) return scene;
  const std::string_view message = importer.GetErrorString();
  if (message.find("bad_alloc") != message.npos) throw std::bad_alloc();  // Assimp catches it, too
  return fail(ErrorCode::Malformed, text(message));
}

void add_material(const aiMaterial& from, PackedSoup& soup) {
  Material material;
  aiString name, texture;
  if (from.Get(AI_MATKEY_NAME, name) == aiReturn_SUCCESS) material.name = name.C_Str();
  aiColor3D color(1, 1, 1), emissive(0, 0, 0);
  float opacity = 1;
  from.Get(AI_MATKEY_COLOR_DIFFUSE, color);
  from.Get(AI_MATKEY_COLOR_EMISSIVE, emissive);
  from.Get(AI_MATKEY_OPACITY, opacity);
  const auto share = [](float value) { return value > 0 ? std::min(value, 1.0F) : 0; };
  material.base_color = {share(color.r), share(color.g), share(color.b), share(opacity)};
  material.emissive = {share(emissive.r), share(emissive.g), share(emissive.b)};
  material.translucent = material.base_color[3] < 1;
  from.GetTexture(aiTextureType_DIFFUSE, 0, &texture);
  soup.file.materials.push_back(std::move(material));
  soup.textures.emplace_back(texture.C_Str());
}

Result<std::vector<std::byte>> import_packed(std::span<const std::byte> bytes, const std::string& extension) {
  Assimp::Importer importer;
  LODESTONE_TRY(const aiScene* const scene, import(importer, bytes, extension));
  const std::vector<Instance> instances = collect_instances(*scene);
  SoupBuilder builder(instances);
  for (const Instance& instance : instances) LODESTONE_CHECK(builder.add(instance));
  PackedSoup soup;
  LODESTONE_TRY(soup.file, builder.finish());
  for (unsigned i = 0; i < scene->mNumMaterials; ++i) add_material(*scene->mMaterials[i], soup);
  return pack(soup);
}

/// In proportion to the file: Assimp's own data are some tens of times as large as a text.
ChildLimits limits_for(std::size_t file_bytes) {
  ChildLimits limits;
  limits.processor_time += std::chrono::seconds(file_bytes / (std::size_t{1} << 20));
  limits.memory_bytes += 100 * file_bytes;
  return limits;
}

}  // namespace

Result<SoupFile> read_with_assimp(std::span<const std::byte> bytes, const std::string& extension,
                                  const FileFetcher& fetch) {
  if (extension.empty() || !Assimp::Importer().IsExtensionSupported(extension))
    return fail(ErrorCode::Unsupported, text("files with the extension '", extension, "' are not supported"));
  const auto packed = run_in_child([&] { return import_packed(bytes, extension); }, limits_for(bytes.size()));
  if (!packed) return fail(packed.error().code, text(extension, ": ", packed.error().message));
  LODESTONE_TRY(PackedSoup soup, unpack(*packed));
  SoupFile file = std::move(soup.file);
  ImageLoader images(fetch, file);
  for (std::size_t i = 0; i < std::min(file.materials.size(), soup.textures.size()); ++i)
    if (const auto image = images.load(soup.textures[i], ""))
      file.materials[i].base_color_texture = Texture{*image, {1, 1}, {0, 0}, false};
  return file;
}

}  // namespace lodestone::detail
