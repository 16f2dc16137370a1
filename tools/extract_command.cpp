#include "extract_command.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <system_error>

#include <CLI/CLI.hpp>

#include <lodestone/io/file.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/scene.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/io/write_mesh.h>
#include <lodestone/lod/cursor.h>

#include "messages.h"
#include "scene_target.h"
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

/// A scene with the progressive meshes that its streams hold.
struct StreamedScene {
  Scene scene;
  std::vector<std::size_t> meshes;  ///< numbers of the scene's meshes that have a stream
  std::vector<ProgressiveMesh> progressive;
};

Result<StreamedScene> read_streams(const std::filesystem::path& path) {
  Result<Scene> scene = Scene::read_multi_lod(path);
  if (!scene) return tl::unexpected(scene.error());
  StreamedScene streamed{std::move(*scene), {}, {}};
  for (std::size_t i = 0; i < streamed.scene.meshes().size(); ++i) {
    const SceneMesh& mesh = streamed.scene.meshes()[i];
    if (mesh.stream.empty()) continue;
    Result<ProgressiveMesh> progressive = decode_stream(mesh.stream);
    if (!progressive) {
      return fail(progressive.error().code, quoted(path) + ": " + progressive.error().message,
                  progressive.error().byte_offset);
    }
    streamed.meshes.push_back(i);
    streamed.progressive.push_back(std::move(*progressive));
  }
  if (streamed.meshes.empty()) return fail(ErrorCode::Unsupported, quoted(path) + ": holds no removal stream");
  return streamed;
}

std::vector<ScenePart> parts_of(const StreamedScene& streamed) {
  std::vector<ScenePart> parts;
  for (std::size_t i = 0; i < streamed.meshes.size(); ++i) {
    const SceneMesh& mesh = streamed.scene.meshes()[streamed.meshes[i]];
    parts.push_back({&streamed.progressive[i], mesh.scale, mesh.instance_count, StopReason::Stuck, 1, {}, 0});
  }
  return parts;
}

/// What is taken out of the streams; meshes without one stay as the file has them.
struct Extracted {
  std::vector<LeveledMesh> meshes;
  std::size_t face_count = 0, vertex_count = 0;  ///< drawn
  double deviation = 0;                          ///< world units
};

Extracted extract_positions(const StreamedScene& streamed, std::span<const Index> positions) {
  Extracted out;
  for (const SceneMesh& mesh : streamed.scene.meshes()) {
    out.meshes.emplace_back().levels.resize(1);
    out.meshes.back().levels[0].mesh = mesh.mesh;
  }
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Cursor cursor(streamed.progressive[i]);
    cursor.seek(positions[i]);
    out.meshes[streamed.meshes[i]].levels[0].mesh = extract_level(streamed.progressive[i], cursor);
    const double deviation = streamed.progressive[i].deviation[positions[i]];
    out.deviation = std::max(out.deviation, deviation * streamed.scene.meshes()[streamed.meshes[i]].scale);
  }
  for (std::size_t i = 0; i < out.meshes.size(); ++i) {
    const Mesh& level = out.meshes[i].levels[0].mesh;
    out.face_count += level.face_count() * streamed.scene.meshes()[i].instance_count;
    out.vertex_count += level.vertex_count() * streamed.scene.meshes()[i].instance_count;
  }
  return out;
}

/// A .glb keeps the scene; other formats get its triangles in world space.
Result<void> write_extracted(const std::filesystem::path& path, const Scene& scene, const Extracted& extracted) {
  AssetOptions options;
  options.draco = false;
  const Result<EncodedAsset> asset = encode_scene_level(scene, extracted.meshes, 0, options);
  if (!asset) return tl::unexpected(asset.error());
  if (path.extension() == ".glb") return write_file(path, asset->glb);
  const Result<MeshFile> flat = read_mesh_bytes(asset->glb, "glb");
  if (!flat) return tl::unexpected(flat.error());
  return write_mesh(path, flat->mesh);
}

std::string missed_message(std::size_t face_count, const LevelTarget& target) {
  return std::to_string(face_count) + " faces are the fewest the file has, " +
         std::to_string(static_cast<std::uint64_t>(target.value)) + " were asked for";
}

}  // namespace

void ExtractCommand::add_to(CLI::App& app) {
  app.add_option("-i,--input,IN", input, "A .glb that lodestone build wrote, with its streams")
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
  const Result<StreamedScene> streamed = read_streams(input);
  if (!streamed) return tl::unexpected(streamed.error());

  const double diagonal = streamed->scene.box().diagonal();
  const SceneChoice choice = choose_positions(parts_of(*streamed), *requested, TargetScope::Scene, diagonal);
  const Extracted extracted = extract_positions(*streamed, choice.positions);
  if (!choice.met) {
    const std::string message = missed_message(extracted.face_count, choice.target);
    strict ? print_error(message) : print_warning(message);
    if (strict) return Outcome::TargetNotMet;
  }
  if (Result<void> done = write_extracted(output, streamed->scene, extracted); !done) {
    return tl::unexpected(done.error());
  }
  if (!quiet) {
    std::printf("%s: %zu faces, %zu vertices, deviation at most %s (%s of the diagonal)\n", output.c_str(),
                extracted.face_count, extracted.vertex_count, number_text(extracted.deviation).c_str(),
                percent_text(extracted.deviation, diagonal).c_str());
  }
  return Outcome::Done;
}

}  // namespace lodestone::tool
