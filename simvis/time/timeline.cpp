#include "simvis/time/timeline.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <string>

#include <simvis/error.h>

namespace simvis {
namespace {

constexpr std::int64_t kLast_ns = std::numeric_limits<std::int64_t>::max();

// To count so many takes some seconds.
constexpr std::uint64_t kMaxCountedFrames = 10'000'000;

[[noreturn]] void refuse_beyond(std::uint64_t frame) {
  throw InputError("frame " + std::to_string(frame) + " lies beyond the clock's 292 years");
}

}  // namespace

std::int64_t Timeline::time_of_next(std::span<const double> rates_hz) const {
  if (made_ == 0 || !when_due_ || rates_hz.empty() || stretched_) {
    const std::int64_t since_ns = clock_.frame(made_ - start_).time_ns;
    if (since_ns > kLast_ns - origin_ns_) refuse_beyond(made_);
    return origin_ns_ + since_ns;
  }
  std::optional<std::int64_t> first;
  for (const double rate : rates_hz) {
    const std::optional<std::int64_t> due = next_firing(rate, last_ns_);
    if (due && (!first || *due < *first)) first = due;
  }
  if (!first) refuse_beyond(made_);
  return *first;
}

FrameTime Timeline::next(std::span<const double> rates_hz) const {
  FrameTime frame{
      .index = made_, .time_ns = time_of_next(rates_hz), .period_ns = clock_.frame(0).period_ns, .when_due = when_due_};
  if (stretched_) frame.period_ns = dt_ns_;
  if (stretched_ || !when_due_ || rates_hz.empty()) return frame;
  std::int64_t period_ns = kLast_ns - frame.time_ns;
  for (const double rate : rates_hz) {
    const std::optional<std::int64_t> due = next_firing(rate, frame.time_ns);
    if (due) period_ns = std::min(period_ns, *due - frame.time_ns);
  }
  frame.period_ns = period_ns;
  return frame;
}

void Timeline::stretch(std::chrono::nanoseconds dt) {
  if (dt.count() <= 0) {
    throw InputError("a step of " + std::to_string(dt.count()) + " ns is not possible, expected more than 0");
  }
  if (dt.count() > kLast_ns - last_ns_) refuse_beyond(made_);
  stretched_ = true;
  dt_ns_ = dt.count();
  if (made_ == 0) return;
  start_ = made_;
  origin_ns_ = last_ns_ + dt.count();
}

std::uint64_t Timeline::frames_until(std::int64_t end_ns, std::span<const double> rates_hz) const {
  if (!when_due_) return clocked_frames_until(end_ns);
  Timeline ahead = *this;
  std::uint64_t frames = 0;
  do {
    if (frames == kMaxCountedFrames) {
      throw InputError("there are more than " + std::to_string(kMaxCountedFrames) + " frames until " +
                       std::to_string(end_ns / 1'000'000'000) + " s, expected --frames with their number");
    }
    ahead.go_on(ahead.next(rates_hz));
    ++frames;
  } while (ahead.next(rates_hz).time_ns <= end_ns);
  return frames;
}

// By bisection, since there may be any number of frames.
std::uint64_t Timeline::clocked_frames_until(std::int64_t end_ns) const {
  const auto comes_in_time = [&](std::uint64_t frames) {
    Timeline ahead = *this;
    ahead.made_ += frames;
    try {
      return ahead.time_of_next({}) <= end_ns;
    } catch (const InputError&) {
      return false;  // beyond the clock's range
    }
  };
  std::uint64_t in_time = 0, late = 1;  // the frame after so many comes in time, or not
  while (comes_in_time(late)) {
    in_time = late;
    late *= 2;  // the clock's range ends below 2^63
  }
  while (late - in_time > 1) {
    const std::uint64_t middle = in_time + (late - in_time) / 2;
    (comes_in_time(middle) ? in_time : late) = middle;
  }
  return in_time + 1;
}

void Timeline::go_on(const FrameTime& frame) {
  last_ns_ = frame.time_ns;
  ++made_;
  stretched_ = false;
  if (!when_due_) return;
  // While no sensor has a rate, frames follow the last one at the clock's rate.
  start_ = made_ - 1;
  origin_ns_ = last_ns_;
}

void Timeline::archive(StateArchive& state) {
  state(made_, last_ns_, start_, origin_ns_, stretched_, dt_ns_);
  if (state.is_reading() && !state.keeps_all()) state.require(is_possible());
}

// Whether the last frame stands where stretch() and go_on() leave it.
bool Timeline::is_possible() const {
  if (last_ns_ < 0 || origin_ns_ < 0 || dt_ns_ < 0 || (stretched_ && dt_ns_ == 0)) return false;
  if (made_ == 0) return last_ns_ == 0 && start_ == 0 && origin_ns_ == 0;
  if (stretched_) return start_ == made_ && origin_ns_ >= dt_ns_ && last_ns_ == origin_ns_ - dt_ns_;
  return start_ < made_ && last_ns_ >= origin_ns_ && last_ns_ - origin_ns_ == clock_.frame(made_ - 1 - start_).time_ns;
}

}  // namespace simvis
