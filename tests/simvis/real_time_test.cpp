// --real-time: when frames are due, by a sleep that notes it.
#include "program/cli/real_time.h"

#include <doctest/doctest.h>

#include <thread>

#include "engine/base/now_ns.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr std::int64_t kPeriod_ns = 50'000'000;

FrameTime frame(std::uint64_t index) {
  return {.index = index, .time_ns = static_cast<std::int64_t>(index) * kPeriod_ns, .period_ns = kPeriod_ns};
}

/// Notes how long the clock would sleep, and sleeps.
struct Sleeps {
  std::vector<std::int64_t> waits_ns{};
  RealTime clock(double factor) {
    return RealTime(factor, [this](std::int64_t due_ns) {
      waits_ns.push_back(due_ns - now_ns());
      std::this_thread::sleep_for(std::chrono::nanoseconds(waits_ns.back()));
    });
  }
};

TEST_CASE("the clock starts behind the first frame of the process, also in a run that goes on") {
  for (const std::uint64_t first : {std::uint64_t{0}, std::uint64_t{1000}}) {
    CAPTURE(first);
    Sleeps sleeps;
    RealTime clock = sleeps.clock(1);
    clock.wait(frame(first));
    CHECK(sleeps.waits_ns.empty());
    clock.wait(frame(first + 1));
    REQUIRE_FALSE(sleeps.waits_ns.empty());
    CHECK(sleeps.waits_ns.front() <= kPeriod_ns);
  }
}

TEST_CASE("durations beyond the clock's range are the longest one") {
  CHECK(limited_ns(1.5) == 1'500'000'000);
  CHECK(limited_ns(1e300) == limited_ns(std::numeric_limits<double>::infinity()));
  CHECK(now_ns() + limited_ns(1e300) > now_ns());
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
