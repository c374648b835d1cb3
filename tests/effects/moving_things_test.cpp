// Things that move during a sweep and a rolling shutter, against geometry.
#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <utility>

#include <simvis/simulation.h>
#include "tests/support/moving_scene.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

constexpr double kRate_hz = 16, kThingSweep_s = 0.05;  // a frame lasts 62.5 ms, a whole number of nanoseconds
// Vertices are float32, as are ranges: half a unit in the last place of at most 16 m, twice.
constexpr double kFloat_m = 16 * 0x1p-24;

std::string sweeping(const std::string& attributes = "") {
  return "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='41' min_angle='-40' max_angle='40' "
         "sweep='0.05' " +
         attributes + "/>";
}
double azimuth_of(std::size_t beam) { return glm::radians(-40 + 2.0 * static_cast<double>(beam)); }
double age_of(std::size_t beam) { return kThingSweep_s * static_cast<double>(40 - beam) / 40; }

Simulation world_of(const std::string& xml) {
  SimulationDesc desc;
  desc.rate_hz = kRate_hz;
  return Simulation::from_string(xml, desc);
}

// A plate across x whose front is at x = 4, with an element pose WALL_POSE.
const std::string kWall =
    "<part name='WALL' insert_at='ROOT'/><element type='pose' name='WALL_POSE' insert_at='WALL'/>"
    "<part name='PLATE' shape='box' size='0.25 30 30' insert_at='WALL' pose_offset='4.125 0 0 0 0 0'/>";

double expected_bound(const Scan& scan, std::size_t beam) { return scan.error_bound_m[beam] + kFloat_m; }

TEST_CASE("each beam meets a wall that comes nearer where it was when the beam left") {
  Simulation simulation = world_of(kWall + sweeping());
  for (int frame = 0; frame < 3; ++frame) {
    simulation.set("WALL_POSE", "x", -0.5 * frame);
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    for (std::size_t beam = 0; beam < 41; ++beam) {
      const double speed = frame == 0 ? 0 : 0.5 * kRate_hz;
      const double expected_m = (4 - 0.5 * frame + speed * age_of(beam)) / std::cos(azimuth_of(beam));
      CHECK(std::abs(scan.range_m[beam] - expected_m) <= expected_bound(scan, beam));
    }
  }
}

TEST_CASE("a wall that turns about the scanner is met at the angle that it had") {
  Simulation simulation = world_of(kWall + sweeping());
  simulation.step();
  simulation.set("WALL_POSE", "yaw", 20);
  simulation.step();
  const Scan& scan = simulation.scan("SCAN");
  for (std::size_t beam = 0; beam < 41; ++beam) {
    const double turned = glm::radians(20 * (1 - kRate_hz * age_of(beam)));
    CHECK(std::abs(scan.range_m[beam] - 4 / std::cos(azimuth_of(beam) - turned)) <= expected_bound(scan, beam));
  }
}

TEST_CASE("a scanner and a wall that drive together keep their distance") {
  Simulation simulation =
      world_of("<part name='CAR' insert_at='ROOT'/><element type='pose' name='D' insert_at='CAR'/>" + kWall +
               "<sensor type='laser_scanner' name='SCAN' insert_at='CAR' samples='41' " +
               "min_angle='-40' max_angle='40' sweep='0.05'/>");
  for (int frame = 0; frame < 3; ++frame) {
    simulation.set("D", "x", frame);
    simulation.set("WALL_POSE", "x", frame);
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    for (std::size_t beam = 0; beam < 41; ++beam) {
      CHECK(std::abs(scan.range_m[beam] - 4 / std::cos(azimuth_of(beam))) <= expected_bound(scan, beam));
    }
  }
}

