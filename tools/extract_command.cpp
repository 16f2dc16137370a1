#include "extract_command.h"

#include <algorithm>
#include <cstdio>

#include <CLI/CLI.hpp>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>
#include <lodestone/io/scene.h>
#include <lodestone/io/stream_reader.h>
#include <lodestone/io/write_mesh.h>
#include <lodestone/lod/cursor.h>
#include <lodestone/pipeline/scene_target.h>

#include "asset_files.h"
#include "input_files.h"
#include "messages.h"
#include "staged_file.h"
#include "standard_streams.h"
#include "text_table.h"

namespace lodestone::tool {
namespace {

using detail::text;

/// Where the level goes: a file and its format, an extension without its dot.
struct Destination {
  std::filesystem::path path;
  std::string extension;
};

Result<Destination> check_destination_of(const FilePair& files, const std::string& format) {
  const bool is_stream = is_standard_stream(files.output);
  const std::string extension = output_extension(files.output, format);
  if (!is_level_format(extension))
    return fail(ErrorCode::InvalidArgument, text("-o: ", quoted(files.output), " does not end in ", kLevelFormatNames));
  if (is_stream && extension == "gltf")
    return fail(ErrorCode::InvalidArgument, "--format: a .gltf is several files, the standard output takes one");
  if (is_stream && extension != "obj" && standard_output_is_terminal())
    return fail(ErrorCode::InvalidArgument, "-o: the standard output is a terminal: send it to a file or a program");
  LODESTONE_CHECK(check_destination(files.output));
  return Destination{files.output, extension};
}

/// A scene with the progressive meshes that its streams hold.
struct StreamedScene {
  Scene scene;
  std::vector<std::size_t> meshes;  ///< numbers of the scene's meshes that have a stream
  std::vector<ProgressiveMesh> progressive;
};

/// Of a stream alone, whose materials nobody knows.
Result<StreamedScene> scene_of_stream(const std::filesystem::path& path, ProgressiveMesh mesh) {
  for (FaceGroup& group : mesh.groups) group.material = 0;
  MeshFile file;
  file.mesh = extract_level(mesh, kNoIndex);
  LODESTONE_TRY(Scene scene, Scene::from_mesh(std::move(file), path.stem().string()));
  StreamedScene streamed{std::move(scene), {0}, {}};
  streamed.progressive.push_back(std::move(mesh));
  return streamed;
}

Result<StreamedScene> read_streams(const std::filesystem::path& path) {
  LODESTONE_TRY(std::optional<StreamFile> stream, read_stream_file(path));
  if (stream) return scene_of_stream(path, std::move(stream->mesh));
  LODESTONE_TRY(Scene scene, read_levels(path, 0));
  StreamedScene streamed{std::move(scene), {}, {}};
  for (std::size_t i = 0; i < streamed.scene.meshes().size(); ++i) {
    const SceneMesh& mesh = streamed.scene.meshes()[i];
    if (mesh.stream.empty()) continue;
    Result<ProgressiveMesh> progressive = read_stream(mesh.stream);
    if (!progressive) {
      return fail(progressive.error().code, quoted(path) + ": " + progressive.error().message,
                  progressive.error().byte_offset);
    }
    streamed.meshes.push_back(i);
    streamed.progressive.push_back(std::move(*progressive));
  }
  if (streamed.meshes.empty())
    return tl::unexpected(not_streamed(path, ErrorCode::Unsupported, "none of its meshes has one"));
  return streamed;
}

std::vector<ScenePart> parts_of(const StreamedScene& streamed) {
  std::vector<ScenePart> parts;
  for (std::size_t i = 0; i < streamed.meshes.size(); ++i) {
    const SceneMesh& mesh = streamed.scene.meshes()[streamed.meshes[i]];
    parts.push_back({&streamed.progressive[i], mesh.scale, mesh.instance_count, StopReason::Stuck, 1, {}, {}, 0});
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
    out.meshes[streamed.meshes[i]].levels[0].mesh = extract_level(streamed.progressive[i], positions[i]);
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

/// Lists what a scene holds as the level of each of its meshes.
Extracted take_scene(const Scene& scene) {
  Extracted out;
  for (const SceneMesh& mesh : scene.meshes()) {
    out.meshes.emplace_back().levels.resize(1);
    out.meshes.back().levels[0].mesh = mesh.mesh;
    out.face_count += mesh.mesh.face_count() * mesh.instance_count;
    out.vertex_count += mesh.mesh.vertex_count() * mesh.instance_count;
  }
  return out;
}

/// A glTF keeps the scene; other formats get its triangles in world space.
Result<void> write_extracted(const std::filesystem::path& input, const Destination& to, const Scene& scene,
                             const Extracted& extracted) {
  StagedFiles files;
  if (to.extension == "glb" || to.extension == "gltf") {
    AssetOptions options;
    options.compression = Compression::None;
    if (to.extension == "gltf") options.gltf_name = to.path.stem().string();
    LODESTONE_TRY(const EncodedAsset asset, encode_scene_level(scene, extracted.meshes, 0, options));
    LODESTONE_CHECK(add_asset(asset, to.path, {input, scene.files()}, files));
  } else {
    LODESTONE_TRY(const Mesh surface, level_surface(scene, extracted.meshes, 0));
    LODESTONE_TRY(const std::vector<std::byte> bytes,
                  write_mesh_bytes(surface, to.path.stem().concat("." + to.extension)));
    LODESTONE_CHECK(files.add(to.path, bytes));
  }
  return files.commit();
}

std::string missed_message(std::size_t face_count, const SceneChoice& choice) {
  return text(face_count, " faces are the fewest the file has",
              choice.beyond.empty() ? ", " : " before its error leaps, ",
              static_cast<std::uint64_t>(choice.target.value), " were asked for");
}

/// Takes a level as it stands in the file.
Result<Outcome> extract_level_number(const ExtractCommand& options, const std::filesystem::path& input,
                                     const Destination& to) {
  LODESTONE_TRY(const Scene scene, read_levels(input, *options.level));
  const Extracted extracted = take_scene(scene);
  LODESTONE_CHECK(write_extracted(input, to, scene, extracted));
  if (!options.quiet && !is_standard_stream(to.path))
    std::printf("%s: %zu faces, %zu vertices\n", to.path.c_str(), extracted.face_count, extracted.vertex_count);
  return Outcome::Done;
}

/// Takes a level out of the streams.
Result<Outcome> extract_target(const ExtractCommand& options, const std::filesystem::path& input,
                               const LevelTarget& requested, const Destination& to) {
  LODESTONE_TRY(const StreamedScene streamed, read_streams(input));
  const double diagonal = streamed.scene.box().diagonal();
  for (const std::string& line : options.target.remarks(diagonal, true)) print_warning(line);
  const SceneChoice choice = choose_positions(parts_of(streamed), requested, TargetScope::Scene, diagonal);
  const Extracted extracted = extract_positions(streamed, choice.positions);
  if (!choice.met) {
    const std::string message = missed_message(extracted.face_count, choice);
    options.strict ? print_error(message) : print_warning(message);
    if (options.strict) return Outcome::TargetNotMet;
  }
  LODESTONE_CHECK(write_extracted(input, to, streamed.scene, extracted));
  if (!options.quiet && !is_standard_stream(to.path)) {
    std::printf("%s: %zu faces, %zu vertices, deviation at most %s (%s of the diagonal)\n", to.path.c_str(),
                extracted.face_count, extracted.vertex_count, number_text(extracted.deviation).c_str(),
                percent_text(extracted.deviation, diagonal).c_str());
  }
  return Outcome::Done;
}

}  // namespace

void ExtractCommand::add_to(CLI::App& app) {
  files.add_to(app, "A .glb or .gltf that lodestone build wrote, with its streams, or a .lods; - for standard input",
               "The .glb, .gltf, .obj or .ply to write; - for standard output");
  add_format_option(app, format, kLevelFormats);
  const char* group = "Target: one of these";
  target.add_to(app, group, false, false);
  app.add_option("--level", level, "This level as it stands in the file, 0 the finest")->type_name("N")->group(group);
  app.add_flag("--strict", strict, "Write nothing and exit with 5 where the target cannot be met");
  app.add_flag("-q,--quiet", quiet, "Print warnings and errors only");
  app.footer(
      "Examples:\n"
      "  lodestone extract bunny.glb --error 0.1% -o bunny-near.glb\n"
      "  lodestone extract bunny.glb --faces 855 -o bunny-far.obj\n"
      "  lodestone extract bunny.glb --level 2 -o bunny-2.glb\n"
      "  lodestone extract bunny.glb --error 0 -o bunny-whole.ply");
}

Result<Outcome> ExtractCommand::run() const {
  LODESTONE_TRY(const std::vector<FilePair> pairs, files.pair_up("." + format));
  if (pairs.size() > 1) return fail(ErrorCode::InvalidArgument, "extract takes one input");
  const std::filesystem::path& input = pairs.front().input;
  LODESTONE_TRY(const TargetOptions::Parsed wanted, target.parse());
  const std::vector<LevelTarget>& targets = wanted.targets;
  if (wanted.limit || targets.size() + (level ? 1 : 0) != 1) {
    return fail(ErrorCode::InvalidArgument, "give one value with one of --error, --epsilon, --faces, --ratio, --level");
  }
  MadeFolders folders;
  if (pairs.front().in_folder) {
    LODESTONE_CHECK(folders.make(pairs.front().output.parent_path()));
  }
  LODESTONE_TRY(const Destination destination, check_destination_of(pairs.front(), format));
  return level ? extract_level_number(*this, input, destination)
               : extract_target(*this, input, targets.front(), destination);
}

}  // namespace lodestone::tool
