// Keeps the frames of a run to the wall clock.
#pragma once

#include <cstdint>
#include <optional>

#include <simvis/sensor.h>
#include "simvis/report/run_report.h"

namespace simvis {

/// The frame at simulated time t begins t / FACTOR after the first one has ended. No frame is left out: a run that is
/// late makes its frames as fast as it can until it has caught up.
class RealTime {
 public:
  /// `factor` simulated seconds for each second, above 0.
  explicit RealTime(double factor) : factor_(factor) {}

  /// Waits until the frame is due, or until a signal comes. Prints once to the standard error when the run falls
  /// behind, and once when it has caught up.
  void wait(const FrameTime& frame);

  double factor() const { return factor_; }
  const Punctuality& punctuality() const { return punctuality_; }

 private:
  void note_lag(double lag_s, double frame_s, const FrameTime& frame);

  double factor_;
  std::optional<std::int64_t> start_ns_;  // of simulated time 0
  bool behind_ = false;
  Punctuality punctuality_;
};

}  // namespace simvis
