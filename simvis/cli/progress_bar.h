// Tells somebody who waits at a terminal how far a run is.
#pragma once

#include <chrono>
#include <cstdint>
#include <ostream>
#include <string>

namespace simvis {

/// Takes the cursor to the start of a terminal's line, and empties the line.
inline constexpr const char* kClearLine = "\r\033[K";

/// "[####    ]"; `part` from 0 to 1.
std::string bar_of(double part);

/// Shows itself once the work has taken more than a second, a few times a second, and clears its line when it ends.
/// Off, it writes nothing at all.
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
