// Late times, large angles and many changes: errors that accumulate in other simulators.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <simvis/pose.h>
#include <simvis/ray_caster.h>
#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "simvis/time/clock.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/hard_cases/part_file.h"
#include "tests/support/clock_fires.h"
#include "tests/support/infinity.h"
#include "tests/support/random_room.h"
#include "tests/support/reference_directions.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("hard_cases");

using namespace simvis;

namespace {

// Steps are about ten times slower under sanitizers.
const int kFewerSteps = sanitized() ? 10 : 1;

const glm::dvec3 kRoomHalf_m(5, 4, 1.5);

/// Range to the walls of the room from inside.
double range_in_room(const glm::dvec3& from, const glm::dvec3& direction) {
  double nearest = kInfinity;
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == 0) continue;
    const double wall = direction[axis] > 0 ? kRoomHalf_m[axis] : -kRoomHalf_m[axis];
    nearest = std::min(nearest, (wall - from[axis]) / direction[axis]);
  }
  return nearest;
}

/// The room, and a robot in it with a scanner of each method.
class Room {
 public:
  Simulation make(double rate_hz = 15) const {
    std::string xml = R"(<part file="room.gltf" name="ROOM" insert_at="ROOT" up="z"/>
      <element type="pose" name="DRIVE" insert_at="ROOT"/><element type="joint" name="TURN" insert_at="ROOT"/>)";
    for (const std::string& method : methods()) {
      xml += "<sensor type=\"laser_scanner\" name=\"" + method + "\" " + method_attributes(method) +
             " insert_at=\"ROOT\" rate=\"1e-6\"/>";
    }
    return Simulation::from_string(xml, {.rate_hz = rate_hz, .device = {}, .overrides = {}}, folder_.path());
  }
  Room() { write_part(folder_ / "room.gltf", half_box_mesh(kRoomHalf_m)); }

  static std::vector<std::string> methods() { return {"nearest", "planar", "hybrid", "raycast"}; }

 private:
  TemporaryFolder folder_;
};

bool same_scans(const Simulation& a, const Simulation& b) {
  return std::ranges::all_of(Room::methods(), [&](const std::string& method) {
    const Scan &x = a.scan(method), &y = b.scan(method);
    return !x.range_m.empty() && x.range_m == y.range_m && x.error_bound_m == y.error_bound_m;
  });
}

}  // namespace

TEST_CASE("frames at 10^6 s") {
  constexpr std::uint64_t kFrame = 15'000'000;
  constexpr std::int64_t kTime_ns = 1'000'000'000'000'000;
  const Clock clock(15);
  for (std::uint64_t k = 0; k < 1000; ++k) {
    REQUIRE(clock.frame(kFrame + k).time_ns == kTime_ns + clock.frame(k).time_ns);
    REQUIRE(fires_in(clock, 5, kFrame + k) == fires_in(clock, 5, k));
  }
}

