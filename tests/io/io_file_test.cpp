#include <lodestone/io/file.h>

#include <sys/stat.h>

#include <cstring>
#include <string>

#include "support/catch.h"
#include "support/data.h"

namespace lodestone::test {
namespace {

std::vector<std::byte> bytes_of(const std::string& text) {
  std::vector<std::byte> bytes(text.size());
  if (!text.empty()) std::memcpy(bytes.data(), text.data(), text.size());
  return bytes;
}

std::size_t file_count(const std::filesystem::path& folder) {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder)) ++count;
  return count;
}

}  // namespace

TEST_CASE("files read back as written") {
  const ScratchDirectory scratch;
  for (const std::size_t size : {0u, 1u, 4096u, 3000000u}) {
    std::vector<std::byte> bytes(size);
    for (std::size_t i = 0; i < size; ++i) bytes[i] = static_cast<std::byte>(i * 31 + i / 256);
    REQUIRE(write_file(scratch / "file", bytes));
    const auto read = read_file(scratch / "file");
    REQUIRE(read);
    CHECK(*read == bytes);
  }
  CHECK(file_count(scratch.path()) == 1);
}

TEST_CASE("writing replaces a file whole and leaves nothing else behind") {
  const ScratchDirectory scratch;
  REQUIRE(write_file(scratch / "file", bytes_of("a longer text")));
  REQUIRE(write_file(scratch / "file", bytes_of("short")));
  CHECK(*read_file(scratch / "file") == bytes_of("short"));
  CHECK(file_count(scratch.path()) == 1);
}

TEST_CASE("a failed write names the path, keeps the old file and removes the temporary one") {
  const ScratchDirectory scratch;
  const auto missing = scratch.path() / "missing" / "file";
  const auto written = write_file(missing, bytes_of("x"));
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ErrorCode::NotWritten);
  CHECK_THAT(written.error().message, contains(missing.string()) && contains("No such file"));

  std::filesystem::create_directory(scratch / "folder");
  CHECK_FALSE(write_file(scratch / "folder", bytes_of("x")));
  CHECK(std::filesystem::is_directory(scratch / "folder"));
  CHECK(file_count(scratch.path()) == 1);
}

TEST_CASE("reading what is not there or no file names path and reason") {
  const ScratchDirectory scratch;
  const auto missing = read_file(scratch / "missing");
  REQUIRE_FALSE(missing);
  CHECK(missing.error().code == ErrorCode::Unreadable);
  CHECK_THAT(missing.error().message, contains("missing") && contains("No such file"));
  const auto folder = read_file(scratch.path());
  REQUIRE_FALSE(folder);
  CHECK_THAT(folder.error().message, contains("directory"));
}

TEST_CASE("a symbolic link is followed and stays a link") {
  namespace fs = std::filesystem;
  const ScratchDirectory scratch;
  fs::create_directory(scratch / "folder");
  fs::create_symlink("folder/file", scratch / "relative");
  fs::create_symlink(scratch / "relative", scratch / "chain");
  for (const char* link : {"relative", "chain"}) {
    for (const char* text : {"new", "replaced"}) {
      CAPTURE(link, text);
      REQUIRE(write_file(scratch / link, bytes_of(text)));
      CHECK(fs::is_symlink(scratch / link));
      CHECK(*read_file(scratch.path() / "folder" / "file") == bytes_of(text));
      CHECK(fs::equivalent(follow_links(scratch / link).value(), scratch.path() / "folder" / "file"));
    }
    fs::remove(scratch.path() / "folder" / "file");
  }
  fs::create_symlink("round", scratch / "round");
  CHECK(write_file(scratch / "round", bytes_of("x")).error().code == ErrorCode::NotWritten);
  CHECK(file_count(scratch.path()) == 4);
}

TEST_CASE("the longest name that a folder takes can be written") {
  const ScratchDirectory scratch;
  const std::string longest(255, 'n');
  REQUIRE(write_file(scratch / longest, bytes_of("x")));
  CHECK(*read_file(scratch / longest) == bytes_of("x"));
  CHECK(file_count(scratch.path()) == 1);
  CHECK(write_file(scratch / (longest + "n"), bytes_of("x")).error().code == ErrorCode::NotWritten);
  CHECK(file_count(scratch.path()) == 1);
}

TEST_CASE("devices are written through, not replaced") {
  REQUIRE(write_file("/dev/null", bytes_of("x")));
  CHECK(std::filesystem::is_character_file("/dev/null"));
}

}  // namespace lodestone::test
