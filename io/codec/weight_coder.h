#pragma once

#include <vector>

#include "codec/attribute_coder.h"

namespace lodestone::detail {

/// The sets of joints and weights of a mesh, in order. Weights of a wedge add up to the largest number over all sets.
struct SkinSets {
  struct Set {
    const ElementCoder* joints = nullptr;  ///< none where there are none of as many components
    const ElementCoder* weights = nullptr;
  };
  std::vector<Set> sets;
};

/// Codes weights, each from those that the ring has of the same joint.
class WeightCoder final : public ElementCoder {
 public:
  /// `skin` outlives the coder and has all sets before the first element is coded.
  WeightCoder(const AttributeSpec& spec, const SkinSets& skin, std::size_t set);

 protected:
  bool code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) override;
  void pass(const ElementPlace&) override {}

 private:
  std::int64_t weight_around(const ElementPlace& place, std::int32_t joint) const;

  const SkinSets& skin_;
  std::size_t set_;
  NumberCoder numbers_;
  std::int64_t miss_ = 256;  // of late, sixteenths
};

}  // namespace lodestone::detail
