#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace lodestone::detail {

/// Eight numbers of 16 bits: one vector register where there are such. Every machine finds the same.
class Lanes {
 public:
  static constexpr int kCount = 8;

#if defined(__SSE2__)
  /// The numbers, then zeros.
  template <class... Numbers>
  explicit Lanes(Numbers... numbers) : v_(of(std::array<std::int16_t, kCount>{numbers...})) {}

  /// The sum of the products.
  friend std::int32_t dot(const Lanes& a, const Lanes& b) {
    __m128i sums = _mm_madd_epi16(a.v_, b.v_);
    sums = _mm_add_epi32(sums, _mm_shuffle_epi32(sums, _MM_SHUFFLE(1, 0, 3, 2)));
    sums = _mm_add_epi32(sums, _mm_shuffle_epi32(sums, _MM_SHUFFLE(2, 3, 0, 1)));
    return _mm_cvtsi128_si32(sums);
  }
  /// Adds `other` times a number / 2^16, rounded to nearest, halves up; what goes beyond 16 bits is cut.
  void add_product(const Lanes& other, std::int16_t factor) {
    const __m128i f = _mm_set1_epi16(factor);
    const __m128i round = _mm_srli_epi16(_mm_mullo_epi16(other.v_, f), 15);
    v_ = _mm_adds_epi16(v_, _mm_add_epi16(_mm_mulhi_epi16(other.v_, f), round));
  }

 private:
  static __m128i of(const std::array<std::int16_t, kCount>& a) {
    return _mm_set_epi16(a[7], a[6], a[5], a[4], a[3], a[2], a[1], a[0]);
  }
  __m128i v_;
#else
  template <class... Numbers>
  explicit Lanes(Numbers... numbers) : v_{numbers...} {}

  friend std::int32_t dot(const Lanes& a, const Lanes& b) {
    std::int32_t sum = 0;
    for (int i = 0; i < kCount; ++i) sum += std::int32_t{a.v_[i]} * b.v_[i];
    return sum;
  }
  void add_product(const Lanes& other, std::int16_t factor) {
    for (int i = 0; i < kCount; ++i) {
      const std::int32_t product = (std::int32_t{other.v_[i]} * factor + (1 << 15)) >> 16;
      v_[i] = static_cast<std::int16_t>(std::clamp<std::int32_t>(v_[i] + product, INT16_MIN, INT16_MAX));
    }
  }

 private:
  std::array<std::int16_t, kCount> v_;
#endif
};

}  // namespace lodestone::detail
