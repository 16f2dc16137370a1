#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#ifndef LODESTONE_RUNTIME_ONLY
#define LODESTONE_RUNTIME_ONLY 0
#endif

namespace lodestone::detail {

/// Hears from a writer that it is at work; false ends that.
class WorkListener {
 public:
  virtual ~WorkListener() = default;
  virtual bool step() = 0;
};

/// A binary range coder. One class writes and reads, so that what models the bits is written once: `code` takes the bit
/// when it writes, and gives it when it reads.
class BitCoder {
 public:
  /// Writes; `is_fast`: by the models of CompactCoding::Fast.
  explicit BitCoder(bool is_fast) : is_fast_(is_fast) {}
  /// Reads.
  BitCoder(std::span<const std::byte> bytes, bool is_fast) : is_fast_(is_fast), reading_(true), input_(bytes) {
    for (int i = 0; i < 4; ++i) code_ = code_ << 8U | next_byte();
  }

  /// Whether it reads: nothing else where there is no encoder, so that compilers leave writing out.
  bool is_reading() const { return LODESTONE_RUNTIME_ONLY != 0 || reading_; }
  /// Which models numbers are coded by.
  bool is_fast() const { return is_fast_; }

  /// Codes a bit that is 1 with probability `one` / 65536, `one` in 1 … 65535.
  int code(int bit, std::uint32_t one);

  /// Codes the low `count` bits of a value, both values of each as likely.
  std::uint32_t code_raw(std::uint32_t value, int count);

  /// Ends writing with the fewest bytes that a reader, who takes zeros for what is missing, needs.
  std::vector<std::byte> finish();

  /// How many bits have been written or read, as a real number: for reports alone.
  double bits() const {
    const std::size_t done = reading_ ? read_ - 4 : output_.size();
    return 8 * static_cast<double>(done) + 32 - std::log2(static_cast<double>(high_ - low_) + 1);
  }

  /// Sets who hears of a writer's steps; nobody with null.
  void set_listener(WorkListener* listener) { listener_ = listener; }
  /// Whether the work goes on: asked for every vertex and face, so that it ends soon.
  bool goes_on() const { return LODESTONE_RUNTIME_ONLY != 0 || listener_ == nullptr || listener_->step(); }

 private:
  template <bool kReads>
  friend class BitRun;

  int write(int bit, std::uint32_t one);
  void put(std::uint32_t byte);
  std::uint32_t next_byte() {
    const std::size_t at = read_++;
    return at < input_.size() ? static_cast<std::uint32_t>(input_[at]) : 0;
  }

  bool is_fast_;
  std::uint32_t low_ = 0;
  std::uint32_t high_ = 0xFFFFFFFFU;
  std::uint32_t code_ = 0;
  bool reading_ = false;
  std::span<const std::byte> input_;
  std::size_t read_ = 0;
  std::vector<std::byte> output_;
  WorkListener* listener_ = nullptr;
};

/// Codes bits one after the other, with what the coder is at hand in registers; the coder has it again when this ends,
/// and codes nothing until then. Pre: the coder reads, or writes, as this does.
template <bool kReads>
class BitRun {
 public:
  explicit BitRun(BitCoder& coder) : coder_(coder), low_(coder.low_), high_(coder.high_), code_(coder.code_) {}
  BitRun(const BitRun&) = delete;
  BitRun& operator=(const BitRun&) = delete;
  ~BitRun() {
    coder_.low_ = low_;
    coder_.high_ = high_;
    coder_.code_ = code_;
  }

  /// As BitCoder::code.
  int code(int bit, std::uint32_t one) {
    const std::uint32_t middle = low_ + static_cast<std::uint32_t>(std::uint64_t{high_ - low_} * one >> 16U);
    if (kReads) bit = code_ <= middle ? 1 : 0;
    if (bit != 0)
      high_ = middle;
    else
      low_ = middle + 1;
    while (((low_ ^ high_) >> 24U) == 0) shift();
    return bit;
  }
  /// As BitCoder::code_raw.
  std::uint32_t code_raw(std::uint32_t value, int count) {
    std::uint32_t result = 0;
    while (count-- > 0) result = result << 1U | code_even(value >> count & 1U);
    return result;
  }

 private:
  /// The same as `code` of a bit that nobody can foretell: without a branch on it.
  std::uint32_t code_even(std::uint32_t bit) {
    const std::uint32_t middle = low_ + ((high_ - low_) >> 1U);
    if (kReads) bit = code_ <= middle ? 1 : 0;
    const std::uint32_t is_upper = 0U - bit;  // all bits where the bit is 1
    high_ = (middle & is_upper) | (high_ & ~is_upper);
    low_ = (low_ & is_upper) | ((middle + 1) & ~is_upper);
    while (((low_ ^ high_) >> 24U) == 0) shift();
    return bit;
  }
  void shift() {
    if (kReads)
      code_ = code_ << 8U | coder_.next_byte();
    else
      coder_.put(high_ >> 24U);
    low_ <<= 8U;
    high_ = high_ << 8U | 255U;
  }

  BitCoder& coder_;
  std::uint32_t low_, high_, code_;
};

inline int BitCoder::code(int bit, std::uint32_t one) {
  return is_reading() ? BitRun<true>(*this).code(bit, one) : write(bit, one);
}

}  // namespace lodestone::detail
