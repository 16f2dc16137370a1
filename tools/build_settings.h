#pragma once

#include <filesystem>

#include <lodestone/core/result.h>
#include <lodestone/pipeline/importance.h>

namespace lodestone::tool {

/// Reads a settings file: {"materials": {NAME: {"importance": 4, "lock": true}}, "nodes": {NAME: …}}.
/// Errors: Unreadable, Malformed, naming the member.
Result<Importance> read_settings(const std::filesystem::path& path);

}  // namespace lodestone::tool
