#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lodestone::bench {

/// Prints how far models are still off after 5, 10, 25 and 50 % of the bytes of their streams, beside levels by Draco
/// of as many bytes, and draws error against bytes into an SVG file. Both are built as `lodestone build` does, with all
/// of a model's triangles as one mesh. Returns an exit status.
int draw_rates(const std::vector<std::filesystem::path>& models, const std::string& picture);

}  // namespace lodestone::bench
