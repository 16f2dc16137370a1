#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>
#include <lodestone/core/progress.h>
#include <lodestone/core/removal.h>

#include "distance/level_deviation.h"
#include "distance/round_up.h"

namespace lodestone::detail {

/// Bounds the two-sided distance between the full mesh and the mesh after each removal.
///
/// From time to time the mesh is measured. In between, each removal adds an upper bound of how far it moves the surface
/// it replaces; the triangle inequality bounds the rest, for the points at each face by themselves.
class DeviationBounds {
 public:
  /// Measures whenever a share `step` of the faces has gone since the last time; never where it is 0.
  DeviationBounds(const Mesh& full, double step, const Progress& progress);

  /// Writes how far each record of a removal, just done, moves the surface at most. Changes nothing here, so that it
  /// may be called from several threads.
  void displacements(std::span<const RemovalRecord> copies, std::vector<double>& displacement) const;
  /// Accounts for the removal of a vertex and its copies, with what `displacements` found for it.
  void add(std::span<const RemovalRecord> copies, std::span<const double> displacement);
  /// Accounts for a piece that has vanished: all of it lies within `reach` of `face`, which is one of the faces left.
  void add_vanished(std::span<const RemovalRecord> records, Index face, double reach);
  /// Accounts for the last piece: nothing is left to measure a distance to, so the bound is the mesh's diagonal.
  void add_last() { last_ = bounding_box(*full_).diagonal(); }
  /// Gives the next vertex of the vanished pieces the bound that all of them together have.
  void repeat() { bound_.push_back(round_up(bound())); }
  /// Ends a round: measures the mesh where enough has changed since the last time.
  void end_round(const Connectivity& current);
  /// The bound after the last removal, mesh units.
  double current() const { return bound_.empty() ? 0 : static_cast<double>(bound_.back()); }
  /// Frees what only further removals would need.
  void stop_measuring() {
    level_.reset();
    moved_ = FaceReach(0);
  }
  /// One bound for each removal, in order.
  const std::vector<float>& bounds() const { return bound_; }

 private:
  double bound() const;
  const Mesh* full_;
  double step_;
  std::optional<LevelDeviation> level_;  // where it measures at all; else
  FaceReach moved_;                      // how far the full mesh's points are from where they were
  FaceChanges last_change_;
  std::size_t measured_faces_;
  bool vanished_ = false;  // whether a piece has since it was measured
  double last_ = 0;        // > 0 once nothing is left
  std::vector<float> bound_;
};

}  // namespace lodestone::detail
