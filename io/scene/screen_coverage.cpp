#include <lodestone/io/screen_coverage.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace lodestone {
namespace {

constexpr double kLargest = 0.95;                  // the finest level must be seen somewhere
constexpr double kSmallest = 0.1 / kScreenHeight;  // an object of a tenth of a pixel is as good as gone
constexpr double kLeastFall = 0.98;                // of two values in a row, well above what readers' floats can tell

/// Lets each value be less than the one before: those behind are the ones to trust, but for the screen's own limits.
void make_fall(std::vector<double>& values) {
  for (std::size_t i = values.size(); i-- > 1;) values[i - 1] = std::max(values[i - 1], values[i] / kLeastFall);
  double limit = kLargest;
  for (double& value : values) {
    value = std::min(value, limit);
    limit = value * kLeastFall;
  }
}

}  // namespace

double visible_error(const LevelLook& level) {
  if (!(level.face_count > 0)) return std::numeric_limits<double>::infinity();
  const double face_length = std::sqrt(level.area / level.face_count);
  return 2 * level.rms_deviation + level.normal_angle * face_length;
}

std::vector<double> screen_coverages(double size, std::span<const double> visible_errors) {
  std::vector<double> values;
  for (std::size_t i = 1; i < visible_errors.size(); ++i) {
    const double share = size / (kScreenHeight * visible_errors[i]);
    values.push_back(std::isnan(share) ? kSmallest : std::clamp(share, kSmallest, kLargest));
  }
  make_fall(values);
  if (!visible_errors.empty()) values.push_back(0);
  return values;
}

}  // namespace lodestone
