// Colours are blended in OKLCh (B. Ottosson, "A perceptual color space for image processing", 2020), where equal steps
// look equally large. Lightness is linear in the error; hue and chroma run through the stops below.

#include "colour_map.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace lodestone::tool {
namespace {

constexpr double kPale = 0.93, kDark = 0.27;  // lightness at no error and at the upper end

struct Stop {
  double share, chroma, hue;  // hue in degrees
};

constexpr Stop kStops[] = {
    {0.00, 0.015, 110}, {0.12, 0.090, 105}, {0.28, 0.150, 82},  {0.45, 0.180, 55},
    {0.62, 0.200, 32},  {0.80, 0.160, 8},   {1.00, 0.110, -35},
};

using LinearColour = std::array<double, 3>;

LinearColour from_oklab(double lightness, double a, double b) {
  const double l = std::pow(lightness + 0.3963377774 * a + 0.2158037573 * b, 3);
  const double m = std::pow(lightness - 0.1055613458 * a - 0.0638541728 * b, 3);
  const double s = std::pow(lightness - 0.0894841775 * a - 1.2914855480 * b, 3);
  return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
          -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
          -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

bool is_displayable(const LinearColour& colour) {
  return std::all_of(colour.begin(), colour.end(), [](double x) { return x >= 0 && x <= 1; });
}

LinearColour linear_colour(double share) {
  share = std::clamp(share, 0.0, 1.0);
  std::size_t i = 1;
  while (i + 1 < std::size(kStops) && kStops[i].share < share) ++i;
  const Stop &from = kStops[i - 1], &to = kStops[i];
  const double t = (share - from.share) / (to.share - from.share);
  const double lightness = std::lerp(kPale, kDark, share);
  const double hue = std::lerp(from.hue, to.hue, t) * std::numbers::pi / 180;
  double chroma = std::lerp(from.chroma, to.chroma, t);
  // What no screen can show loses chroma, never lightness.
  LinearColour colour = from_oklab(lightness, chroma * std::cos(hue), chroma * std::sin(hue));
  for (; !is_displayable(colour) && chroma > 0.005; chroma *= 0.97)
    colour = from_oklab(lightness, chroma * std::cos(hue), chroma * std::sin(hue));
  for (double& x : colour) x = std::clamp(x, 0.0, 1.0);
  return colour;
}

std::uint8_t srgb_byte(double linear) {
  const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
  return static_cast<std::uint8_t>(std::lround(255 * encoded));
}

}  // namespace

Colour error_colour(double share) {
  const LinearColour colour = linear_colour(share);
  return {srgb_byte(colour[0]), srgb_byte(colour[1]), srgb_byte(colour[2])};
}

std::array<std::uint16_t, 3> linear_error_colour(double share) {
  std::array<std::uint16_t, 3> out{};
  const LinearColour colour = linear_colour(share);
  for (std::size_t i = 0; i < 3; ++i) out[i] = static_cast<std::uint16_t>(std::lround(65535 * colour[i]));
  return out;
}

std::vector<std::string> colour_stops(std::size_t count) {
  std::vector<std::string> stops;
  for (std::size_t i = 0; i < count; ++i) {
    const Colour colour = error_colour(static_cast<double>(i) / static_cast<double>(count - 1));
    char text[8];
    std::snprintf(text, sizeof text, "#%02x%02x%02x", colour.red, colour.green, colour.blue);
    stops.emplace_back(text);
  }
  return stops;
}

}  // namespace lodestone::tool
