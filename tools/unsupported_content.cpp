#include "unsupported_content.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

namespace lodestone::tool {
namespace {

constexpr std::array<std::string_view, 4> kRefused = {"skin", "morph target", "animation", "texture"};

/// Readers word such notes as `2 animations are left out`.
bool is_refused(std::string_view note) {
  const std::size_t noun = note.find_first_not_of("0123456789 ");
  if (noun == 0 || noun == note.npos || note.find(" left out") == note.npos) return false;
  return std::any_of(kRefused.begin(), kRefused.end(),
                     [&](std::string_view word) { return note.substr(noun).starts_with(word); });
}

}  // namespace

std::vector<std::string> unsupported_content(const std::vector<std::string>& notes) {
  std::vector<std::string> refused;
  std::copy_if(notes.begin(), notes.end(), std::back_inserter(refused), is_refused);
  return refused;
}

}  // namespace lodestone::tool
