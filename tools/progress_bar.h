#pragma once

#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>
#include <vector>

namespace lodestone::tool {

/// A line on standard error that says how far the whole work is and how long the rest may take; silent unless that is a
/// terminal. The work is one of one or more pieces, and each consists of stages.
class ProgressBar {
 public:
  /// `wanted` false (--quiet) keeps it silent on a terminal too. The time begins now.
  explicit ProgressBar(bool wanted);
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Starts one of several pieces, which lasts from one share of the whole to another; `title` is shown before it.
  void start_piece(std::string title, double begin, double end);
  /// Starts a stage, e.g. "simplifying", which is this share of its piece and comes after those before.
  void start(std::string stage, double share);
  /// Says how much of the stage is done, 0 to 1; redraws at most ten times a second.
  void update(double done);
  /// Wipes the line, so that other output starts on a clean one.
  void clear();

 private:
  void draw(double done);
  /// The share of the whole that is done with this much of the stage.
  double overall(double done) const;

  bool shown_ = false;
  bool drawn_ = false;
  std::string title_, stage_;
  double piece_begin_ = 0, piece_end_ = 1;  // shares of the whole
  double stage_begin_ = 0, stage_end_ = 0;  // shares of the piece
  std::chrono::steady_clock::time_point begin_, last_draw_;
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
