#pragma once

namespace lodestone::bench {

/// Time that something took.
struct Seconds {
  double cpu = 0;   ///< of this process, all threads together
  double wall = 0;  ///< by the clock
};

inline Seconds operator+(const Seconds& a, const Seconds& b) { return {a.cpu + b.cpu, a.wall + b.wall}; }
inline Seconds operator-(const Seconds& a, const Seconds& b) { return {a.cpu - b.cpu, a.wall - b.wall}; }

/// Runs from when it is made.
class Clock {
 public:
  Clock();
  Seconds seconds() const;  ///< since then

 private:
  Seconds start_;
};

}  // namespace lodestone::bench
