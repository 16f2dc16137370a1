#include "peak_memory.h"

#include <malloc.h>

#include <fstream>
#include <string>

namespace lodestone::bench {
namespace {

/// Returns a field of /proc/self/status that is in kB, as bytes.
std::optional<std::uint64_t> status_bytes(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind(field + ":", 0) == 0) return std::stoull(line.substr(field.size() + 1)) * 1024;
  }
  return std::nullopt;
}

/// Sets the peak to what is held now; returns false where the system does not let us.
bool reset_peak() {
  std::ofstream clear("/proc/self/clear_refs");
  clear << 5 << std::flush;
  return clear.good();
}

}  // namespace

PeakMemory::PeakMemory() {
  malloc_trim(0);
  if (reset_peak()) before_ = status_bytes("VmRSS");
}

std::optional<std::uint64_t> PeakMemory::bytes() const {
  const auto peak = status_bytes("VmHWM");
  if (!before_ || !peak || *peak < *before_) return std::nullopt;
  return *peak - *before_;
}

}  // namespace lodestone::bench
