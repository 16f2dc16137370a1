#pragma once

#include <span>
#include <string>
#include <string_view>

namespace lodestone::tool {

/// Returns what to say to a word that no command has: which word of ours does what another program means by it, or
/// else which of `known` it may be a slip of. Empty where nothing comes near.
std::string answer_to(std::string_view word, std::span<const std::string> known);

}  // namespace lodestone::tool
