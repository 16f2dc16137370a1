#include "pipeline/error_leap.h"

#include <algorithm>

namespace lodestone::detail {
namespace {

constexpr double kLeap = 8;    // of smooth surfaces the error doubles with half of the faces, of lines four times
constexpr double kBurden = 4;  // that is a quarter of the faces and less
constexpr double kOrdinaryError = 0.02;  // of the mesh's diagonal
constexpr double kNoticeable = 0.01;     // of the scene's

/// The largest error that is no leap, where the finer level has an error of its own.
double largest_without_leap(double finer_error, const LeapScale& scale) {
  return std::max(kLeap * std::max(finer_error, kOrdinaryError * scale.mesh), kNoticeable * scale.scene);
}

}  // namespace

bool is_leap(double error, Index position, std::span<const Index> face_counts, std::span<const double> errors,
             const LeapScale& scale) {
  std::size_t finer = position;  // the finest with at most twice the faces
  while (finer + 1 < face_counts.size() && face_counts[finer + 1] <= 2 * face_counts[position]) ++finer;
  return error > largest_without_leap(errors[finer], scale);
}

Index position_before_leap(const ProgressiveMesh& mesh, std::span<const Index> face_counts,
                           std::span<const double> errors, const LeapScale& scale) {
  auto position = static_cast<Index>(errors.size() - 1);
  std::size_t finer = position;  // the finest with at most twice the faces
  for (; position > 0; --position) {
    const double next = errors[position - 1];
    while (face_counts[finer] > 2 * face_counts[position - 1]) --finer;
    if (next > largest_without_leap(errors[finer], scale)) break;
  }
  while (!is_whole(mesh, position)) ++position;
  return position;
}

bool is_burdened(double error, double error_alone, const LeapScale& scale) {
  return error > kBurden * error_alone && error > kNoticeable * scale.scene;
}

}  // namespace lodestone::detail
