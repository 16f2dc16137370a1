#include "report.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <sstream>
#include <utility>

namespace lodestone::bench {
namespace {

constexpr std::size_t kFewestFaces = 12;
constexpr double kMissedShare = 0.05;  // beyond it a level does not stand for its target
constexpr double kSameShare = 0.01;    // face counts this close are one target
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

bool missed(const Row& row) {
  const auto faces = static_cast<double>(row.judgement.faces);
  const auto target = static_cast<double>(row.target.faces);
  return std::abs(faces - target) > std::max(kMissedShare * target, 2.0);
}

const Row* find(const std::vector<Row>& rows, const std::string& model, std::size_t faces, const std::string& key) {
  for (const Row& row : rows) {
    if (row.model == model && row.target.faces == faces && row.simplifier->key == key) return &row;
  }
  return nullptr;
}

std::string format(const char* pattern, double value) {
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), pattern, value);
  return buffer.data();
}

std::string percent_text(double ratio) { return format("%g %%", ratio * 100); }

std::string relative_text(double value) { return std::isnan(value) ? "–" : format("%.2f", value); }

/// The rows of one target by key, those that missed it left out.
using Field = std::map<std::string, const Row*>;

double best(const Field& field, const std::vector<std::string>& keys, double Judgement::*figure) {
  double lowest = kNone;
  for (const auto& key : keys) {
    const auto found = field.find(key);
    if (found != field.end()) lowest = std::fmin(lowest, found->second->judgement.*figure);
  }
  return lowest;
}

/// Returns value / limit as text, bold where it is above `goal`.
std::string judged(double value, double limit, double goal) {
  const double relative = value / limit;
  if (!std::isfinite(relative)) return "–";
  return relative > goal ? "**" + relative_text(relative) + "**" : relative_text(relative);
}

/// The keys of the rows' peers, all or those that keep vertices where they were.
std::vector<std::string> peer_keys(const std::vector<Row>& rows, bool subset_alone) {
  std::vector<std::string> keys;
  for (const Row& row : rows) {
    const Simplifier& s = *row.simplifier;
    const bool wanted = s.key != "levels" && s.key != "stream" && (s.subset || !subset_alone);
    if (wanted && std::find(keys.begin(), keys.end(), s.key) == keys.end()) keys.push_back(s.key);
  }
  return keys;
}

std::string count_text(std::size_t value) { return value == 0 ? "0" : "**" + std::to_string(value) + "**"; }

/// One row for each published count.
std::vector<const Row*> paper_rows(const std::vector<Row>& rows) {
  std::vector<const Row*> result;
  for (const Row& row : rows) {
    if (row.target.paper && row.simplifier == rows.front().simplifier) result.push_back(&row);
  }
  return result;
}

/// The distances of one simplifier at the target of `column`; the least of the simplifiers of its kind are bold.
std::string figures_cell(const std::vector<Row>& rows, const Row& column, const Simplifier& simplifier) {
  const Row* row = find(rows, column.model, column.target.faces, simplifier.key);
  if (row == nullptr || missed(*row)) return "–";
  std::string text;
  for (const auto figure : {&Judgement::mean, &Judgement::rms, &Judgement::maximum}) {
    const double value = row->judgement.*figure;
    const bool least = std::none_of(rows.begin(), rows.end(), [&](const Row& other) {
      return other.model == row->model && other.target.faces == row->target.faces && !missed(other) &&
             other.simplifier->subset == simplifier.subset && other.judgement.*figure < value;
    });
    text += (text.empty() ? "" : " / ") + (least ? "**" + figure_text(value) + "**" : figure_text(value));
  }
  return text;
}

}  // namespace

