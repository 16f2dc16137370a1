// Places at equal steps of the lengths or areas of a surface's elements, for samples.

#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace lodestone::detail {

/// Samples that are looked up together, between two words about the progress.
inline constexpr std::size_t kSamplesOfStep = 1024;

/// Turns the elements' sizes into running sums; sizes that are all 0 count as 1. Returns the whole size, which may be
/// 0.
inline double add_up(std::vector<double>& sizes) {
  double whole = 0;
  for (double& size : sizes) size = whole += size;
  if (whole > 0) return whole;
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = static_cast<double>(i + 1);
  return whole;
}

/// Calls `visit(element, share, k)` for k = 0 … count − 1: the places at equal steps of the elements' sizes, whose
/// running sums are `until`. `share` is how much of the element lies before the place.
template <class Visit>
void step_through(const std::vector<double>& until, std::size_t count, const Visit& visit) {
  std::size_t element = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const double place = (static_cast<double>(k) + 0.5) / static_cast<double>(count) * until.back();
    while (element + 1 < until.size() && until[element] < place) ++element;
    const double begin = element > 0 ? until[element - 1] : 0;
    const double size = until[element] - begin;
    visit(element, size > 0 ? std::clamp((place - begin) / size, 0.0, 1.0) : 0.5, k);
  }
}

}  // namespace lodestone::detail
