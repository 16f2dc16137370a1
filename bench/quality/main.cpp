// How lodestone's levels compare with those of other simplifiers, by one referee for all.
//
//   quality [--models bunny,cow] [--ratios 50,10,2,0.5] [--only stream,lt] [--fast] [--readme README.md]
//   quality --grid [SETTING …]      lodestone alone, one line for each setting
//   quality --check                 the referee against the original Metro tool's figures

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <lodestone/core/effort.h>
#include <lodestone/io/read_mesh.h>

#include "grid.h"
#include "models.h"
#include "peers/referee.h"
#include "peers/simplifier.h"
#include "picture/picture.h"
#include "report.h"

namespace lodestone::bench {
namespace {

struct Options {
  std::string data;
  std::vector<std::string> models;  ///< parts of names; empty: all
  std::vector<double> percents = {50, 10, 2, 0.5};
  std::vector<std::string> only;  ///< keys of simplifiers; empty: all
  std::size_t samples = 500'000;  ///< each way
  int effort = kDefaultEffort;
  bool fast = false;
  bool check = false;
  bool grid = false;
  std::vector<std::string> settings;
  std::string readme;
  std::string picture;
};

std::string default_data() {
  const char* from_environment = std::getenv("LODESTONE_DATA");
  return from_environment != nullptr ? from_environment : LODESTONE_SOURCE_DIR "/../shared/data";
}

Surface read_surface(const std::string& path) {
  const Result<MeshFile> file = read_mesh(path);
  return file ? surface_of(file->mesh) : Surface{};
}

/// Prints what the referee finds beside every row of Metro's figures.
int check_referee(const Options& options) {
  std::ifstream table(options.data + "/metro/metro.tsv");
  if (!table) {
    std::fprintf(stderr, "%s: no metro/metro.tsv\n", options.data.c_str());
    return 2;
  }
  std::puts("The referee over Metro: mean / rms / max, mesh units.\n");
  std::puts("| | direction | referee | Metro | share |\n|---|---|---|---|---|");
  std::string line;
  std::getline(table, line);  // headings
  while (std::getline(table, line)) {
    std::istringstream fields(line);
    std::string original, simplified;
    OneWay metro[2];
    fields >> original >> simplified;
    for (OneWay& way : metro) fields >> way.maximum >> way.mean >> way.rms;
    const Surface full = read_surface(options.data + "/" + original);
    const Surface coarse = read_surface(options.data + "/metro/" + simplified);
    if (full.faces.empty() || coarse.faces.empty()) continue;
    const Referee referee(full, options.samples);
    const OneWay ours[2] = {referee.forward(coarse), referee.backward(coarse)};
    for (int i = 0; i < 2; ++i) {
      std::printf("| %s | %s | %s / %s / %s | %s / %s / %s | %.3f / %.3f / %.3f |\n", simplified.c_str(),
                  i == 0 ? "there" : "back", figure_text(ours[i].mean).c_str(), figure_text(ours[i].rms).c_str(),
                  figure_text(ours[i].maximum).c_str(), figure_text(metro[i].mean).c_str(),
                  figure_text(metro[i].rms).c_str(), figure_text(metro[i].maximum).c_str(),
                  ours[i].mean / metro[i].mean, ours[i].rms / metro[i].rms, ours[i].maximum / metro[i].maximum);
    }
  }
  return 0;
}

std::vector<Simplifier> chosen_simplifiers(const Options& options) {
  std::vector<Simplifier> chosen;
  for (Simplifier& simplifier : simplifiers(options.effort)) {
    const bool wanted = std::find(options.only.begin(), options.only.end(), simplifier.key) != options.only.end();
    if (options.only.empty() || wanted) chosen.push_back(std::move(simplifier));
  }
  return chosen;
}

/// Adds the rows of one model, target by target.
void compare_on(const Model& model, const std::vector<Target>& targets, const std::vector<Simplifier>& tools,
                std::size_t samples, std::vector<Row>& rows) {
  const Referee referee(surface_of(model.mesh), samples);
  std::vector<std::size_t> counts;
  for (const Target& target : targets) counts.push_back(target.faces);
  std::vector<std::vector<Level>> levels;
  for (const Simplifier& tool : tools) {
    std::fprintf(stderr, "%s: %s\n", model.name.c_str(), tool.name.c_str());
    levels.push_back(tool.run(model.mesh, counts));
  }
  for (std::size_t t = 0; t < targets.size(); ++t) {
    for (std::size_t s = 0; s < tools.size(); ++s) {
      const Level& level = levels[s][t];
      rows.push_back({model.name, targets[t], &tools[s], referee.judge(level.surface), level.seconds.cpu});
    }
  }
}

void print_head(const std::vector<std::string>& missing_models) {
  std::puts(
      "Distances in % of the original's bounding-box diagonal: mean and rms are those of both directions, averaged, "
      "max is the larger. Normals: mean angle over the original's area. Minimum angle: mean of the faces' smallest. "
      "Edges of more than two faces and slivers (an angle under 1°): beyond the original's. Flipped: looking away "
      "from the original. CPU: the simplification alone; lodestone's goes to the base mesh once, for all levels.\n");
  std::vector<std::string> missing = missing_simplifiers();
  missing.insert(missing.end(), missing_models.begin(), missing_models.end());
  for (const auto& name : missing) std::printf("Not found: %s.\n", name.c_str());
  if (!missing.empty()) std::puts("");
}

int write_figures(const std::string& path, const std::string& table) {
  if (table.empty()) {
    std::fprintf(stderr, "%s: left as it is: none of these models has published counts\n", path.c_str());
    return 1;
  }
  if (replace_between_markers(path, table)) return 0;
  std::fprintf(stderr, "%s: not writable, or no lines '<!-- quality: begin -->' and '<!-- quality: end -->'\n",
               path.c_str());
  return 4;
}

int compare(const Options& options, const Models& models, const std::vector<double>& ratios) {
  const std::vector<Simplifier> tools = chosen_simplifiers(options);
  print_head(models.missing);
  std::vector<Row> rows;
  for (const Model& model : models.found) {
    compare_on(model, targets_of(model, ratios, true), tools, options.samples, rows);
    std::fputs(model_table(model, rows).c_str(), stdout);
    std::fflush(stdout);
  }
  if (rows.empty()) return 0;
  std::fputs((summary_table(rows, tools, ratios) + standing_table(rows)).c_str(), stdout);
  return options.readme.empty() ? 0 : write_figures(options.readme, figures_table(rows, tools));
}

// A time that something else on the machine disturbs is longer, never shorter.
constexpr int kTimedRuns = 3;

CostedError timed_error(const Simplifier& tool, const Mesh& mesh, std::size_t faces, const Referee& referee) {
  CostedError result;
  for (int run = 0; run < kTimedRuns; ++run) {
    const std::vector<Level> levels = tool.run(mesh, std::span(&faces, 1));
    if (run == 0) result.error = referee.judge(levels.front().surface).mean;
    const double seconds = levels.front().seconds.cpu;
    result.cost = run == 0 ? seconds : std::min(result.cost, seconds);
  }
  return result;
}

/// Takes a model to its smallest published count: lodestone at each effort, the others once.
ErrorPanel picture_panel(const Model& model, const Options& options) {
  const std::size_t faces = model.paper_counts.back();
  ErrorPanel panel{model.name + ", " + std::to_string(faces) + " faces", {}, {}};
  const Referee referee(surface_of(model.mesh), options.samples);
  for (int effort = kLeastEffort; effort <= kMostEffort; ++effort) {
    Options at = options;
    at.effort = effort;
    const std::vector<Simplifier> tools = chosen_simplifiers(at);
    panel.series.resize(tools.size());
    for (std::size_t i = 0; i < tools.size(); ++i) {
      if (!tools[i].has_effort && effort > kLeastEffort) continue;
      std::fprintf(stderr, "%s: %s, effort %d\n", model.name.c_str(), tools[i].name.c_str(), effort);
      panel.series[i].name = tools[i].name;
      panel.series[i].points.push_back(timed_error(tools[i], model.mesh, faces, referee));
      if (tools[i].has_effort) panel.series[i].points.back().label = std::to_string(effort);
    }
  }
  return panel;
}

int draw_picture(const Options& options, const Models& models) {
  std::vector<ErrorPanel> panels;
  for (const Model& model : models.found)
    if (!model.paper_counts.empty()) panels.push_back(picture_panel(model, options));
  if (panels.empty()) {
    std::fprintf(stderr, "%s: not drawn: none of these models has published counts\n", options.picture.c_str());
    return 1;
  }
  for (const ErrorPanel& panel : panels)
    for (const ErrorSeries& series : panel.series)
      for (const CostedError& point : series.points)
        std::printf("%s | %s %s | %.3f s | %.4f %%\n", panel.title.c_str(), series.name.c_str(), point.label.c_str(),
                    point.cost, point.error);
  std::ofstream file(options.picture);
  file << error_picture(panels, "s", panels.size());
  if (file.flush()) return 0;
  std::fprintf(stderr, "%s: not writable\n", options.picture.c_str());
  return 4;
}

int run_grid_of(const Options& options, const Models& models, const std::vector<double>& ratios) {
  std::vector<Setting> settings;
  for (const auto& text : options.settings.empty() ? default_settings() : options.settings) {
    Result<Setting> setting = parse_setting(text);
    if (!setting) {
      std::fprintf(stderr, "%s\n", setting.error().message.c_str());
      return 1;
    }
    settings.push_back(std::move(*setting));
  }
  run_grid(settings, models, ratios, options.samples);
  return 0;
}

int run(Options options) {
  if (options.fast) {
    options.samples = std::min<std::size_t>(options.samples, 50'000);
    options.percents = {10, 2};
  }
  if (options.check) return check_referee(options);
  std::vector<double> ratios;
  for (const double percent : options.percents) ratios.push_back(percent / 100);
  const Models models = load_models(options.data, options.models);
  if (!options.picture.empty()) return draw_picture(options, models);
  return options.grid ? run_grid_of(options, models, ratios) : compare(options, models, ratios);
}

}  // namespace
}  // namespace lodestone::bench

int main(int argc, char** argv) {
  lodestone::bench::Options options;
  options.data = lodestone::bench::default_data();
  CLI::App app("Compares lodestone's levels with those of other simplifiers and prints Markdown.");
  app.add_option("--data", options.data, "folder of models, laid out as shared/data");
  app.add_option("--models", options.models,
                 "parts of models' names; cad- for those of engineering, which are not among all")
      ->delimiter(',');
  app.add_option("--ratios", options.percents, "percent of the faces")->delimiter(',');
  app.add_option("--only", options.only, "simplifiers: levels, stream, lt-end, meshopt, openmesh, vtk-pro, lt, gh, vtk")
      ->delimiter(',');
  app.add_option("--samples", options.samples, "of a surface, each way, at most");
  app.add_option("--effort", options.effort, "lodestone's, 1 to 9")
      ->check(CLI::Range(lodestone::kLeastEffort, lodestone::kMostEffort));
  app.add_flag("--fast", options.fast, "10 % and 2 % alone, a tenth of the samples");
  app.add_flag("--check", options.check, "measure what the Metro tool measured, and print both");
  app.add_option("--readme", options.readme, "file whose table between the marker comments is replaced");
  app.add_option("--picture", options.picture, "SVG file to draw: error against time, lodestone at each effort");
  auto* grid =
      app.add_option("--grid", options.settings, "lodestone alone with each of these settings, e.g. mean,current")
          ->expected(0, 1000);
  CLI11_PARSE(app, argc, argv);
  options.grid = grid->count() > 0;
  return lodestone::bench::run(options);
}
