#pragma once

namespace lodestone {

/// How much work a result is worth, as compressors have it: from 1, the fastest, to 9, the best there is. What each
/// step does with it stands beside that step; results are the same each time at each effort.
inline constexpr int kLeastEffort = 1;
inline constexpr int kDefaultEffort = 5;
inline constexpr int kMostEffort = 9;

}  // namespace lodestone
