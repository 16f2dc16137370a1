#pragma once

#include <lodestone/lod/deviation.h>

namespace lodestone::detail {

/// Adds up the deviations of a scene's meshes: maxima are the largest, means and squares count by drawn area.
class DeviationTotal {
 public:
  /// `scale`: world units per mesh unit; `area`: squared world units.
  void add(const Deviation& deviation, double scale, double area);
  /// World units.
  Deviation result() const;

 private:
  struct OneSided {
    OneSidedDeviation largest;
    double mean = 0, squares = 0;
    void add(const OneSidedDeviation& other, double scale, double area);
    OneSidedDeviation result(double area) const;
  };
  OneSided forward_, backward_;
  double angle_ = 0;
  double area_ = 0;
};

}  // namespace lodestone::detail
