#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>
#include <lodestone/io/asset.h>

#include "gltf/draco_decode.h"
#include "gltf/draco_encode.h"
#include "gltf/glb_builder.h"
#include "gltf/gltf_mesh_writer.h"
#include "scene/scene_impl.h"

namespace lodestone::detail {

/// A level of a mesh, with the attributes its primitives are made of.
struct LevelGeometry {
  const Mesh* mesh = nullptr;
  std::vector<const Attribute*> columns;                     ///< one for each of the source's columns
  std::map<std::size_t, std::unique_ptr<Attribute>> mended;  ///< columns that are no longer the mesh's own
  std::vector<std::unique_ptr<Attribute>> changed;           ///< others that are neither
  std::unique_ptr<Mesh> own_mesh;                            ///< where it is not the one given

  void replace_column(std::size_t column, Attribute attribute);
  void replace_mesh(std::unique_ptr<Mesh> other);
};

/// Finds the source's columns in a level; floats stand for the normalized integers of a column that was packed when
/// the file was written. Errors: InvalidArgument where one is missing or the materials are no
/// primitives of the source.
Result<LevelGeometry> match_level(const Mesh& mesh, const MeshSource& source);

/// Returns the attributes that a primitive has in a level, in the order of its columns.
std::vector<const Attribute*> attributes_of(const LevelGeometry& level, const SourcePrimitive& primitive);

/// The primitives of a level in the document, and what a client will get out of them.
struct WrittenLevel {
  Json primitives = Json::array();   ///< kept ones included; empty for a level that shows nothing
  std::vector<std::size_t> sources;  ///< which primitive of the document's mesh each of them was
  std::uint64_t face_count = 0;
  std::uint64_t vertex_count = 0;
  std::uint64_t byte_count = 0;            ///< of its geometry
  std::uint64_t collapsed_face_count = 0;  ///< two of whose corners the grid has put at one place
  Mesh decoded;                    ///< as clients get it, with the source's columns; only where `measure` will see it
  std::vector<std::string> notes;  ///< what is stored otherwise than asked for, one sentence each
};

/// Draco data, and what it decodes to.
struct DracoOutput {
  DracoPrimitive encoded;
  DracoGeometry decoded;
};

/// A level's faces by material, as they are written.
struct EncodedLevel {
  std::vector<FacesOfMaterial> groups;
  std::vector<Result<DracoOutput>> outputs;  ///< one for each; empty without Draco
};

/// Writes a level's geometry, with meshopt rounded to `grids`, and describes it by `source_mesh`, the mesh's object in
/// the document: primitives keep their material, extensions and extras, those that are not replaced all they have.
Result<WrittenLevel> write_level(GlbBuilder& builder, const Json& source_mesh, const MeshSource& source,
                                 const LevelGeometry& level, const QuantizationGrids& grids,
                                 const EncodedLevel& encoded, const AssetOptions& options);

}  // namespace lodestone::detail
