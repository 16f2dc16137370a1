#include "inspect_command.h"

#include <array>
#include <cstdio>
#include <fstream>
#include <string_view>

#include <CLI/CLI.hpp>

#include <lodestone/core/connectivity.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/read_mesh.h>
#include <lodestone/io/stream_format.h>

#include "json_text.h"
#include "messages.h"
#include "text_table.h"

namespace lodestone::tool {
namespace {

constexpr int kInspectSchemaVersion = 1;

struct KindName {
  VertexKind kind;
  const char* name;
};
constexpr std::array<KindName, 6> kKindNames = {{{VertexKind::Interior, "interior"},
                                                 {VertexKind::Border, "border"},
                                                 {VertexKind::Feature, "feature"},
                                                 {VertexKind::Corner, "corner"},
                                                 {VertexKind::NonManifold, "nonmanifold"},
                                                 {VertexKind::Isolated, "isolated"}}};
using KindCounts = std::array<std::size_t, kKindNames.size()>;

std::string text_of(std::uint64_t number) { return std::to_string(number); }

bool is_glb(const std::filesystem::path& path) {
  char magic[4] = {};
  std::ifstream(path, std::ios::binary).read(magic, sizeof magic);
  return std::string_view(magic, sizeof magic) == "glTF";
}

Result<KindCounts> count_kinds(const Mesh& mesh) {
  const Result<Connectivity> connectivity = Connectivity::build(mesh);
  if (!connectivity) return tl::unexpected(connectivity.error());
  KindCounts counts{};
  for (Index vertex = 0; vertex < mesh.vertex_count(); ++vertex) {
    const VertexKind kind = connectivity->has_vertex(vertex) ? connectivity->kind(vertex) : VertexKind::Isolated;
    for (std::size_t i = 0; i < kKindNames.size(); ++i) counts[i] += kKindNames[i].kind == kind ? 1 : 0;
  }
  return counts;
}

// A multi-LOD file: its levels, its stream, and what is left.

Json level_json(const Asset::Level& level) {
  return {
      {"faces", level.face_count},
      {"vertices", level.mesh.vertex_count()},
      {"bytes", level.byte_length},
      {"draco", level.draco},
      {"deviation", {{"max", level.maximum_deviation}, {"mean", level.mean_deviation}, {"rms", level.rms_deviation}}},
      {"curvature_error", level.curvature_error},
      {"screen_coverage", level.screen_coverage}};
}

Json chunk_json(const StreamChunk& chunk) {
  return {{"byte_offset", chunk.byte_offset},        {"bytes", chunk.byte_length},
          {"decoded_bytes", chunk.decoded_bytes},    {"first_record", chunk.record_begin},
          {"records", chunk.record_count},           {"faces", chunk.face_count},
          {"vertices", chunk.vertex_count},          {"deviation_bound", chunk.deviation},
          {"curvature_error", chunk.curvature_error}};
}

Json stream_json(const StreamDirectory& directory) {
  Json chunks = Json::array();
  for (const StreamChunk& chunk : directory.chunks) chunks.push_back(chunk_json(chunk));
  return {{"version", text_of(directory.version_major) + "." + text_of(directory.version_minor)},
          {"bytes", directory.total_bytes},
          {"chunks", chunks}};
}

/// A stream's directory and the name of its mesh.
struct ListedStream {
  std::string mesh;
  StreamDirectory directory;
};

std::uint64_t stream_bytes(const Asset& asset) {
  std::uint64_t bytes = 0;
  for (const Asset::Stream& stream : asset.streams) bytes += stream.bytes.size();
  return bytes;
}

/// Everything but levels and streams: textures, animations, the glTF's JSON, headers, padding.
std::uint64_t other_bytes(const Asset& asset) {
  std::uint64_t parts = stream_bytes(asset);
  for (const Asset::Level& level : asset.levels) parts += level.byte_length;
  return parts < asset.total_bytes ? asset.total_bytes - parts : 0;
}

/// One stream with its chunks; of several only what they are together.
Json all_streams_json(const Asset& asset, std::span<const ListedStream> streams) {
  if (streams.empty()) return nullptr;
  Json json = stream_json(streams[0].directory);
  if (streams.size() == 1) return json;
  json["bytes"] = stream_bytes(asset);
  json["chunks"] = Json::array();
  return json;
}

Json asset_json(const std::string& path, const Asset& asset, std::span<const ListedStream> streams) {
  Json levels = Json::array();
  for (const Asset::Level& level : asset.levels) levels.push_back(level_json(level));
  Json by_mesh = Json::array();
  for (const ListedStream& stream : streams) {
    by_mesh.push_back({{"mesh", stream.mesh}});
    by_mesh.back().update(stream_json(stream.directory));
  }
  return {{"schema_version", kInspectSchemaVersion},
          {"path", path},
          {"kind", "asset"},
          {"bytes", asset.total_bytes},
          {"other_bytes", other_bytes(asset)},
          {"levels", levels},
          {"stream", all_streams_json(asset, streams)},
          {"streams", by_mesh}};
}

void print_levels(const Asset& asset) {
  TextTable table({"level", "faces", "vertices", "max", "mean", "rms", "epsilon", "bytes", "coding"});
  for (std::size_t i = 0; i < asset.levels.size(); ++i) {
    const Asset::Level& level = asset.levels[i];
    table.add({text_of(i), text_of(level.face_count), text_of(level.mesh.vertex_count()),
               number_text(level.maximum_deviation), number_text(level.mean_deviation),
               number_text(level.rms_deviation), number_text(level.curvature_error), text_of(level.byte_length),
               level.draco ? "draco" : "plain"});
  }
  table.print();
}

void print_stream(const ListedStream& stream) {
  const StreamDirectory& directory = stream.directory;
  std::printf("\nremoval stream%s, version %d.%d, %llu bytes\n",
              stream.mesh.empty() ? "" : (" of " + stream.mesh).c_str(), directory.version_major,
              directory.version_minor, static_cast<unsigned long long>(directory.total_bytes));
  TextTable table({"chunk", "records", "faces", "vertices", "deviation", "epsilon", "bytes", "decoded"});
  for (std::size_t i = 0; i < directory.chunks.size(); ++i) {
    const StreamChunk& chunk = directory.chunks[i];
    table.add({text_of(i), text_of(chunk.record_count), text_of(chunk.face_count), text_of(chunk.vertex_count),
               number_text(chunk.deviation), number_text(chunk.curvature_error), text_of(chunk.byte_length),
               text_of(chunk.decoded_bytes)});
  }
  table.print();
}

void print_asset(const std::string& path, const Asset& asset, std::span<const ListedStream> streams) {
  std::printf("%s: %llu bytes, %llu of them neither level nor stream; errors in the file's units\n", path.c_str(),
              static_cast<unsigned long long>(asset.total_bytes), static_cast<unsigned long long>(other_bytes(asset)));
  print_levels(asset);
  for (const ListedStream& stream : streams) print_stream(stream);
}

Result<Outcome> inspect_asset(const std::string& path, const Asset& asset, bool json) {
  std::vector<ListedStream> streams;
  for (const Asset::Stream& stream : asset.streams) {
    Result<StreamDirectory> directory = read_stream_directory(stream.bytes);
    if (!directory) return tl::unexpected(directory.error());
    streams.push_back({stream.mesh, std::move(*directory)});
  }
  if (json) {
    std::fputs(json_text(asset_json(path, asset, streams)).c_str(), stdout);
  } else {
    print_asset(path, asset, streams);
  }
  return Outcome::Done;
}

// Any other mesh file.

Json mesh_json(const std::string& path, const MeshFile& file, const KindCounts& kinds) {
  Json attributes = Json::array();
  for (const Attribute& attribute : file.mesh.attributes) attributes.push_back(attribute.name);
  Json kind_counts = Json::object();
  for (std::size_t i = 0; i < kinds.size(); ++i) kind_counts[kKindNames[i].name] = kinds[i];
  return {{"schema_version", kInspectSchemaVersion},
          {"path", path},
          {"kind", "mesh"},
          {"faces", file.mesh.face_count()},
          {"vertices", file.mesh.vertex_count()},
          {"wedges", file.mesh.wedge_count()},
          {"vertex_kinds", kind_counts},
          {"attributes", attributes},
          {"area", surface_area(file.mesh)},
          {"bounding_box", box_json(bounding_box(file.mesh))},
          {"assembly", assembly_json(file.assembly)},
          {"notes", file.notes}};
}

void print_kinds(const KindCounts& kinds) {
  std::string line;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] == 0) continue;
    line += (line.empty() ? "" : ", ") + text_of(kinds[i]) + " " + kKindNames[i].name;
  }
  if (!line.empty()) std::printf("vertex kinds: %s\n", line.c_str());
}

