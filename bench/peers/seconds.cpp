#include "seconds.h"

#include <ctime>

namespace lodestone::bench {
namespace {

double reading_of(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Seconds now() { return {reading_of(CLOCK_PROCESS_CPUTIME_ID), reading_of(CLOCK_MONOTONIC)}; }

}  // namespace

Clock::Clock() : start_(now()) {}
Seconds Clock::seconds() const { return now() - start_; }

}  // namespace lodestone::bench
