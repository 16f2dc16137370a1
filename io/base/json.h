#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include <lodestone/core/result.h>

namespace lodestone::detail {

/// Keeps members in the order they came in, so that what we write is deterministic and what we keep stays as it was.
using Json = nlohmann::ordered_json;

/// How deep documents may nest: writing them out again recurses.
inline constexpr std::size_t kMaxJsonDepth = 200;

/// Parses UTF-8 text. Errors: Malformed with the offset; LimitExceeded where it nests deeper than that.
Result<Json> parse_json(std::string_view text);

/// Returns the member of an object, or null where there is none or `value` is no object.
const Json* find_member(const Json& value, const char* key);

/// Returns a whole number ≥ 0; nothing for any other value.
std::optional<std::size_t> as_size(const Json& value);

/// Returns a member that must be a whole number ≥ 0. `where` names the object for messages, e.g. "accessor 3".
Result<std::size_t> size_member(const Json& object, const char* key, std::string_view where);
/// The same, with a value for where the member is missing.
Result<std::size_t> size_member_or(const Json& object, const char* key, std::size_t fallback, std::string_view where);

/// Returns the member as a string, or "" where there is none or it is something else.
std::string string_member(const Json& object, const char* key);
/// Returns the member as a number, or `fallback` where there is none or it is something else.
double number_member(const Json& object, const char* key, double fallback);

/// Returns the double of the fewest digits that is nearest to a float: written as text, it has nine at most where the
/// float itself, a double then, has seventeen. Pre: finite.
double of_few_digits(float value);

/// Reads an array of whole numbers ≥ 0; empty where the member is missing.
Result<std::vector<std::size_t>> size_array_member(const Json& object, const char* key, std::string_view where);
/// Reads an array of exactly `count` numbers; empty where the member is missing.
Result<std::vector<double>> number_array_member(const Json& object, const char* key, std::size_t count,
                                                std::string_view where);

}  // namespace lodestone::detail
