// A host in shared memory with a few elements and one sensor, for tests of clients.
#pragma once

#include <unistd.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <simvis_client/connection.h>
#include "clients/host.h"

namespace simvis {

/// A name that no other test of this machine has.
inline std::string unique_name(const std::string& test) { return "test-" + test + "-" + std::to_string(::getpid()); }

inline constexpr std::size_t kPoseValues = 6;
inline constexpr std::array<double, 16> kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};

/// Adds an element with x, y, z in [-10, 10] m and three angles without limits, all 0.
inline std::size_t add_pose(SharedHost& host, const std::string& name) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<SharedParameter> rows;
  for (const char* axis : {"x", "y", "z"}) rows.push_back({axis, "m", -10, 10, false, false, 0});
  for (const char* angle : {"roll", "pitch", "yaw"}) {
    rows.push_back({angle, "deg", -kInfinity, kInfinity, false, false, 0});
  }
  return host.add_element(name, "pose", "ROOT", rows);
}

/// A scan whose ranges are all `value`.
inline void publish_scan(SharedHost& host, std::size_t sensor, std::uint64_t frame, float value) {
  const std::vector<float> ranges(361, value);
  const SharedOutput output{
      .name = "range_m", .rows = 1, .columns = 361, .channels = 1, .type = SIMVIS_FLOAT32, .data = ranges.data()};
  host.publish(sensor, frame, static_cast<std::int64_t>(frame) * 1000, kIdentity, {&output, 1});
}

}  // namespace simvis
