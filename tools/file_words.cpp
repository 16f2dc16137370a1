#include "file_words.h"

#include <algorithm>
#include <map>
#include <string_view>
#include <system_error>
#include <utility>

#include <CLI/CLI.hpp>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>

#include "messages.h"
#include "standard_streams.h"

namespace lodestone::tool {
namespace {

using detail::text;

namespace fs = std::filesystem;

constexpr std::string_view kWritten[] = {"glb", "gltf", "lods", "obj", "ply", "json", "html"};

/// What ends like a file that is written means one, even where a folder has that name.
bool ends_like_a_file(const fs::path& path) {
  const std::string extension = extension_of(path);
  return std::find(std::begin(kWritten), std::end(kWritten), extension) != std::end(kWritten);
}

bool is_folder(const fs::path& path, bool several) {
  std::error_code ignored;
  if (is_standard_stream(path)) return false;
  if (!path.has_filename() || path == "." || path == "..") return true;
  return !ends_like_a_file(path) && (several || fs::is_directory(path, ignored));
}

tl::unexpected<Error> refuse(const std::string& what) { return fail(ErrorCode::InvalidArgument, what); }

Result<void> check_several(const std::vector<fs::path>& inputs, const fs::path& output, const FileWords& words) {
  if (std::count_if(inputs.begin(), inputs.end(), is_standard_stream) > 0)
    return refuse("the standard input cannot be one of several inputs");
  if (is_folder(output, true)) return {};
  std::string hint;
  std::error_code ignored;
  if (words.output && !words.positional.empty() && !fs::exists(words.positional.back(), ignored))
    hint = "; " + quoted(words.positional.back()) + " does not exist: is it a second output?";
  return refuse(text(inputs.size(), " inputs need a folder as output, ", quoted(output), " is a file's name", hint));
}

Result<void> check_pairs(const std::vector<FilePair>& pairs) {
  std::map<fs::path, fs::path> input_of;
  for (const FilePair& pair : pairs) {
    const auto [entry, is_new] = input_of.emplace(pair.output.lexically_normal(), pair.input);
    if (!is_new)
      return refuse(quoted(entry->second) + " and " + quoted(pair.input) + " would both become " + quoted(pair.output));
    std::error_code ignored;
    for (const FilePair& other : pairs)
      if (fs::equivalent(other.input, pair.output, ignored))
        return refuse("-o: " + quoted(pair.output) + " is the input");
  }
  return {};
}

}  // namespace

bool is_level_format(std::string_view extension) {
  return std::find(kLevelFormats.begin(), kLevelFormats.end(), extension) != kLevelFormats.end();
}

void add_format_option(CLI::App& app, std::string& format, std::span<const std::string_view> names) {
  app.add_option("--format", format, "What is written to a folder or to standard output (default glb)")
      ->check(CLI::IsMember(std::vector<std::string>(names.begin(), names.end())))
      ->type_name("NAME");
}

std::string output_extension(const std::filesystem::path& output, const std::string& format) {
  return is_standard_stream(output) ? format : extension_of(output);
}

void FileWords::add_to(CLI::App& app, const char* input_help, const char* output_help) {
  app.add_option("FILES", positional, "The input, and the output where -o does not name it")->type_name("");
  app.add_option("-i,--input", inputs, input_help)->allow_extra_args(false)->type_name("IN");
  app.add_option("-o,--output", output, output_help)->type_name("OUT");
}

/// Returns the inputs, and the output as `target`.
Result<std::vector<fs::path>> FileWords::take_output(fs::path& target) const {
  std::vector<fs::path> files = inputs;
  files.insert(files.end(), positional.begin(), positional.end());
  if (files.empty()) return refuse("no input is given");
  if (!output && (positional.empty() || files.size() == 1))
    return refuse("no output is given: where " + quoted(files.back()) + " is the input, add -o OUT");
  target = output ? *output : files.back();
  if (!output) files.pop_back();
  if (target.empty()) return refuse("the output has no name");
  return files;
}

Result<std::vector<FilePair>> FileWords::pair_up(const std::string& extension) const {
  fs::path target;
  LODESTONE_TRY(const std::vector<fs::path> files, take_output(target));
  const bool several = files.size() > 1;
  const bool in_folder = is_folder(target, several);
  if (several) {
    LODESTONE_CHECK(check_several(files, target, *this));
  } else if (in_folder && is_standard_stream(files.front())) {
    return refuse("the standard input has no name to be written under in " + quoted(target) + ": name the file");
  }
  std::vector<FilePair> pairs;
  for (const fs::path& input : files) pairs.push_back({input, place_in(target, input, extension, several), in_folder});
  LODESTONE_CHECK(check_pairs(pairs));
  return pairs;
}

bool FileWords::reads_standard_input() const {
  const auto reads = [](const std::vector<fs::path>& files) {
    return std::any_of(files.begin(), files.end(), is_standard_stream);
  };
  return reads(inputs) || reads(positional);
}

fs::path place_in(const fs::path& path, const fs::path& input, const std::string& extension, bool several) {
  return is_folder(path, several) ? path / input.stem().concat(extension) : path;
}

}  // namespace lodestone::tool
