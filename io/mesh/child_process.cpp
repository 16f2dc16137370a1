#include "mesh/child_process.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include <lodestone/core/detail/text.h>

#include "base/bytes.h"
#include "mesh/soup_file.h"

namespace lodestone::detail {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kWallTimePerProcessorTime = 10;  // ends a child that waits for what never comes
constexpr std::size_t kMebibyte = std::size_t{1} << 20;
constexpr std::byte kDone{0};  // the first byte of an answer; else it is 1 + the code of an error, its message behind

std::string limits_text(const ChildLimits& limits) {
  return text("it takes more than ", limits.processor_time.count(), " s or ", limits.memory_bytes / kMebibyte, " MiB");
}

/// Returns the bytes of address space that this process has.
std::size_t address_space() {
  std::size_t pages = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%zu", &pages) != 1) pages = 0;
    std::fclose(file);
  }
  return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

void limit(int resource, rlim_t most) {
  rlimit value{};
  if (::getrlimit(static_cast<__rlimit_resource_t>(resource), &value) != 0) return;
  value.rlim_cur = std::min(value.rlim_max, most);
  ::setrlimit(static_cast<__rlimit_resource_t>(resource), &value);
}

/// What a crash has to say would only be in the way of the parent's message.
void silence() {
  const int nowhere = ::open("/dev/null", O_WRONLY | O_CLOEXEC);
  if (nowhere < 0) return;
  ::dup2(nowhere, STDOUT_FILENO);
  ::dup2(nowhere, STDERR_FILENO);
}

void apply(const ChildLimits& limits) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  for (const int signal : {SIGXCPU, SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGTERM, SIGINT})
    ::signal(signal, SIG_DFL);
  limit(RLIMIT_CORE, 0);
  limit(RLIMIT_CPU, static_cast<rlim_t>(limits.processor_time.count()));
  limit(RLIMIT_AS, address_space() + limits.memory_bytes);
  silence();
}

void write_all(int fd, const std::byte* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t count = ::write(fd, bytes, size);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return;
    bytes += count;
    size -= static_cast<std::size_t>(count);
  }
}

Result<std::vector<std::byte>> guarded(const std::function<Result<std::vector<std::byte>>()>& work,
                                       const ChildLimits& limits) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::LimitExceeded, limits_text(limits));
  } catch (const std::exception& error) {
    return fail(ErrorCode::Malformed, error.what());
  }
}

/// The child's whole life. No destructor of the parent's objects and no handler of its end may run here.
[[noreturn]] void live(int fd, const std::function<Result<std::vector<std::byte>>()>& work, const ChildLimits& limits) {
  apply(limits);
  const auto made = guarded(work, limits);
  const std::byte code = made ? kDone : static_cast<std::byte>(1 + static_cast<int>(made.error().code));
  write_all(fd, &code, 1);
  if (made)
    write_all(fd, made->data(), made->size());
  else
    write_all(fd, std::as_bytes(std::span(made.error().message)).data(), made.error().message.size());
  ::_exit(0);
}

/// Reads until the child closes its end; false where that takes longer or is more than it may.
bool read_answer(int fd, const ChildLimits& limits, std::vector<std::byte>& answer) {
  const auto end = Clock::now() + kWallTimePerProcessorTime * limits.processor_time;
  std::array<std::byte, 1 << 16> block;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now()).count();
    if (left <= 0 || answer.size() > limits.memory_bytes) return false;
    pollfd waiting{fd, POLLIN, 0};
    if (::poll(&waiting, 1, static_cast<int>(std::min<long long>(left, 1000))) <= 0) continue;
    const ssize_t count = ::read(fd, block.data(), block.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count == 0;
    answer.insert(answer.end(), block.begin(), block.begin() + count);
  }
}

Result<std::vector<std::byte>> result_of(std::vector<std::byte> answer, int status, const ChildLimits& limits) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    if (signal == SIGXCPU || signal == SIGKILL) return fail(ErrorCode::LimitExceeded, limits_text(limits));
    return fail(ErrorCode::Malformed, text("reading it ends with signal ", signal, " (", ::strsignal(signal), ")"));
  }
  if (answer.empty()) return fail(ErrorCode::Malformed, "reading it ends without a result");
  const std::byte code = answer[0];
  answer.erase(answer.begin());
  if (code == kDone) return answer;
  return fail(static_cast<ErrorCode>(std::to_integer<int>(code) - 1), std::string(as_text(answer)));
}

}  // namespace

Result<std::vector<std::byte>> run_in_child(const std::function<Result<std::vector<std::byte>>()>& work,
                                            const ChildLimits& limits) {
  std::array<int, 2> ends{};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return fail(ErrorCode::Unreadable, text("no pipe: ", std::strerror(errno)));
  const pid_t child = ::fork();
  if (child == 0) live(ends[1], work, limits);
  ::close(ends[1]);
  std::vector<std::byte> answer;
  const bool ended = child > 0 && read_answer(ends[0], limits, answer);
  ::close(ends[0]);
  if (child < 0) return fail(ErrorCode::Unreadable, text("no process: ", std::strerror(errno)));
  if (!ended) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) continue;
  return result_of(std::move(answer), status, limits);
}

}  // namespace lodestone::detail
