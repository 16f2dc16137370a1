#include "progress_bar.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#if __has_include(<unistd.h>)
#include <unistd.h>

#include <lodestone/core/detail/text.h>
#endif

namespace lodestone::tool {
namespace {

using detail::text;

constexpr auto kRedrawInterval = std::chrono::milliseconds(100);
constexpr int kBarWidth = 30;

/// A terminal that can go back to the start of its line.
bool stderr_is_terminal() {
#if __has_include(<unistd.h>)
  const char* terminal = std::getenv("TERM");
  return isatty(STDERR_FILENO) == 1 && terminal != nullptr && std::string(terminal) != "dumb";
#else
  return false;
#endif
}

/// A rough number is all an estimate is worth.
std::string duration_text(double seconds) {
  constexpr double kMinute = 60, kHour = 3600;
  if (seconds < 2 * kMinute) return text(std::lround(seconds), " s");
  if (seconds < 2 * kHour) return text(std::lround(seconds / kMinute), " min");
  return text(std::lround(seconds / kHour), " h");
}

}  // namespace

ProgressBar::ProgressBar(bool wanted)
    : shown_(wanted && stderr_is_terminal()), begin_(std::chrono::steady_clock::now()) {}

void ProgressBar::start_piece(std::string title, double begin, double end) {
  title_ = std::move(title);
  piece_begin_ = begin;
  piece_end_ = end;
}

void ProgressBar::update(std::string_view stage, double done) {
  if (!shown_) return;
  const bool is_new = stage_ != stage;
  stage_ = stage;
  if (is_new || std::chrono::steady_clock::now() - last_draw_ >= kRedrawInterval) draw(done);
}

void ProgressBar::clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

void ProgressBar::draw(double done) {
  last_draw_ = std::chrono::steady_clock::now();
  const double of_piece = std::clamp(done, 0.0, 1.0);
  const double share = std::clamp(piece_begin_ + of_piece * (piece_end_ - piece_begin_), 0.0, 1.0);
  const int filled = static_cast<int>(share * kBarWidth);
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  std::string left;
  if (share > 0) {
    const double elapsed = std::chrono::duration<double>(last_draw_ - begin_).count();
    left = ", " + duration_text(elapsed * (1 - share) / share) + " left";
  }
  std::fprintf(stderr, "\r\033[K[%s] %3.0f%%%s, %s%s", bar.c_str(), 100 * share, left.c_str(), title_.c_str(),
               stage_.c_str());
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace lodestone::tool
