// The times of frames and of due sensors, compared with a count that steps through the due times one by one.
#include "simvis/time/clock.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <simvis/error.h>
#include "tests/support/clock_fires.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr std::uint64_t kManyFrames = 1'000'000;

struct Rate {
  double hz;
  long double written_hz;  // nearer to the decimal number
};

const Rate kRates[] = {{0.1, 0.1L}, {3, 3}, {7.5, 7.5L}, {15, 15}, {29.97, 29.97L}, {1e6, 1e6L}};

// The definition in extended precision, with two relative roundings of 2^-64. A time below 10^14 ns then has an error
// of 10^-5 ns, while a multiple of 1/29.97 or of 1/7.5 is no closer to a half than 10^9 / 2997 / 2 of its units, 10^-4
// ns. Longer times come from rates whose periods are whole nanoseconds.
std::int64_t time_by_definition(std::uint64_t index, const Rate& rate) {
  return std::llround(static_cast<long double>(index) * 1e9L / rate.written_hz);
}

TEST_CASE("frame times are rounded once from the frame's number") {
  for (const Rate& rate : kRates) {
    const Clock clock(rate.hz);
    bool equal = true;
    for (std::uint64_t k = 0; k < kManyFrames; ++k)
      equal = equal && clock.frame(k).time_ns == time_by_definition(k, rate);
    CHECK_MESSAGE(equal, "rate ", rate.hz);
  }
  const Clock clock(15);
  CHECK(clock.frame(1).time_ns == 66'666'667);
  CHECK(clock.frame(2).time_ns == 133'333'333);
  CHECK(clock.frame(15).time_ns == 1'000'000'000);
  CHECK(clock.frame(7).index == 7);
  CHECK(clock.frame(7).period_ns == 66'666'667);
}

TEST_CASE("halves are rounded up, and large numbers stay exact") {
  const Clock clock(4e8);  // 2.5 ns a frame
  CHECK(clock.frame(1).time_ns == 3);
  CHECK(clock.frame(2).time_ns == 5);
  CHECK(clock.frame(3).time_ns == 8);
  // 0.1 is not a double, but ten million frames of 10 s are 10^8 s to the nanosecond.
  CHECK(Clock(0.1).frame(10'000'000).time_ns == 100'000'000'000'000'000);
  // 3 * 10^18 + 1 frames of 1 ns: a double would deviate by hundreds.
  CHECK(Clock(1e9).frame(3'000'000'000'000'000'001).time_ns == 3'000'000'000'000'000'001);
}

TEST_CASE("a sensor is due in the first frame at or after each of its due times") {
  for (const Rate& frame_rate : kRates) {
    const Clock clock(frame_rate.hz);
    for (const Rate& sensor_rate : kRates) {
      std::uint64_t next = 0;  // the first due time not yet used
      std::uint64_t wrong = 0;
      for (std::uint64_t k = 0; k < kManyFrames; ++k) {
        const std::int64_t now = clock.frame(k).time_ns;
        const bool due = time_by_definition(next, sensor_rate) <= now;
        if (fires_in(clock, sensor_rate.hz, k) != due) ++wrong;
        if (!due) continue;
        // Jumps near the first due time after `now`, then steps.
        next =
            std::max(next, static_cast<std::uint64_t>(static_cast<double>(now) * 1e-9 * sensor_rate.hz * (1 - 1e-12)));
        while (time_by_definition(next, sensor_rate) <= now) ++next;
      }
      CHECK_MESSAGE(wrong == 0, "sensor at ", sensor_rate.hz, " Hz in frames at ", frame_rate.hz, " Hz");
    }
  }
}

std::uint64_t firings(double frame_rate_hz, double sensor_rate_hz, std::uint64_t frames) {
  const Clock clock(frame_rate_hz);
  std::uint64_t count = 0;
  for (std::uint64_t k = 0; k < frames; ++k) count += fires_in(clock, sensor_rate_hz, k) ? 1 : 0;
  return count;
}

TEST_CASE("the number of due frames of sensors") {
  CHECK(firings(15, 1, 15) == 1);
  CHECK(firings(15, 1, 16) == 2);
  CHECK(firings(15, 0, 100) == 100);     // no rate: every frame
  CHECK(firings(15, 1000, 100) == 100);  // faster than the frames: once in each
  CHECK(firings(15, 1e300, 100) == 100);
  CHECK(firings(15, 1e-300, 100) == 1);  // only at time 0
  CHECK(firings(15, 15, kManyFrames) == kManyFrames);
  CHECK(firings(29.97, 29.97, kManyFrames) == kManyFrames);
  // Frame 999,999 is at 99,999.9 s; due times at 0, 1, ..., 99,999 s.
  CHECK(firings(10, 1, kManyFrames) == 100'000);
  CHECK(firings(30, 7.5, kManyFrames) == kManyFrames / 4);
}

std::string refusal(double rate_hz) {
  try {
    Clock clock(rate_hz);
  } catch (const InputError& error) {
    return error.what();
  }
  return "accepted";
}

TEST_CASE("invalid rates are refused") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  for (const double rate : {0.0, -1.0, 2e9, nan, infinity, -infinity}) {
    CHECK(refusal(rate).find("expected more than 0 and at most 1e9") != std::string::npos);
  }
  CHECK(refusal(1e-300).find("292 years") != std::string::npos);
  CHECK(refusal(1e-10) != "accepted");
  CHECK(refusal(2e-10) == "accepted");
  CHECK_THROWS_AS(Clock(2e-10).frame(2), InputError);
  CHECK_THROWS_AS(Clock(15).frame(std::numeric_limits<std::uint64_t>::max()), InputError);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
