#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "models.h"
#include "peers/referee.h"
#include "peers/simplifier.h"

namespace lodestone::bench {

/// A face count to simplify a model to, and why.
struct Target {
  std::size_t faces = 0;
  double ratio = 0;    ///< share of the model's faces; 0 where the count stands in no list of ratios
  bool paper = false;  ///< one of the model's published counts
};

/// Returns the counts of `ratios` and the model's published ones, descending, each once; none under 12 faces.
std::vector<Target> targets_of(const Model& model, const std::vector<double>& ratios, bool with_paper);

/// What one simplifier did at one target.
struct Row {
  std::string model;
  Target target;
  const Simplifier* simplifier = nullptr;
  Judgement judgement;
  double cpu_seconds = 0;
};

/// Returns the geometric mean of a figure over that of a reference; unset (NaN) where no pair of rows has both.
/// Rows that missed their face count by more than 5 % are left out on either side.
double geometric_mean(const std::vector<Row>& rows, const std::string& key, const std::string& reference_key,
                      double ratio, double Judgement::*figure);

// Markdown, each with a heading or sentence of its own.
std::string model_table(const Model& model, const std::vector<Row>& rows);
std::string summary_table(const std::vector<Row>& rows, const std::vector<Simplifier>& simplifiers,
                          const std::vector<double>& ratios);
/// The stream against the best peers, target by target; what misses is bold.
std::string standing_table(const std::vector<Row>& rows);
/// The published counts alone, for the README; nothing where no row is of one.
std::string figures_table(const std::vector<Row>& rows, const std::vector<Simplifier>& simplifiers);

/// Puts `text` between the lines `<!-- quality: begin -->` and `<!-- quality: end -->` of a file; returns whether it
/// has them and was written.
bool replace_between_markers(const std::string& path, const std::string& text);

/// Three significant digits.
std::string figure_text(double value);

}  // namespace lodestone::bench
