#include "program/cli/progress_bar.h"

#include <cmath>

namespace simvis {

namespace {

constexpr std::chrono::seconds kPatience{1};
constexpr std::chrono::milliseconds kInterval{200};

}  // namespace

std::string bar_of(double part) {
  constexpr std::size_t kWidth = 40;
  const auto filled = static_cast<std::size_t>(part * static_cast<double>(kWidth));
  return '[' + std::string(filled, '#') + std::string(kWidth - filled, ' ') + ']';
}

ProgressBar::ProgressBar(std::ostream& out, bool on, std::uint64_t frames, Time start)
    : out_(out), on_(on), frames_(frames), start_(start), next_(start + kPatience) {}

ProgressBar::~ProgressBar() {
  if (shown_) out_ << kClearLine << std::flush;
}

void ProgressBar::update(std::uint64_t frames_done, Time now) {
  if (!on_ || now < next_) return;
  next_ = now + kInterval;
  shown_ = true;
  const double part = static_cast<double>(frames_done) / static_cast<double>(frames_);
  out_ << kClearLine << bar_of(part) << ' ' << frames_done << " of " << frames_ << " frames";
  if (frames_done > 0) {
    const double elapsed_s = std::chrono::duration<double>(now - start_).count();
    out_ << ", " << std::llround(elapsed_s * (1 - part) / part) << " s left";
  }
  out_ << std::flush;
}

}  // namespace simvis
