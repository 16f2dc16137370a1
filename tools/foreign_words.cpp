#include "foreign_words.h"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

namespace lodestone::tool {
namespace {

/// A word of another program, or one that many type, and ours.
struct ForeignWord {
  std::string_view word;
  std::string_view answer;
};

// Commands stand without dashes. What an entry answers follows the word itself: "unknown option '-si'; …".
constexpr ForeignWord kForeignWords[] = {
    // gltfpack
    {"-si", "gltfpack's -si R is --ratio R here"},
    {"-se", "gltfpack's -se E, a share of the extent, is --error here: 1% for 0.01"},
    {"-sa", "gltfpack's -sa has no like: without --error there is no limit on it"},
    {"-slb", "gltfpack's -slb is --lock-border here"},
    {"-sp", "gltfpack's -sp has no like: attributes count by --weight"},
    {"-sv", "gltfpack's -sv is always on here; attributes count by --weight"},
    {"-c", "gltfpack's -c is --compress meshopt here; without it geometry is compressed with Draco"},
    {"-cc", "gltfpack's -cc is --compress meshopt here; without it geometry is compressed with Draco"},
    {"-cf", "gltfpack's -cf has no like: for viewers without a decoder there is --compress none"},
    {"-cz", "gltfpack's -cz is --compress meshopt here; without it geometry is compressed with Draco"},
    {"-noq", "gltfpack's -noq is --compress none here"},
    {"-vp", "gltfpack's -vp N is --qp N here"},
    {"-vpf", "gltfpack's -vpf is --compress none here"},
    {"-kn", "gltfpack's -kn is always on here: nodes and their names stay"},
    {"-km", "gltfpack's -km is always on here: materials and their names stay"},
    {"-ke", "gltfpack's -ke is always on here: extras stay"},
    {"-kv", "gltfpack's -kv is always on here: all attributes stay"},
    {"-r", "gltfpack's -r R.json is --report R.json here"},
    {"-v", "the version is -V; more to read about a run is in --report R.json"},
    {"-tc", "textures stay as they are here"},
    {"-tu", "textures stay as they are here"},
    {"-tw", "textures stay as they are here"},
    {"-tq", "textures stay as they are here"},
    {"-ts", "textures stay as they are here"},
    // glTF-Transform
    {"--simplify", "building levels always simplifies; --ratio, --faces or --error say how far"},
    {"--simplify-ratio", "glTF-Transform's --simplify-ratio is --ratio here"},
    {"--simplify-error", "glTF-Transform's --simplify-error is --error here: 0.01% for 0.0001"},
    {"--simplify-lock-border", "glTF-Transform's --simplify-lock-border is --lock-border here"},
    {"--quantize-position", "glTF-Transform's --quantize-position N is --qp N here"},
    {"--quantize-position-bits", "--quantize-position-bits N is --qp N here"},
    {"--texture-compress", "textures stay as they are here"},
    {"--texture-size", "textures stay as they are here"},
    {"--weld", "vertices are always welded here, where all their attributes are equal"},
    {"optimize", "glTF-Transform's optimize is build here"},
    {"draco", "build compresses with Draco unless --compress says otherwise"},
    {"meshopt", "glTF-Transform's meshopt is build --compress meshopt here"},
    {"validate", "no command validates; the Khronos glTF validator does"},
    // gltf-pipeline and obj2gltf
    {"-d", "geometry is compressed with Draco unless --compress says otherwise"},
    {"-b", "a .glb is written where OUT ends in .glb"},
    {"--binary", "a .glb is written where OUT ends in .glb"},
    {"-s", "a .bin and images of their own are written where OUT ends in .gltf"},
    {"--separate", "a .bin and images of their own are written where OUT ends in .gltf"},
    {"--draco", "geometry is compressed with Draco unless --compress says otherwise"},
    {"--draco.quantizePositionBits", "gltf-pipeline's --draco.quantizePositionBits N is --qp N here"},
    // Words that come to mind
    {"--verbose", "more to read about a run is in --report R.json"},
    {"--lods", "the number of levels is --levels N here"},
    {"--lod", "the number of levels is --levels N here; extract takes one with --level N"},
    {"--lod-count", "the number of levels is --levels N here"},
    {"--triangles", "a number of triangles is --faces N here"},
    {"--tris", "a number of triangles is --faces N here"},
    {"--target", "a target is --ratio, --faces, --error or --epsilon here"},
    {"--quality", "quality is --error here, e.g. --error 0.1%"},
    {"--threshold", "a threshold is --error here, e.g. --error 0.1%"},
    {"--percent", "a share of the faces is --ratio here, e.g. --ratio 50%"},
    {"--reduction", "the share of faces that stays is --ratio here, e.g. --ratio 50%"},
    {"--out", "the output is -o OUT or --output OUT"},
    {"--in", "the input is -i IN or --input IN"},
    {"--bits", "bits of positions are --qp N here"},
    {"--force", "outputs are always written over"},
    {"-f", "outputs are always written over"},
    {"-y", "outputs are always written over"},
    {"decimate", "decimating is simplify here"},
    {"reduce", "reducing is simplify here"},
    {"convert", "converting is simplify --ratio 1 here"},
    {"lod", "making levels is build here"},
    {"info", "glTF-Transform's info is inspect here"},
    {"diff", "comparing is compare here"},
    {"metro", "comparing is compare here"},
};

const ForeignWord* find_foreign(std::string_view word) {
  const auto* found = std::find_if(std::begin(kForeignWords), std::end(kForeignWords),
                                   [&](const ForeignWord& foreign) { return foreign.word == word; });
  return found == std::end(kForeignWords) ? nullptr : found;
}

/// Letters to insert, drop, change, or swap with their neighbour, to make one word the other.
std::size_t letters_apart(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before, above, row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    before = std::exchange(above, row);
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      row[j + 1] = std::min({row[j] + 1, above[j + 1] + 1, above[j] + (a[i] == b[j] ? 0 : 1)});
      if (i > 0 && j > 0 && a[i] == b[j - 1] && a[i - 1] == b[j]) row[j + 1] = std::min(row[j + 1], before[j - 1] + 1);
    }
  }
  return row.back();
}

std::string_view without_dashes(std::string_view word) {
  return word.substr(std::min(word.find_first_not_of('-'), word.size()));
}

/// Whether one is what the other begins with, as `--norm` of `--normalise`.
bool begins_alike(std::string_view word, std::string_view known) {
  constexpr std::size_t kEnough = 4;
  const std::size_t common = std::min(word.size(), known.size());
  return common >= kEnough && word.substr(0, common) == known.substr(0, common);
}

std::optional<std::string> closest(std::string_view word, std::span<const std::string> known) {
  const std::string_view typed = without_dashes(word);
  std::optional<std::string> best;
  std::size_t least = typed.size() / 3 + 1;  // one slip in short words
  if (typed.size() < 2) return best;
  for (const std::string& candidate : known) {
    const std::string_view name = without_dashes(candidate);
    if (name.size() < 2) continue;
    const std::size_t apart = begins_alike(typed, name) ? 1 : letters_apart(typed, name);
    if (apart > least || (apart == least && best)) continue;
    least = apart;
    best = candidate;
  }
  return best;
}

}  // namespace

std::string answer_to(std::string_view word, std::span<const std::string> known) {
  if (const ForeignWord* foreign = find_foreign(word)) return std::string(foreign->answer);
  if (const auto meant = closest(word, known)) return "did you mean " + *meant + "?";
  return "";
}

}  // namespace lodestone::tool
