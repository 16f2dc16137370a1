#pragma once

#include <chrono>

namespace lodestone::detail {

/// Wall-clock time, lap by lap.
class Stopwatch {
 public:
  /// Returns the milliseconds since the last lap, or since construction.
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    const std::chrono::duration<double, std::milli> lap = now - last_;
    last_ = now;
    return lap.count();
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace lodestone::detail
