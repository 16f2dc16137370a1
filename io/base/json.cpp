#include "base/json.h"

#include <array>
#include <charconv>
#include <cmath>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "base/number_text.h"

namespace lodestone::detail {
namespace {

std::size_t nesting_depth(std::string_view text) {
  std::size_t depth = 0, deepest = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      in_string = c != '"';
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      deepest = std::max(deepest, ++depth);
    } else if ((c == '}' || c == ']') && depth > 0) {
      --depth;
    }
  }
  return deepest;
}

tl::unexpected<Error> wrong(std::string_view where, const char* key, const Json& value, const char* expected) {
  std::string shown =
      value.is_structured() ? value.type_name() : value.dump(-1, ' ', true, Json::error_handler_t::replace);
  if (shown.size() > 40) shown = shown.substr(0, 40) + "...";
  return fail(ErrorCode::Malformed, text(where, ": ", key, " is ", shown, " and not ", expected));
}

}  // namespace

double of_few_digits(float value) {
  std::array<char, 32> digits;
  const char* const end = std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr;
  return parse_double({digits.data(), static_cast<std::size_t>(end - digits.data())}).value_or(value);
}

std::optional<std::size_t> as_size(const Json& value) {
  // Writers of glTF are known to say 3.0 for 3.
  constexpr double kLargest = 9007199254740992.0;  // 2^53: beyond it doubles skip whole numbers
  if (value.is_number_unsigned()) return value.get<std::size_t>();
  if (!value.is_number_float()) return std::nullopt;
  const double number = value.get<double>();
  if (!(number >= 0 && number <= kLargest) || number != std::floor(number)) return std::nullopt;
  return static_cast<std::size_t>(number);
}

Result<Json> parse_json(std::string_view source) {
  if (const std::size_t depth = nesting_depth(source); depth > kMaxJsonDepth)
    return fail(ErrorCode::LimitExceeded, text("json: nested ", depth, " deep, more than ", kMaxJsonDepth));
  try {
    return Json::parse(source);
  } catch (const Json::parse_error& error) {
    return fail(ErrorCode::Malformed, text("json: broken at byte ", error.byte), error.byte);
  } catch (const Json::exception& error) {
    return fail(ErrorCode::Malformed, text("json: ", error.what()));
  }
}

const Json* find_member(const Json& value, const char* key) {
  if (!value.is_object()) return nullptr;
  const auto found = value.find(key);
  return found == value.end() ? nullptr : &*found;
}

Result<std::size_t> size_member(const Json& object, const char* key, std::string_view where) {
  const Json* value = find_member(object, key);
  if (value == nullptr) return fail(ErrorCode::Malformed, text(where, ": ", key, " is missing"));
  if (const auto size = as_size(*value)) return *size;
  return wrong(where, key, *value, "a whole number");
}

Result<std::size_t> size_member_or(const Json& object, const char* key, std::size_t fallback, std::string_view where) {
  if (find_member(object, key) == nullptr) return fallback;
  return size_member(object, key, where);
}

std::string string_member(const Json& object, const char* key) {
  const Json* value = find_member(object, key);
  return value != nullptr && value->is_string() ? value->get<std::string>() : std::string();
}

double number_member(const Json& object, const char* key, double fallback) {
  const Json* value = find_member(object, key);
  return value != nullptr && value->is_number() ? value->get<double>() : fallback;
}

Result<std::vector<std::size_t>> size_array_member(const Json& object, const char* key, std::string_view where) {
  std::vector<std::size_t> sizes;
  const Json* value = find_member(object, key);
  if (value == nullptr) return sizes;
  if (!value->is_array()) return wrong(where, key, *value, "an array");
  for (const Json& element : *value) {
    const auto size = as_size(element);
    if (!size) return wrong(where, key, element, "an array of whole numbers");
    sizes.push_back(*size);
  }
  return sizes;
}

Result<std::vector<double>> number_array_member(const Json& object, const char* key, std::size_t count,
                                                std::string_view where) {
  std::vector<double> numbers;
  const Json* value = find_member(object, key);
  if (value == nullptr) return numbers;
  if (!value->is_array()) return wrong(where, key, *value, "an array");
  if (value->size() != count)
    return fail(ErrorCode::Malformed, text(where, ": ", key, " has ", value->size(), " numbers and not ", count));
  for (const Json& element : *value) {
    if (!element.is_number()) return wrong(where, key, element, "an array of numbers");
    numbers.push_back(element.get<double>());
  }
  return numbers;
}

}  // namespace lodestone::detail
