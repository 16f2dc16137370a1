#include "codec/bit_coder.h"

namespace lodestone::detail {

int BitCoder::write(int bit, std::uint32_t one) { return BitRun<false>(*this).code(bit, one); }

std::uint32_t BitCoder::code_raw(std::uint32_t value, int count) {
  return is_reading() ? BitRun<true>(*this).code_raw(value, count) : BitRun<false>(*this).code_raw(value, count);
}

void BitCoder::put(std::uint32_t byte) { output_.push_back(static_cast<std::byte>(byte)); }

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
