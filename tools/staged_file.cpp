#include "staged_file.h"

#include <algorithm>
#include <random>
#include <string>
#include <system_error>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>

#include "messages.h"
#include "standard_streams.h"

namespace lodestone::tool {
namespace {

using detail::text;

namespace fs = std::filesystem;

/// A name that no other run uses at the same time.
fs::path staged_name(const fs::path& target) { return stand_in_name(target, text(".staged-", std::random_device{}())); }

/// Messages name the file the user asked for, not its stand-in.
Error naming(Error error, const fs::path& stand_in, const fs::path& destination) {
  const std::size_t begin = error.message.find(stand_in.string());
  if (begin != std::string::npos) error.message.replace(begin, stand_in.string().size(), destination.string());
  return error;
}

/// A device cannot be replaced by a file, nor can what reads at the other end of a pipe.
bool takes_bytes_directly(const fs::path& path) {
  std::error_code ignored;
  return is_standard_stream(path) || fs::is_other(path, ignored);
}

Result<void> check_is_no_folder(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    return fail(ErrorCode::NotWritten, "cannot write " + quoted(path) + ": it is a folder");
  }
  [[maybe_unused]] const fs::file_status status = fs::symlink_status(path, error);
  if (error == std::errc::filename_too_long) {
    return fail(ErrorCode::NotWritten, "cannot write " + quoted(path) + ": " + error.message());
  }
  return {};
}

/// Rights, quotas and read-only file systems say no in many ways; only a file that was made shows that none does.
Result<void> try_to_write_beside(const fs::path& target, const fs::path& destination) {
  const fs::path trial = staged_name(target);
  Result<void> written = write_file(trial, {});
  std::error_code ignored;
  fs::remove(trial, ignored);
  return written.map_error([&](Error error) { return naming(std::move(error), trial, destination); });
}

}  // namespace

StagedFile::StagedFile(fs::path destination) : destination_(std::move(destination)) {}

StagedFile::~StagedFile() {
  std::error_code ignored;
  for (const fs::path& leftover : {staged_, old_})
    if (!leftover.empty()) fs::remove(leftover, ignored);
}

Result<void> StagedFile::write(std::span<const std::byte> bytes) {
  if (is_standard_stream(destination_)) return write_standard_output(bytes);
  if (takes_bytes_directly(destination_)) return write_file(destination_, bytes);
  LODESTONE_CHECK(check_is_no_folder(destination_));
  LODESTONE_TRY(target_, follow_links(destination_));
  staged_ = staged_name(target_);
  return write_file(staged_, bytes).map_error([&](Error error) {
    return naming(std::move(error), staged_, destination_);
  });
}

Result<void> StagedFile::keep_old() {
  std::error_code error;
  if (staged_.empty() || !fs::is_regular_file(target_, error)) return {};
  const fs::path kept = staged_name(target_);
  fs::create_hard_link(target_, kept, error);
  if (error) fs::copy_file(target_, kept, error);  // some file systems have no links
  if (error) return fail(ErrorCode::NotWritten, "cannot replace " + quoted(destination_) + ": " + error.message());
  old_ = kept;
  return {};
}

Result<void> StagedFile::commit() {
  if (staged_.empty()) return {};
  std::error_code error;
  fs::rename(staged_, target_, error);
  if (error) return fail(ErrorCode::NotWritten, "cannot write " + quoted(destination_) + ": " + error.message());
  staged_.clear();
  is_committed_ = true;
  return {};
}

void StagedFile::undo() {
  if (!is_committed_) return;
  std::error_code ignored;
  old_.empty() ? void(fs::remove(target_, ignored)) : fs::rename(old_, target_, ignored);
  old_.clear();
  is_committed_ = false;
}

MadeFolders::~MadeFolders() {
  std::error_code not_empty;
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) fs::remove(*folder, not_empty);
}

Result<void> MadeFolders::make(const fs::path& folder) {
  fs::path path;
  for (const fs::path& part : folder) {
    path /= part;
    std::error_code error;
    if (path.empty() || fs::is_directory(path, error)) continue;
    if (!fs::create_directory(path, error))
      return fail(ErrorCode::NotWritten,
                  "cannot make the folder " + quoted(path) + ": " + (error ? error.message() : "a file has that name"));
    made_.push_back(path);
  }
  return {};
}

Result<void> StagedFiles::add_with_folder(const fs::path& path, std::span<const std::byte> bytes) {
  LODESTONE_CHECK(folders_.make(path.parent_path()));
  return add(path, bytes);
}

Result<void> StagedFiles::add(const fs::path& path, std::span<const std::byte> bytes) {
  files_.push_back(std::make_unique<StagedFile>(path));
  return files_.back()->write(bytes);
}

Result<void> StagedFiles::add(const fs::path& path, const std::string& text) {
  return add(path, std::as_bytes(std::span(text)));
}

bool StagedFiles::has(const fs::path& path) const {
  return std::any_of(files_.begin(), files_.end(), [&](const auto& file) { return file->destination() == path; });
}

Result<void> StagedFiles::commit() {
  for (const auto& file : files_) LODESTONE_CHECK(file->keep_old());
  for (const auto& file : files_) {
    Result<void> done = file->commit();
    if (done) continue;
    for (const auto& other : files_) other->undo();
    return done;
  }
  return {};
}

Result<void> check_destination(const fs::path& path) {
  if (takes_bytes_directly(path)) return {};
  LODESTONE_CHECK(check_is_no_folder(path));
  LODESTONE_TRY(const fs::path target, follow_links(path));
  std::error_code error;
  const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) {
    return fail(ErrorCode::NotWritten,
                "cannot write " + quoted(path) + ": the folder " + quoted(folder) + " does not exist");
  }
  return try_to_write_beside(target, path);
}

}  // namespace lodestone::tool
