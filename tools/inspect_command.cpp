#include "inspect_command.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <string>

#include <CLI/CLI.hpp>

#include <lodestone/core/connectivity.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/asset.h>
#include <lodestone/io/scene.h>

#include "input_files.h"
#include "json_text.h"
#include "messages.h"
#include "stream_listing.h"
#include "text_table.h"

namespace lodestone::tool {
namespace {

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

// A multi-LOD file: its levels, its stream, and what is left.

Json level_json(const Asset::Level& level) {
  return {
      {"faces", level.face_count},
      {"vertices", level.vertex_count},
      {"bytes", level.byte_length},
      {"compression", name_of(level.compression)},
      {"deviation", {{"max", level.maximum_deviation}, {"mean", level.mean_deviation}, {"rms", level.rms_deviation}}},
      {"curvature_error", level.curvature_error},
      {"screen_coverage", level.screen_coverage}};
}

std::uint64_t stream_bytes(const DecodedAsset& asset) {
  std::uint64_t bytes = 0;
  for (const Asset::Stream& stream : asset.streams) bytes += stream.bytes.size();
  return bytes;
}

/// Everything but levels and streams: textures, animations, the glTF's JSON, headers, padding.
std::uint64_t other_bytes(const DecodedAsset& asset) {
  std::uint64_t parts = stream_bytes(asset);
  for (const Asset::Level& level : asset.levels) parts += level.byte_length;
  return parts < asset.total_bytes ? asset.total_bytes - parts : 0;
}

/// One stream with its chunks; of several only what they are together.
Json all_streams_json(const DecodedAsset& asset, std::span<const ListedStream> streams) {
  if (streams.empty()) return nullptr;
  Json json = stream_json(streams[0].directory);
  if (streams.size() == 1) return json;
  json["bytes"] = stream_bytes(asset);
  json["chunks"] = Json::array();
  return json;
}

Json asset_json(const std::string& path, const DecodedAsset& asset, std::span<const ListedStream> streams) {
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
          {"diagonal", asset.levels[0].box.diagonal()},
          {"levels", levels},
          {"stream", all_streams_json(asset, streams)},
          {"streams", by_mesh}};
}

void print_levels(const DecodedAsset& asset) {
  TextTable table({"level", "faces", "vertices", "max", "mean", "rms", "epsilon", "bytes", "compression"});
  const double diagonal = asset.levels[0].box.diagonal();
  for (std::size_t i = 0; i < asset.levels.size(); ++i) {
    const Asset::Level& level = asset.levels[i];
    table.add({text_of(i), text_of(level.face_count), text_of(level.vertex_count),
               percent_text(level.maximum_deviation, diagonal), percent_text(level.mean_deviation, diagonal),
               percent_text(level.rms_deviation, diagonal), number_text(level.curvature_error),
               text_of(level.byte_length), name_of(level.compression)});
  }
  table.print();
}

void print_asset(const std::string& path, const DecodedAsset& asset, std::span<const ListedStream> streams) {
  std::printf("%s: %llu bytes, %llu of them neither level nor stream; diagonal %s\n", path.c_str(),
              static_cast<unsigned long long>(asset.total_bytes), static_cast<unsigned long long>(other_bytes(asset)),
              number_text(asset.levels[0].box.diagonal()).c_str());
  print_levels(asset);
  for (const ListedStream& stream : streams) print_stream(stream);
}

Result<Outcome> inspect_asset(const std::string& path, const DecodedAsset& asset, bool json) {
  std::vector<ListedStream> streams;
  for (const Asset::Stream& stream : asset.streams) {
    LODESTONE_TRY(StreamDirectory directory, directory_of(stream.bytes));
    streams.push_back({stream.mesh, std::move(directory), {}});
  }
  if (json) {
    std::fputs(json_text(asset_json(path, asset, streams)).c_str(), stdout);
  } else {
    print_asset(path, asset, streams);
  }
  return Outcome::Done;
}

// Any other file: what build takes it for, every instance counted.

struct Inventory {
  std::uint64_t bytes = 0;  ///< with the buffers and images beside the file
  std::size_t face_count = 0, vertex_count = 0, wedge_count = 0;
  KindCounts kinds{};
  std::vector<std::string> attributes;
  double area = 0;
  Box box;
  AssemblyReport assembly;
  std::vector<std::string> notes;
};

Result<void> count_kinds(const SceneMesh& mesh, KindCounts& counts) {
  LODESTONE_TRY(const Connectivity connectivity, Connectivity::build(mesh.mesh));
  for (Index vertex = 0; vertex < mesh.mesh.vertex_count(); ++vertex) {
    const VertexKind kind = connectivity.has_vertex(vertex) ? connectivity.kind(vertex) : VertexKind::Isolated;
    for (std::size_t i = 0; i < kKindNames.size(); ++i)
      if (kKindNames[i].kind == kind) counts[i] += mesh.instance_count;
  }
  return {};
}

Result<void> add_mesh(const SceneMesh& mesh, Inventory& inventory) {
  inventory.face_count += mesh.mesh.face_count() * mesh.instance_count;
  inventory.vertex_count += mesh.mesh.vertex_count() * mesh.instance_count;
  inventory.wedge_count += mesh.mesh.wedge_count() * mesh.instance_count;
  inventory.area += mesh.area;
  inventory.assembly = inventory.assembly + mesh.assembly;
  std::vector<std::string>& names = inventory.attributes;
  for (const Attribute& attribute : mesh.mesh.attributes)
    if (std::find(names.begin(), names.end(), attribute.name) == names.end()) names.push_back(attribute.name);
  return count_kinds(mesh, inventory.kinds);
}

Result<Inventory> take_inventory(const Scene& scene, std::uint64_t bytes) {
  Inventory inventory;
  inventory.bytes = bytes;
  inventory.box = scene.box();
  inventory.notes = scene.notes();
  for (const AssemblyReport& dropped : scene.dropped()) inventory.assembly = inventory.assembly + dropped;
  for (const SceneMesh& mesh : scene.meshes()) LODESTONE_CHECK(add_mesh(mesh, inventory));
  return inventory;
}

Json inventory_json(const std::string& path, const Inventory& inventory) {
  Json kind_counts = Json::object();
  for (std::size_t i = 0; i < kKindNames.size(); ++i) kind_counts[kKindNames[i].name] = inventory.kinds[i];
  return {{"schema_version", kInspectSchemaVersion},
          {"path", path},
          {"kind", "mesh"},
          {"bytes", inventory.bytes},
          {"faces", inventory.face_count},
          {"vertices", inventory.vertex_count},
          {"wedges", inventory.wedge_count},
          {"vertex_kinds", kind_counts},
          {"attributes", inventory.attributes},
          {"area", inventory.area},
          {"bounding_box", box_json(inventory.box)},
          {"assembly", assembly_json(inventory.assembly)},
          {"notes", inventory.notes}};
}

void print_kinds(const KindCounts& kinds) {
  std::string line;
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (kinds[i] == 0) continue;
    line += (line.empty() ? "" : ", ") + text_of(kinds[i]) + " " + kKindNames[i].name;
  }
  if (!line.empty()) std::printf("vertex kinds: %s\n", line.c_str());
}

