#include "interruption.h"

#include <csignal>
#include <initializer_list>

namespace lodestone::tool {
namespace {

// A handler reaches nothing else.
volatile std::sig_atomic_t asked_by = 0;

extern "C" void note_signal(int signal) {
  asked_by = signal;
  std::signal(signal, SIG_DFL);
}

/// What is ignored, as under nohup, stays so.
void handle_by(void (*handler)(int)) {
  for (const int signal : {SIGINT, SIGTERM})
    if (std::signal(signal, handler) == SIG_IGN) std::signal(signal, SIG_IGN);
}

}  // namespace

Interruption::Interruption() { handle_by(note_signal); }

Interruption::~Interruption() { handle_by(SIG_DFL); }

bool Interruption::is_wanted() { return asked_by != 0; }

void end_as_asked() {
  if (asked_by == 0) return;
  std::signal(asked_by, SIG_DFL);
  std::raise(asked_by);
}

}  // namespace lodestone::tool
