#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace lodestone::tool {

/// A line on standard error that says how far the work is; silent unless that is a terminal.
class ProgressBar {
 public:
  /// `wanted` false (--quiet) keeps it silent on a terminal too.
  explicit ProgressBar(bool wanted);
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Starts a stage, e.g. "simplifying", at 0.
  void start(std::string stage);
  /// Shows the share of the stage that is done, 0 to 1; redraws at most ten times a second.
  void update(double share);
  /// Wipes the line, so that other output starts on a clean one.
  void clear();

 private:
  void draw(double share);

  bool shown_ = false;
  bool drawn_ = false;
  std::string stage_;
  std::chrono::steady_clock::time_point last_draw_;
};

/// Adds up the progress of parts of a stage that threads work on; any thread may report.
class SharedProgress {
 public:
  explicit SharedProgress(ProgressBar& bar) : bar_(bar) {}

  /// Announces the next part and its weight; before the work starts.
  void add_part(double weight);
  /// Says how much of a part is done, 0 to 1.
  void update(std::size_t part, double share);

 private:
  ProgressBar& bar_;
  std::mutex mutex_;
  std::vector<double> weight_, share_;
  double total_ = 0;
};

}  // namespace lodestone::tool