TEST_CASE("beams pass where a box of physics has not come yet, and meet it where it was") {
  // A thin box at x = 2 that moves along y at 8 m/s, in front of a wall that stands.
  constexpr double kSpeed_m_s = 8, kHalf_m = 0.25;
  Simulation simulation = world_of(test::physics("gravity='0 0 0'") +
                                   test::body("BOX", "shape='box' size='0.001 0.5 0.5' pose_offset='2.0005 -1 0 0 0 0'",
                                              "shape='box' mass='1' velocity='0 8 0'") +
                                   kWall + sweeping());
  int on_box = 0, behind_edge = 0;
  for (int frame = 0; frame < 5; ++frame) {
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    // A frame shows the last whole step of 1 ms before it; the motion between two frames is that of their steps.
    const auto shown_s = [](int f) { return std::floor(f / kRate_hz * 1000 + 1e-9) / 1000; };
    const double now_m = -1 + kSpeed_m_s * shown_s(frame);
    const double speed = frame == 0 ? 0 : kSpeed_m_s * (shown_s(frame) - shown_s(frame - 1)) * kRate_hz;
    for (std::size_t beam = 0; beam < 41; ++beam) {
      const double along = std::tan(azimuth_of(beam)), off_m = 2 * along - (now_m - speed * age_of(beam));
      if (std::abs(std::abs(off_m) - kHalf_m) < 2e-3) continue;  // the box is 1 mm thick
      const bool hits = std::abs(off_m) < kHalf_m, would_hit = std::abs(2 * along - now_m) < kHalf_m;
      const double expected_m = (hits ? 2 : 4) / std::cos(azimuth_of(beam));
      CHECK(std::abs(scan.range_m[beam] - expected_m) <= expected_bound(scan, beam));
      on_box += hits;
      behind_edge += hits != would_hit;
    }
  }
  CHECK(on_box > 20);
  CHECK(behind_edge > 10);
}

TEST_CASE("skipped frames change nothing of what a sweep sees") {
  Simulation all = world_of(kWall + sweeping()), some = world_of(kWall + sweeping());
  for (int frame = 0; frame < 4; ++frame) {
    for (Simulation* const simulation : {&all, &some}) {
      simulation->set("WALL_POSE", "x", -0.1 * frame * frame);
      simulation == &some&& frame < 3 ? simulation->skip_frame() : simulation->step();
    }
  }
  CHECK(all.scan("SCAN").range_m == some.scan("SCAN").range_m);
}

TEST_CASE("a scanner without a sweep follows no motion and casts no more rays") {
  const auto work = [](const std::string& sensor, bool moves) {
    Simulation simulation = world_of(kWall + sensor);
    for (int frame = 0; frame < 3; ++frame) {
      if (moves) simulation.set("WALL_POSE", "x", -0.5 * frame);
      simulation.step();
    }
    return std::pair(simulation.diagnostics().motions_followed(), simulation.diagnostics().ray_counters().rays);
  };
  const std::string plain =
      "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='41' min_angle='-40' max_angle='40'/>";
  CHECK(work(plain, true) == std::pair(std::uint64_t{0}, std::uint64_t{3 * 41}));
  CHECK(work(sweeping(), false).second == 3 * 41);
  CHECK(work(sweeping(), true).first > 0);
}

TEST_CASE("a rolling shutter slants the edge of a box that moves past the camera") {
  constexpr std::uint32_t kWide_px = 48, kHigh_px = 32;
  constexpr double kRow_s = 1e-3, kFar_m = 3, kStep_m = 0.5;
  for (const std::uint32_t rows : {1u, 8u}) {
    CAPTURE(rows);
    // The plate's front is at x = 3 and reaches from its edge at y = 0 to the right.
    Simulation simulation = world_of(
        "<part name='PLATE' shape='box' size='0.5 8 8' insert_at='ROOT' pose_offset='3.25 -4 0 0 0 0'/>"
        "<element type='pose' name='MOVE' insert_at='PLATE'/>"
        "<sensor type='camera' name='CAM' insert_at='ROOT' width='48' height='32' hfov='60' outputs='depth' "
        "row_time='1e-3' rows_per_pose='" +
        std::to_string(rows) + "'/>");
    simulation.step();
    simulation.set("MOVE", "y", kStep_m);
    simulation.step();
    const Image& depth = simulation.depth("CAM");
    const double focal_px = kWide_px / 2.0 / std::tan(glm::radians(30.0));
    int seen = 0;
    for (std::uint32_t y = 0; y < kHigh_px; ++y) {
      const std::uint32_t first = y / rows * rows;
      const double age_s = (kHigh_px - 1 - (first + (rows - 1) / 2.0)) * kRow_s;
      const double edge_px = kWide_px / 2.0 - focal_px * kStep_m * (1 - age_s * kRate_hz) / kFar_m;
      for (std::uint32_t x = 0; x < kWide_px; ++x) {
        if (std::abs(x + 0.5 - edge_px) < 0.02) continue;  // vertices are snapped to 1/256 pixel, after some rounding
        const float z = depth.pixels[y * kWide_px + x];
        CHECK((x + 0.5 > edge_px ? std::abs(z - kFar_m) < 1e-3 : std::isinf(z)));
        seen += x + 0.5 > edge_px;
      }
    }
    CHECK(seen > 100);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
