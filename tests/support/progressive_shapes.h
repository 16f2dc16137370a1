#pragma once

#include <utility>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/lod/simplify.h>

#include "support/shapes.h"

namespace lodestone::test {

/// All families of shapes that have faces, as progressive meshes down to nothing.
inline std::vector<ProgressiveMesh> progressive_shapes() {
  std::vector<ProgressiveMesh> meshes;
  SimplifyOptions options;
  options.measure_step = 0;
  options.vanish = true;
  for (const NamedShape& shape : all_shapes()) {
    const auto assembled = assemble(shape.soup);
    if (assembled && assembled->mesh.face_count() > 0)
      meshes.push_back(std::move(simplify(assembled->mesh, options).value().mesh));
  }
  return meshes;
}

}  // namespace lodestone::test
