// Formats without a reader of their own, through Assimp. Its joining of vertices is not used: `assemble` joins exactly.

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <exception>
#include <memory>

#include "soup_file.h"
#include "text.h"
#include "transform.h"
#include "try.h"

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

class SoupBuilder {
 public:
  explicit SoupBuilder(const std::vector<Instance>& instances) {
    for (const Instance& instance : instances) {
      with_normals_ &= instance.mesh->HasNormals();
      with_texcoords_ &= instance.mesh->HasTextureCoords(0);
      with_colors_ &= instance.mesh->HasVertexColors(0);
    }
  }

  Result<void> add(const Instance& instance) {
    const aiMesh& mesh = *instance.mesh;
    const std::size_t first = soup_.positions.size();
    if (first + mesh.mNumVertices >= kNoIndex) return fail(ErrorCode::LimitExceeded, "too many vertices");
    for (unsigned i = 0; i < mesh.mNumVertices; ++i) add_point(mesh, i, instance.world);
    const bool mirrored = instance.world.mirrors();
    for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
      const aiFace& face = mesh.mFaces[f];
      if (face.mNumIndices < 3) ++short_faces_;
      for (unsigned k = 1; k + 1 < face.mNumIndices; ++k)
        LODESTONE_CHECK(
            add_triangle(mesh, first, face.mIndices[0], face.mIndices[k + mirrored], face.mIndices[k + !mirrored]));
    }
    return {};
  }

  SoupFile finish() {
    if (with_normals_) soup_.attributes.push_back(float_attribute("NORMAL", 3, normals_));
    if (with_texcoords_) soup_.attributes.push_back(float_attribute("TEXCOORD_0", 2, texcoords_));
    if (with_colors_) soup_.attributes.push_back(float_attribute("COLOR_0", 4, colors_));
    SoupFile file{std::move(soup_), {}};
    if (short_faces_ > 0) file.notes.push_back(text(short_faces_, " point and line elements are left out"));
    return file;
  }

 private:
  void add_point(const aiMesh& mesh, unsigned i, const Transform& world) {
    const aiVector3D& p = mesh.mVertices[i];
    soup_.positions.push_back(world.point({p.x, p.y, p.z}));
    if (with_normals_) {
      const Vec3f n = world.normal({mesh.mNormals[i].x, mesh.mNormals[i].y, mesh.mNormals[i].z});
      normals_.insert(normals_.end(), {n.x, n.y, n.z});
    }
    if (with_texcoords_) {
      const aiVector3D& t = mesh.mTextureCoords[0][i];
      texcoords_.insert(texcoords_.end(), {t.x, 1 - t.y});  // Assimp's v points up, that of TEXCOORD_0 down.
    }
    if (with_colors_) {
      const aiColor4D& c = mesh.mColors[0][i];
      colors_.insert(colors_.end(), {c.r, c.g, c.b, c.a});
    }
  }

  Result<void> add_triangle(const aiMesh& mesh, std::size_t first, unsigned a, unsigned b, unsigned c) {
    for (const unsigned index : {a, b, c}) {
      if (index >= mesh.mNumVertices)
        return fail(ErrorCode::Malformed,
                    text("vertex index ", index, " is out of range: there are ", mesh.mNumVertices));
      soup_.indices.push_back(static_cast<Index>(first + index));
    }
    soup_.face_material.push_back(mesh.mMaterialIndex + 1);
    return {};
  }

  TriangleSoup soup_;
  std::vector<float> normals_, texcoords_, colors_;
  bool with_normals_ = true, with_texcoords_ = true, with_colors_ = true;
  std::size_t short_faces_ = 0;
};

/// Imports without any post-processing. What Assimp throws past its own handlers (bad_alloc) is caught here.
Result<const aiScene*> import(Assimp::Importer& importer, std::span<const std::byte> bytes, const std::string& hint) {
  if (hint.empty() || !importer.IsExtensionSupported(hint))
    return fail(ErrorCode::Unsupported, text("files with the extension '", hint, "' are not supported"));
  try {
    const aiScene* scene = importer.ReadFileFromMemory(bytes.data(), bytes.size(), 0, hint.c_str());
    if (scene != nullptr && scene->mRootNode != nullptr) return scene;
    return fail(ErrorCode::Malformed, text(hint, ": ", importer.GetErrorString()));
  } catch (const std::exception& error) {
    return fail(ErrorCode::Malformed, text(hint, ": ", error.what()));
  }
}

}  // namespace

Result<SoupFile> read_with_assimp(std::span<const std::byte> bytes, const std::string& extension) {
  Assimp::Importer importer;
  LODESTONE_TRY(const aiScene* const scene, import(importer, bytes, extension));
  const std::vector<Instance> instances = collect_instances(*scene);
  SoupBuilder builder(instances);
  for (const Instance& instance : instances) LODESTONE_CHECK(builder.add(instance));
  return builder.finish();
}

}  // namespace lodestone::detail
