#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

#include "gltf/gltf_document.h"

namespace lodestone::detail {

/// The triangles of one primitive, with the points they use.
struct Primitive {
  std::vector<Vec3f> positions;
  std::vector<Attribute> attributes;  ///< see PrimitiveContent
  std::vector<Attribute> targets;     ///< morph targets, see PrimitiveContent
  std::vector<Index> indices;         ///< three per triangle, < positions.size()
  std::vector<Index> sheet;           ///< one per point or empty: points of one are alike in attributes that get lost
  Index material = 0;                 ///< the document's material + 1; 0: none
  std::size_t number = 0;             ///< its place among the mesh's primitives
};

/// How attributes are read. Morph targets are floats in any case, under names like "TARGET_0:POSITION".
enum class PrimitiveContent {
  Surface,  ///< NORMAL and TANGENT as floats, the others as the file stores them
  Whole,    ///< all as the file stores them
};

/// Returns what an accessor holds as an attribute. Directions are turned with a flattened scene and so have to be
/// floats; everything else is only moved.
Attribute to_attribute(const std::string& name, const AccessorData& data, PrimitiveContent content);

/// Returns a primitive's material in the document + 1; 0 for none. Errors: Malformed.
Result<Index> material_number(const Json& primitive, const GltfDocument& document, const std::string& where);

/// Returns the attribute that carries a morph target's member; the same for every writer and reader of scenes.
std::string target_attribute_name(std::size_t target, const std::string& semantic);

/// What primitives hold that is not read.
struct PrimitiveOmissions {
  std::size_t points_and_lines = 0;  ///< primitives
  std::size_t morph_targets = 0;     ///< of all primitives; they are read for the shape at rest
};

/// Reads primitives of a document; keeps decoded accessors while several primitives of a mesh share them. A file that
/// names one accessor again and again cannot have any amount of memory.
class PrimitiveReader {
 public:
  explicit PrimitiveReader(const GltfDocument& document, PrimitiveContent content = PrimitiveContent::Surface)
      : document_(document), content_(content) {}

  /// Reads the primitives of a mesh that have triangles. Strips and fans become triangles.
  Result<std::vector<Primitive>> read_mesh(std::size_t mesh);

  const PrimitiveOmissions& omissions() const { return omissions_; }

 private:
  Result<Primitive> read_plain(const Json& json, std::size_t mode, const std::string& where);
  Result<Primitive> read_draco(const Json& json, const Json& extension, std::size_t mode, const std::string& where);
  Result<void> add_attribute(Primitive& primitive, const std::string& name, const AccessorData& data,
                             const std::string& where);
  Result<void> add_targets(Primitive& primitive, const Json& json, const std::string& where);
  Result<const AccessorData*> accessor(std::size_t index);
  Result<void> spend(std::size_t bytes, const std::string& where);

  const GltfDocument& document_;
  PrimitiveContent content_;
  std::map<std::size_t, AccessorData> accessors_;
  std::size_t bytes_ = 0;  // of the mesh's attributes and targets
  PrimitiveOmissions omissions_;
};

/// Returns the bufferViews a mesh's geometry lies in, each once, ascending.
Result<std::vector<std::size_t>> geometry_views(const GltfDocument& document, std::size_t mesh);

/// True if any primitive of the mesh is compressed with Draco.
bool uses_draco(const GltfDocument& document, std::size_t mesh);

}  // namespace lodestone::detail
