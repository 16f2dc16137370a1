#pragma once

#include <span>
#include <vector>

namespace lodestone {

/// Pixels of the height of a screen, where nobody says how large it is.
inline constexpr double kScreenHeight = 1080;

/// How a level of an object differs from the object, all its parts together.
struct LevelLook {
  double rms_deviation = 0;  ///< world units
  double normal_angle = 0;   ///< radians, in the mean
  double area = 0;           ///< of the object in full detail, squared world units
  double face_count = 0;     ///< of the level, as often as they are drawn
};

/// Returns the length in the world that must be at most a pixel long for a level to look like the object: twice the
/// root mean square of its distances, and what its normals turn over the length of a face. Infinity for a level of no
/// faces. Source: pictures of levels at many distances, by structural similarity; tests/web/pictures.mjs takes them.
double visible_error(const LevelLook& level);

/// Returns for each level, finest first, the share of the screen's height that an object spans where the next level
/// takes over: where that one's visible error is one pixel of `kScreenHeight`. Values are below 1 and fall strictly;
/// the last is 0, so that nothing ever vanishes. A level that looks no worse than the one before takes over at once.
/// Pre: `size` is the object's longest side, `visible_errors` has one value for each level.
std::vector<double> screen_coverages(double size, std::span<const double> visible_errors);

}  // namespace lodestone
