#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include "support/catch.h"
#include "support/data.h"
#include "support/program.h"
#include "support/shapes.h"

namespace lodestone::test {
namespace {

/// The program, building what it reads from a pipe. It has made the folder of its report before it reads.
class RunningBuild {
 public:
  explicit RunningBuild(const std::filesystem::path& folder) {
    const std::string output = folder / "ball.glb", report = folder / "made" / "", messages = folder / "messages";
    std::array<int, 2> pipe{};
    REQUIRE(::pipe(pipe.data()) == 0);
    pid_ = ::fork();
    REQUIRE(pid_ >= 0);
    if (pid_ == 0) {
      ::dup2(pipe[0], STDIN_FILENO);
      ::close(pipe[0]);
      ::close(pipe[1]);
      const bool is_told = std::freopen(messages.c_str(), "w", stderr) != nullptr;
      if (is_told)
        ::execl(LODESTONE_PROGRAM, "lodestone", "build", "-", "-o", output.c_str(), "--input-format", "obj", "--quiet",
                "--report", report.c_str(), static_cast<char*>(nullptr));
      ::_exit(126);
    }
    ::close(pipe[0]);
    input_ = pipe[1];
  }
  ~RunningBuild() {
    if (input_ >= 0) ::close(input_);
  }
  RunningBuild(const RunningBuild&) = delete;
  RunningBuild& operator=(const RunningBuild&) = delete;

  void signal(int number) const { CHECK(::kill(pid_, number) == 0); }
  void feed(const std::string& text) {
    std::signal(SIGPIPE, SIG_IGN);  // where the program has ended already
    for (std::size_t written = 0; written < text.size();) {
      const ::ssize_t some = ::write(input_, &text[written], text.size() - written);
      if (some <= 0) break;
      written += static_cast<std::size_t>(some);
    }
    ::close(input_);
    input_ = -1;
  }
  /// Returns what `waitpid` says of its end.
  int end() const {
    int status = 0;
    CHECK(::waitpid(pid_, &status, 0) == pid_);
    return status;
  }

 private:
  ::pid_t pid_ = -1;
  int input_ = -1;
};

std::string obj_text(const Mesh& mesh) {
  std::string text;
  for (const Vec3f& p : mesh.positions)
    text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  for (Index f = 0; f < mesh.face_count(); ++f) {
    text += "f";
    for (Index k = 0; k < 3; ++k) text += " " + std::to_string(mesh.corner_vertex(3 * f + k) + 1);
    text += "\n";
  }
  return text;
}

void wait_for(const std::filesystem::path& path) {
  for (int i = 0; i < 10'000 && !std::filesystem::exists(path); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  REQUIRE(std::filesystem::exists(path));
}

}  // namespace

TEST_CASE("a build that is interrupted leaves nothing behind, and ends by the signal") {
  const std::string ball = obj_text(assemble(icosphere(3, 0.02, 7))->mesh);
  for (const int number : {SIGINT, SIGTERM}) {
    CAPTURE(number);
    const ScratchDirectory folder;
    RunningBuild build(folder.path());
    wait_for(folder / "made");
    build.signal(number);
    build.feed(ball);
    const int status = build.end();
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == number);
    CHECK(names_in(folder.path()) == std::vector<std::string>{"messages"});
    CHECK(file_text(folder / "messages") == "lodestone: error: cancelled\n");
  }
}

TEST_CASE("a build that is interrupted twice ends at once") {
  const ScratchDirectory folder;
  RunningBuild build(folder.path());
  wait_for(folder / "made");
  build.signal(SIGINT);
  std::this_thread::sleep_for(std::chrono::milliseconds(100));  // two at a time may come as one
  build.signal(SIGINT);
  const int status = build.end();
  CHECK(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == SIGINT);
}

TEST_CASE("a build that nobody interrupts reads the same pipe to its end") {
  const ScratchDirectory folder;
  RunningBuild build(folder.path());
  build.feed(obj_text(assemble(icosphere(2, 0.02, 7))->mesh));
  const int status = build.end();
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  CHECK(names_in(folder.path()) == std::vector<std::string>{"ball.glb", "made", "messages"});
  CHECK(names_in(folder / "made").size() == 1);
}

}  // namespace lodestone::test
