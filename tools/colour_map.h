#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace lodestone::tool {

/// A colour as screens take it: sRGB, 0 to 255.
struct Colour {
  std::uint8_t red = 0, green = 0, blue = 0;
  friend bool operator==(const Colour&, const Colour&) = default;
};

/// Returns the colour of an error, `share` of the scale's upper end, clamped to [0, 1]: from pale (no error) over
/// yellow and red to a dark purple. Its lightness falls evenly, so that the order shows without hues, too.
Colour error_colour(double share);

/// Returns the same as linear light, as glTF stores colours: 0 to 65535.
std::array<std::uint16_t, 3> linear_error_colour(double share);

/// Returns `count` colours at equal steps from 0 to 1, as `#rrggbb`; pre: count ≥ 2.
std::vector<std::string> colour_stops(std::size_t count);

}  // namespace lodestone::tool
