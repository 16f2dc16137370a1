#include "staged_file.h"

#include <filesystem>
#include <memory>
#include <string>

#include "support/catch.h"
#include "support/data.h"
#include "support/program.h"

namespace lodestone::test {

namespace fs = std::filesystem;

TEST_CASE("staged files appear together, and leave nothing beside them") {
  const ScratchDirectory folder;
  write_text(folder / "old", "before");
  {
    tool::StagedFiles files;
    REQUIRE(files.add(folder / "old", std::string("after")));
    REQUIRE(files.add_with_folder(folder / "made/new", std::as_bytes(std::span("x", 1))));
    CHECK(file_text(folder / "old") == "before");
    REQUIRE(files.commit());
  }
  CHECK(file_text(folder / "old") == "after");
  CHECK(file_text(folder / "made/new") == "x");
  CHECK(names_in(folder / ".") == std::vector<std::string>{"made", "old"});
}

TEST_CASE("where one of several files cannot be put in its place, all others are as they were") {
  for (int broken = 0; broken < 3; ++broken) {
    CAPTURE(broken);
    const ScratchDirectory folder;
    write_text(folder / "0", "before 0");
    write_text(folder / "2", "before 2");
    const std::string name = std::to_string(broken);
    {
      tool::StagedFiles files;
      for (const char* file : {"0", "1", "2"}) REQUIRE(files.add(folder / file, std::string("after")));
      // Something else takes the place after it was looked at: a folder, which no file replaces.
      fs::remove(folder / name);
      fs::create_directories(folder / name / "full");
      const Result<void> done = files.commit();
      REQUIRE_FALSE(done);
      CHECK(done.error().code == ErrorCode::NotWritten);
    }
    for (const char* file : {"0", "1", "2"}) {
      if (file == name) continue;
      const bool was_there = std::string(file) != "1";
      CHECK(fs::exists(folder / file) == was_there);
      if (was_there) CHECK(file_text(folder / file) == "before " + std::string(file));
    }
    CHECK(names_in(folder / ".").size() == (broken == 1 ? 3 : 2));
  }
}

}  // namespace lodestone::test
