// Drives a robot by what its front scanner sees: driver NAME. Ends with the simulation.
//
// The robot is the element R_POSE, the scanner is FRONT_SCANNER. driver.c and driver.py beside this file do the same.
//
//   c++ -std=c++20 -o driver driver.cpp -lsimvis-client
#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <numbers>
#include <optional>

#include <simvis_client/connection.h>

namespace {

using simvis::client::Connection;

constexpr double kDegrees = 180 / std::numbers::pi;
constexpr double kFree_m = 3;           // farther away, everything is as good
constexpr double kStop_m = 0.6;         // nearer, the robot only turns
constexpr std::ptrdiff_t kWindow = 20;  // beams on each side that must be free, too
constexpr double kSpeed_m_s = 0.6, kTurn_deg_s = 90;
constexpr double kStraight_m = 1;  // a way straight ahead may be so much shorter than one at 90 degrees

struct Way {
  double azimuth_rad = 0, distance_m = 0;
};

Way free_way(std::span<const float> ranges, std::span<const double> azimuths) {
  Way way;
  double best = -std::numeric_limits<double>::infinity();
  const auto beams = std::ssize(azimuths);
  for (std::ptrdiff_t i = 0; i < beams; ++i) {
    const auto from = ranges.begin() + std::max<std::ptrdiff_t>(0, i - kWindow);
    const auto to = ranges.begin() + std::min(beams, i + kWindow + 1);
    const double nearest = std::min(kFree_m, static_cast<double>(*std::min_element(from, to)));
    const double azimuth = azimuths[static_cast<std::size_t>(i)];
    const double value = nearest - kStraight_m * std::abs(azimuth) / (std::numbers::pi / 2);
    if (value <= best) continue;
    best = value;
    way = {azimuth, nearest};
  }
  return way;
}

// Reads the latest scan in place; empty if the host has begun to write over it.
std::optional<Way> look(const Connection& sim) {
  const auto scan = sim.latest(sim.sensor("FRONT_SCANNER"));
  if (!scan) return {};
  const Way way = free_way(scan->output<float>("range_m"), scan->output<double>("azimuth_rad"));
  return scan->whole() ? std::optional(way) : std::nullopt;
}

void drive(Connection& sim) {
  const std::int64_t robot = sim.element("R_POSE");
  const char* const names[] = {"x", "y", "z", "roll", "pitch", "yaw"};
  std::array<double, 6> pose{};
  for (std::size_t i = 0; i < pose.size(); ++i) pose[i] = sim.value(sim.parameter("R_POSE", names[i]));
  auto& [x, y, z, roll, pitch, yaw] = pose;
  std::uint64_t frame = sim.frame();
  double time_s = static_cast<double>(simvis_time_ns(sim.get())) / 1e9;
  sim.ready();  // in lock-step, each frame waits for this
  while (simvis_wait_frame(sim.get(), frame, -1) == 1) {
    frame = sim.frame();
    const double dt_s = static_cast<double>(simvis_time_ns(sim.get())) / 1e9 - time_s;
    time_s += dt_s;
    if (const std::optional<Way> way = look(sim)) {
      yaw += std::clamp(way->azimuth_rad * kDegrees, -kTurn_deg_s * dt_s, kTurn_deg_s * dt_s);
      const bool ahead = std::abs(way->azimuth_rad) < std::numbers::pi / 6 && way->distance_m > kStop_m;
      const double step_m = ahead ? kSpeed_m_s * dt_s : 0;
      x += step_m * std::cos(yaw / kDegrees);
      y += step_m * std::sin(yaw / kDegrees);
      sim.set_element(robot, pose);  // all of them at once
    }
    simvis_ready(sim.get());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  try {
    Connection sim(argv[1], "driver", 60'000);
    drive(sim);
  } catch (const simvis::client::Error& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