std::vector<Target> targets_of(const Model& model, const std::vector<double>& ratios, bool with_paper) {
  std::map<std::size_t, Target, std::greater<>> targets;
  for (const double ratio : ratios) {
    const auto faces = static_cast<std::size_t>(std::lround(ratio * static_cast<double>(model.mesh.face_count())));
    if (faces >= kFewestFaces) targets[faces] = {faces, ratio, false};
  }
  for (const std::size_t faces : with_paper ? model.paper_counts : std::vector<std::size_t>{}) {
    // A published count that is a ratio's but for rounding stands for both.
    const auto close = std::find_if(targets.begin(), targets.end(), [&](const auto& entry) {
      return std::abs(static_cast<double>(entry.first) / static_cast<double>(faces) - 1) < kSameShare;
    });
    const double ratio = close == targets.end() ? 0 : close->second.ratio;
    if (close != targets.end()) targets.erase(close);
    targets[faces] = {faces, ratio, true};
  }
  std::vector<Target> result;
  for (const auto& [faces, target] : targets) result.push_back(target);
  return result;
}

double geometric_mean(const std::vector<Row>& rows, const std::string& key, const std::string& reference_key,
                      double ratio, double Judgement::*figure) {
  double sum = 0;
  int count = 0;
  for (const Row& row : rows) {
    if (row.simplifier->key != key || row.target.ratio != ratio || missed(row)) continue;
    const Row* reference = find(rows, row.model, row.target.faces, reference_key);
    if (reference == nullptr || missed(*reference)) continue;
    const double relative = row.judgement.*figure / (reference->judgement.*figure);
    if (!std::isfinite(relative) || relative <= 0) continue;
    sum += std::log(relative);
    ++count;
  }
  return count > 0 ? std::exp(sum / count) : kNone;
}

std::string model_table(const Model& model, const std::vector<Row>& rows) {
  std::ostringstream out;
  out << "### " << model.name << ", " << model.mesh.face_count() << " faces\n\n"
      << "| faces | | got | mean | rms | max | normals | min. angle | non-manifold | flipped | slivers | CPU |\n"
      << "|---|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    if (row.model != model.name) continue;
    const Judgement& j = row.judgement;
    out << "| " << row.target.faces << (row.target.paper ? " (paper)" : "") << " | " << row.simplifier->name << " | "
        << (missed(row) ? "**" + std::to_string(j.faces) + "**" : std::to_string(j.faces)) << " | "
        << figure_text(j.mean) << " | " << figure_text(j.rms) << " | " << figure_text(j.maximum) << " | "
        << format("%.2f°", j.normal_angle) << " | " << format("%.1f°", j.minimum_angle) << " | "
        << count_text(j.nonmanifold_edges) << " | " << count_text(j.flipped_faces) << " | "
        << count_text(j.sliver_faces) << " | " << format("%.2f s", row.cpu_seconds) << " |\n";
  }
  return out.str() + "\n";
}

std::string summary_table(const std::vector<Row>& rows, const std::vector<Simplifier>& simplifiers,
                          const std::vector<double>& ratios) {
  std::ostringstream out;
  out << "### Over all models\n\nGeometric means as multiples of meshoptimizer's: mean / rms / max / normals.\n\n|";
  for (const double ratio : ratios) out << " | " << percent_text(ratio);
  out << " |\n|---";
  for (std::size_t i = 0; i < ratios.size(); ++i) out << "|---";
  out << "|\n";
  for (const Simplifier& simplifier : simplifiers) {
    out << "| " << simplifier.name;
    for (const double ratio : ratios) {
      const char* separator = " | ";
      for (const auto figure : {&Judgement::mean, &Judgement::rms, &Judgement::maximum, &Judgement::normal_angle}) {
        out << separator << relative_text(geometric_mean(rows, simplifier.key, "meshopt", ratio, figure));
        separator = " / ";
      }
    }
    out << " |\n";
  }
  return out.str() + "\n";
}

