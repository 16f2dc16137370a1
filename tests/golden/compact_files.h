#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

// What the files of compact-3.0 and compact-3.1 are made of.

namespace lodestone::test {

inline constexpr char kGoldenFolder[] = "tests/golden";
/// One for each minor version: of streams of small coding, and of fast.
inline constexpr const char* kCompactFolders[] = {"compact-3.0", "compact-3.1"};

/// A compact stream as the encoder wrote it when its version was fixed.
struct CompactFile {
  std::string folder;  ///< in kGoldenFolder
  std::string name;
  std::string what;  ///< what it is there for
  std::function<std::vector<std::byte>()> encode;
};
std::vector<CompactFile> compact_files();

/// Returns what the streams that `bytes` is when it is cut off after each of its chunks decode to: one line for each,
/// as compact-3.0/README.md says. An error is a line, too.
std::vector<std::string> compact_levels(std::span<const std::byte> bytes);

/// Returns the first line of a file's text.
std::string compact_heading(const CompactFile& file);

}  // namespace lodestone::test
