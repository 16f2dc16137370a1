#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <lodestone/core/ids.h>

#include "codec/bit_coder.h"
#include "codec/bit_mixer.h"
#include "codec/fixed_point.h"
#include "codec/wedge_table.h"

namespace lodestone::detail {

/// A base mesh. Groups follow one another.
struct BaseMesh {
  std::vector<Index> corners;       ///< three vertices for each face, numbered in the order of first use
  std::vector<Index> wedges;        ///< by corner: within its vertex
  std::vector<Index> wedge_counts;  ///< by vertex
  std::vector<Index> groups;        ///< by face; known to a reader
  std::vector<Vec3i> positions;     ///< by vertex
};

/// Codes which vertices and wedges the faces of a base mesh have.
class BaseCoder {
 public:
  /// Codes all but positions and groups; a reader gives arrays of the right lengths. False where what is read is no
  /// mesh of at most `most_wedges`. The wedges are added to a table that is empty.
  bool code(BitCoder& coder, BaseMesh& base, std::uint64_t most_wedges, WedgeTable& wedges);

 private:
  bool code_corners(BitCoder& coder, BaseMesh& base);
  bool code_wedge_counts(BitCoder& coder, BaseMesh& base, std::uint64_t most_wedges, WedgeTable& wedges);
  bool code_wedges(BitCoder& coder, BaseMesh& base);
  bool code_bit(BitCoder& coder, std::uint32_t context, bool is);

  BitMixer<1> bits_{{8}, 1};
};

}  // namespace lodestone::detail
