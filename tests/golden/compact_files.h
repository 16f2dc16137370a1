#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

// What the files of compact-3.0 are made of.

namespace lodestone::test {

inline constexpr char kCompactFolder[] = "tests/golden/compact-3.0";

/// A compact stream as the encoder wrote it when version 3.0 was fixed.
struct CompactFile {
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
