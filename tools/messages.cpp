#include "messages.h"

#include <cstdio>

#include <lodestone/core/detail/text.h>

namespace lodestone::tool {
namespace {

using detail::text;

void print_line(const char* kind, std::string_view message) {
  std::fprintf(stderr, "lodestone: %s: %.*s\n", kind, static_cast<int>(message.size()), message.data());
}

}  // namespace

void print_error(std::string_view message) { print_line("error", message); }

void print_warning(std::string_view message) { print_line("warning", message); }

std::string describe(const Error& error) {
  return error.byte_offset ? text(error.message, " (at byte ", *error.byte_offset, ')') : error.message;
}

std::string quoted(std::string_view text) { return std::string(1, '\'').append(text).append(1, '\''); }

std::string quoted(const std::filesystem::path& path) { return quoted(std::string_view(path.string())); }

std::vector<std::string> sentences(const AssemblyReport& report) {
  const struct {
    std::size_t count;
    const char* one;
    const char* many;
    const char* what;
  } changes[] = {
      {report.nonfinite_faces, "face", "faces", " left out: a corner is not finite"},
      {report.degenerate_faces, "face", "faces", " left out: two corners at one position"},
      {report.duplicate_faces, "face", "faces", " left out: the same as another"},
      {report.unused_points, "point", "points", " left out: no face uses it"},
      {report.turned_faces, "face", "faces", " turned to wind as their neighbours do"},
      {report.nonmanifold_edges, "edge", "edges", " cut: not manifold"},
      {report.cut_vertices, "vertex", "vertices", " cut: several sheets met there"},
  };
  std::vector<std::string> lines;
  for (const auto& change : changes) {
    if (change.count == 0) continue;
    lines.push_back(text(change.count, ' ', change.count == 1 ? change.one : change.many, change.what));
  }
  return lines;
}

}  // namespace lodestone::tool
