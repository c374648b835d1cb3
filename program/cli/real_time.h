// Keeps the frames of a run to the wall clock.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include <simvis/sensor.h>
#include "program/report/run_report.h"

namespace simvis {

/// The frame at simulated time t begins t / FACTOR after the first one has ended. No frame is left out: a run that is
/// late makes its frames as fast as it can until it has caught up.
class RealTime {
 public:
  /// Sleeps until `due_ns` (clock of now_ns()), or shorter.
  using Sleep = std::function<void(std::int64_t due_ns)>;

  /// `factor` simulated seconds for each second; 0: it never waits.
  explicit RealTime(double factor, Sleep sleep = sleep_until) : factor_(factor), sleep_(std::move(sleep)) {}

  /// Waits until the frame is due, or until a signal comes. Prints once to the standard error when the run falls
  /// behind, and once when it has caught up.
  void wait(const FrameTime& frame);

  /// From now on the frames come at this factor: the next one after its period. Also in `sleep`.
  void restart(double factor);

  double factor() const { return factor_; }
  const Punctuality& punctuality() const { return punctuality_; }
  /// Sleeps until `due_ns` (clock of now_ns()), or until a signal comes.
  static void sleep_until(std::int64_t due_ns);

 private:
  std::int64_t due_ns(const FrameTime& frame);
  void note_lag(double lag_s, double frame_s, const FrameTime& frame);

  double factor_;
  Sleep sleep_;
  std::optional<std::int64_t> start_ns_;      // of simulated time 0
  std::optional<std::uint64_t> first_frame_;  // index of the first frame of this process
  bool restarted_ = false;
  bool behind_ = false;
  Punctuality punctuality_;
};

}  // namespace simvis
