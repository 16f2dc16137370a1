#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>
#include <lodestone/core/parallel.h>
#include <lodestone/core/progress.h>
#include <lodestone/core/removal.h>

#include "distance/level_deviation.h"

namespace lodestone::detail {

/// Bounds the two-sided distance between the full mesh and the mesh after each removal.
///
/// From time to time the mesh is measured. In between, each removal adds an upper bound of how far it moves the surface
/// it replaces; the triangle inequality bounds the rest, for the points at each face by themselves. Removals go on
/// while another thread measures what they had left; what they did since is accounted for afterwards.
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
  void add_last() { least_ = bounding_box(*full_).diagonal(); }
  /// Gives the next vertex of the vanished pieces the bound that all of them together have.
  void repeat() { ask(); }
  /// Ends a round: has the mesh measured where enough has changed since the last time.
  void end_round(const Connectivity& current);
  /// The bound after the last removal, mesh units. Waits for all measurements.
  double current();
  /// One bound for each removal, in order; frees what only further removals would need. Waits as well.
  std::vector<float> take_bounds();

 private:
  /// What removals did, and after how many of these changes a bound is asked for, which is no less than `least`.
  struct Account {
    struct Question {
      std::size_t change_count = 0;
      double least = 0;
    };
    FaceChanges changes;
    std::vector<Question> questions;
  };

  void ask() { account_.questions.push_back({account_.changes.size(), least_}); }
  void settle(const Account& account);
  void settle_all();
  void measure(const LevelDeviation::Level& level);
  double bound() const;

  const Mesh* full_;
  double step_;
  Progress progress_;  // hears
  std::size_t measured_faces_;
  bool vanished_ = false;  // whether a piece has since it was measured
  double least_ = 0;       // > 0 once nothing is left
  bool any_removed_ = false;
  Account account_;  // not settled yet

  // While measurements are on the way these are theirs.
  std::optional<LevelDeviation> level_;  // where it measures at all; else
  FaceReach moved_;                      // how far the full mesh's points are from where they were
  std::vector<float> bound_;

  SideJobs measurements_;  // the first to end
};

}  // namespace lodestone::detail
