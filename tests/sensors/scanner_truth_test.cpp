// Columns of scanners that say which things their beams meet, and how these move.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include <simvis/diagnostics.h>
#include <simvis/scan.h>
#include <simvis/simulation.h>
#include <simvis/surface_point.h>
#include "tests/sensors/truth_scene.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

TEST_CASE("a scanner gives the ids of the camera, normals and velocities of what its beams meet") {
  Simulation simulation = truth_simulation(
      truth_camera(kDrawnTruth) +
      "<sensor type='laser_scanner' name='SCAN' insert_at='CAR' samples='101' vertical_samples='3' min_angle='-30' "
      "max_angle='30' vertical_min_angle='-15' vertical_max_angle='10' "
      "truth='hit range instance semantic normal velocity'/>");
  simulation.step(std::chrono::milliseconds(100));
  simulation.set("MOVE", "y", 0.05);
  simulation.step(std::chrono::milliseconds(100));
  const Scan& scan = simulation.scan("SCAN");
  const std::vector<SceneItem> items = simulation.items();
  const DrawList& list = simulation.diagnostics().draw_list();
  const auto value = [&](const char* channel, std::size_t beam) {
    REQUIRE_MESSAGE(!scan.channel(channel).empty(), channel);
    return scan.channel(channel)[beam];
  };
  std::set<double> ids;
  int met = 0, moving = 0;
  for (std::size_t beam = 0; beam < scan.range_m.size(); ++beam) {
    if (std::isinf(value("true_range_m", beam))) {
      CHECK(std::isnan(value("true_instance", beam)));
      CHECK(std::isnan(value("true_normal_x", beam)));
      continue;
    }
    ++met;
    const auto number = static_cast<std::uint32_t>(value("true_item", beam));
    const SceneItem& item = items.at(number);
    CHECK(value("true_instance", beam) == item.instance);
    CHECK(value("true_semantic", beam) == item.semantic);
    ids.insert(value("true_instance", beam));
    const glm::dvec3 direction =
        beam_direction(scan.azimuth_rad[beam % scan.beams], scan.elevation_rad[beam / scan.beams]);
    const RayHit hit{.range_m = value("true_range_m", beam),
                     .item = number,
                     .primitive = static_cast<std::uint32_t>(value("true_primitive", beam))};
    const glm::dvec3 normal = surface_point(list, scan.world_from_sensor, direction, hit).normal;
    CHECK(glm::dvec3(value("true_normal_x", beam), value("true_normal_y", beam), value("true_normal_z", beam)) ==
          normal);
    // The crate's frame has moved 0.05 m in 0.1 s, and nothing else has.
    const glm::dvec3 velocity(value("true_velocity_x_mps", beam), value("true_velocity_y_mps", beam),
                              value("true_velocity_z_mps", beam));
    const bool moves = item.part == "CRATE";
    moving += moves;
    constexpr double kVelocityRounding_mps = 10 * 0x1p-53 * 10 / 0.1;  // see scenegraph/motion.h: 10 m, 0.1 s
    CHECK(glm::distance(velocity, glm::dvec3(0, moves ? 0.5 : 0, 0)) <= kVelocityRounding_mps);
  }
  CHECK(met > 100);
  CHECK(moving > 0);
  const std::vector<double> pixels = truth_numbers(simulation.measurement("CAM"), "instance");
  for (const double id : ids) CHECK(std::ranges::count(pixels, id) > 0);
  CHECK(ids.size() >= 3);
}

TEST_CASE("the radial speed is that of the point against the start of the beam") {
  // A wall at x = 5 that comes at 2 m/s; the scanner turns by 90 deg/s about its part, 1 m from the axis.
  Simulation simulation = Simulation::from_string(R"(
    <part name="TRACK" insert_at="ROOT"/><element type="pose" name="COME" insert_at="TRACK"/>
    <part name="WALL" insert_at="TRACK" shape="box" size="1 40 40" pose_offset="5.5 0 0 0 0 0"/>
    <part name="ARM" insert_at="ROOT"/><element type="pose" name="TURN" insert_at="ARM"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="ARM" pose_offset="0 1 0 0 0 0" samples="5" min_angle="-40"
            max_angle="40" truth="radial_speed velocity"/>)");
  // Velocities are those of the screw that leads from pose to pose in the step: exact for these motions.
  constexpr double kStep_s = 0.001, kTurn_radps = std::numbers::pi / 2, kWall_mps = -2;
  const auto step = [&] { simulation.step(std::chrono::microseconds(1000)); };
  step();
  simulation.set("COME", "x", kWall_mps * kStep_s);
  simulation.set("TURN", "yaw", 90 * kStep_s);
  step();
  const Scan& scan = simulation.scan("SCAN");
  const double turned = kTurn_radps * kStep_s;
  for (std::size_t i = 0; i < 5; ++i) {
    const double angle = scan.azimuth(i) + turned;
    const glm::dvec3 direction(std::cos(angle), std::sin(angle), 0);
    // The scanner is at (-sin, cos) of the turned angle, 1 m from the axis.
    const glm::dvec3 own = -kTurn_radps * glm::dvec3(std::cos(turned), std::sin(turned), 0);
    const double expected = glm::dot(direction, glm::dvec3(kWall_mps, 0, 0) - own);
    constexpr double kRounding_mps = 10 * 0x1p-53 * 10 / kStep_s;  // see scenegraph/motion.h: 10 m
    CHECK(std::abs(scan.channel("true_radial_speed_mps")[i] - expected) <= kRounding_mps);
  }
}

TEST_CASE("a scanner that casts every beam has its truth from the same rays") {
  const auto rays_of = [](const std::string& more) {
    Simulation simulation =
        truth_simulation("<sensor type='laser_scanner' name='SCAN' insert_at='CAR' samples='101' " + more + "/>");
    simulation.step();
    const Measurement scan = simulation.measurement("SCAN");
    return std::pair(simulation.diagnostics().ray_counters().rays, scan.find("true_range_m") == nullptr
                                                                       ? std::vector<double>()
                                                                       : truth_numbers(scan, "true_range_m"));
  };
  const std::string truth = " truth='range instance normal'";
  CHECK(rays_of("method='raycast'").first == 101);
  CHECK(rays_of("method='raycast'" + truth).first == 101);
  CHECK(rays_of("method='planar'" + truth).first == 101);
  CHECK(rays_of("method='raycast'" + truth).second == rays_of("method='planar'" + truth).second);
  // Beams that leave at their own times are other rays.
  CHECK(rays_of("method='raycast' sweep='0.01'" + truth).first == 202);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
