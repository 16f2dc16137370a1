#include "stream_listing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numeric>
#include <utility>
#include <vector>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/stream_reader.h>

#include "text_table.h"

namespace lodestone::tool {
namespace {

using detail::text;

Json chunk_json(const StreamChunk& chunk) {
  return {{"byte_offset", chunk.byte_offset},        {"bytes", chunk.byte_length},
          {"decoded_bytes", chunk.decoded_bytes},    {"first_record", chunk.record_begin},
          {"records", chunk.record_count},           {"faces", chunk.face_count},
          {"vertices", chunk.vertex_count},          {"deviation_bound", chunk.deviation},
          {"curvature_error", chunk.curvature_error}};
}

std::string version_text(const StreamDirectory& directory) {
  return text(directory.version_major, ".", directory.version_minor);
}

const char* coding_name(CompactCoding coding) { return coding == CompactCoding::Fast ? "fast" : "small"; }

/// How tables call the stream of a mesh.
std::string title_of(const ListedStream& stream) {
  const bool is_compact = stream.directory.version_major >= kCompactStreamVersion;
  const std::string coding = stream.parts ? text(", ", coding_name(stream.parts->coding), " coding") : "";
  return text(is_compact ? "compact" : "removal", " stream", stream.mesh.empty() ? "" : " of " + stream.mesh,
              ", version ", version_text(stream.directory), coding);
}

struct PartName {
  const char* name;
  double CompactSizes::*bits;
};
constexpr std::array kParts = {
    PartName{"header", &CompactSizes::header},       PartName{"base", &CompactSizes::base},
    PartName{"places", &CompactSizes::places},       PartName{"wedges", &CompactSizes::wedges},
    PartName{"positions", &CompactSizes::positions}, PartName{"moves", &CompactSizes::moves},
    PartName{"loose", &CompactSizes::loose},         PartName{"rests", &CompactSizes::rests},
    PartName{"errors", &CompactSizes::errors}};

/// The names of parts: those that every stream has, then attributes.
std::vector<std::string> part_names(const CompactParts& parts) {
  std::vector<std::string> names;
  for (const PartName& part : kParts) names.emplace_back(part.name);
  names.insert(names.end(), parts.attributes.begin(), parts.attributes.end());
  return names;
}

/// The bits of the same parts.
std::vector<double> part_bits(const CompactSizes& sizes) {
  std::vector<double> bits;
  for (const PartName& part : kParts) bits.push_back(sizes.*part.bits);
  bits.insert(bits.end(), sizes.attributes.begin(), sizes.attributes.end());
  return bits;
}

/// By round: how many bytes must have come for it to be complete, if a chunk could be cut off there.
std::vector<std::uint64_t> bytes_so_far(const ListedStream& stream) {
  std::vector<std::uint64_t> ends;
  double bits = 0;  // of the chunk
  const std::vector<CompactRound>& rounds = stream.parts->rounds;
  for (std::size_t i = 0; i < rounds.size(); ++i) {
    bits = i > 0 && rounds[i - 1].chunk != rounds[i].chunk ? rounds[i].sizes.sum() : bits + rounds[i].sizes.sum();
    const StreamChunk& chunk = stream.directory.chunks[rounds[i].chunk];
    const bool is_last = i + 1 == rounds.size() || rounds[i + 1].chunk != rounds[i].chunk;
    const auto bytes = is_last ? chunk.byte_length : static_cast<std::uint64_t>(std::ceil(bits / 8));
    ends.push_back(chunk.byte_offset + bytes);
  }
  return ends;
}

std::string two_places(double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.2f", value);
  return text.data();
}

double per(double bits, std::uint64_t count) { return count > 0 ? bits / static_cast<double>(count) : 0; }

/// What parts take, of one stream or several.
struct PartSizes {
  std::vector<std::string> names;
  std::vector<double> bits;
  std::uint64_t vertices = 0;

