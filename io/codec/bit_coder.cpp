#include "codec/bit_coder.h"

namespace lodestone::detail {

/// The same as `code` of a bit that nobody can foretell: without a branch on it.
std::uint32_t BitCoder::code_even(std::uint32_t bit) {
  const std::uint32_t range = high_ - low_;
  const std::uint32_t middle = low_ + ((range >> 16U) << 15U) + (((range & 0xFFFFU) << 15U) >> 16U);
  if (reading_) bit = code_ <= middle ? 1 : 0;
  const std::uint32_t is_upper = 0U - bit;  // all bits where the bit is 1
  high_ = (middle & is_upper) | (high_ & ~is_upper);
  low_ = (low_ & is_upper) | ((middle + 1) & ~is_upper);
  while (((low_ ^ high_) >> 24U) == 0) shift();
  return bit;
}

std::uint32_t BitCoder::code_raw(std::uint32_t value, int count) {
  std::uint32_t result = 0;
  while (count-- > 0) result = result << 1U | code_even(value >> count & 1U);
  return result;
}

std::vector<std::byte> BitCoder::finish() {
  for (int kept = 1; kept <= 4; ++kept) {
    const std::uint32_t mask = kept == 4 ? 0 : 0xFFFFFFFFU >> (8 * kept);
    const std::uint32_t value = (low_ + mask) & ~mask;
    if (value < low_ || value > high_) continue;  // wrapped around, or beyond
    for (int i = 0; i < kept; ++i) output_.push_back(static_cast<std::byte>(value >> (24 - 8 * i)));
    break;
  }
  while (!output_.empty() && output_.back() == std::byte{0}) output_.pop_back();
  return std::move(output_);
}

}  // namespace lodestone::detail
