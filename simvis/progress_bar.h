// Tells somebody who waits at a terminal how far a run is.
#pragma once

#include <chrono>
#include <cstdint>
#include <ostream>

namespace simvis {

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
