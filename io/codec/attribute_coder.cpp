#include "codec/attribute_coder.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <string_view>

#include "codec/direction_coder.h"
#include "codec/element_coders.h"
#include "codec/fast_attributes.h"
#include "codec/ring.h"
#include "codec/texture_coder.h"
#include "codec/weight_coder.h"

namespace lodestone::detail {
namespace {

/// Which attributes are coded before which.
int rank_of(const AttributeSpec& spec) {
  switch (spec.coding) {
    case AttributeCoding::Texture:
      return 0;
    case AttributeCoding::Directions:
      return spec.component_count == 3 ? 1 : 2;
    case AttributeCoding::Weights:
      return 3;
    case AttributeCoding::Numbers:
    case AttributeCoding::kCount:
      break;
  }
  return 0;
}

constexpr std::string_view kWeights = "WEIGHTS_", kJoints = "JOINTS_";

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

bool ElementCoder::are_same(Index a, Index b) const {
  const std::span<const std::int32_t> x = numbers(a), y = numbers(b);
  for (std::size_t c = 0; c < x.size(); ++c)  // most differ in the first
    if (x[c] != y[c]) return false;
  return true;
}

/// Where wedges of the ring have the same, so may this one: what most of them have.
bool ElementCoder::code_common(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers,
                               bool is_writer) {
  std::uint32_t most = 1;
  Index common = 0;
  for (std::size_t i = 0; i + most < place.ring.size(); ++i) {
    std::uint32_t count = 1;
    for (std::size_t j = i + 1; j < place.ring.size(); ++j) count += are_same(place.ring[i], place.ring[j]) ? 1 : 0;
    if (count > most) most = count, common = place.ring[i];
  }
  if (most < 2) return false;
  const std::span<const std::int32_t> others = this->numbers(common);
  const bool is_common = is_writer && std::equal(others.begin(), others.end(), numbers.begin());
  const auto size = static_cast<std::uint32_t>(place.ring.size());
  const std::array<std::uint32_t, 1> context = {
      (std::min(most - 2, kCommon - 1) * kCommon + std::min(size - most, kCommon - 1)) * 2 + (was_common_ ? 1 : 0)};
  was_common_ = common_.code(coder, is_common ? 1 : 0, context, 0) != 0;
  if (was_common_) std::copy(others.begin(), others.end(), numbers.begin());
  return was_common_;
}

bool ElementCoder::code(BitCoder& coder, const ElementPlace& place, std::span<const std::int32_t> given) {
  const std::span<std::int32_t> numbers =
      std::span(numbers_).subspan(std::size_t{place.wedge} * spec_.component_count, spec_.component_count);
  std::copy(given.begin(), given.end(), numbers.begin());
  const bool is_writer = !given.empty();
  if (code_same(coder, place, numbers, is_writer) || code_common(coder, place, numbers, is_writer))
    return pass(place), true;
  return code_element(coder, place, numbers);
}

AttributeCoder::AttributeCoder(std::span<const AttributeSpec> specs, bool is_fast)
    : is_fast_(is_fast), skin_(std::make_unique<SkinSets>()) {
  for (const AttributeSpec& spec : specs) add_coder(spec);
  find_joints();
  // What others are predicted from comes first.
  for (int rank = 0; rank < 4; ++rank)
    for (std::size_t i = 0; i < coders_.size(); ++i)
      if (rank_of(coders_[i]->spec()) == rank) order_.push_back(i);
  bits.assign(specs.size(), 0);
}

AttributeCoder::~AttributeCoder() = default;

void AttributeCoder::add_coder(const AttributeSpec& spec) {
  switch (spec.coding) {
    case AttributeCoding::Directions:
      has_directions_ = true;
      if (is_fast_)
        coders_.push_back(std::make_unique<FastDirectionCoder>(spec));
      else
        coders_.push_back(std::make_unique<FittedDirectionCoder>(spec));
      if (normal_ == nullptr && spec.component_count == 3) normal_ = coders_.back().get();
      return;
    case AttributeCoding::Texture:
      if (is_fast_)
        coders_.push_back(std::make_unique<FastTextureCoder>(spec));
      else
        coders_.push_back(std::make_unique<FittedTextureCoder>(spec));
      if (texture_ == nullptr) texture_ = coders_.back().get();
      return;
    case AttributeCoding::Weights:
      coders_.push_back(std::make_unique<WeightCoder>(spec, *skin_, skin_->sets.size()));
      skin_->sets.push_back({nullptr, coders_.back().get()});
      return;
    case AttributeCoding::Numbers:
    case AttributeCoding::kCount:
      break;
  }
  coders_.push_back(std::make_unique<PlainElementCoder>(spec));
}

/// Finds the joints of each set of weights, by their names.
void AttributeCoder::find_joints() {
  for (SkinSets::Set& set : skin_->sets) {
    const AttributeSpec& weights = set.weights->spec();
    if (!weights.name.starts_with(kWeights)) continue;
    for (const auto& coder : coders_) {
      const AttributeSpec& spec = coder->spec();
      if (spec.coding == AttributeCoding::Numbers && spec.component_count == weights.component_count &&
          spec.name.starts_with(kJoints) &&
          spec.name.compare(kJoints.size(), std::string::npos, weights.name, kWeights.size()) == 0)
        set.joints = coder.get();
    }
  }
}

bool AttributeCoder::code_wedge(BitCoder& coder, const ElementPlace& place,
                                std::span<const std::vector<std::int32_t>> given, Index first_given) {
  for (const std::size_t i : order_) {
    const std::size_t size = coders_[i]->spec().component_count;
    std::span<const std::int32_t> numbers;
    if (!given.empty()) numbers = std::span(given[i]).subspan((place.wedge - first_given) * size, size);
    const double before = counts ? coder.bits() : 0;
    if (!coders_[i]->code(coder, place, numbers)) return false;
    if (counts) bits[i] += coder.bits() - before;
  }
  return coder.goes_on();
}

void AttributeCoder::look(const PatchMesh& mesh, const WedgeTable& wedges, const GridPoints& positions) {
  for (auto& element : coders_) element->resize(wedges.size());
  if (!has_directions_ || is_fast_) return;
  look_at_normals(
      mesh, positions, wedges.size(), [&](Index half) { return mesh.wedge(half); }, normals_);
}

bool AttributeCoder::code_base(BitCoder& coder, const PatchMesh& mesh, const WedgeTable& wedges,
                               const GridPoints& positions, std::span<const std::vector<std::int32_t>> given) {
  if (coders_.empty()) return true;
  look(mesh, wedges, positions);
  std::vector<Index> beside(wedges.size(), kNoIndex);  // by wedge: the last before it that shares a face
  for (Index c = 0; c < 3 * mesh.face_count(); ++c)
    for (const Index other : {next_corner(c), previous_corner(c)}) {
      Index& best = beside[mesh.wedge(c)];
      if (mesh.wedge(other) < mesh.wedge(c) && (best == kNoIndex || best < mesh.wedge(other))) best = mesh.wedge(other);
    }
  for (Index w = 0; w < wedges.size(); ++w) {
    const Index near = beside[w] != kNoIndex ? beside[w] : w > 0 ? w - 1 : kNoIndex;
    if (!code_wedge(coder, {mesh, wedges, positions, normals_, w, {}, {}, texture_, normal_, near}, given, 0))
      return false;
  }
  return true;
}

/// Sorts the faces of a vertex by its wedges; those that another record has taken since are left out.
void AttributeCoder::sort_faces(const PatchMesh& mesh, Index first_wedge, Index end_wedge,
                                std::span<const Index> faces) {
  const auto is_own = [&](Index face) {
    return mesh.wedge(3 * face) >= first_wedge && mesh.wedge(3 * face) < end_wedge;
  };
  sorted_end_.assign(end_wedge - first_wedge + std::size_t{1}, 0);
  for (const Index face : faces)
    if (is_own(face)) ++sorted_end_[mesh.wedge(3 * face) - first_wedge + 1];
  std::partial_sum(sorted_end_.begin(), sorted_end_.end(), sorted_end_.begin());
  sorted_.resize(sorted_end_.back());
  // Where each wedge's begin moves to where they end.
  for (const Index face : faces)
    if (is_own(face)) sorted_[sorted_end_[mesh.wedge(3 * face) - first_wedge]++] = face;
}

/// Finds the ring of a wedge with these faces.
void AttributeCoder::look_around(const PatchMesh& mesh, Index wedge, std::span<const Index> faces) {
  faces_.assign(faces.begin(), faces.begin() + static_cast<std::ptrdiff_t>(std::min(faces.size(), kMostAround)));
  ring_.clear();
  for (const Index face : faces_)
    for (const Index other : {mesh.wedge(3 * face + 1), mesh.wedge(3 * face + 2)}) {
      if (seen_by_[other] == wedge || ring_.size() == kMostAround) continue;
      seen_by_[other] = wedge;
      ring_.push_back(other);
    }
}

bool AttributeCoder::code_vertex(BitCoder& coder, const PatchMesh& mesh, const WedgeTable& wedges,
                                 const GridPoints& positions, Index vertex, std::span<const Index> faces,
                                 std::span<const std::vector<std::int32_t>> given, Index first_given) {
  if (coders_.empty()) return true;
  const Index first = wedges.begin(vertex), end = wedges.end(vertex);
  seen_by_.resize(wedges.size(), kNoIndex);
  sort_faces(mesh, first, end, faces);
  for (Index w = first; w < end; ++w) {
    const Index begin = w == first ? 0 : sorted_end_[w - first - 1];
    look_around(mesh, w, std::span(sorted_).subspan(begin, sorted_end_[w - first] - begin));
    const Index near = w > 0 ? w - 1 : kNoIndex;
    if (!code_wedge(coder, {mesh, wedges, positions, normals_, w, faces_, ring_, texture_, normal_, near}, given,
                    first_given))
      return false;
  }
  return true;
}

}  // namespace lodestone::detail
