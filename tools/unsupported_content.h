#pragma once

#include <string>
#include <vector>

namespace lodestone::tool {

/// Returns those of a file's notes that `build` takes as a reason to refuse it: a result without skins, morph targets,
/// animations or textures would be another asset than the one put in.
std::vector<std::string> unsupported_content(const std::vector<std::string>& notes);

}  // namespace lodestone::tool
