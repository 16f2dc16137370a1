// The files of stream-2.0: what was fixed with the version stays, whatever becomes of the encoder and of `simplify`.

#include <array>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include <zstd.h>

#include <lodestone/io/file.h>
#include <lodestone/io/stream_format.h>
#include <lodestone/lod/cursor.h>

#include "golden/stream_files.h"
#include "support/catch.h"
#include "support/mesh_properties.h"

namespace lodestone::test {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(LODESTONE_SOURCE_DIR) / kGoldenFolder;
constexpr unsigned kZstdVersion = 10504;  // of the library that the files were made with

StreamBytes read(const std::string& name) {
  auto bytes = read_file(kFolder / (name + ".lds"));
  REQUIRE(bytes);
  return std::move(*bytes);
}

/// The lines of a table behind its first, without their first field, by that field.
std::map<std::string, std::string> read_table(const char* name) {
  std::ifstream file(kFolder / name);
  std::map<std::string, std::string> rows;
  std::string line;
  for (std::getline(file, line); std::getline(file, line);) {
    const std::size_t end = line.find('\t');
    REQUIRE(rows.emplace(line.substr(0, end), line.substr(end + 1)).second);
  }
  REQUIRE_FALSE(rows.empty());
  return rows;
}

std::string row_of(const EditedFile& file, const std::string& message) {
  return file.source + '\t' + file.what + '\t' + message;
}

/// Returns the columns of all chunks, and the header without what depends on how they are compressed.
std::pair<StreamBytes, std::vector<StreamBytes>> content_of(const StreamBytes& bytes) {
  TakenStream stream(bytes);
  std::vector<StreamBytes> content;
  for (std::size_t i = 0; i < stream.chunk_count(); ++i)
    for (const detail::Column& column : stream.columns(i))
      for (StreamBytes& plane : planes(column)) content.push_back(std::move(plane));
  for (std::size_t i = 0; i < stream.chunk_count(); ++i) stream.chunk(i).clear();
  return {stream.lay_out().seal().header(), content};
}

}  // namespace

TEST_CASE("every file of the folder is in one of its tables, and every row of the tables is a file made here") {
  std::set<std::string> files, rows, made;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder))
    if (entry.path().extension() == ".lds") files.insert(entry.path().stem().string());
  for (const char* table : {"valid.tsv", "must-fail.tsv"})
    for (const auto& [name, row] : read_table(table)) CHECK(rows.insert(name).second);
  for (const EncodedFile& file : encoded_files()) CHECK(made.insert(file.name).second);
  for (const auto& edits : {valid_edits(), breaking_edits()})
    for (const EditedFile& file : edits) CHECK(made.insert(file.name).second);
  CHECK(files == rows);
  CHECK(files == made);
}

TEST_CASE("valid files decode to the counts and refine to the levels that the table has") {
  const auto table = read_table("valid.tsv");
  for (const EncodedFile& file : encoded_files())
    CHECK(table.at(file.name) == summary_of(read(file.name)) + '\t' + file.what);
  for (const EditedFile& file : valid_edits())
    CHECK(table.at(file.name) == summary_of(read(file.name)) + '\t' + file.source + ": " + file.what);
}

TEST_CASE("valid files come back from their finest level as they were, byte for byte") {
  for (const auto& [name, row] : read_table("valid.tsv")) {
    INFO(name);
    const ProgressiveMesh mesh = decode_stream(read(name)).value();
    Cursor cursor(mesh);
    const Mesh base = extract_level(mesh, cursor);
    cursor.seek(static_cast<Index>(mesh.record_count()));
    const Mesh full = extract_level(mesh, cursor);
    cursor.seek(0);
    CHECK(extract_level(mesh, cursor).corner_wedge == base.corner_wedge);
    cursor.seek(static_cast<Index>(mesh.record_count()));
    CHECK(extract_level(mesh, cursor).corner_wedge == full.corner_wedge);
  }
}

TEST_CASE("encoded files are encoded to the same columns again, and to the same bytes where zstd is the same") {
  for (const EncodedFile& file : encoded_files()) {
    INFO(file.name);
    const StreamBytes bytes = read(file.name);
    StreamOptions options;
    options.records_per_chunk = file.records_per_chunk;
    const StreamBytes again = encode_stream(decode_stream(bytes).value(), options).value();
    CHECK(content_of(again) == content_of(bytes));
    if (ZSTD_versionNumber() == kZstdVersion) CHECK(again == bytes);
  }
}

TEST_CASE("files made by edits are what the edits make, byte for byte") {
  for (const auto& edits : {valid_edits(), breaking_edits()})
    for (const EditedFile& file : edits) {
      INFO(file.name);
      CHECK(file.edit(TakenStream(read(file.source))) == read(file.name));
    }
}

TEST_CASE("files that must fail give the message that the table has") {
  const auto table = read_table("must-fail.tsv");
  for (const EditedFile& file : breaking_edits()) {
    INFO(file.name);
    const auto mesh = decode_stream(read(file.name));
    CHECK(table.at(file.name) == row_of(file, mesh ? "none" : mesh.error().message));
    REQUIRE_FALSE(mesh);
  }
}

TEST_CASE("the encoded files have what the format has: all shapes of sectors, kinds of blocks and types") {
  std::array<std::size_t, 4> shapes{};
  std::array<std::size_t, 3> modes{};
  std::set<ComponentType> types;
  std::size_t without_sectors = 0, most_groups = 0, most_wedges = 0, most_sectors = 0, normalized = 0;
  for (const EncodedFile& file : encoded_files()) {
    const StreamBytes bytes = read(file.name);
    const ProgressiveMesh mesh = decode_stream(bytes).value();
    for (const SectorHeader& sector : mesh.sectors) ++shapes.at(static_cast<std::size_t>(sector.shape));
    for (std::size_t k = 0; k < mesh.record_count(); ++k) {
      const std::size_t sectors = mesh.sector_begin[k + 1] - mesh.sector_begin[k];
      without_sectors += sectors == 0 ? 1 : 0;
      most_sectors = std::max(most_sectors, sectors);
      most_wedges = std::max<std::size_t>(most_wedges, mesh.record_wedge_begin[k + 1] - mesh.record_wedge_begin[k]);
    }
    most_groups = std::max(most_groups, mesh.groups.size());
    for (const Attribute& attribute : mesh.attributes) {
      types.insert(attribute.type);
      normalized += attribute.normalized ? 1 : 0;
    }
    TakenStream stream(bytes);
    for (std::size_t i = 0; i < stream.chunk_count(); ++i)
      for (const Block& block : blocks_of(stream.chunk(i), stream.get<std::uint64_t>(TakenStream::entry(i, 16))))
        ++modes.at(static_cast<std::size_t>(block.mode));
  }
  for (const std::size_t count : shapes) CHECK(count > 0);
  for (const std::size_t count : modes) CHECK(count > 0);
  CHECK(types.size() == 6);
  CHECK(normalized > 0);
  CHECK(without_sectors > 0);
  CHECK(most_groups > 1);
  CHECK(most_wedges > 1);
  CHECK(most_sectors > 2);
}

}  // namespace lodestone::test