void print_attributes(const std::vector<std::string>& names) {
  std::string line;
  for (const std::string& name : names) line += " " + name;
  if (!line.empty()) std::printf("attributes:%s\n", line.c_str());
}

void print_inventory(const std::string& path, const Inventory& inventory) {
  const Box& box = inventory.box;
  std::printf("%s: %zu faces, %zu vertices, %zu wedges, %llu bytes\n", path.c_str(), inventory.face_count,
              inventory.vertex_count, inventory.wedge_count, static_cast<unsigned long long>(inventory.bytes));
  print_kinds(inventory.kinds);
  print_attributes(inventory.attributes);
  std::printf("bounds: (%g, %g, %g) to (%g, %g, %g), diagonal %g\n", box.low.x, box.low.y, box.low.z, box.high.x,
              box.high.y, box.high.z, box.diagonal());
  std::printf("area: %g\n", inventory.area);
  for (const std::string& line : sentences(inventory.assembly)) std::printf("repaired: %s\n", line.c_str());
  for (const std::string& line : inventory.notes) std::printf("note: %s\n", line.c_str());
}

// A stream in a file of its own: what its finest level is, and its chunks.

Json chunk_json(const ReaderChunk& chunk, std::size_t i, const StreamFile& stream) {
  const Index first = i == 0 ? 0 : stream.chunks[i - 1].position;
  return {{"byte_offset", chunk.bytes.begin},
          {"bytes", chunk.bytes.end - chunk.bytes.begin},
          {"first_record", first},
          {"records", chunk.position - first},
          {"faces", chunk.face_count},
          {"vertices", chunk.vertex_count},
          {"deviation_bound", chunk.deviation}};
}

