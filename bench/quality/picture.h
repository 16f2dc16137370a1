#pragma once

#include <string>
#include <vector>

namespace lodestone::bench {

/// What a simplifier made of a model, and in what time.
struct TimedError {
  double seconds = 0;
  double error = 0;   ///< mean, % of the diagonal
  std::string label;  ///< beside the point; may be empty
};

/// The points of one simplifier, joined by a line where they are several.
struct TimedSeries {
  std::string name;
  std::vector<TimedError> points;
};

/// Errors against times on one model.
struct TimedPanel {
  std::string title;
  std::vector<TimedSeries> series;
};

/// Returns an SVG picture: error against time, both logarithmic, a panel for each model side by side; the simplifiers
/// have the same colours in all, named under them. Pre: some panel, times and errors above 0.
std::string error_time_picture(const std::vector<TimedPanel>& panels);

}  // namespace lodestone::bench
