#pragma once

#include <cstddef>
#include <vector>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/mesh.h>
#include <lodestone/core/removal.h>

namespace lodestone::detail {

/// Bounds the two-sided distance between the full mesh and the mesh after each removal.
class DeviationBounds {
 public:
  explicit DeviationBounds(const Mesh& full);

  /// Accounts for a removal that is about to be done.
  void add(const RemovalRecord& record);
  /// Ends a round: measures the mesh where enough has changed since the last time.
  void end_round(const Connectivity& current);
  /// The bound after the last removal, mesh units.
  double current() const { return bound_.empty() ? 0 : static_cast<double>(bound_.back()); }
  /// One bound for each removal, in order.
  const std::vector<float>& bounds() const { return bound_; }

 private:
  const Mesh* full_;
  std::vector<float> moved_;  // by face: how far its points may lie from the last measured mesh
  double largest_moved_ = 0;
  double measured_ = 0;       // bound of the last measured mesh
  std::vector<float> bound_;
};

}  // namespace lodestone::detail
