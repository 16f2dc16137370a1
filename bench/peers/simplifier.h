#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>

#include "seconds.h"
#include "surface.h"

namespace lodestone::bench {

/// One result of a simplifier.
struct Level {
  Surface surface;
  Seconds seconds;  ///< of the simplification alone, from the mesh as the tool holds it
};

/// A row of the table: something that takes a mesh to face counts.
struct Simplifier {
  std::string key;   ///< short, for `--only`
  std::string name;  ///< for people
  bool subset;       ///< vertices stay where they were
  /// Returns one level for each of `face_counts`, which descend; a level may miss its count.
  /// Pre: `mesh` comes from `assemble` and has no attributes.
  std::function<std::vector<Level>(const Mesh& mesh, std::span<const std::size_t> face_counts)> run;
  bool has_effort = false;  ///< whether it is one of lodestone's
};

/// Returns every simplifier this build has; `effort` is lodestone's. The one place where a new one is added to the
/// table.
std::vector<Simplifier> simplifiers(int effort);

/// Returns the names of those that were not found when the build was configured.
std::vector<std::string> missing_simplifiers();

std::vector<Level> run_lodestone_levels(const Mesh& mesh, std::span<const std::size_t> face_counts, int effort);
std::vector<Level> run_lodestone_stream(const Mesh& mesh, std::span<const std::size_t> face_counts, int effort);
std::vector<Level> run_cgal_lindstrom_turk(const Mesh& mesh, std::span<const std::size_t> face_counts);
std::vector<Level> run_cgal_lindstrom_turk_end_points(const Mesh& mesh, std::span<const std::size_t> face_counts);
std::vector<Level> run_cgal_garland_heckbert(const Mesh& mesh, std::span<const std::size_t> face_counts);
std::vector<Level> run_openmesh(const Mesh& mesh, std::span<const std::size_t> face_counts);
std::vector<Level> run_meshoptimizer(const Mesh& mesh, std::span<const std::size_t> face_counts);
std::vector<Level> run_vtk_quadrics(const Mesh& mesh, std::span<const std::size_t> face_counts);
std::vector<Level> run_vtk_decimate_pro(const Mesh& mesh, std::span<const std::size_t> face_counts);

}  // namespace lodestone::bench
