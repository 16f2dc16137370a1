#include "progress_bar.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>

#if __has_include(<unistd.h>)
#include <unistd.h>
#endif

namespace lodestone::tool {
namespace {

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

}  // namespace

ProgressBar::ProgressBar(bool wanted) : shown_(wanted && stderr_is_terminal()) {}

void ProgressBar::start(std::string stage) {
  stage_ = std::move(stage);
  if (shown_) draw(0);
}

void ProgressBar::update(double share) {
  if (shown_ && std::chrono::steady_clock::now() - last_draw_ >= kRedrawInterval) draw(share);
}

void ProgressBar::clear() {
  if (drawn_) std::fputs("\r\033[K", stderr);
  drawn_ = false;
}

void ProgressBar::draw(double share) {
  const int filled = static_cast<int>(std::clamp(share, 0.0, 1.0) * kBarWidth);
  const std::string bar = std::string(filled, '#') + std::string(kBarWidth - filled, '.');
  std::fprintf(stderr, "\r\033[K%s [%s] %3.0f%%", stage_.c_str(), bar.c_str(), 100 * std::clamp(share, 0.0, 1.0));
  std::fflush(stderr);
  drawn_ = true;
  last_draw_ = std::chrono::steady_clock::now();
}

void SharedProgress::add_part(double weight) {
  weight_.push_back(weight);
  share_.push_back(0);
  total_ += weight;
}

void SharedProgress::update(std::size_t part, double share) {
  const std::scoped_lock lock(mutex_);
  share_[part] = share;
  double done = 0;
  for (std::size_t i = 0; i < share_.size(); ++i) done += weight_[i] * share_[i];
  bar_.update(total_ > 0 ? done / total_ : 1);
}

}  // namespace lodestone::tool