// Frame 10 of a simulation with a frame every 10^5 s. The scanners measure every 10^6 s: in frames 0 and 10. All
// numbers are exact between the two rows of the trajectory half a second before and after.
TEST_CASE("a trajectory at 10^6 s") {
  const Room room;
  Simulation late = room.make(1e-5), fresh = room.make();
  TemporaryFolder folder;
  write_text(folder / "drive.csv",
             "time_s,DRIVE.x,DRIVE.y,DRIVE.yaw\n0,-3,0,0\n999999.5,1,0.25,30\n1000000.5,2,0.75,50\n");
  const Trajectory drive(folder / "drive.csv", late.parameters());
  FrameTime time;
  for (int frame = 0; frame <= 10; ++frame) {
    time = late.next_frame();
    drive.apply(static_cast<double>(time.time_ns) / 1e9, late.parameters());
    late.step();
    CHECK(late.measured().size() == (frame % 10 == 0 ? Room::methods().size() : 0));
  }
  CHECK(time.time_ns == 1'000'000'000'000'000);
  const std::pair<const char*, double> expected[] = {{"x", 1.5}, {"y", 0.5}, {"yaw", 40}};
  for (const auto& [name, value] : expected) {
    CHECK(late.get("DRIVE", name) == value);
    fresh.set("DRIVE", name, value);
  }
  fresh.step();
  CHECK(same_scans(late, fresh));
  for (const std::string& method : Room::methods()) {
    const Scan& scan = late.scan(method);
    std::size_t beyond = 0;
    for (std::size_t beam = 0; beam < scan.beams; ++beam) {
      const double a = scan.azimuth_rad[beam] + 40 * kPi / 180;
      const double error = std::abs(scan.range_m[beam] - range_in_room({1.5, 0.5, 0}, {std::cos(a), std::sin(a), 0}));
      beyond += !(error <= scan.error_bound_m[beam]);
    }
    CHECK(beyond == 0);
  }
  add_line("frame and trajectory at 10^6 s", "the same bytes as at once");
}

TEST_CASE("10^6 pose updates leave nothing behind") {
  const int kUpdates = 1'000'000, kSteps = 3000 / kFewerSteps;
  const Room room;
  Simulation worn = room.make(1e-6), fresh = room.make(1e-6);  // the scanners measure in each frame
  std::mt19937 random(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  const char* const names[] = {"x", "y", "z", "roll", "pitch", "yaw"};
  for (int update = 0; update < kUpdates; ++update) {
    const std::size_t which = static_cast<std::size_t>(update) % std::size(names);
    worn.set("DRIVE", names[which], (which < 3 ? 1 : 1000) * unit(random));
    worn.set("TURN", "value", 1000 * unit(random));
    if (update % (kUpdates / kSteps) != 0) continue;
    const bool all = worn.next_frame().index % 10 == 0;  // the others cost ten times as much as the last
    for (const std::string& method : Room::methods()) worn.enable(method, all || method == Room::methods().back());
    worn.step();
  }
  for (const std::string& method : Room::methods()) worn.enable(method, true);
  for (Simulation* simulation : {&worn, &fresh}) {
    for (std::size_t i = 0; i < std::size(names); ++i) {
      simulation->set("DRIVE", names[i], 0.1 * static_cast<double>(i + 1) * (i < 3 ? 1 : 77));
    }
    simulation->set("TURN", "value", -123.4);
    simulation->step();
  }
  glm::dmat4 a(0), b(1);
  REQUIRE(worn.sensor_pose("planar", a));
  REQUIRE(fresh.sensor_pose("planar", b));
  CHECK(a == b);
  CHECK(same_scans(worn, fresh));
  add_line("10^6 pose updates", "the same bytes as the last one alone");
}

TEST_CASE("angles of 10^9 degrees") {
  // 10^9 = 2,777,777 * 360 + 280, and 10^15 + 90 = 2,777,777,777,778 * 360 + 10
  const std::pair<double, double> equal[] = {{1e9, 280}, {-1e9, 80}, {1e15 + 90, 10}, {360e9 + 90, 90}};
  const Room room;
  Simulation large = room.make(1e-6), small = room.make(1e-6);
  for (const auto& angles : equal) {
    const double angle = angles.first, remainder = angles.second;
    CAPTURE(angle);
    for (const char* name : {"roll", "pitch", "yaw"}) {
      large.set("DRIVE", name, angle);
      small.set("DRIVE", name, remainder);
    }
    const bool allowed = std::abs(angle) <= kMaxCoordinate_m;  // of a joint's value
    large.set("TURN", "value", allowed ? angle : remainder);
    small.set("TURN", "value", remainder);
    large.step();
    small.step();
    CHECK(same_scans(large, small));
  }

  HardCase hard{.name = "a scanner turned by 10^9 degrees"};
  add_item(hard.world, half_box_mesh(kRoomHalf_m), glm::dmat4(1.0));
  hard.world_from_sensor = matrix_from_degrees({0, 0, 0}, 0, 0, 1e9);
  hard.scanner.pattern = {.beams = 361,
                          .rings = 21,
                          .min_azimuth_rad = -kPi / 2,
                          .max_azimuth_rad = kPi / 2,
                          .min_elevation_rad = -0.5,
                          .max_elevation_rad = 0.5};
  const glm::dmat3 turned(glm::rotate(glm::dmat4(1.0), 280 * kPi / 180, {0, 0, 1}));
  hard.truth = [=](const glm::dvec3& d) { return range_in_room({0, 0, 0}, turned * d); };
  measure(hard);
}

TEST_CASE("a pitch of exactly 90 degrees, up and down") {
  for (const double pitch : {90.0, -90.0}) {
    const double side = pitch > 0 ? 1 : -1;
    // Yaw and roll turn about the same axis there: R = Rz(yaw) Ry(pitch) Rx(roll) depends on yaw - side * roll only.
    // Both come from sines and cosines with an error of one ulp, multiplied twice: 8 half ulps of 1.
    constexpr double kRounding = 8 * 0x1p-53;
    for (const double roll : {0.0, 33.0, -90.0, 170.0}) {
      const glm::dmat3 m(matrix_from_degrees({0, 0, 0}, roll, pitch, 20)),
          alone(matrix_from_degrees({0, 0, 0}, 0, pitch, 20 - side * roll));
      const glm::dmat3 square = glm::transpose(m) * m;
      CHECK(std::abs(glm::determinant(m) - 1) <= kRounding);
      for (int c = 0; c < 3; ++c) {
        for (int r = 0; r < 3; ++r) {
          CHECK(std::abs(m[c][r] - alone[c][r]) <= kRounding);
          CHECK(std::abs(square[c][r] - (c == r)) <= kRounding);
        }
      }
      CHECK(m[0] == glm::dvec3(0, 0, -side));  // the nose points straight down, or up
    }
    HardCase hard{.name = pitch > 0 ? "a scanner with its nose straight down" : "a scanner with its nose straight up"};
    add_item(hard.world, half_box_mesh(kRoomHalf_m), glm::dmat4(1.0));
    hard.world_from_sensor = matrix_from_degrees({0.5, -1, 0.2}, 0, pitch, 20);
    hard.scanner.pattern = {.beams = 361,
                            .rings = 21,
                            .min_azimuth_rad = -kPi,
                            .max_azimuth_rad = kPi,
                            .min_elevation_rad = -0.7,
                            .max_elevation_rad = 0.7};
    const glm::dmat3 turned(
        glm::rotate(glm::rotate(glm::dmat4(1.0), 20 * kPi / 180, {0, 0, 1}), side * kPi / 2, {0, 1, 0}));
    hard.truth = [=](const glm::dvec3& d) { return range_in_room({0.5, -1, 0.2}, turned * d); };
    measure(hard);
  }
}

TEST_SUITE_END();