std::string standing_table(const std::vector<Row>& rows) {
  const std::vector<std::string> kept = {"meshopt", "openmesh"};
  const std::vector<std::string> end_points = {"lt-end"};
  const std::vector<std::string> subset = peer_keys(rows, true);
  const std::vector<std::string> peers = peer_keys(rows, false);
  std::ostringstream out;
  out << "### Where the stream stands\n\nAs multiples of the best of the peers named; bold: above the goal, which is "
         "0.75 "
         "for the first two columns and 1 for the others. Angles: of the best peer, free ones included; minimum angles "
         "are inverted, so that below 1 is better everywhere.\n\n"
         "| | mean, OpenMesh or meshoptimizer | rms | mean, end-point LT | rms | max, subset peers | normals | min. "
         "angle | non-manifold | flipped | slivers |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Row& row : rows) {
    if (row.simplifier->key != "stream") continue;
    Field field;
    for (const Row& other : rows) {
      if (other.model == row.model && other.target.faces == row.target.faces && !missed(other)) {
        field[other.simplifier->key] = &other;
      }
    }
    const Judgement& j = row.judgement;
    const auto against = [&](const auto& keys, double Judgement::*figure, double goal) {
      return judged(j.*figure, best(field, keys, figure), goal);
    };
    double widest = kNone;
    for (const auto& key : peers) {
      if (field.contains(key)) widest = std::fmax(widest, field[key]->judgement.minimum_angle);
    }
    out << "| " << row.model << "@" << row.target.faces << (missed(row) ? " (missed)" : "") << " | "
        << against(kept, &Judgement::mean, 0.75) << " | " << against(kept, &Judgement::rms, 0.75) << " | "
        << against(end_points, &Judgement::mean, 1) << " | " << against(end_points, &Judgement::rms, 1) << " | "
        << against(subset, &Judgement::maximum, 1) << " | " << against(peers, &Judgement::normal_angle, 1) << " | "
        << judged(widest, j.minimum_angle, 1) << " | " << count_text(j.nonmanifold_edges) << " | "
        << count_text(j.flipped_faces) << " | " << count_text(j.sliver_faces) << " |\n";
  }
  return out.str() + "\n";
}

std::string figures_table(const std::vector<Row>& rows, const std::vector<Simplifier>& simplifiers) {
  const std::vector<const Row*> columns = paper_rows(rows);
  if (columns.empty()) return {};
  std::ostringstream out;
  out << "| mean / rms / max";
  for (const Row* column : columns) out << " | " << column->model << "@" << column->target.faces;
  out << " |\n|---";
  for (std::size_t i = 0; i < columns.size(); ++i) out << "|---";
  out << "|\n";
  for (const bool subset : {false, true}) {
    out << (subset ? "| *vertices stay where they were*" : "| *vertices are placed anew*");
    for (std::size_t i = 0; i < columns.size(); ++i) out << " |";
    out << " |\n";
    for (const Simplifier& simplifier : simplifiers) {
      if (simplifier.subset != subset) continue;
      out << "| " << simplifier.name;
      for (const Row* column : columns) out << " | " << figures_cell(rows, *column, simplifier);
      out << " |\n";
    }
  }
  return out.str();
}

bool replace_between_markers(const std::string& path, const std::string& text) {
  const std::string begin = "<!-- quality: begin -->\n";
  const std::string end = "<!-- quality: end -->";
  std::ifstream in(path);
  std::string all((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  const auto from = all.find(begin);
  const auto to = all.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from) return false;
  all.replace(from + begin.size(), to - from - begin.size(), text);
  std::ofstream out(path);
  out << all;
  out.close();
  return out.good();
}

std::string figure_text(double value) {
  if (!std::isfinite(value)) return "∞";
  if (value == 0) return "0";
  const int decimals = std::clamp(2 - static_cast<int>(std::floor(std::log10(value))), 0, 9);
  std::array<char, 64> buffer{};
  std::snprintf(buffer.data(), buffer.size(), "%.*f", decimals, value);
  return buffer.data();
}

}  // namespace lodestone::bench
