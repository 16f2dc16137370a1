#include "codec/attribute_coder.h"

#include <algorithm>

#include "codec/direction_coder.h"
#include "codec/element_coders.h"

namespace lodestone::detail {
namespace {

std::unique_ptr<ElementCoder> make_coder(const AttributeSpec& spec) {
  switch (spec.coding) {
    case AttributeCoding::Directions:
      return std::make_unique<DirectionCoder>(spec);
    case AttributeCoding::Texture:
    case AttributeCoding::Numbers:
    case AttributeCoding::kCount:
      break;
  }
  return std::make_unique<PlainElementCoder>(spec);
}

}  // namespace

/// A wedge may have what an earlier one of its vertex has.
bool ElementCoder::code_same(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers,
                             bool is_writer) {
  const Index vertex = place.wedges.vertex(place.wedge), first = place.wedges.begin(vertex);
  for (Index i = 0; i < kSame && first + i < place.wedge; ++i) {
    const Index other = place.wedge - 1 - i;
    const std::span<const std::int32_t> others = this->numbers(other);
    const bool is_same = is_writer && std::equal(others.begin(), others.end(), numbers.begin());
    if (same_.code(coder, is_same ? 1 : 0, std::array<std::uint32_t, 1>{i}, 0) == 0) continue;
    std::copy(others.begin(), others.end(), numbers.begin());
    return true;
  }
  return false;
}

bool ElementCoder::code(BitCoder& coder, const ElementPlace& place, std::span<const std::int32_t> given) {
  const std::span<std::int32_t> numbers =
      std::span(numbers_).subspan(std::size_t{place.wedge} * spec_.component_count, spec_.component_count);
  std::copy(given.begin(), given.end(), numbers.begin());
  if (code_same(coder, place, numbers, !given.empty())) return pass(place), true;
  return code_element(coder, place, numbers);
}

AttributeCoder::AttributeCoder(std::span<const AttributeSpec> specs) {
  for (const AttributeSpec& spec : specs) coders_.push_back(make_coder(spec));
  bits.assign(specs.size(), 0);
}

bool AttributeCoder::code_wedge(BitCoder& coder, const ElementPlace& place,
                                std::span<const std::vector<std::int32_t>> given, Index first_given) {
  for (std::size_t i = 0; i < coders_.size(); ++i) {
    const std::size_t size = coders_[i]->spec().component_count;
    std::span<const std::int32_t> numbers;
    if (!given.empty()) numbers = std::span(given[i]).subspan((place.wedge - first_given) * size, size);
    const double before = given.empty() ? 0 : coder.bits();
    if (!coders_[i]->code(coder, place, numbers)) return false;
    if (!given.empty()) bits[i] += coder.bits() - before;
  }
  return true;
}

void AttributeCoder::resize(std::size_t wedge_count) {
  for (auto& element : coders_) element->resize(wedge_count);
}

bool AttributeCoder::code_base(BitCoder& coder, const PatchMesh& mesh, const WedgeTable& wedges,
                               std::span<const Vec3i> positions, std::span<const std::vector<std::int32_t>> given) {
  if (coders_.empty()) return true;
  resize(wedges.size());
  std::vector<Index> beside(wedges.size(), kNoIndex);  // by wedge: the last before it that shares a face
  for (Index c = 0; c < mesh.corners().size(); ++c)
    for (const Index other : {next_corner(c), previous_corner(c)}) {
      Index& best = beside[mesh.wedge(c)];
      if (mesh.wedge(other) < mesh.wedge(c) && (best == kNoIndex || best < mesh.wedge(other))) best = mesh.wedge(other);
    }
  for (Index w = 0; w < wedges.size(); ++w) {
    const Index near = beside[w] != kNoIndex ? beside[w] : w > 0 ? w - 1 : kNoIndex;
    if (!code_wedge(coder, {mesh, wedges, positions, w, {}, {}, near}, given, 0)) return false;
  }
  return true;
}

bool AttributeCoder::code_vertex(BitCoder& coder, const PatchMesh& mesh, const WedgeTable& wedges,
                                 std::span<const Vec3i> positions, Index vertex, std::span<const Index> faces,
                                 std::span<const std::vector<std::int32_t>> given, Index first_given) {
  if (coders_.empty()) return true;
  for (Index w = wedges.begin(vertex); w < wedges.end(vertex); ++w) {
    faces_.clear();
    ring_.clear();
    for (const Index face : faces) {
      if (mesh.wedge(3 * face) != w) continue;
      faces_.push_back(face);
      for (const Index other : {mesh.wedge(3 * face + 1), mesh.wedge(3 * face + 2)})
        if (std::find(ring_.begin(), ring_.end(), other) == ring_.end()) ring_.push_back(other);
    }
    const Index near = w > 0 ? w - 1 : kNoIndex;
    if (!code_wedge(coder, {mesh, wedges, positions, w, faces_, ring_, near}, given, first_given)) return false;
  }
  return true;
}

}  // namespace lodestone::detail
