#include "staged_file.h"

#include <random>
#include <string>
#include <system_error>

#include <lodestone/io/file.h>

#include "messages.h"

namespace lodestone::tool {
namespace {

namespace fs = std::filesystem;

/// A name beside the destination that no other run uses at the same time; the destination itself if it is a device.
fs::path staged_name(const fs::path& destination) {
  std::error_code ignored;
  if (fs::is_other(destination, ignored)) return destination;
  fs::path name = destination;
  name.replace_filename(std::string(".").append(destination.filename().string()) + ".staged-" +
                        std::to_string(std::random_device{}()));
  return name;
}

}  // namespace

StagedFile::StagedFile(fs::path destination)
    : destination_(std::move(destination)), staged_(staged_name(destination_)) {}

StagedFile::~StagedFile() {
  std::error_code ignored;
  if (staged_ != destination_) fs::remove(staged_, ignored);
}

Result<void> StagedFile::write(std::span<const std::byte> bytes) {
  return write_file(staged_, bytes).map_error([&](Error error) {
    // Messages name the file the user asked for, not its stand-in.
    const std::size_t begin = error.message.find(staged_.string());
    if (begin != std::string::npos) error.message.replace(begin, staged_.string().size(), destination_.string());
    return error;
  });
}

Result<void> StagedFile::commit() {
  if (staged_ == destination_) return {};
  std::error_code error;
  fs::rename(staged_, destination_, error);
  if (error) return fail(ErrorCode::NotWritten, "cannot write " + quoted(destination_) + ": " + error.message());
  return {};
}

Result<void> StagedFiles::add(const fs::path& path, std::span<const std::byte> bytes) {
  files_.push_back(std::make_unique<StagedFile>(path));
  return files_.back()->write(bytes);
}

Result<void> StagedFiles::add(const fs::path& path, const std::string& text) {
  return add(path, std::as_bytes(std::span(text)));
}

Result<void> StagedFiles::commit() {
  for (const auto& file : files_)
    if (Result<void> done = file->commit(); !done) return done;
  return {};
}

Result<void> check_destination(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error)) {
    return fail(ErrorCode::NotWritten, "cannot write " + quoted(path) + ": it is a folder");
  }
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) {
    return fail(ErrorCode::NotWritten,
                "cannot write " + quoted(path) + ": the folder " + quoted(folder) + " does not exist");
  }
  return {};
}

}  // namespace lodestone::tool
