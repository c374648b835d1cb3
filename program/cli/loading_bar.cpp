#include "program/cli/loading_bar.h"

#include "program/cli/progress_bar.h"

namespace simvis {
namespace {

constexpr std::chrono::milliseconds kLoadingInterval{200};

}  // namespace

LoadingBar::LoadingBar(std::ostream& out, bool on, std::chrono::milliseconds patience) : out_(out) {
  if (on) painter_ = std::thread([this, patience] { wait_and_paint(patience); });
}

LoadingBar::~LoadingBar() {
  if (!painter_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    has_ended_ = true;
  }
  ended_.notify_one();
  painter_.join();
  clear_shown();
}

void LoadingBar::update(const Progress& progress) {
  const std::lock_guard lock(mutex_);
  progress_ = progress;
}

void LoadingBar::clear_line() {
  const std::lock_guard lock(mutex_);
  clear_shown();
}

void LoadingBar::wait_and_paint(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  std::chrono::milliseconds wait = patience;
  while (!ended_.wait_for(lock, wait, [this] { return has_ended_; })) {
    paint();
    wait = kLoadingInterval;
  }
}

void LoadingBar::paint() {
  if (progress_.total == 0) return;  // no progress has been reported yet
  const double part = static_cast<double>(progress_.done) / static_cast<double>(progress_.total);
  out_ << kClearLine << bar_of(part) << ' ' << progress_.work << std::flush;
  shown_ = true;
}

void LoadingBar::clear_shown() {
  if (shown_) out_ << kClearLine << std::flush;
  shown_ = false;
}

}  // namespace simvis
