#include "program/cli/real_time.h"

#include <algorithm>
#include <ctime>
#include <iostream>

#include <simvis/attributes.h>
#include "engine/base/now_ns.h"
#include "program/cli/signals.h"

namespace simvis {
namespace {

// Of the wall clock: a run is behind if it is later than this and than the time of a frame.
constexpr double kPatience_s = 0.1;

}  // namespace

void RealTime::sleep_until(std::int64_t due_ns) {
  const timespec due{due_ns / 1'000'000'000, due_ns % 1'000'000'000};
  ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &due, nullptr);
}

void RealTime::restart(double factor) {
  factor_ = factor;
  start_ns_.reset();
  restarted_ = true;
}

std::int64_t RealTime::due_ns(const FrameTime& frame) {
  const auto wall_ns = [this](std::int64_t simulated_ns) {
    return limited_ns(static_cast<double>(simulated_ns) / 1e9 / factor_);
  };
  if (!start_ns_) start_ns_ = now_ns() - (restarted_ ? wall_ns(frame.time_ns - frame.period_ns) : 0);
  return *start_ns_ + wall_ns(frame.time_ns);
}

void RealTime::wait(const FrameTime& frame) {
  // The first frame prepares meshes and pipelines, so the clock starts behind it. A run that goes on has another one.
  if (!first_frame_) {
    first_frame_ = frame.index;
    restarted_ = restarted_ || frame.index > 0;
  }
  if (frame.index == *first_frame_ || factor_ == 0) return;
  const std::int64_t lag_ns = now_ns() - due_ns(frame);
  if (lag_ns > 0) return note_lag(static_cast<double>(lag_ns) / 1e9, static_cast<double>(frame.period_ns) / 1e9, frame);
  if (behind_) std::cerr << "simvis-run: in real time again at frame " << frame.index << '\n';
  behind_ = false;
  while (received_signal() == nullptr && factor_ > 0 && now_ns() < due_ns(frame)) sleep_(due_ns(frame));
}

void RealTime::note_lag(double lag_s, double frame_s, const FrameTime& frame) {
  const double wall_frame_s = frame_s / factor_;
  punctuality_.largest_lag_s = std::max(punctuality_.largest_lag_s, lag_s);
  if (lag_s > wall_frame_s) ++punctuality_.late_frames;
  if (behind_ || lag_s <= std::max(wall_frame_s, kPatience_s)) return;
  behind_ = true;
  std::cerr << "warning: --real-time " << format_number(factor_) << ": the run is behind the wall clock by "
            << format_number(lag_s) << " s at frame " << frame.index
            << "; all frames are made, later than they should be\n";
}

}  // namespace simvis
