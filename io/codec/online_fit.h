#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "codec/fixed_point.h"

namespace lodestone::detail {

/// Least squares that are learnt sample by sample, in whole numbers: a target is taken for a weighted sum of features.
template <int N>
class OnlineFit {
 public:
  static constexpr int kFraction = 12;  ///< bits of the weights
  using Features = std::array<std::int64_t, N>;

  /// The weights to begin with count as much as samples of `trust` squared features would.
  OnlineFit(const std::array<std::int32_t, N>& weights, std::int64_t trust)
      : weights_(weights), prior_(weights), trust_(trust) {}

  std::int64_t predict(const Features& features) const {
    std::int64_t sum = 0;
    for (int i = 0; i < N; ++i) sum += weights_[i] * features[i];
    return (sum + (1 << (kFraction - 1))) >> kFraction;
  }

  /// Adds one equation. Magnitudes are cut at 4096.
  void add(const Features& features, std::int64_t target) {
    Features f;
    for (int i = 0; i < N; ++i) f[i] = cut(features[i]);
    const std::int64_t t = cut(target);
    for (int i = 0; i < N; ++i) {
      for (int j = 0; j <= i; ++j) products_[i][j] += f[i] * f[j];
      targets_[i] += f[i] * t;
    }
  }
  /// Ends a sample of one or more equations; solves now and then.
  void end_sample() {
    if (++samples_ % kSolveEach != 0 && samples_ > kSolveEach) return;
    if (samples_ >= kForget) {
      samples_ /= 2;
      for (int i = 0; i < N; ++i) {
        for (int j = 0; j <= i; ++j) products_[i][j] /= 2;
        targets_[i] /= 2;
      }
    }
    solve();
  }

 private:
  static constexpr std::int64_t kCut = 4096;
  static constexpr int kSolveEach = 16;
  static constexpr int kForget = 8192;
  static constexpr int kSweeps = 3;
  static constexpr std::int32_t kMostWeight = 16 << kFraction;

  static std::int64_t cut(std::int64_t x) { return std::clamp(x, -kCut, kCut); }

  /// Sweeps of Gauss and Seidel from the last solution. Sums are below 2^24 · 2^14 = 2^38, weights below 2^17.
  void solve() {
    for (int sweep = 0; sweep < kSweeps; ++sweep)
      for (int i = 0; i < N; ++i) {
        std::int64_t rest = (targets_[i] << kFraction) + trust_ * prior_[i];
        for (int j = 0; j < N; ++j)
          if (j != i) rest -= (j < i ? products_[i][j] : products_[j][i]) * weights_[j];
        const std::int64_t weight = rest / (products_[i][i] + trust_);
        weights_[i] = static_cast<std::int32_t>(std::clamp<std::int64_t>(weight, -kMostWeight, kMostWeight));
      }
  }

  std::array<std::int32_t, N> weights_;
  std::array<std::int32_t, N> prior_;
  std::int64_t trust_;
  std::array<std::array<std::int64_t, N>, N> products_{};
  std::array<std::int64_t, N> targets_{};
  int samples_ = 0;
};

/// Weights to begin with.
inline constexpr int kWholeWeight = 1 << OnlineFit<1>::kFraction;
inline constexpr int kHalfWeight = kWholeWeight / 2, kQuarterWeight = kHalfWeight / 2;

}  // namespace lodestone::detail
