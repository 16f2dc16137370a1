#pragma once

namespace lodestone::tool {

/// While it lives, the first Ctrl-C (or SIGTERM) only asks for an end, so that nothing half done is left behind; the
/// second one ends the program at once, as ever. One at a time.
class Interruption {
 public:
  Interruption();
  ~Interruption();
  Interruption(const Interruption&) = delete;
  Interruption& operator=(const Interruption&) = delete;

  /// Whether an end was asked for.
  static bool is_wanted();
};

/// Ends the program by the signal that asked for it, as whoever sent it expects; returns where there was none.
void end_as_asked();

}  // namespace lodestone::tool
