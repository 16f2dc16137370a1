#include <vtkCellArray.h>
#include <vtkDecimatePro.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkQuadricDecimation.h>

#include "simplifier.h"

namespace lodestone::bench {
namespace {

vtkNew<vtkPolyData> to_vtk(const Mesh& mesh) {
  const vtkNew<vtkPoints> points;
  for (const Vec3f& p : mesh.positions) points->InsertNextPoint(p.x, p.y, p.z);
  const vtkNew<vtkCellArray> faces;
  for (const auto& face : surface_of(mesh).faces) faces->InsertNextCell({face[0], face[1], face[2]});
  vtkNew<vtkPolyData> result;
  result->SetPoints(points);
  result->SetPolys(faces);
  return result;
}

Surface from_vtk(vtkPolyData& mesh) {
  Surface surface;
  for (vtkIdType i = 0; i < mesh.GetNumberOfPoints(); ++i) {
    const double* p = mesh.GetPoint(i);
    surface.points.emplace_back(p[0], p[1], p[2]);
  }
  const vtkNew<vtkIdList> face;
  const auto corner = [&](int i) { return static_cast<Index>(face->GetId(i)); };
  for (vtkIdType i = 0; i < mesh.GetNumberOfPolys(); ++i) {
    mesh.GetPolys()->GetCellAtId(i, face);
    surface.faces.push_back({corner(0), corner(1), corner(2)});
  }
  return surface;
}

/// Runs a filter once for each count, from the full mesh.
template <class Filter>
std::vector<Level> reduce(Filter& filter, const Mesh& mesh, std::span<const std::size_t> face_counts) {
  const vtkNew<vtkPolyData> full = to_vtk(mesh);
  filter.SetInputData(full);
  std::vector<Level> levels;
  for (const std::size_t faces : face_counts) {
    filter.SetTargetReduction(1 - static_cast<double>(faces) / static_cast<double>(mesh.face_count()));
    const Clock clock;
    filter.Update();
    const Seconds seconds = clock.seconds();
    levels.push_back({from_vtk(*filter.GetOutput()), seconds});
  }
  return levels;
}

}  // namespace

std::vector<Level> run_vtk_quadrics(const Mesh& mesh, std::span<const std::size_t> face_counts) {
  const vtkNew<vtkQuadricDecimation> filter;
  // VTK 9.1 heeds it only beside AttributeErrorMetric, and with both fandisk stops at 1,537 faces, with spikes.
  filter->VolumePreservationOn();
  return reduce(*filter, mesh, face_counts);
}

std::vector<Level> run_vtk_decimate_pro(const Mesh& mesh, std::span<const std::size_t> face_counts) {
  const vtkNew<vtkDecimatePro> filter;
  // By default it cuts the surface open along what it takes for features.
  filter->PreserveTopologyOn();
  // In one piece and at the default of 15° it stops at a tenth of bunny; of 30, 45, 60, 75 and 180° this is best.
  filter->SetFeatureAngle(60);
  return reduce(*filter, mesh, face_counts);
}

}  // namespace lodestone::bench