void print_chunks(const StreamFile& stream) {
  std::printf("\nstream of %zu chunks\n", stream.chunks.size());
  TextTable table({"chunk", "faces", "vertices", "deviation", "bytes", "bytes so far"});
  for (std::size_t i = 0; i < stream.chunks.size(); ++i) {
    const ReaderChunk& chunk = stream.chunks[i];
    table.add({text_of(i), text_of(chunk.face_count), text_of(chunk.vertex_count), number_text(chunk.deviation),
               text_of(chunk.bytes.end - chunk.bytes.begin), text_of(chunk.bytes.end)});
  }
  table.print();
}

Result<Outcome> inspect_stream(const std::string& path, const Scene& scene, const StreamFile& stream, bool json) {
  LODESTONE_TRY(const Inventory inventory, take_inventory(scene, stream.bytes));
  if (!json) {
    print_inventory(path, inventory);
    print_chunks(stream);
    return Outcome::Done;
  }
  Json all = inventory_json(path, inventory);
  all["kind"] = "stream";
  all["chunks"] = Json::array();
  for (std::size_t i = 0; i < stream.chunks.size(); ++i)
    all["chunks"].push_back(chunk_json(stream.chunks[i], i, stream));
  std::fputs(json_text(all).c_str(), stdout);
  return Outcome::Done;
}

/// Of any file with streams: what they spend their bytes on.
Result<Outcome> inspect_parts(const std::filesystem::path& path, bool json) {
  LODESTONE_TRY(const std::vector<Asset::Stream> streams, read_streams(path));
  std::vector<ListedStream> listed;
  for (const Asset::Stream& stream : streams) {
    auto one = list_stream(stream);
    if (!one) return fail(one.error().code, quoted(path) + ": " + one.error().message, one.error().byte_offset);
    listed.push_back(std::move(*one));
  }
  if (json) {
    std::fputs(json_text(parts_json(path.string(), listed)).c_str(), stdout);
  } else {
    print_parts(path.string(), listed);
  }
  return Outcome::Done;
}

Result<Outcome> inspect_scene(const std::string& path, const Scene& scene, std::uint64_t bytes, bool json) {
  LODESTONE_TRY(const Inventory inventory, take_inventory(scene, bytes));
  if (json) {
    std::fputs(json_text(inventory_json(path, inventory)).c_str(), stdout);
  } else {
    print_inventory(path, inventory);
  }
  return Outcome::Done;
}

}  // namespace

void InspectCommand::add_to(CLI::App& app) {
  app.add_option("X,-i,--input", input, "A file that lodestone build wrote, or any mesh file; - for standard input")
      ->required()
      ->type_name("FILE");
  app.add_flag("--stream", stream,
               "Show what the streams of the file spend their bytes on, part by part, round by round");
  app.add_flag("--json", json, "Print JSON");
  app.footer(
      "Examples:\n"
      "  lodestone inspect bunny.glb\n"
      "  lodestone inspect bunny.lods --stream");
}

Result<Outcome> InspectCommand::run() const {
  if (stream) return inspect_parts(input, json);
  LODESTONE_TRY(const AssetOrScene file, read_asset_or_scene(input));
  if (file.asset) return inspect_asset(input.string(), *file.asset, json);
  LODESTONE_TRY(const std::optional<StreamFile> alone, read_stream_file(input));
  if (alone) return inspect_stream(input.string(), *file.scene, *alone, json);
  return inspect_scene(input.string(), *file.scene, file.bytes, json);
}

}  // namespace lodestone::tool
