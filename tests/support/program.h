#pragma once

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "support/data.h"

namespace lodestone::test {

/// What a run of the program left behind.
struct ProgramRun {
  int exit_code = -1;  ///< −1 where a signal ended it
  std::string out;
  std::string err;
};

/// Returns a file's bytes; nothing where there is no such file.
inline std::string file_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

/// Quotes a word for the shell.
inline std::string quoted(const std::string& word) {
  std::string out(1, '\'');
  for (const char c : word) out.append(c == '\'' ? std::string("'\\''") : std::string(1, c));
  return out.append(1, '\'');
}

/// Runs the lodestone program under test, without a terminal; `input` is what its standard input reads, and
/// `memory_limit`, in bytes, what it may ask the system for.
inline ProgramRun run_program(const std::vector<std::string>& arguments,
                              const std::filesystem::path& input = "/dev/null",
                              std::optional<std::size_t> memory_limit = {}) {
  const ScratchDirectory scratch;
  std::string command;
  if (memory_limit) command = "ulimit -v " + std::to_string(*memory_limit / 1024) + "; ";
  command += quoted(LODESTONE_PROGRAM);
  for (const std::string& argument : arguments) command.append(" ").append(quoted(argument));
  command.append(" <").append(quoted(input.string())).append(" >").append(quoted((scratch / "out").string()));
  command.append(" 2>").append(quoted((scratch / "err").string()));
  const int status = std::system(command.c_str());
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, file_text(scratch / "out"), file_text(scratch / "err")};
}

/// Returns the names in a folder, sorted: what a run created, and that it left no temporary files.
inline std::vector<std::string> names_in(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace lodestone::test
