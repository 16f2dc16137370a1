#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lodestone/core/result.h>

namespace CLI {
class App;
}

namespace lodestone::tool {

/// What is read and where the result goes.
struct FilePair {
  std::filesystem::path input;   ///< `-` for the standard input
  std::filesystem::path output;  ///< `-` for the standard output
  bool in_folder = false;        ///< the user named the folder of `output`, not the file
};

/// The files of a command that makes files of files, in any way that users name them: IN -o OUT, IN OUT, -i IN -o OUT,
/// IN IN … -o FOLDER/.
struct FileWords {
  std::vector<std::filesystem::path> positional;
  std::vector<std::filesystem::path> inputs;    ///< with -i
  std::optional<std::filesystem::path> output;  ///< with -o

  void add_to(CLI::App& app, const char* input_help, const char* output_help);
  /// Returns each input with its output; in a folder that is the input's name, ending in `extension`. A folder is what
  /// ends in a slash or exists; of several inputs, whatever has no extension of its own.
  /// Errors: InvalidArgument where an input or the output is missing, where two inputs would become one file, or an
  /// output is an input.
  Result<std::vector<FilePair>> pair_up(const std::string& extension) const;
  /// Whether the standard input is among the inputs.
  bool reads_standard_input() const;

 private:
  Result<std::vector<std::filesystem::path>> take_output(std::filesystem::path& target) const;
};

/// What one level is written as, a scene or triangles alone: extensions without a dot, and as a sentence names them.
inline constexpr std::array<std::string_view, 4> kLevelFormats = {"glb", "gltf", "obj", "ply"};
inline constexpr const char* kLevelFormatNames = ".glb, .gltf, .obj or .ply";
bool is_level_format(std::string_view extension);

/// Adds --format, for what has no name of its own: one of `names`, extensions without a dot.
void add_format_option(CLI::App& app, std::string& format, std::span<const std::string_view> names);

/// Returns the extension of what is written, without its dot: the output's, or of the standard output `format`.
std::string output_extension(const std::filesystem::path& output, const std::string& format);

/// Returns what to make of `path` for the input of that name: the file itself, or inside it where it is a folder.
std::filesystem::path place_in(const std::filesystem::path& path, const std::filesystem::path& input,
                               const std::string& extension, bool several);

}  // namespace lodestone::tool
