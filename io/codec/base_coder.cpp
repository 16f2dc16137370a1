#include "codec/base_coder.h"

#include <algorithm>
#include <bit>

namespace lodestone::detail {
namespace {

enum BaseContext : std::uint32_t { kIsNewVertex, kHasWedge, kHasTwo, kHasMore, kIsLastWedge };

}  // namespace

bool BaseCoder::code_bit(BitCoder& coder, std::uint32_t context, bool is) {
  return bits_.code(coder, is ? 1 : 0, std::array<std::uint32_t, 1>{context}, 0) != 0;
}

/// A corner is the next vertex that none had before, or one of those.
bool BaseCoder::code_corners(BitCoder& coder, BaseMesh& base) {
  const auto vertex_count = static_cast<Index>(base.positions.size());
  Index used = 0;
  for (Index& corner : base.corners) {
    const bool is_new = code_bit(coder, kIsNewVertex, corner == used);
    if (!is_new) corner = coder.code_raw(corner, std::bit_width(std::max<Index>(used, 1) - 1));
    if (is_new) corner = used++;
    if (corner >= std::min(used, vertex_count)) return false;
  }
  return true;
}

bool BaseCoder::code_wedge_counts(BitCoder& coder, BaseMesh& base, std::uint64_t most_wedges, WedgeTable& wedges) {
  for (Index& count : base.wedge_counts) {
    wedges.add_vertex();
    for (Index i = 0; code_bit(coder, kHasWedge + std::min<Index>(i, 2), i < count); ++i) {
      if (wedges.size() >= most_wedges) return false;
      wedges.add_wedge();
    }
    count = wedges.count(static_cast<Index>(wedges.vertex_count() - 1));
  }
  return true;
}

/// A corner most often has the wedge that the corner before had there.
bool BaseCoder::code_wedges(BitCoder& coder, BaseMesh& base) {
  std::vector<Index> last(base.wedge_counts.size(), 0);
  for (std::size_t c = 0; c < base.corners.size(); ++c) {
    const Index vertex = base.corners[c], count = base.wedge_counts[vertex];
    if (count == 0) return false;
    Index& wedge = base.wedges[c];
    if (count == 1 || code_bit(coder, kIsLastWedge, wedge == last[vertex])) {
      wedge = last[vertex];
      continue;
    }
    wedge = coder.code_raw(wedge, std::bit_width(count - 1));
    if (wedge >= count) return false;
    last[vertex] = wedge;
  }
  return true;
}

bool BaseCoder::code(BitCoder& coder, BaseMesh& base, std::uint64_t most_wedges, WedgeTable& wedges) {
  return code_corners(coder, base) && code_wedge_counts(coder, base, most_wedges, wedges) && code_wedges(coder, base);
}

}  // namespace lodestone::detail