void print_attributes(const std::vector<Attribute>& attributes) {
  std::string line;
  for (const Attribute& attribute : attributes) line += " " + attribute.name;
  if (!line.empty()) std::printf("attributes:%s\n", line.c_str());
}

void print_mesh(const std::string& path, const MeshFile& file, const KindCounts& kinds) {
  const Mesh& mesh = file.mesh;
  const Box box = bounding_box(mesh);
  std::printf("%s: %zu faces, %zu vertices, %zu wedges\n", path.c_str(), mesh.face_count(), mesh.vertex_count(),
              mesh.wedge_count());
  print_kinds(kinds);
  print_attributes(mesh.attributes);
  std::printf("bounds: (%g, %g, %g) to (%g, %g, %g), diagonal %g\n", box.low.x, box.low.y, box.low.z, box.high.x,
              box.high.y, box.high.z, box.diagonal());
  std::printf("area: %g\n", surface_area(mesh));
  for (const std::string& line : sentences(file.assembly)) std::printf("repaired: %s\n", line.c_str());
  for (const std::string& line : file.notes) std::printf("note: %s\n", line.c_str());
}

Result<Outcome> inspect_mesh(const std::filesystem::path& path, bool json) {
  const Result<MeshFile> file = read_mesh(path);
  if (!file) return tl::unexpected(file.error());
  const Result<KindCounts> kinds = count_kinds(file->mesh);
  if (!kinds) return tl::unexpected(kinds.error());
  if (json) {
    std::fputs(json_text(mesh_json(path.string(), *file, *kinds)).c_str(), stdout);
  } else {
    print_mesh(path.string(), *file, *kinds);
  }
  return Outcome::Done;
}

}  // namespace

void InspectCommand::add_to(CLI::App& app) {
  app.add_option("X,-i,--input", input, "A .glb that lodestone build wrote, or any mesh file")
      ->required()
      ->type_name("FILE");
  app.add_flag("--json", json, "Print JSON");
  app.footer("Example:\n  lodestone inspect bunny.glb");
}

Result<Outcome> InspectCommand::run() const {
  if (!is_glb(input)) return inspect_mesh(input, json);
  const Result<Asset> asset = read_asset(input);
  // A .glb from elsewhere may hold what only the general reader understands.
  if (!asset && asset.error().code == ErrorCode::Unsupported) return inspect_mesh(input, json);
  if (!asset) return tl::unexpected(asset.error());
  if (asset->levels.size() < 2 && asset->streams.empty()) return inspect_mesh(input, json);
  return inspect_asset(input.string(), *asset, json);
}

}  // namespace lodestone::tool
