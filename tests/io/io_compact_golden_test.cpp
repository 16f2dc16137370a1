// The files of compact-3.0 and compact-3.1: what was fixed with a version stays, whatever becomes of the encoder and of
// `simplify`.

#include <lodestone/io/compact_stream.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <lodestone/io/file.h>

#include "golden/compact_files.h"
#include "support/catch.h"

namespace lodestone::test {
namespace {

const std::filesystem::path kFolder = std::filesystem::path(LODESTONE_SOURCE_DIR) / kGoldenFolder;
constexpr std::size_t kMostBytes = 3000;

std::vector<std::byte> read(const CompactFile& file) {
  auto bytes = read_file(kFolder / file.folder / (file.name + ".lods"));
  REQUIRE(bytes);
  return std::move(*bytes);
}

std::vector<std::string> lines_of(const CompactFile& file) {
  std::ifstream text(kFolder / file.folder / (file.name + ".txt"));
  std::vector<std::string> lines;
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  REQUIRE_FALSE(lines.empty());
  return lines;
}

}  // namespace

TEST_CASE("every compact file of the folder is made here, and has a text") {
  std::set<std::string> files, texts, made;
  const auto name_of = [](std::filesystem::path path) {
    return path.replace_extension().lexically_relative(kFolder).generic_string();
  };
  for (const char* folder : kCompactFolders)
    for (const auto& entry : std::filesystem::directory_iterator(kFolder / folder)) {
      if (entry.path().extension() == ".lods") files.insert(name_of(entry.path()));
      if (entry.path().extension() == ".txt") texts.insert(name_of(entry.path()));
    }
  for (const CompactFile& file : compact_files()) {
    CHECK(made.insert(file.folder + '/' + file.name).second);
    CHECK(read(file).size() < kMostBytes);
  }
  CHECK(files == made);
  CHECK(texts == made);
}

TEST_CASE("compact files decode to what their texts say after each chunk") {
  for (const CompactFile& file : compact_files()) {
    INFO(file.folder << '/' << file.name << ".lods");
    const std::vector<std::string> expected = lines_of(file), found = compact_levels(read(file));
    CHECK(expected.front() == compact_heading(file));
    REQUIRE(expected.size() == found.size() + 1);
    for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i] == expected[i + 1]);
  }
}

TEST_CASE("the compact files have what the format has: sectors of all shapes, loose records, stages, attributes") {
  std::array<std::size_t, 4> shapes{};
  std::set<ComponentType> types;
  std::size_t most_sectors = 0, most_chunks = 0, without_sectors = 0, moves = 0, loose = 0, most_groups = 0;
  for (const CompactFile& file : compact_files()) {
    INFO(file.folder << '/' << file.name);
    const std::vector<std::byte> bytes = read(file);
    const auto mesh = decode_compact(bytes);
    const auto parts = measure_compact(bytes);
    REQUIRE(mesh);
    REQUIRE(parts);
    CHECK(validate(*mesh));
    CHECK((parts->coding == CompactCoding::Fast) == (file.folder == "compact-3.1"));
    for (const SectorHeader& sector : mesh->sectors) ++shapes.at(static_cast<std::size_t>(sector.shape));
    for (std::size_t k = 0; k < mesh->record_count(); ++k) {
      const std::size_t sectors = mesh->sector_begin[k + 1] - mesh->sector_begin[k];
      without_sectors += sectors == 0 ? 1 : 0;
      most_sectors = std::max(most_sectors, sectors);
    }
    for (const CompactRound& round : parts->rounds) loose += round.loose_count;
    for (const Attribute& attribute : mesh->attributes) types.insert(attribute.type);
    moves += mesh->moves.size();
    most_groups = std::max(most_groups, mesh->groups.size());
    most_chunks = std::max(most_chunks, read_compact_chunks(bytes).value().size());
  }
  for (const std::size_t count : shapes) CHECK(count > 0);
  CHECK(types.size() == 6);
  CHECK(most_sectors > 2);
  CHECK(most_chunks > 2);
  CHECK(without_sectors > 0);
  CHECK(moves > 0);
  CHECK(loose > 0);
  CHECK(most_groups > 1);
}

}  // namespace lodestone::test