  double sum() const { return std::accumulate(bits.begin(), bits.end(), 0.0); }
  void add(const std::string& name, double part) {
    const auto found = std::find(names.begin(), names.end(), name);
    const auto i = static_cast<std::size_t>(found - names.begin());
    if (found == names.end()) {
      names.push_back(name);
      bits.push_back(0);
    }
    bits[i] += part;
  }
  void add(const CompactParts& parts) {
    const std::vector<std::string> more = part_names(parts);
    const std::vector<double> more_bits = part_bits(parts.sizes);
    for (std::size_t i = 0; i < more.size(); ++i) add(more[i], more_bits[i]);
    vertices += parts.rounds.back().vertex_count;
  }
};

PartSizes sizes_of(std::span<const ListedStream> streams) {
  PartSizes sizes;
  for (const ListedStream& stream : streams)
    if (stream.parts) sizes.add(*stream.parts);
  return sizes;
}

void print_sizes(const PartSizes& sizes) {
  const double all = sizes.sum();
  TextTable table({"part", "bytes", "bits a vertex", "share"});
  const auto add = [&](const std::string& name, double part) {
    table.add({name, two_places(part / 8), two_places(per(part, sizes.vertices)), two_places(100 * part / all) + "%"});
  };
  for (std::size_t i = 0; i < sizes.names.size(); ++i) add(sizes.names[i], sizes.bits[i]);
  add("all", all);
  table.print();
}

Json sizes_json(const PartSizes& sizes) {
  Json json = Json::array();
  for (std::size_t i = 0; i < sizes.names.size(); ++i)
    json.push_back(
        {{"name", sizes.names[i]}, {"bits", sizes.bits[i]}, {"bits_a_vertex", per(sizes.bits[i], sizes.vertices)}});
  return json;
}

void print_rounds(const ListedStream& stream) {
  const std::vector<std::string> names = part_names(*stream.parts);
  std::vector<std::string> head = {"round", "chunk", "records", "loose", "faces", "deviation", "bytes so far"};
  for (std::size_t i = 1; i < names.size(); ++i) head.push_back(names[i]);  // no round has a header
  head.emplace_back("all");
  std::puts("\nby round, in bits for each vertex that it adds; the first is the base mesh");
  TextTable table(head);
  const std::vector<std::uint64_t> ends = bytes_so_far(stream);
  std::uint64_t before = 0;
  for (std::size_t i = 0; i < ends.size(); ++i) {
    const CompactRound& round = stream.parts->rounds[i];
    const std::uint64_t added = round.vertex_count - std::exchange(before, round.vertex_count);
    std::vector<std::string> row = {text_of(i),
                                    text_of(round.chunk),
                                    text_of(round.record_count),
                                    text_of(round.loose_count),
                                    text_of(round.face_count),
                                    number_text(static_cast<double>(round.deviation)),
                                    text_of(ends[i])};
    const std::vector<double> bits = part_bits(round.sizes);
    for (std::size_t part = 1; part < bits.size(); ++part) row.push_back(two_places(per(bits[part], added)));
    row.push_back(two_places(per(round.sizes.sum(), added)));
    table.add(row);
  }
  table.print();
}

Json round_json(const CompactRound& round, std::uint64_t end) {
  return {{"chunk", round.chunk},      {"records", round.record_count},  {"loose", round.loose_count},
          {"faces", round.face_count}, {"vertices", round.vertex_count}, {"deviation_bound", round.deviation},
          {"bytes_so_far", end},       {"bits", part_bits(round.sizes)}};
}

}  // namespace

std::string text_of(std::uint64_t number) { return std::to_string(number); }

Result<StreamDirectory> directory_of(std::span<const std::byte> stream) {
  const std::uint16_t version = stream_version(stream);
  if (version < kCompactStreamVersion) return read_stream_directory(stream);
  LODESTONE_TRY(const std::vector<CompactChunk> chunks, read_compact_chunks(stream));
  StreamDirectory directory;
  directory.version_major = version;
  directory.version_minor =
      static_cast<std::uint16_t>(std::to_integer<unsigned>(stream[10]) | std::to_integer<unsigned>(stream[11]) << 8U);
  directory.total_bytes = stream.size();
  for (const CompactChunk& chunk : chunks)
    directory.chunks.push_back({chunk.byte_offset, chunk.byte_length, chunk.byte_length, 0, chunk.record_begin,
                                chunk.record_count, chunk.face_count, chunk.vertex_count, chunk.deviation, 0});
  return directory;
}

Result<ListedStream> list_stream(const Asset::Stream& stream) {
  LODESTONE_TRY(StreamDirectory directory, directory_of(stream.bytes));
  ListedStream listed{stream.mesh, std::move(directory), {}};
  if (listed.directory.version_major < kCompactStreamVersion) return listed;
  LODESTONE_TRY(listed.parts, measure_compact(stream.bytes));
  return listed;
}

Json stream_json(const StreamDirectory& directory) {
  Json chunks = Json::array();
  for (const StreamChunk& chunk : directory.chunks) chunks.push_back(chunk_json(chunk));
  return {{"version", version_text(directory)}, {"bytes", directory.total_bytes}, {"chunks", chunks}};
}

void print_stream(const ListedStream& stream) {
  const StreamDirectory& directory = stream.directory;
  std::printf("\n%s, %llu bytes\n", title_of(stream).c_str(), static_cast<unsigned long long>(directory.total_bytes));
  TextTable table({"chunk", "records", "faces", "vertices", "deviation", "epsilon", "bytes", "decoded"});
  for (std::size_t i = 0; i < directory.chunks.size(); ++i) {
    const StreamChunk& chunk = directory.chunks[i];
    table.add({text_of(i), text_of(chunk.record_count), text_of(chunk.face_count), text_of(chunk.vertex_count),
               number_text(static_cast<double>(chunk.deviation)),
               number_text(static_cast<double>(chunk.curvature_error)), text_of(chunk.byte_length),
               text_of(chunk.decoded_bytes)});
  }
  table.print();
}

namespace {

Json one_json(const ListedStream& stream) {
  Json json = {{"mesh", stream.mesh}};
  json.update(stream_json(stream.directory));
  json["coding"] = stream.parts ? Json(coding_name(stream.parts->coding)) : Json(nullptr);
  json["parts"] = stream.parts ? Json(part_names(*stream.parts)) : Json(nullptr);
  json["rounds"] = Json::array();
  if (!stream.parts) return json;
  const std::vector<std::uint64_t> ends = bytes_so_far(stream);
  for (std::size_t i = 0; i < ends.size(); ++i) json["rounds"].push_back(round_json(stream.parts->rounds[i], ends[i]));
  return json;
}

void print_one(const ListedStream& stream) {
  if (!stream.parts) {
    print_stream(stream);
    std::puts("its chunks are compressed as wholes: what parts take of them is not told apart");
    return;
  }
  const CompactRound& last = stream.parts->rounds.back();
  std::printf("\n%s, %llu bytes: %llu vertices, %llu faces, %s bits a vertex\n", title_of(stream).c_str(),
              static_cast<unsigned long long>(stream.directory.total_bytes),
              static_cast<unsigned long long>(last.vertex_count), static_cast<unsigned long long>(last.face_count),
              two_places(per(stream.parts->sizes.sum(), last.vertex_count)).c_str());
  print_sizes(sizes_of({&stream, 1}));
  print_rounds(stream);
}

}  // namespace

Json parts_json(const std::string& path, std::span<const ListedStream> streams) {
  Json all = {{"schema_version", kInspectSchemaVersion}, {"path", path}, {"kind", "parts"}, {"bytes", 0}};
  std::uint64_t bytes = 0;
  all["parts"] = sizes_json(sizes_of(streams));
  all["streams"] = Json::array();
  for (const ListedStream& stream : streams) {
    bytes += stream.directory.total_bytes;
    all["streams"].push_back(one_json(stream));
  }
  all["bytes"] = bytes;
  return all;
}

void print_parts(const std::string& path, std::span<const ListedStream> streams) {
  const PartSizes all = sizes_of(streams);
  if (streams.size() > 1 && all.vertices > 0) {
    std::printf("%s: compact streams of %zu meshes, %s bits a vertex\n", path.c_str(), streams.size(),
                two_places(per(all.sum(), all.vertices)).c_str());
    print_sizes(all);
  } else {
    std::printf("%s\n", path.c_str());
  }
  for (const ListedStream& stream : streams) print_one(stream);
}

}  // namespace lodestone::tool
