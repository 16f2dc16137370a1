#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <functional>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "build_command.h"
#include "command.h"
#include "compare_command.h"
#include "extract_command.h"
#include "inspect_command.h"
#include "interruption.h"
#include "messages.h"
#include "words.h"

namespace lodestone::tool {
namespace {

/// Part of the program's interface: scripts branch on these.
enum class ExitCode : int {
  Done = 0,
  Usage = 1,
  InputUnreadable = 2,
  Unsupported = 3,
  NotWritten = 4,
  TargetNotMet = 5,
  Interrupted = 130,  // as shells say of a program that Ctrl-C ended
};

ExitCode exit_code(ErrorCode code) {
  switch (code) {
    case ErrorCode::InvalidArgument:
      return ExitCode::Usage;
    case ErrorCode::Unreadable:
    case ErrorCode::Malformed:
    case ErrorCode::LimitExceeded:
      return ExitCode::InputUnreadable;
    case ErrorCode::Unsupported:
      return ExitCode::Unsupported;
    case ErrorCode::NotWritten:
      return ExitCode::NotWritten;
    case ErrorCode::Cancelled:
      return ExitCode::Interrupted;
  }
  return ExitCode::Usage;
}

ExitCode exit_code(const Result<Outcome>& result) {
  if (result) return *result == Outcome::Done ? ExitCode::Done : ExitCode::TargetNotMet;
  print_error(describe(result.error()));
  return exit_code(result.error().code);
}

/// The commands and what runs each of them.
class Program {
 public:
  Program() {
    app_.set_version_flag("-V,--version", "lodestone " LODESTONE_VERSION);
    app_.footer(
        "Exit codes: 0 done, 1 usage, 2 input unreadable, 3 unsupported, 4 output not written,\n"
        "5 target not met (with --strict), 130 interrupted\n\n"
        "Example:\n"
        "  lodestone bunny.obj bunny.glb        (the same as lodestone build bunny.obj -o bunny.glb)\n"
        "  lodestone extract bunny.glb --error 0.1% -o bunny-near.glb\n"
        "  lodestone simplify bunny.obj bunny-small.obj --ratio 10%");
    add("build", "Turn a mesh file into a progressive multi-LOD .glb or .gltf", build_);
    add("simplify", "Make one file with fewer faces of a mesh or scene", simplify_);
    add("extract", "Take one level out of a .glb's removal stream", extract_);
    add("inspect", "Show the levels, faces, errors and bytes of a file", inspect_);
    add("compare", "Measure how far apart two surfaces are", compare_);
  }

  ExitCode run(int argument_count, const char* const* arguments);

 private:
  template <class Command>
  void add(const char* name, const char* description, Command& command) {
    CLI::App* app = app_.add_subcommand(name, description);
    command.add_to(*app);
    commands_.emplace_back(app, [&command] { return command.run(); });
  }

  void print_usage_error(std::string message) const;
  ExitCode run_command() const;

  CLI::App app_{"Progressive, multi-LOD assets from triangle meshes", "lodestone"};
  BuildCommand build_;
  SimplifyCommand simplify_;
  ExtractCommand extract_;
  InspectCommand inspect_;
  CompareCommand compare_;
  std::vector<std::pair<CLI::App*, std::function<Result<Outcome>()>>> commands_;
};

ExitCode Program::run(int argument_count, const char* const* arguments) {
  Result<std::vector<std::string>> words =
      spell_out(app_, {arguments + std::min(argument_count, 1), arguments + argument_count});
  if (!words) {
    print_error(words.error().message);
    return ExitCode::Usage;
  }
  try {
    std::reverse(words->begin(), words->end());  // as the parser takes them
    app_.parse(std::move(*words));
  } catch (const CLI::ParseError& error) {
    // Help and version are thrown too, with the code 0; only real errors are ours to word.
    if (error.get_exit_code() == 0) {
      app_.exit(error);
      return ExitCode::Done;
    }
    print_usage_error(error.what());
    return ExitCode::Usage;
  }
  return run_command();
}

void Program::print_usage_error(std::string message) const {
  message.front() = static_cast<char>(std::tolower(static_cast<unsigned char>(message.front())));
  std::string help = "lodestone";
  for (const CLI::App* app : app_.get_subcommands()) help += " " + app->get_name();
  print_error(message + "; see " + help + " --help");
}

ExitCode Program::run_command() const {
  for (const auto& [app, run] : commands_) {
    if (app->parsed()) return exit_code(run());
  }
  print_usage_error("no command given");
  return ExitCode::Usage;
}

/// Standard output is buffered: a full disk shows only now.
ExitCode finish_output(ExitCode code) {
  if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) return code;
  print_error(std::string("standard output: ") + std::strerror(errno));
  return code == ExitCode::Done ? ExitCode::NotWritten : code;
}

ExitCode guarded_main(int argument_count, const char* const* arguments) {
  try {
    Program program;
    return finish_output(program.run(argument_count, arguments));
  } catch (const std::bad_alloc&) {
    print_error("out of memory");
  } catch (const std::exception& error) {
    print_error(std::string("internal error: ") + error.what());
  }
  return ExitCode::InputUnreadable;
}

}  // namespace
}  // namespace lodestone::tool

int main(int argc, char** argv) {
  const lodestone::tool::ExitCode code = lodestone::tool::guarded_main(argc, argv);
  if (code == lodestone::tool::ExitCode::Interrupted) lodestone::tool::end_as_asked();
  return static_cast<int>(code);
}
