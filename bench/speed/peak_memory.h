#pragma once

#include <cstdint>
#include <optional>

namespace lodestone::bench {

/// Measures the most memory that the process holds at any time from here on, beyond what it holds now.
class PeakMemory {
 public:
  /// Gives freed memory back to the system and restarts the system's count.
  PeakMemory();
  /// Returns bytes; nothing where the system does not tell.
  std::optional<std::uint64_t> bytes() const;

 private:
  std::optional<std::uint64_t> before_;
};

}  // namespace lodestone::bench
