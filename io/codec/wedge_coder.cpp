#include "codec/wedge_coder.h"

#include <algorithm>
#include <array>
#include <bit>

namespace lodestone::detail {
namespace {

// Contexts of bits; the foretold ones come first.
constexpr std::uint32_t kCuts = 4;   // seams that end in the middle
constexpr std::uint32_t kKinds = 3;  // closed, open, ear
constexpr std::uint32_t kOuters = 3;
enum Context : std::uint32_t {
  kIsForetold = 0,
  kIsOwn = kCuts * kKinds * kOuters * 2,
  kIsBeyond = kIsOwn + 2,
  kIsSame,
  kIsNew = kIsSame + 3,
  kIsMore,
  kEnd = kIsMore + 2
};
static_assert(kEnd <= 128);

/// Wedges and group of a face at an edge, as seen from the face on the edge's other side.
struct Side {
  Index from, to, group;
  friend bool operator==(const Side&, const Side&) = default;
};

Side own_side(const PatchMesh& mesh, Index half) {
  return {mesh.wedge(half), mesh.wedge(next_corner(half)), mesh.group(face_of_corner(half))};
}
Side side_beyond(const PatchMesh& mesh, Index twin) {
  return {mesh.wedge(next_corner(twin)), mesh.wedge(twin), mesh.group(face_of_corner(twin))};
}
void take_side(PatchMesh& mesh, Index half, const Side& side) {
  mesh.set_wedge(half, side.from);
  mesh.set_wedge(next_corner(half), side.to);
  mesh.set_group(face_of_corner(half), side.group);
}

/// What differs between two faces at the spoke between them: 2 if wedges do, 1 if the groups alone.
std::uint32_t cut_between(const PatchMesh& mesh, Index before, Index after) {
  if (mesh.wedge(3 * before + 2) != mesh.wedge(3 * after + 1)) return 2;
  return mesh.group(before) != mesh.group(after) ? 1 : 0;
}

}  // namespace

int WedgeCoder::code_bit(BitCoder& coder, std::uint32_t context, bool bit) {
  return bits_.code(coder, bit ? 1 : 0, std::array<std::uint32_t, 1>{context}, 0);
}

void WedgeCoder::foretell(const PatchMesh& mesh, bool has_seams, std::span<const Index> star, bool closed, bool is_ear,
                          Index used) {
  const std::size_t count = star.size();
  std::uint32_t cuts = 0, outers = 0;
  foretold_.centres.clear();
  for (std::size_t i = 0; i < count && has_seams; ++i) {
    const bool is_cut = (i > 0 || closed) && cut_between(mesh, star[i > 0 ? i - 1 : count - 1], star[i]) == 2;
    cuts += is_cut ? 1 : 0;
    foretold_.centres.push_back(i > 0 ? foretold_.centres[i - 1] + (is_cut ? 1 : 0) : used);
    outers += mesh.is_seam(3 * star[i] + 1) ? 1 : 0;
  }
  if (!has_seams || (closed && cuts < 2)) foretold_.centres.assign(count, used);
  if (closed && cuts >= 2 && cut_between(mesh, star[count - 1], star[0]) != 2)
    for (std::size_t i = count, last = foretold_.centres[count - 1]; i-- > 0 && foretold_.centres[i] == last;)
      foretold_.centres[i] = used;
  const std::uint32_t kind = is_ear ? 2 : closed ? 0 : 1;
  foretold_.context =
      ((std::min(cuts, kCuts - 1) * kKinds + kind) * kOuters + std::min(outers, kOuters - 1)) * 2 + (used > 0 ? 1 : 0);
}

bool WedgeCoder::is_foretold(const PatchMesh& mesh, std::span<const Index> star, const Star::Spoke* plan) const {
  for (std::size_t i = 0; i < star.size(); ++i)
    if (own_side(mesh, 3 * star[i] + 1) != Side{plan[i].from, plan[i].to, plan[i].group} ||
        foretold_.centres[i] != plan[i].centre)
      return false;
  return true;
}

/// Codes a group and two wedges of the vertices at a face's outer edge by their numbers.
bool WedgeCoder::code_named(BitCoder& coder, PatchMesh& mesh, Index face, const Star::Spoke* plan,
                            const WedgeTable& wedges) {
  const Index group = coder.code_raw(plan != nullptr ? plan->group : 0, std::bit_width(group_count_ - 1));
  if (group >= group_count_) return false;
  std::array<Index, 2> ends{};
  for (Index k = 0; k < 2; ++k) {
    const Index vertex = mesh.from(3 * face + 1 + k), count = wedges.count(vertex);
    if (count == 0) return false;
    const Index wanted = plan == nullptr ? 0 : (k == 0 ? plan->from : plan->to) - wedges.begin(vertex);
    const Index number = coder.code_raw(wanted, std::bit_width(count - 1));
    if (number >= count) return false;
    ends[k] = wedges.begin(vertex) + number;
  }
  take_side(mesh, 3 * face + 1, {ends[0], ends[1], group});
  return true;
}

bool WedgeCoder::code_side(BitCoder& coder, PatchMesh& mesh, Index face, bool is_ear, const Star::Spoke* plan,
                           const WedgeTable& wedges) {
  const Index half = 3 * face + 1, twin = mesh.twin(half);
  const Side wanted = plan != nullptr ? Side{plan->from, plan->to, plan->group} : Side{};
  const bool is_seam = mesh.is_seam(half);
  if (code_bit(coder, kIsOwn + (is_seam ? 1 : 0), own_side(mesh, half) == wanted) != 0) return true;
  if (is_seam && !is_ear && code_bit(coder, kIsBeyond, side_beyond(mesh, twin) == wanted) != 0)
    return take_side(mesh, half, side_beyond(mesh, twin)), true;
  return code_named(coder, mesh, face, plan, wedges);
}

bool WedgeCoder::code_centre(BitCoder& coder, PatchMesh& mesh, std::span<const Index> star, std::size_t i,
                             const Star::Spoke* plan, WedgeTable& wedges) {
  const auto vertex = static_cast<Index>(wedges.vertex_count() - 1);
  const Index first = wedges.begin(vertex), used = wedges.count(vertex);
  const Index wanted = plan != nullptr ? plan->centre : 0;
  if (i > 0) {
    const Index before = mesh.wedge(3 * star[i - 1]);
    if (code_bit(coder, kIsSame + cut_between(mesh, star[i - 1], star[i]), first + wanted == before) != 0)
      return mesh.set_wedge(3 * star[i], before), true;
  }
  if (used == 0 || code_bit(coder, kIsNew, wanted == used) != 0)
    return mesh.set_wedge(3 * star[i], wedges.add_wedge()), true;
  const Index number = coder.code_raw(wanted, std::bit_width(used - 1));
  if (number >= used) return false;
  mesh.set_wedge(3 * star[i], first + number);
  return true;
}

bool WedgeCoder::code(BitCoder& coder, PatchMesh& mesh, bool has_seams, std::span<const Index> star, bool closed,
                      bool is_ear, const Star::Spoke* plan, WedgeTable& wedges) {
  const auto vertex = static_cast<Index>(wedges.vertex_count() - 1);
  const Index used = wedges.count(vertex), first = wedges.begin(vertex);
  foretell(mesh, has_seams, star, closed, is_ear, used);
  if (code_bit(coder, kIsForetold + foretold_.context, plan != nullptr && is_foretold(mesh, star, plan)) != 0) {
    for (std::size_t i = 0; i < star.size(); ++i) {
      if (foretold_.centres[i] == wedges.count(vertex)) wedges.add_wedge();
      mesh.set_wedge(3 * star[i], first + foretold_.centres[i]);
    }
    return true;
  }
  for (std::size_t i = 0; i < star.size(); ++i) {
    const Star::Spoke* wanted = plan != nullptr ? plan + i : nullptr;
    if (!code_side(coder, mesh, star[i], is_ear, wanted, wedges)) return false;
    if (!code_centre(coder, mesh, star, i, wanted, wedges)) return false;
  }
  return true;
}

bool WedgeCoder::code_extra(BitCoder& coder, Index count, Index most, WedgeTable& wedges) {
  for (Index i = 0; code_bit(coder, kIsMore + (i > 0 ? 1 : 0), i < count) != 0; ++i) {
    if (i == most) return false;
    wedges.add_wedge();
  }
  return true;
}

}  // namespace lodestone::detail
