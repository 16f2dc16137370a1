#pragma once

namespace lodestone {

/// How much work a result is worth, as compressors have it: from 1, the fastest, to 9, the best there is. Results are
/// the same each time at each effort, and what they say of their errors is true at each: a bound is proved, but at a
/// small effort it may be the less tight, and a mean is of fewer samples.
///
/// What each step does with it is one table beside that step, and all of them together are in bench/README.md:
/// simplifying charges less for a removal (removal_cost.cpp), fitting moves fewer levels less often by fewer samples
/// (placement.cpp), and a build measures less closely and codes its streams faster (build_effort.h).
inline constexpr int kLeastEffort = 1;
inline constexpr int kDefaultEffort = 5;
inline constexpr int kMostEffort = 9;

}  // namespace lodestone
