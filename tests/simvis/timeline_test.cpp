// When frames come, and which rates of frames keep which rates of sensors.
#include "simvis/time/timeline.h"

#include <doctest/doctest.h>

#include <simvis/simulation.h>
#include "simvis/time/frame_rates.h"
#include "tests/support/error_of.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

using std::chrono::milliseconds;

std::vector<std::int64_t> times(Timeline& timeline, std::span<const double> rates, int frames) {
  std::vector<std::int64_t> result;
  for (int i = 0; i < frames; ++i) {
    const FrameTime frame = timeline.next(rates);
    CHECK(frame.index == static_cast<std::uint64_t>(i));
    result.push_back(frame.time_ns);
    timeline.go_on(frame);
  }
  return result;
}

TEST_CASE("a fixed rate is the clock's") {
  Timeline timeline(15, false);
  const Clock clock(15);
  const std::vector<std::int64_t> all = times(timeline, std::vector<double>{10}, 100);
  for (std::uint64_t k = 0; k < 100; ++k) CHECK(all[k] == clock.frame(k).time_ns);
}

TEST_CASE("frames when a sensor is due: all its firings, no others, none twice") {
  Timeline timeline(15, true);
  const std::vector<double> rates{10, 15, 40};
  std::vector<std::int64_t> due;
  for (const double rate : rates) {
    const Clock clock(rate);
    for (std::uint64_t k = 0; clock.frame(k).time_ns <= 1'000'000'000; ++k) due.push_back(clock.frame(k).time_ns);
  }
  std::ranges::sort(due);
  due.erase(std::unique(due.begin(), due.end()), due.end());
  CHECK(timeline.frames_until(1'000'000'000, rates) == due.size());
  CHECK(timeline.next(rates).period_ns == 25'000'000);
  CHECK(times(timeline, rates, static_cast<int>(due.size())) == due);
}

TEST_CASE("frames until a time are counted by bisection, or not at all if there are too many") {
  for (const double rate : {15.0, 0.3, 1000.0}) {
    Timeline timeline(rate, false);
    if (rate == 15) timeline.stretch(milliseconds(7));
    for (int made = 0; made < 3; ++made) {
      for (const std::int64_t end_ns : {std::int64_t{0}, std::int64_t{66'666'667}, std::int64_t{5'000'000'000}}) {
        Timeline ahead = timeline;
        std::uint64_t counted = 0;
        do {
          ahead.go_on(ahead.next({}));
          ++counted;
        } while (ahead.next({}).time_ns <= end_ns);
        CHECK(timeline.frames_until(end_ns, {}) == counted);
      }
      timeline.go_on(timeline.next({}));
    }
  }
  // Seconds since 1970: a frame at 0, and 20 in each second after it.
  CHECK(Timeline(20, false).frames_until(1'700'000'000'000'000'000, {}) == 34'000'000'001);
  const std::vector<double> rates{1000};
  CHECK(error_of([&] { Timeline(20, true).frames_until(1'700'000'000'000'000'000, rates); }) ==
        "there are more than 10000000 frames until 1700000000 s, expected --frames with their number");
}

TEST_CASE("without a sensor with a rate, frames come at the fixed rate, from the last one on") {
  Timeline timeline(10, true);
  CHECK(times(timeline, {}, 3) == std::vector<std::int64_t>{0, 100'000'000, 200'000'000});
  const std::vector<double> rates{4};
  CHECK(timeline.next(rates).time_ns == 250'000'000);
  timeline.go_on(timeline.next(rates));
  CHECK(timeline.next({}).time_ns == 350'000'000);
}

TEST_CASE("frames as far apart as the caller says, then at the rate again") {
  Timeline timeline(10, false);
  timeline.stretch(milliseconds(7));
  CHECK(timeline.next({}).time_ns == 0);
  timeline.go_on(timeline.next({}));
  CHECK(timeline.next({}).time_ns == 100'000'000);
  timeline.stretch(milliseconds(7));
  CHECK(timeline.next({}).time_ns == 7'000'000);
  timeline.stretch(milliseconds(3));
  CHECK(timeline.next({}).time_ns == 3'000'000);
  timeline.go_on(timeline.next({}));
  CHECK(timeline.next({}).time_ns == 103'000'000);
  for (const int wrong : {0, -1}) {
    CHECK(contains(error_of([&] { timeline.stretch(milliseconds(wrong)); }), "expected more than 0"));
  }
  CHECK(contains(error_of([&] { timeline.stretch(std::chrono::nanoseconds::max()); }), "292 years"));
  CHECK(timeline.next({}).time_ns == 103'000'000);
}

TEST_CASE("the period of a frame is the caller's, if the caller says when it comes") {
  for (const bool when_due : {false, true}) {
    Timeline timeline(10, when_due);
    const std::vector<double> rates{4};
    timeline.stretch(milliseconds(7));
    CHECK(timeline.next(rates).period_ns == 7'000'000);
    timeline.go_on(timeline.next(rates));
    CHECK(timeline.next(rates).period_ns == (when_due ? 250'000'000 : 100'000'000));
    timeline.stretch(milliseconds(3));
    CHECK(timeline.next(rates).period_ns == 3'000'000);
  }
}

TEST_CASE("sensors are due at the first frame at or after their times, whatever the frames' distances") {
  Simulation simulation =
      Simulation::from_string(R"(<sensor type="camera" name="C" insert_at="ROOT" width="4" height="4" rate="10"/>)");
  std::string due;
  for (const int ms : {1, 30, 30, 30, 30, 250, 30}) {  // frames at 0, 30, 60, 90, 120, 370, 400 ms
    simulation.step(milliseconds(ms));
    due += simulation.measured().empty() ? '-' : 'X';
  }
  CHECK(due == "X---XXX");
  CHECK(simulation.next_frame().time_ns == 400'000'000 + 66'666'667);
}

TEST_CASE("a simulation whose frames come when a sensor is due") {
  SimulationDesc desc;
  desc.frames_when_due = true;
  Simulation simulation = Simulation::from_string(
      R"(<sensor type="camera" name="A" insert_at="ROOT" width="4" height="4" rate="10"/>
         <sensor type="camera" name="B" insert_at="ROOT" width="4" height="4" rate="4"/>)",
      desc);
  std::string measured;
  for (int i = 0; i < 5; ++i) {
    measured += std::to_string(simulation.next_frame().time_ns / 1'000'000);
    simulation.step();
    for (const std::string& name : simulation.measured()) measured += name;
    measured += " ";
  }
  CHECK(measured == "0AB 100A 200A 250B 300A ");
  simulation.enable("A", false);
  CHECK(simulation.next_frame().time_ns == 500'000'000);
}

TEST_CASE("multiples of rates, exactly as they are written") {
  CHECK(is_multiple(15, 5));
  CHECK(is_multiple(15, 15));
  CHECK(is_multiple(0.3, 0.1));  // though the doubles are not
  CHECK(is_multiple(29.97, 9.99));
  CHECK(is_multiple(1e9, 1e-12));
  CHECK_FALSE(is_multiple(15, 10));
  CHECK_FALSE(is_multiple(5, 15));
  CHECK_FALSE(is_multiple(1e-12, 1e9));
  CHECK_FALSE(is_multiple(30, 29.97));
  CHECK(common_multiple(std::vector<double>{10, 15}) == 30);
  CHECK(common_multiple(std::vector<double>{37.5, 10}) == 150);
  CHECK(common_multiple(std::vector<double>{0.1}) == 0.1);
  CHECK_FALSE(common_multiple({}));
  CHECK_FALSE(common_multiple(std::vector<double>{29.97, 30}));  // 2997 Hz
  CHECK_FALSE(common_multiple(std::vector<double>{1e-9}));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
