#include "child.h"

#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <cstdlib>

namespace lodestone::bench {
namespace {

[[noreturn]] void serve(int output, const std::function<std::string()>& work) {
  const std::string bytes = work();
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = write(output, bytes.data() + sent, bytes.size() - sent);
    if (count < 0) _exit(1);
    sent += static_cast<std::size_t>(count);
  }
  _exit(0);
}

std::string read_all(int input) {
  std::string bytes;
  std::array<char, 1 << 16> block;
  for (ssize_t count = 0; (count = read(input, block.data(), block.size())) > 0;)
    bytes.append(block.data(), static_cast<std::size_t>(count));
  return bytes;
}

}  // namespace

std::optional<std::string> in_child(const std::function<std::string()>& work) {
  std::fflush(nullptr);  // else both would write what waits
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) return std::nullopt;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    serve(ends[1], work);
  }
  close(ends[1]);
  std::string bytes = child < 0 ? std::string() : read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || status != 0) return std::nullopt;
  return bytes;
}

}  // namespace lodestone::bench
