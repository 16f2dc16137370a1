#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>
#include <lodestone/core/removal.h>
#include <lodestone/lod/level_deviation.h>

namespace lodestone::detail {

/// Bounds the two-sided distance between the full mesh and the mesh after each removal.
///
/// From time to time the mesh is measured. In between, each removal adds an upper bound of how far it moves the surface
/// it replaces; the triangle inequality bounds the rest.
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
    since_measured_ = since_start_ = Chain(0);
  }
  /// One bound for each removal, in order.
  const std::vector<float>& bounds() const { return bound_; }

 private:
  /// How far removals may have moved each face's points from where they were at some time.
  struct Chain {
    std::vector<float> moved;  // by face, mesh units
    double largest = 0;

    explicit Chain(std::size_t face_count) : moved(face_count, 0) {}
    void add(const RemovalRecord& record, double displacement);
    void add_vanished(std::span<const RemovalRecord> records, Index face, double reach);
    void reset() {
      std::fill(moved.begin(), moved.end(), 0.0F);
      largest = 0;
    }
  };

  static float round_up(double value);
  double bound() const;
  template <class Visit>
  void for_chains(const Visit& visit) {
    visit(since_start_);
    if (level_) visit(since_measured_);
  }

  const Mesh* full_;
  double step_;
  std::optional<LevelDeviation> level_;  // where it measures at all
  std::size_t measured_faces_;
  Chain since_start_;
  Chain since_measured_;   // empty where it does not measure: as since_start_
  double measured_ = 0;    // bound of the last measured mesh
  bool vanished_ = false;  // whether a piece has since it was measured
  double last_ = 0;        // > 0 once nothing is left
  std::vector<float> bound_;
};

}  // namespace lodestone::detail
