#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <lodestone/core/assemble.h>
#include <lodestone/core/result.h>

namespace lodestone::tool {

/// Prints `lodestone: error: …` to standard error.
void print_error(std::string_view message);

/// Prints `lodestone: warning: …` to standard error.
void print_warning(std::string_view message);

/// Returns an error's message, with its place in the file where it has one.
std::string describe(const Error& error);

/// Returns a user's text as messages show it: in single quotes.
std::string quoted(std::string_view text);
std::string quoted(const std::filesystem::path& path);

/// Returns a sentence for each thing that assembly changed; none for a clean file.
std::vector<std::string> sentences(const AssemblyReport& report);

}  // namespace lodestone::tool
