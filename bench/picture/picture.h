#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace lodestone::bench {

/// An error, and what it costs.
struct CostedError {
  double cost = 0;    ///< seconds, kilobytes …
  double error = 0;   ///< mean, % of the diagonal
  std::string label;  ///< beside the point; may be empty
};

/// The points of one way to do it, joined by a line where they are several.
struct ErrorSeries {
  std::string name;
  std::vector<CostedError> points;
  bool is_stepped = false;  ///< a point's error holds up to the next one's cost
};

/// A cost that is of interest: a line through the panel.
struct CostMark {
  double cost = 0;
  std::string label;
};

/// Errors against costs on one model.
struct ErrorPanel {
  std::string title;
  std::vector<ErrorSeries> series;
  std::vector<CostMark> marks;
};

/// Returns an SVG picture: error against cost, both logarithmic, a panel for each model, so many in a row; series have
/// the same colours in all, named under them. `unit`: of costs, as axes say it. Pre: some panel, costs and errors above
/// 0.
std::string error_picture(const std::vector<ErrorPanel>& panels, const std::string& unit, std::size_t columns);

}  // namespace lodestone::bench
