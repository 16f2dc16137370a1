#include "grid.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <numbers>
#include <sstream>

#include "peers/lodestone_stream.h"
#include "peers/referee.h"
#include "report.h"

namespace lodestone::bench {
namespace {

const std::map<std::string, Metric> kMetrics = {{"hybrid", Metric::Hybrid},
                                                {"gaussian", Metric::Gaussian},
                                                {"mean", Metric::Mean},
                                                {"principal", Metric::Principal}};

const std::map<std::string, double AttributeWeights::*> kWeights = {{"normal", &AttributeWeights::normal},
                                                                    {"texcoord", &AttributeWeights::texcoord},
                                                                    {"color", &AttributeWeights::color},
                                                                    {"skin", &AttributeWeights::skin},
                                                                    {"target", &AttributeWeights::target}};

/// Returns whether the word means something.
bool apply_word(const std::string& word, Setting& setting) {
  if (const auto metric = kMetrics.find(word); metric != kMetrics.end()) {
    setting.options.metric = metric->second;
    return true;
  }
  if (word == "density") return setting.options.normalisation = Normalisation::Density, true;
  if (word == "current") return setting.options.reference = Reference::Current, true;
  if (word == "lock-border") return setting.options.lock_border = true;
  const auto equals = word.find('=');
  if (equals == std::string::npos) return false;
  const std::string name = word.substr(0, equals);
  char* end = nullptr;
  const double value = std::strtod(word.c_str() + equals + 1, &end);
  if (*end != '\0' || equals + 1 == word.size()) return false;
  if (name == "crease") return setting.options.crease_angle = value * std::numbers::pi / 180, true;
  const auto weight = kWeights.find(name);
  if (weight == kWeights.end()) return false;
  setting.options.weights.*weight->second = value;
  return setting.with_attributes = true;
}

}  // namespace

Result<Setting> parse_setting(const std::string& text) {
  Setting setting{text, {}, false};
  setting.options.measure_step = 0;  // bounds change no removal
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) {
    if (apply_word(word, setting)) continue;
    return fail(ErrorCode::InvalidArgument, "setting '" + text + "': unknown '" + word + "'");
  }
  return setting;
}

std::vector<std::string> default_settings() {
  return {"hybrid", "hybrid,crease=30", "hybrid,crease=60", "gaussian",
          "mean",   "principal",        "mean,current",     "mean,density"};
}

void run_grid(const std::vector<Setting>& settings, const Models& models, const std::vector<double>& ratios,
              std::size_t samples) {
  std::printf("Multiples of the first setting's, geometric means over %zu models: mean / rms / max / normals.\n\n|",
              models.found.size());
  for (const double ratio : ratios) std::printf(" | %g %%", ratio * 100);
  std::printf(" | CPU |\n|---");
  for (std::size_t i = 0; i <= ratios.size(); ++i) std::printf("|---");
  std::printf("|\n");

  std::vector<Referee> referees;
  for (const Model& model : models.found) referees.emplace_back(surface_of(model.mesh), samples);

  // A row's simplifier is its setting here.
  std::vector<Simplifier> keys;
  for (const Setting& setting : settings) keys.push_back({setting.text, setting.text, true, {}});
  std::vector<Row> rows;
  for (std::size_t s = 0; s < settings.size(); ++s) {
    double cpu_seconds = 0;
    for (std::size_t m = 0; m < models.found.size(); ++m) {
      const Model& model = models.found[m];
      const std::vector<Target> targets = targets_of(model, ratios, false);
      std::vector<std::size_t> counts;
      for (const Target& target : targets) counts.push_back(target.faces);
      const auto levels =
          lodestone_stream(settings[s].with_attributes ? model.attributed : model.mesh, counts, settings[s].options);
      cpu_seconds += levels.empty() ? 0 : levels.front().seconds.cpu;
      for (std::size_t t = 0; t < targets.size(); ++t) {
        rows.push_back({model.name, targets[t], &keys[s], referees[m].judge(levels[t].surface), levels[t].seconds.cpu});
      }
    }
    std::printf("| %s", settings[s].text.c_str());
    for (const double ratio : ratios) {
      const char* separator = " | ";
      for (const auto figure : {&Judgement::mean, &Judgement::rms, &Judgement::maximum, &Judgement::normal_angle}) {
        std::printf("%s%.3f", separator, geometric_mean(rows, keys[s].key, keys[0].key, ratio, figure));
        separator = " / ";
      }
    }
    std::printf(" | %.1f s |\n", cpu_seconds);
    std::fflush(stdout);
  }
}

}  // namespace lodestone::bench
