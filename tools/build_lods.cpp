#include "build_lods.h"

#include <array>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/compact_stream.h>
#include <lodestone/io/file.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/lod/simplify.h>

#include "build_options.h"
#include "input_files.h"
#include "interruption.h"
#include "messages.h"
#include "staged_file.h"
#include "standard_streams.h"

namespace lodestone::tool {
namespace {

using detail::text;

/// The shares of the time; the rest is encoding.
constexpr double kReadingShare = 0.05, kSimplifyingShare = 0.8;

/// Options of files with levels, which a stream has none of, or that streams have nothing for yet.
Result<void> check_options(const BuildCommand& command) {
  struct Given {
    bool given;
    const char* name;
    const char* why;
  };
  const char* const every_level = "a .lods has every level";
  const char* const not_yet = "a .lods does not have it yet";
  const std::array given = {
      Given{command.level_count.has_value(), "--levels", every_level},
      Given{command.per_mesh, "--per-mesh", every_level},
      Given{command.profile != "msft-lod", "--profile", "a .lods is one file"},
      Given{command.no_stream, "--no-stream", "a .lods is a stream"},
      Given{command.compression != "draco", "--compress", "a .lods is compressed in its own way"},
      Given{command.placement != "optimised", "--placement", "the vertices of a .lods are those of the input"},
      Given{command.grid_step.has_value(), "--grid-step", not_yet},
      Given{command.settings.has_value(), "--settings", not_yet},
      Given{!command.importance.empty(), "--importance", not_yet},
      Given{command.report.has_value(), "--report", not_yet},
      Given{command.html.has_value(), "--html", not_yet}};
  for (const Given& option : given)
    if (option.given) return fail(ErrorCode::InvalidArgument, text(option.name, ": ", option.why));
  LODESTONE_TRY(const std::vector<LevelTarget> targets, command.targets.parse());
  if (!targets.empty())
    return fail(ErrorCode::InvalidArgument, text("--ratio, --faces, --error and --epsilon: ", every_level));
  return {};
}

Result<void> check_output(const BuildCommand& command) {
  if (is_standard_stream(command.output)) {
    if (standard_output_is_terminal())
      return fail(ErrorCode::InvalidArgument, "-o: the standard output is a terminal: send it to a file or a program");
    return {};
  }
  return check_destination(command.output);
}

Result<Mesh> read_input(const BuildCommand& command) {
  LODESTONE_TRY(MeshFile file, read_mesh_file(command.input, command.input_format));
  std::vector<std::string> remarks = std::move(file.notes);
  for (std::string& line : sentences(file.assembly)) remarks.push_back(std::move(line));
  for (const std::string& line : remarks) print_warning(quoted(command.input) + ": " + line);
  if (file.mesh.face_count() == 0)
    return fail(ErrorCode::Malformed, quoted(command.input) + ": no triangles to simplify");
  return std::move(file.mesh);
}

void print_summary(const BuildCommand& command, const ProgressiveMesh& mesh, const CompactStream& stream) {
  const std::vector<Index> faces = face_counts(mesh);
  std::printf("%s: %u faces, %zu vertices; base mesh %u faces; %zu bytes, %.2f bits a vertex\n", command.output.c_str(),
              faces.back(), mesh.vertex_count(), faces.front(), stream.bytes.size(),
              8 * static_cast<double>(stream.bytes.size()) / static_cast<double>(mesh.vertex_count()));
}

}  // namespace

bool writes_stream_file(const BuildCommand& command) {
  return is_standard_stream(command.output) ? command.format == "lods" : extension_of(command.output) == "lods";
}

Result<Outcome> build_stream_file(const BuildCommand& command, ProgressBar& bar) {
  LODESTONE_CHECK(check_options(command));
  LODESTONE_TRY(BuildOptions options, build_options(command));
  LODESTONE_CHECK(check_output(command));
  bar.update("reading", 0);
  LODESTONE_TRY(const Mesh mesh, read_input(command));

  options.simplify.effort = command.effort;
  options.simplify.dense_rounds = kStreamDenseRounds;
  options.simplify.progress = [&](double done) {
    bar.update("simplifying", kReadingShare + kSimplifyingShare * done);
    return !Interruption::is_wanted();
  };
  LODESTONE_TRY(const SimplifyResult simplified, simplify(mesh, options.simplify));
  CompactOptions compact;
  compact.grid_bits = command.position_bits.value_or(compact.grid_bits);
  compact.progress = [&](double done) {
    bar.update("encoding", kReadingShare + kSimplifyingShare + (1 - kReadingShare - kSimplifyingShare) * done);
    return !Interruption::is_wanted();
  };
  LODESTONE_TRY(const CompactStream stream, encode_compact(simplified.mesh, compact));
  bar.clear();
  if (Interruption::is_wanted()) return fail(ErrorCode::Cancelled, "cancelled");
  print_warning("the format of .lods is a draft: a later version may not read this one");
  StagedFiles files;
  LODESTONE_CHECK(files.add(command.output, stream.bytes));
  LODESTONE_CHECK(files.commit());
  if (!command.quiet && !is_standard_stream(command.output)) print_summary(command, simplified.mesh, stream);
  return Outcome::Done;
}

}  // namespace lodestone::tool
