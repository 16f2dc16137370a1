#include "extract_command.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <system_error>

#include <CLI/CLI.hpp>

#include <lodestone/io/asset.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/io/write_mesh.h>
#include <lodestone/lod/cursor.h>

#include "messages.h"
#include "staged_file.h"
#include "text_table.h"

namespace lodestone::tool {
namespace {

constexpr std::array kExtensions = {".glb", ".obj", ".ply"};

Result<void> check_paths(const ExtractCommand& options) {
  const std::string extension = options.output.extension().string();
  if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end()) {
    return fail(ErrorCode::InvalidArgument, "-o: " + quoted(options.output) + " does not end in .glb, .obj or .ply");
  }
  std::error_code ignored;
  if (std::filesystem::equivalent(options.input, options.output, ignored)) {
    return fail(ErrorCode::InvalidArgument, "-o: " + quoted(options.output) + " is the input");
  }
  return check_destination(options.output);
}

Result<LevelTarget> requested_target(const TargetOptions& options) {
  const Result<std::vector<LevelTarget>> targets = options.parse();
  if (!targets) return tl::unexpected(targets.error());
  if (targets->size() != 1) {
    return fail(ErrorCode::InvalidArgument, "give one value with one of --error, --epsilon, --faces, --ratio");
  }
  return targets->front();
}

Result<ProgressiveMesh> read_stream(const std::filesystem::path& path) {
  const Result<std::vector<std::byte>> bytes = read_asset_stream(path);
  if (!bytes) return tl::unexpected(bytes.error());
  return decode_stream(*bytes).map_error([&](Error error) {
    error.message = quoted(path) + ": " + error.message;
    return error;
  });
}

FullSize full_size(const ProgressiveMesh& mesh, Cursor& cursor) {
  cursor.seek(static_cast<Index>(mesh.record_count()));
  return {cursor.face_count(), bounding_box(extract_level(mesh, cursor)).diagonal()};
}

std::string missed_message(std::size_t face_count, const LevelTarget& target) {
  return std::to_string(face_count) + " faces are the fewest the stream has, " +
         std::to_string(static_cast<std::uint64_t>(target.value)) + " were asked for";
}

}  // namespace

void ExtractCommand::add_to(CLI::App& app) {
  app.add_option("-i,--input,IN", input, "A .glb that lodestone build wrote, with its stream")
      ->required()
      ->type_name("FILE");
  app.add_option("-o,--output", output, "The .glb, .obj or .ply to write")->required()->type_name("OUT");
  target.add_to(app, "Target: one of these", false);
  app.add_flag("--strict", strict, "Write nothing and exit with 5 where the target cannot be met");
  app.add_flag("-q,--quiet", quiet, "Print warnings and errors only");
  app.footer(
      "Examples:\n"
      "  lodestone extract bunny.glb --error 0.1% -o bunny-near.glb\n"
      "  lodestone extract bunny.glb --faces 855 -o bunny-far.obj\n"
      "  lodestone extract bunny.glb --error 0 -o bunny-whole.ply");
}

Result<Outcome> ExtractCommand::run() const {
  if (Result<void> paths = check_paths(*this); !paths) return tl::unexpected(paths.error());
  const Result<LevelTarget> requested = requested_target(target);
  if (!requested) return tl::unexpected(requested.error());
  const Result<ProgressiveMesh> mesh = read_stream(input);
  if (!mesh) return tl::unexpected(mesh.error());

  Cursor cursor(*mesh);
  const FullSize full = full_size(*mesh, cursor);
  const LevelChoice choice = choose_level(*mesh, resolve(*requested, full), StopReason::Stuck);
  cursor.seek(choice.position);
  if (!choice.met) {
    const std::string message = missed_message(cursor.face_count(), choice.target);
    strict ? print_error(message) : print_warning(message);
    if (strict) return Outcome::TargetNotMet;
  }
  const Mesh level = extract_level(*mesh, cursor);
  if (Result<void> done = write_mesh(output, level); !done) return tl::unexpected(done.error());
  if (!quiet) {
    const double deviation = mesh->deviation[choice.position];
    std::printf("%s: %zu faces, %zu vertices, deviation at most %s (%s of the diagonal)\n", output.c_str(),
                level.face_count(), level.vertex_count(), number_text(deviation).c_str(),
                percent_text(deviation, full.diagonal).c_str());
  }
  return Outcome::Done;
}

}  // namespace lodestone::tool
