#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <lodestone/core/mesh.h>
#include <lodestone/core/result.h>

#include "json_text.h"

namespace lodestone::tool {

/// What a page shows.
struct HtmlReport {
  std::string title;         ///< any text
  Json numbers;              ///< what the page's tables and charts are made of; page.js says what is looked for
  double diagonal = 0;       ///< what percentages are of
  std::vector<Mesh> meshes;  ///< in world space; the original first, its errors are measured against each of the others
};

/// Returns one HTML page that needs nothing beside it. Large meshes are simplified first, for the picture only; the
/// page says so. Errors: what simplification may fail with.
Result<std::string> html_page(const HtmlReport& report);

}  // namespace lodestone::tool
