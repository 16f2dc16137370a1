#include "process_memory.h"

#if __has_include(<sys/resource.h>)
#include <sys/resource.h>
#endif

namespace lodestone::tool {

std::uint64_t peak_memory_bytes() {
#if __has_include(<sys/resource.h>)
  rusage usage{};
  if (getrusage(RUSAGE_SELF, &usage) != 0) return 0;
  const auto peak = static_cast<std::uint64_t>(usage.ru_maxrss);
#ifdef __APPLE__
  return peak;  // bytes there, kibibytes everywhere else
#else
  return peak * 1024;
#endif
#else
  return 0;
#endif
}

}  // namespace lodestone::tool
