#pragma once

#include <chrono>
#include <string>
#include <string_view>

namespace lodestone::tool {

/// A line on standard error that says how far the whole work is and how long the rest may take; silent unless that is a
/// terminal. The work is one of one or more pieces.
class ProgressBar {
 public:
  /// `wanted` false (--quiet) keeps it silent on a terminal too. The time begins now.
  explicit ProgressBar(bool wanted);
  ~ProgressBar() { clear(); }
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Starts one of several pieces, which lasts from one share of the whole to another; `title` is shown before it.
  void start_piece(std::string title, double begin, double end);
  /// Says how much of the piece is done, 0 to 1, and in what stage it is, e.g. "simplifying"; redraws where the stage
  /// is another, else at most ten times a second.
  void update(std::string_view stage, double done);
  /// Wipes the line, so that other output starts on a clean one.
  void clear();

 private:
  void draw(double done);
  bool shown_ = false;
  bool drawn_ = false;
  std::string title_, stage_;
  double piece_begin_ = 0, piece_end_ = 1;  // shares of the whole
  std::chrono::steady_clock::time_point begin_, last_draw_;
};

}  // namespace lodestone::tool
