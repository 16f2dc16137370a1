#include "target_options.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>

#include <lodestone/core/detail/text.h>
#include <lodestone/core/detail/try.h>

#include "error_size.h"
#include "messages.h"
#include "text_table.h"

namespace lodestone::tool {
namespace {

constexpr double kLargeError = 0.01;  // of the diagonal: few mean more without saying so
constexpr double kMostFaces = 1e15;   // every whole number up to here is a double

tl::unexpected<Error> fail_option(std::string_view option, const std::string& what) {
  return fail(ErrorCode::InvalidArgument, std::string("--").append(option) + ": " + what);
}

Result<LevelTarget> parse_faces(std::string_view text) {
  const Result<double> number = parse_number(text);
  if (!number || *number < 1 || *number > kMostFaces || *number != std::floor(*number)) {
    const char* hint = text.ends_with('%') ? "; a share of the faces is --ratio" : "";
    return fail_option("faces", quoted(text) + " is not a whole number above 0" + hint);
  }
  return LevelTarget{TargetKind::Faces, *number, false};
}

Result<LevelTarget> parse_error(std::string_view text) {
  const Result<ErrorSize> size = parse_error_size(text);
  if (!size) return fail_option("error", size.error().message);
  return LevelTarget{TargetKind::Error, size->value, size->unit == ErrorUnit::Diagonal};
}

Result<LevelTarget> parse_epsilon(std::string_view text) {
  const Result<double> number = parse_number(text);
  if (!number || *number < 0) {
    return fail_option("epsilon", quoted(text) + " is not a number of 0 or more");
  }
  return LevelTarget{TargetKind::Epsilon, *number, false};
}

Result<LevelTarget> parse_ratio(std::string_view text) {
  const Result<double> share = parse_share(text);
  if (!share || *share <= 0 || *share > 1) {
    const std::string hint = share && *share > 1 && *share <= 100 ? "; did you mean " + std::string(text) + "%?" : "";
    return fail_option("ratio", quoted(text) + " is not a share above 0 and at most 1, or 100%" + hint);
  }
  return LevelTarget{TargetKind::Faces, *share, true};
}

using ParseTarget = Result<LevelTarget> (*)(std::string_view);

/// Splits lists at commas and spaces, though not between a number and its unit. Nothing between two commas is a value,
/// too: a wrong one.
std::vector<std::string> split_lists(const std::vector<std::string>& lists) {
  std::vector<std::string> values;
  for (const std::string& list : lists) {
    for (std::size_t begin = 0; begin <= list.size();) {
      const std::size_t end = std::min(list.find(',', begin), list.size());
      std::string_view part = trimmed(std::string_view(list).substr(begin, end - begin));
      values.emplace_back();
      for (std::size_t stop = 0; !part.empty(); part = trimmed(part.substr(stop))) {
        stop = std::min(part.find(' '), part.size());
        const std::string_view word = part.substr(0, stop);
        const bool goes_on = is_unit(word) || word.starts_with('@') || values.back().ends_with('@');
        if (!values.back().empty() && !goes_on) values.emplace_back();
        values.back().append(word);
      }
      begin = end + 1;
    }
  }
  return values;
}

Result<std::vector<LevelTarget>> parse_targets(const std::vector<std::string>& lists, ParseTarget parse) {
  std::vector<LevelTarget> targets;
  for (const std::string& value : split_lists(lists)) {
    LODESTONE_TRY(LevelTarget target, parse(value));
    targets.push_back(target);
  }
  return targets;
}

}  // namespace

void TargetOptions::add_to(CLI::App& app, const char* group, bool lists, bool limits) {
  const auto add = [&](const char* name, std::vector<std::string>& values, const std::string& help) {
    app.add_option(name, values, help)->allow_extra_args(false)->type_name(lists ? "LIST" : "VALUE")->group(group);
  };
  add("--ratio", ratio,
      lists ? "Faces of a level, as a share of the one before (default 50%); a list: as shares of the whole mesh"
            : "At most this share of the whole mesh's faces: 0.1 or 10%");
  add("--faces", faces, "At most so many faces");
  add("--error", error,
      std::string("At most so much deviation: 0.1% of the bounding box's diagonal; 1px@1080p where that fills the "
                  "screen's height; 1mm (cm, m, in, ft; a glTF is in metres); or a plain number in the file's units") +
          (limits ? "; beside --ratio, --faces or --epsilon one that nothing goes beyond" : ""));
  add("--epsilon", epsilon, "At most so much curvature error: radians (gaussian) or file units (the others)");
}

Result<TargetOptions::Parsed> TargetOptions::parse() const {
  const struct {
    const std::vector<std::string>& lists;
    ParseTarget parse;
  } kinds[] = {{ratio, parse_ratio}, {faces, parse_faces}, {epsilon, parse_epsilon}};
  Parsed parsed;
  int given = 0;
  for (const auto& [lists, parse] : kinds) {
    if (lists.empty()) continue;
    if (++given > 1) return fail(ErrorCode::InvalidArgument, "give only one of --ratio, --faces, --epsilon");
    LODESTONE_TRY(parsed.targets, parse_targets(lists, parse));
  }
  LODESTONE_TRY(std::vector<LevelTarget> errors, parse_targets(error, parse_error));
  if (given == 0) {
    parsed.targets = std::move(errors);
  } else if (errors.size() > 1) {
    return fail(ErrorCode::InvalidArgument,
                "--error: with --ratio, --faces or --epsilon it limits all levels: give one value");
  } else if (!errors.empty()) {
    parsed.limit = errors.front();
  }
  return parsed;
}

bool TargetOptions::is_one_ratio() const { return split_lists(ratio).size() == 1; }

std::vector<std::string> TargetOptions::remarks(double diagonal, bool in_metres) const {
  std::vector<std::string> lines;
  for (const std::string& value : split_lists(error)) {
    const Result<ErrorSize> size = parse_error_size(value);
    if (size->unit == ErrorUnit::File && size->value > kLargeError * diagonal)
      lines.push_back(detail::text("--error ", value, " is in the file's units, ", percent_text(size->value, diagonal),
                                   " of the diagonal; is a percentage meant, write ", value, "%"));
    if (size->unit == ErrorUnit::Metre && !in_metres)
      lines.push_back(
          detail::text("--error ", value, ": the format does not say what its unit is; it is taken to be the metre"));
  }
  return lines;
}

}  // namespace lodestone::tool
