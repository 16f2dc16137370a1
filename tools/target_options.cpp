#include "target_options.h"

#include <algorithm>
#include <cmath>

#include <CLI/CLI.hpp>

#include "error_size.h"
#include "messages.h"

namespace lodestone::tool {
namespace {

constexpr double kMostFaces = 1e15;  // every whole number up to here is a double

tl::unexpected<Error> fail_option(std::string_view option, const std::string& what) {
  return fail(ErrorCode::InvalidArgument, std::string("--").append(option) + ": " + what);
}

Result<LevelTarget> parse_faces(std::string_view text) {
  const Result<double> number = parse_number(text);
  if (!number || *number < 1 || *number > kMostFaces || *number != std::floor(*number)) {
    return fail_option("faces", quoted(text) + " is not a whole number above 0");
  }
  return LevelTarget{TargetKind::Faces, *number, false};
}

Result<LevelTarget> parse_error(std::string_view text) {
  const Result<ErrorSize> size = parse_error_size(text);
  if (!size) return fail_option("error", size.error().message);
  return LevelTarget{TargetKind::Error, size->value, size->relative};
}

Result<LevelTarget> parse_epsilon(std::string_view text) {
  const Result<double> number = parse_number(text);
  if (!number || *number < 0) {
    return fail_option("epsilon", quoted(text) + " is not a number of 0 or more");
  }
  return LevelTarget{TargetKind::Epsilon, *number, false};
}

Result<LevelTarget> parse_target(TargetKind kind, std::string_view text) {
  switch (kind) {
    case TargetKind::Faces:
      return parse_faces(text);
    case TargetKind::Error:
      return parse_error(text);
    case TargetKind::Epsilon:
      return parse_epsilon(text);
  }
  return fail(ErrorCode::InvalidArgument, "no such target");
}

Result<std::vector<LevelTarget>> parse_targets(TargetKind kind, std::string_view list) {
  std::vector<LevelTarget> targets;
  for (std::size_t begin = 0; begin <= list.size();) {
    const std::size_t end = std::min(list.find(',', begin), list.size());
    Result<LevelTarget> target = parse_target(kind, list.substr(begin, end - begin));
    if (!target) return tl::unexpected(std::move(target.error()));
    targets.push_back(*target);
    begin = end + 1;
  }
  return targets;
}

Result<LevelTarget> parse_ratio(std::string_view text) {
  const Result<double> number = parse_number(text);
  if (!number || *number <= 0 || *number > 1) {
    return fail_option("ratio", quoted(text) + " is not a number above 0 and at most 1");
  }
  return LevelTarget{TargetKind::Faces, *number, true};
}

}  // namespace

void TargetOptions::add_to(CLI::App& app, const char* group, bool lists) {
  const char* type = lists ? "LIST" : "VALUE";
  app.add_option("--ratio", ratio,
                 lists ? "Faces of a level, as a share of the one before (default 0.5)"
                       : "At most this share of the whole mesh's faces")
      ->type_name("SHARE")
      ->group(group);
  app.add_option("--faces", faces, "At most so many faces")->type_name(type)->group(group);
  app.add_option("--error", error, "At most so much deviation: 0.1% of the bounding-box diagonal, or file units")
      ->type_name(type)
      ->group(group);
  app.add_option("--epsilon", epsilon, "At most so much curvature error: radians (gaussian) or file units (the others)")
      ->type_name(type)
      ->group(group);
}

Result<std::vector<LevelTarget>> TargetOptions::parse() const {
  if (given_count() > 1) {
    return fail(ErrorCode::InvalidArgument, "give only one of --ratio, --faces, --error, --epsilon");
  }
  if (ratio) {
    return parse_ratio(*ratio).map([](const LevelTarget& target) { return std::vector<LevelTarget>{target}; });
  }
  if (faces) return parse_targets(TargetKind::Faces, *faces);
  if (error) return parse_targets(TargetKind::Error, *error);
  if (epsilon) return parse_targets(TargetKind::Epsilon, *epsilon);
  return std::vector<LevelTarget>{};
}

int TargetOptions::given_count() const {
  return int{ratio.has_value()} + int{faces.has_value()} + int{error.has_value()} + int{epsilon.has_value()};
}

}  // namespace lodestone::tool
