#include "standard_streams.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#if __has_include(<unistd.h>)
#include <unistd.h>
#endif

#include <lodestone/io/file.h>

namespace lodestone::tool {

bool is_standard_stream(const std::filesystem::path& path) {
  return path == "-" || path == "/dev/stdin" || path == "/dev/stdout";
}

Result<std::vector<std::byte>> read_standard_input() {
  return read_file("/dev/stdin").map_error([](Error error) {
    error.message = "standard input: " + error.message;
    return error;
  });
}

Result<void> write_standard_output(std::span<const std::byte> bytes) {
  const bool written = std::fwrite(bytes.data(), 1, bytes.size(), stdout) == bytes.size() && std::fflush(stdout) == 0;
  if (written) return {};
  return fail(ErrorCode::NotWritten, std::string("standard output: ") + std::strerror(errno));
}

bool standard_output_is_terminal() {
#if __has_include(<unistd.h>)
  return isatty(STDOUT_FILENO) == 1;
#else
  return false;
#endif
}

}  // namespace lodestone::tool
