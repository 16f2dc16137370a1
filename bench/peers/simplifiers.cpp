#include "simplifier.h"

namespace lodestone::bench {

std::vector<Simplifier> simplifiers(int effort) {
  const auto with_effort = [effort](auto* run) {
    return [effort, run](const Mesh& mesh, std::span<const std::size_t> face_counts) {
      return run(mesh, face_counts, effort);
    };
  };
  return {
      {"levels", "lodestone, levels", false, with_effort(run_lodestone_levels), true},
      {"stream", "lodestone, stream", true, with_effort(run_lodestone_stream), true},
      {"lt-end", "Lindstrom–Turk's cost, end points (CGAL, not stock)", true, run_cgal_lindstrom_turk_end_points},
      {"meshopt", "meshoptimizer", true, run_meshoptimizer},
#ifdef LODESTONE_BENCH_OPENMESH
      {"openmesh", "OpenMesh, quadrics", true, run_openmesh},
#endif
#ifdef LODESTONE_BENCH_VTK
      {"vtk-pro", "VTK, DecimatePro", true, run_vtk_decimate_pro},
#endif
      {"lt", "CGAL Lindstrom–Turk", false, run_cgal_lindstrom_turk},
#ifdef LODESTONE_BENCH_EIGEN
      {"gh", "CGAL Garland–Heckbert", false, run_cgal_garland_heckbert},
#endif
#ifdef LODESTONE_BENCH_VTK
      {"vtk", "VTK, quadrics", false, run_vtk_quadrics},
#endif
  };
}

std::vector<std::string> missing_simplifiers() {
  std::vector<std::string> missing;
#ifndef LODESTONE_BENCH_OPENMESH
  missing.emplace_back("OpenMesh (libopenmesh-dev)");
#endif
#ifndef LODESTONE_BENCH_EIGEN
  missing.emplace_back("CGAL Garland–Heckbert (libeigen3-dev)");
#endif
#ifndef LODESTONE_BENCH_VTK
  missing.emplace_back("VTK (libvtk9-dev, or ./run quality --with-vtk)");
#endif
  return missing;
}

}  // namespace lodestone::bench
