// A progress bar on the terminal for the frames of a run.
#pragma once

#include <chrono>
#include <cstdint>
#include <ostream>
#include <string>

namespace simvis {

/// Control sequence that moves the cursor to the start of the terminal line and clears the line.
inline constexpr const char* kClearLine = "\r\033[K";

/// "[####    ]"; `part` from 0 to 1.
std::string bar_of(double part);

/// The bar appears after one second of work, is updated a few times per second, and clears its line at the end. If `on`
/// is false, it writes nothing.
class ProgressBar {
 public:
  using Time = std::chrono::steady_clock::time_point;

  ProgressBar(std::ostream& out, bool on, std::uint64_t frames, Time start);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  void update(std::uint64_t frames_done, Time now);

 private:
  std::ostream& out_;
  bool on_;
  bool shown_ = false;
  std::uint64_t frames_;
  Time start_, next_;
};

}  // namespace simvis
