#pragma once

#include <array>
#include <vector>

#include "codec/attribute_coder.h"

namespace lodestone::detail {

/// Codes elements component by component, each from its mean over the ring.
class PlainElementCoder final : public ElementCoder {
 public:
  explicit PlainElementCoder(const AttributeSpec& spec);

 protected:
  bool code_element(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers) override;
  void pass(const ElementPlace&) override {}

 private:
  bool code_alone(BitCoder& coder, const ElementPlace& place, std::span<std::int32_t> numbers);

  NumberCoder numbers_, alone_;
  std::vector<std::int64_t> misses_;  // by component: how far predictions were off of late, in sixteenths
};

}  // namespace lodestone::detail
