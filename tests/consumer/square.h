#pragma once

#include <lodestone/core/assemble.h>

inline constexpr lodestone::Index kSide = 8;

/// A bent square of kSide × kSide squares.
inline lodestone::TriangleSoup square_soup() {
  lodestone::TriangleSoup soup;
  for (lodestone::Index j = 0; j <= kSide; ++j) {
    for (lodestone::Index i = 0; i <= kSide; ++i) {
      soup.positions.push_back({static_cast<float>(i), static_cast<float>(j), static_cast<float>(i * j) * 0.01f});
    }
  }
  for (lodestone::Index j = 0; j < kSide; ++j) {
    for (lodestone::Index i = 0; i < kSide; ++i) {
      const lodestone::Index a = j * (kSide + 1) + i, b = a + 1, c = b + kSide + 1, d = c - 1;
      soup.indices.insert(soup.indices.end(), {a, b, c, a, c, d});
    }
  }
  return soup;
}
