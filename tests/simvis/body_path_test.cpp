#include "simvis/ros/body_path.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

std::vector<std::int64_t> times_of(std::int64_t frames) {
  BodyPath path;
  for (std::int64_t frame = 0; frame < frames; ++frame) path.add({.time_ns = frame});
  std::vector<std::int64_t> times;
  for (const ros::PoseAt& pose : path.poses()) times.push_back(pose.time_ns);
  return times;
}

TEST_CASE("a path has every frame of a short run, and evenly spaced ones of a long run") {
  constexpr std::int64_t kMax = BodyPath::kMaxPoses;
  CHECK(times_of(0).empty());
  for (const std::int64_t frames : {std::int64_t{1}, std::int64_t{2}, kMax - 1, kMax}) {
    const std::vector<std::int64_t> times = times_of(frames);
    REQUIRE(times.size() == static_cast<std::size_t>(frames));
    CHECK(times.back() == frames - 1);
  }
  for (const auto& [frames, spacing] :
       {std::pair{kMax + 1, 2}, {2 * kMax - 3, 2}, {2 * kMax + 1, 4}, {10 * kMax, 16}}) {
    CAPTURE(frames);
    const std::vector<std::int64_t> times = times_of(frames);
    CHECK(times.size() <= static_cast<std::size_t>(kMax + 1));
    CHECK(times.size() > static_cast<std::size_t>(kMax / 2));
    CHECK(times.back() == frames - 1);
    CHECK(std::ranges::is_sorted(times));
    for (std::size_t i = 0; i + 1 < times.size(); ++i) {
      REQUIRE(times[i] == static_cast<std::int64_t>(i) * spacing);
    }
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
