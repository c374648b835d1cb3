// The frames of one simulation, one after another: at a fixed rate, when a sensor is due, or as far apart as the caller
// says.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>

#include <simvis/state_archive.h>
#include "simvis/time/clock.h"

namespace simvis {

/// Time     frame 0 is at 0. At a fixed rate, frame k is at Clock::frame(k); after stretch() the clock starts again at
///          the frame that was stretched.
/// Rates    arguments `rates_hz` are those of the sensors that are on and have a rate, each above 0.
class Timeline {
 public:
  /// If `when_due`, a frame comes at each firing time of the sensors, and at `rate_hz` while there are none.
  /// Throws InputError as Clock does.
  Timeline(double rate_hz, bool when_due) : clock_(rate_hz), when_due_(when_due) {}

  /// The frame that comes next. Its period is `dt` of stretch() if that says when it comes. Throws InputError if it
  /// lies beyond the clock's range.
  FrameTime next(std::span<const double> rates_hz) const;

  /// Whether a sensor with this rate, or with rate 0 for every frame, is due in `frame`, the next one.
  bool fires(double sensor_rate_hz, const FrameTime& frame) const {
    return made_ == 0 || fires_between(sensor_rate_hz, last_ns_, frame.time_ns);
  }

  /// The next frame comes `dt` after the last one, or at 0 if it is the first. Throws InputError if dt is not above 0,
  /// or out of range.
  void stretch(std::chrono::nanoseconds dt);
  bool is_stretched() const { return stretched_; }  ///< whether stretch() says when the next frame comes

  /// The number of frames that come from now on until `end_ns`, at least 1: the next one counts in any case. Throws
  /// InputError if frames come when sensors are due and there are more than 10 million.
  std::uint64_t frames_until(std::int64_t end_ns, std::span<const double> rates_hz) const;

  /// Goes on to the frame after `frame`, which is next().
  void go_on(const FrameTime& frame);
  std::int64_t last_ns() const { return last_ns_; }  ///< time of the last frame made; 0: there is none
  /// Where it stands. The rate is left out.
  void archive(StateArchive& state);

 private:
  bool is_possible() const;
  std::int64_t time_of_next(std::span<const double> rates_hz) const;
  std::uint64_t clocked_frames_until(std::int64_t end_ns) const;

  Clock clock_;
  bool when_due_;
  std::uint64_t made_ = 0;      // number of frames made
  std::int64_t last_ns_ = 0;    // time of the last frame made
  std::uint64_t start_ = 0;     // the frame at which the clock started
  std::int64_t origin_ns_ = 0;  // the time of that frame
  bool stretched_ = false;      // the next frame is `start_`, wherever sensors are due
  std::int64_t dt_ns_ = 0;      // of the last stretch()
};

}  // namespace simvis
