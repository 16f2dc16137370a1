#include "picture/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

namespace lodestone::bench {
namespace {

constexpr double kWidth = 380, kHeight = 300;  // of a panel, pixels
constexpr double kLeft = 60, kRight = 12, kTop = 30, kBottom = 40;
constexpr double kLegendLine = 18;
constexpr double kMargin = 0.06;   // of an axis, free at each end
constexpr std::size_t kMany = 10;  // points, whose dots are small then
constexpr std::array kColours = {"#0b6e4f", "#1f77b4", "#d1495b", "#8d6a9f",
                                 "#e08e0b", "#5c5c5c", "#a0522d", "#2a9d8f"};

template <class... Values>
std::string format(const char* text, Values... values) {
  std::array<char, 512> buffer;
  std::snprintf(buffer.data(), buffer.size(), text, values...);
  return buffer.data();
}

/// A logarithmic axis from `from` to `to`, in pixels.
class Axis {
 public:
  Axis(double least, double most, double from, double to) : from_(from), to_(to) {
    const double margin = kMargin * std::max(std::log(most / least), 0.5);
    low_ = std::log(least) - margin;
    high_ = std::log(most) + margin;
  }
  double place(double value) const { return from_ + (to_ - from_) * (std::log(value) - low_) / (high_ - low_); }

  /// 1, 2 and 5 times the powers of ten that lie on it.
  std::vector<double> ticks() const {
    std::vector<double> values;
    for (int power = static_cast<int>(std::floor(low_ / std::log(10))) - 1; power * std::log(10) <= high_; ++power)
      for (const double digit : {1, 2, 5}) {
        const double value = digit * std::pow(10, power);
        if (std::log(value) >= low_ && std::log(value) <= high_) values.push_back(value);
      }
    return values;
  }

 private:
  double from_, to_, low_ = 0, high_ = 1;
};

struct Range {
  double least = std::numeric_limits<double>::infinity();
  double most = 0;
  void add(double value) { least = std::min(least, value), most = std::max(most, value); }
};

std::string axes(const Axis& cost, const Axis& error, const std::string& title, const std::string& unit) {
  const double right = kWidth - kRight, bottom = kHeight - kBottom;
  std::string svg = format("<text x='%g' y='18' class='title'>%s</text>\n", kLeft, title.c_str());
  for (const double tick : cost.ticks())
    svg += format("<line x1='%.1f' x2='%.1f' y1='%g' y2='%g'/><text x='%.1f' y='%g' class='middle'>%g %s</text>\n",
                  cost.place(tick), cost.place(tick), kTop, bottom, cost.place(tick), bottom + 16, tick, unit.c_str());
  for (const double tick : error.ticks())
    svg += format("<line x1='%g' x2='%g' y1='%.1f' y2='%.1f'/><text x='%g' y='%.1f' class='end'>%g %%</text>\n", kLeft,
                  right, error.place(tick), error.place(tick), kLeft - 6, error.place(tick) + 4, tick);
  return svg;
}

std::string mark_lines(const Axis& cost, const std::vector<CostMark>& marks) {
  std::string svg;
  for (const CostMark& mark : marks) {
    const double x = cost.place(mark.cost);
    svg += format("<line x1='%.1f' x2='%.1f' y1='%g' y2='%g' class='mark'/><text x='%.1f' y='%g'>%s</text>\n", x, x,
                  kTop, kHeight - kBottom, x + 3, kTop + 9, mark.label.c_str());
  }
  return svg;
}

std::string dots_and_line(const Axis& cost, const Axis& error, const ErrorSeries& series, const char* colour) {
  std::string path, dots;
  for (const CostedError& point : series.points) {
    const double x = cost.place(point.cost), y = error.place(point.error);
    if (!path.empty() && series.is_stepped) path += format("H%.1f", x);
    path += format("%s%.1f %.1f", path.empty() ? "M" : "L", x, y);
    dots += format("<circle cx='%.1f' cy='%.1f' r='%g' fill='%s'/>", x, y, series.points.size() > kMany ? 2.5 : 4.0,
                   colour);
    if (!point.label.empty())
      dots += format("<text x='%.1f' y='%.1f' fill='%s'>%s</text>", x + 6, y - 6, colour, point.label.c_str());
  }
  if (series.points.size() < 2) return dots + "\n";
  return format("<path stroke='%s' fill='none' d='", colour) + path + "'/>" + dots + "\n";
}

std::string panel_picture(const ErrorPanel& panel, const std::string& unit) {
  Range costs, errors;
  for (const ErrorSeries& series : panel.series)
    for (const CostedError& point : series.points) costs.add(point.cost), errors.add(point.error);
  const Axis cost(costs.least, costs.most, kLeft, kWidth - kRight);
  const Axis error(errors.least, errors.most, kHeight - kBottom, kTop);
  std::string svg = axes(cost, error, panel.title, unit) + mark_lines(cost, panel.marks);
  for (std::size_t i = 0; i < panel.series.size(); ++i)
    svg += dots_and_line(cost, error, panel.series[i], kColours[i % kColours.size()]);
  return svg;
}

}  // namespace

std::string error_picture(const std::vector<ErrorPanel>& panels, const std::string& unit, std::size_t columns) {
  const std::vector<ErrorSeries>& named = panels.front().series;
  const std::size_t rows = (panels.size() + columns - 1) / columns;
  const double width = kWidth * static_cast<double>(columns), end = kHeight * static_cast<double>(rows);
  const double height = end + kLegendLine * static_cast<double>(named.size()) + 10;
  std::string svg = format("<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 %g %g' width='%g' height='%g'>\n",
                           width, height, width, height);
  svg +=
      "<style>text{font:11px sans-serif;fill:#444}.title{font-weight:bold;font-size:13px;fill:#111}"
      ".middle{text-anchor:middle}.end{text-anchor:end}line{stroke:#e4e4e4}.mark{stroke:#999;stroke-dasharray:3 3}"
      "path{stroke-width:1.5}</style>\n"
      "<rect width='100%' height='100%' fill='#fff'/>\n";
  for (std::size_t i = 0; i < panels.size(); ++i)
    svg += format("<g transform='translate(%g %g)'>\n", kWidth * static_cast<double>(i % columns),
                  kHeight * static_cast<double>(i / columns)) +
           panel_picture(panels[i], unit) + "</g>\n";
  for (std::size_t i = 0; i < named.size(); ++i) {
    const double y = end + kLegendLine * static_cast<double>(i) + 6;
    svg += format("<circle cx='%g' cy='%g' r='4' fill='%s'/><text x='%g' y='%g'>%s</text>\n", kLeft + 4, y,
                  kColours[i % kColours.size()], kLeft + 14, y + 4, named[i].name.c_str());
  }
  return svg + "</svg>\n";
}

}  // namespace lodestone::bench
