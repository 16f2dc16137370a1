#include "build_settings.h"

#include <map>
#include <string>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>
#include <lodestone/io/file.h>

#include "json_text.h"
#include "messages.h"

namespace lodestone::tool {
namespace {

auto malformed(const std::filesystem::path& path, const std::string& what) {
  return fail(ErrorCode::Malformed, quoted(path) + ": " + what);
}

Result<PartImportance> parse_part(const std::filesystem::path& path, const std::string& where, const Json& json) {
  PartImportance part;
  if (!json.is_object()) return malformed(path, where + " is not an object");
  for (const auto& [name, value] : json.items()) {
    if (name == "importance" && value.is_number() && value.get<double>() >= 0)
      part.factor = value.get<double>();
    else if (name == "lock" && value.is_boolean())
      part.lock = value.get<bool>();
    else if (name == "importance" || name == "lock")
      return malformed(path, detail::text(where, ": ", name,
                                          name == "lock" ? " is not true or false" : " is not a number of 0 or more"));
    else
      return malformed(path, where + ": no setting is called " + quoted(std::string_view(name)));
  }
  return part;
}

Result<std::map<std::string, PartImportance>> parse_parts(const std::filesystem::path& path, const std::string& member,
                                                          const Json& json) {
  std::map<std::string, PartImportance> parts;
  if (!json.is_object()) return malformed(path, member + " is not an object");
  for (const auto& [name, value] : json.items()) {
    LODESTONE_TRY(parts[name], parse_part(path, member + " " + quoted(std::string_view(name)), value));
  }
  return parts;
}

}  // namespace

Result<Importance> read_settings(const std::filesystem::path& path) {
  LODESTONE_TRY(const std::vector<std::byte> bytes, read_file(path));
  const auto* text = reinterpret_cast<const char*>(bytes.data());
  const Json json = Json::parse(text, text + bytes.size(), nullptr, false, true);
  if (json.is_discarded() || !json.is_object()) return malformed(path, "is not a JSON object");
  Importance settings;
  for (const auto& [name, value] : json.items()) {
    if (name != "materials" && name != "nodes")
      return malformed(path, "no setting is called " + quoted(std::string_view(name)));
    LODESTONE_TRY(auto parts, parse_parts(path, name, value));
    (name == "nodes" ? settings.nodes : settings.materials) = std::move(parts);
  }
  return settings;
}

}  // namespace lodestone::tool
