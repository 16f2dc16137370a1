#pragma once

#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <string>
#include <vector>

namespace lodestone::test {

/// Runs the lodestone program under test on a terminal of its own and returns all that it shows there.
inline std::string shown_on_terminal(const std::vector<std::string>& arguments) {
  std::vector<char*> words{const_cast<char*>(LODESTONE_PROGRAM)};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) {
    setenv("TERM", "xterm", 1);
    execv(LODESTONE_PROGRAM, words.data());
    _exit(127);
  }
  std::string shown;
  char block[4096];
  for (ssize_t count; child > 0 && (count = read(terminal, block, sizeof block)) > 0;)
    shown.append(block, static_cast<std::size_t>(count));
  close(terminal);
  waitpid(child, nullptr, 0);
  return shown;
}

}  // namespace lodestone::test
