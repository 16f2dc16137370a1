#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <lodestone/core/result.h>

namespace lodestone::tool {

/// A file that is written in full beside its destination and takes its place only on `commit`.
///
/// Commands with several outputs stage all of them and commit at the end: a failure before that leaves every
/// destination as it was. A symbolic link stays, what it leads to is replaced. The standard output (`-`), devices and
/// pipes cannot be replaced: they are written directly, on `write`.
class StagedFile {
 public:
  explicit StagedFile(std::filesystem::path destination);
  /// Removes what was staged and not committed.
  ~StagedFile();
  StagedFile(const StagedFile&) = delete;
  StagedFile& operator=(const StagedFile&) = delete;

  /// Errors: NotWritten.
  Result<void> write(std::span<const std::byte> bytes);
  /// Keeps the file that its destination has now, for `undo`, as long as this object lives. Errors: NotWritten.
  Result<void> keep_old();
  /// Moves the staged file to its destination. Errors: NotWritten.
  Result<void> commit();
  /// Takes `commit` back: the destination has the kept file again, or none.
  void undo();
  const std::filesystem::path& destination() const { return destination_; }

 private:
  std::filesystem::path destination_;  // as the user names it
  std::filesystem::path target_;       // where its links lead
  std::filesystem::path staged_;       // empty where nothing waits to be moved
  std::filesystem::path old_;          // a second name of the file that was there; empty where none was
  bool is_committed_ = false;
};

/// Folders that are made for files; those that no file came to go away again.
class MadeFolders {
 public:
  MadeFolders() = default;
  ~MadeFolders();
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  /// Makes a folder and those above it, where they do not exist. Errors: NotWritten.
  Result<void> make(const std::filesystem::path& folder);

 private:
  std::vector<std::filesystem::path> made_;  // outer ones first
};

/// Files that appear together, once all of them are written.
class StagedFiles {
 public:
  /// Adds a file, in a folder that is made where it does not exist. Errors: NotWritten.
  Result<void> add_with_folder(const std::filesystem::path& path, std::span<const std::byte> bytes);
  /// Errors: NotWritten.
  Result<void> add(const std::filesystem::path& path, std::span<const std::byte> bytes);
  Result<void> add(const std::filesystem::path& path, const std::string& text);
  /// Whether a file was added under this path.
  bool has(const std::filesystem::path& path) const;
  /// Moves all files to their destinations, or none. Errors: NotWritten.
  Result<void> commit();

 private:
  MadeFolders folders_;
  std::vector<std::unique_ptr<StagedFile>> files_;  // go before their folders do
};

/// Checks, before the long work starts, that a file can be put at `path`, by making one beside it for a moment.
/// Errors: NotWritten where its folder does not exist or cannot be written to, where its name is too long, or where it
/// is a folder itself.
Result<void> check_destination(const std::filesystem::path& path);

}  // namespace lodestone::tool
