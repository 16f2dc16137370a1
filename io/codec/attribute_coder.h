#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "codec/attribute_spec.h"
#include "codec/bit_coder.h"
#include "codec/bit_mixer.h"
#include "codec/fixed_point.h"
#include "codec/grid_points.h"
#include "codec/number_coder.h"
#include "codec/patch_mesh.h"
#include "codec/wedge_table.h"

namespace lodestone::detail {

class ElementCoder;

/// How many faces and wedges around one may tell of it, the first ones: a star of a patch has no more.
inline constexpr std::size_t kMostAround = 256;

/// What is there before an element of a wedge is coded.
struct ElementPlace {
  const PatchMesh& mesh;
  const WedgeTable& wedges;
  const GridPoints& positions;
  std::span<const Vec3i> normals;  ///< by wedge: unit; of the faces that have it, by area; none of a fast coder
  Index wedge = 0;
  std::span<const Index> faces;           ///< those that have the wedge as their first; in order, if it has a ring
  std::span<const Index> ring;            ///< wedges around it, each once; of both, kMostAround at most
  const ElementCoder* texture = nullptr;  ///< the first texture coordinates, if any; they are coded before directions
  const ElementCoder* normal = nullptr;   ///< the first normals, if any; they are coded before directions with a sign
  Index beside = kNoIndex;  ///< without a ring: a wedge that is likely to have about the same; kNoIndex for none

  /// The edges of a face that leave its first corner.
  std::array<Vec3i, 2> edges(Index face) const {
    const Vec3i p = positions[mesh.from(3 * face)];
    return {positions[mesh.from(3 * face + 1)] - p, positions[mesh.from(3 * face + 2)] - p};
  }
  /// The sum of the faces' normals, by area.
  Vec3i area() const {
    Vec3i sum;
    for (const Index face : faces) {
      const auto [a, b] = edges(face);
      sum = sum + cross(a, b);
    }
    return sum;
  }
};

/// The numbers of an attribute so far, and the models that code more.
class ElementCoder {
 public:
  explicit ElementCoder(AttributeSpec spec) : spec_(std::move(spec)) {}
  ElementCoder(const ElementCoder&) = delete;
  ElementCoder& operator=(const ElementCoder&) = delete;
  virtual ~ElementCoder() = default;

  const AttributeSpec& spec() const { return spec_; }
  std::span<const std::int32_t> numbers(Index wedge) const {
    return std::span(numbers_).subspan(std::size_t{wedge} * spec_.component_count, spec_.component_count);
  }
  void resize(std::size_t wedge_count) { numbers_.resize(wedge_count * spec_.component_count); }

  /// Codes an element; a writer gives it. False where what is read is none.
  bool code(BitCoder& coder, const ElementPlace& place, std::span<const std::int32_t> given);

 protected:
  virtual bool code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) = 0;
  /// Learns of an element that was coded as being that of another wedge.
  virtual void pass(const ElementPlace& place) = 0;
  std::int64_t number(Index wedge, std::size_t component) const {
    return numbers_[std::size_t{wedge} * spec_.component_count + component];
  }

 private:
  bool code_same(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers, bool is_writer);
  bool code_common(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers, bool is_writer);
  bool are_same(Index a, Index b) const;

  AttributeSpec spec_;
  std::vector<std::int32_t> numbers_;
  BitMixer<1> same_{{kSame}, 1};
  BitMixer<1> common_{{kCommon * kCommon * 2}, 1};
  bool was_common_ = false;

  static constexpr std::uint32_t kSame = 4;
  static constexpr std::uint32_t kCommon = 6;
};

struct SkinSets;

/// Codes the attributes of a level's wedges.
class AttributeCoder {
 public:
  AttributeCoder(std::span<const AttributeSpec> specs, bool is_fast);
  ~AttributeCoder();

  std::size_t count() const { return coders_.size(); }
  const ElementCoder& attribute(std::size_t i) const { return *coders_[i]; }

  /// Makes room for all wedges of a level, and looks at its faces.
  void look(const PatchMesh& mesh, const WedgeTable& wedges, const GridPoints& positions);
  /// Codes all wedges of a base mesh. `given`: by attribute, their numbers, of a writer; a reader gives none.
  bool code_base(BitCoder& coder, const PatchMesh& mesh, const WedgeTable& wedges, const GridPoints& positions,
                 std::span<const std::vector<std::int32_t>> given);
  /// Codes the wedges of a vertex with these faces. `given`: by attribute, numbers of the wedges from `first_given` on.
  bool code_vertex(BitCoder& coder, const PatchMesh& mesh, const WedgeTable& wedges, const GridPoints& positions,
                   Index vertex, std::span<const Index> faces, std::span<const std::vector<std::int32_t>> given,
                   Index first_given);

  /// By attribute: what has been coded of it, in bits; only where they are counted.
  std::vector<double> bits;
  bool counts = false;

 private:
  bool code_wedge(BitCoder& coder, const ElementPlace& place, std::span<const std::vector<std::int32_t>> given,
                  Index first_given);

  void sort_faces(const PatchMesh& mesh, Index first_wedge, Index end_wedge, std::span<const Index> faces);
  void look_around(const PatchMesh& mesh, Index wedge, std::span<const Index> faces);
  void add_coder(const AttributeSpec& spec);
  void find_joints();

  bool is_fast_;
  std::unique_ptr<SkinSets> skin_;  // at one address as long as its coders live
  std::vector<std::unique_ptr<ElementCoder>> coders_;
  std::vector<std::size_t> order_;         // in which attributes are coded
  const ElementCoder* texture_ = nullptr;  // see ElementPlace
  const ElementCoder* normal_ = nullptr;
  bool has_directions_ = false;
  std::vector<Vec3i> normals_;
  std::vector<Index> faces_, ring_;
  std::vector<Index> seen_by_;     // by wedge: the last one whose ring it is in
  std::vector<Index> sorted_;      // faces of a vertex, by their wedge
  std::vector<Index> sorted_end_;  // by wedge of the vertex: in `sorted_`
};

}  // namespace lodestone::detail
