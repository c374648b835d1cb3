// Sensors of what is near: range, sonar, bumper, touch; against geometry, and sonar against a dense cone of rays.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "sensors/proximity/sonar.h"
#include "tests/support/error_of.h"
#include "tests/support/infinity.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// Vertices are float32, as are their sums in meshes of shapes: 0.5 of a unit in the last place of at most 4 m.
constexpr double kSurface_m = 4 * 0x1p-24;

/// A plate of 8 m x 8 m across x whose front is at x = `range_m`, turned about z by `yaw_deg` about its front's centre.
std::string wall_at(double range_m, double yaw_deg = 0) {
  return "<part name='WALL' insert_at='ROOT' pose_offset='" + std::to_string(range_m) + " 0 0 0 0 " +
         std::to_string(yaw_deg) +
         "'/><part name='PLATE' shape='box' size='0.25 8 8' insert_at='WALL' pose_offset='0.125 0 0 0 0 0'/>";
}

double measured(const std::string& xml, const std::string& sensor, const std::string& value) {
  Simulation simulation = Simulation::from_string(xml);
  simulation.step();
  return simulation.value(sensor, value);
}

std::string range_sensor(const std::string& attributes = "") {
  return "<sensor type='range' name='R' insert_at='ROOT' " + attributes + "/>";
}

TEST_CASE("a range sensor reads the wall along its beam, and what lies beyond its limits") {
  CHECK(std::abs(measured(wall_at(3) + range_sensor(), "R", "range_m") - 3) <= kSurface_m);
  CHECK(std::abs(measured(wall_at(3, 60) + range_sensor("pose_offset='0 0 0 0 0 20'"), "R", "range_m") -
                 3 * std::cos(glm::radians(60.0)) / std::cos(glm::radians(40.0))) <= 2 * kSurface_m);
  CHECK(measured(wall_at(3) + range_sensor("range_max='2.5'"), "R", "range_m") == kInfinity);
  CHECK(measured(wall_at(3) + range_sensor("range_min='3.5'"), "R", "range_m") == 0);
  CHECK(measured(range_sensor(), "R", "range_m") == kInfinity);
  CHECK(std::abs(measured(wall_at(3) + range_sensor("bias_mean='0.25'"), "R", "range_m") - 3.25) <= kSurface_m);
  CHECK(measured(range_sensor("bias_mean='0.25'"), "R", "range_m") == kInfinity);
  CHECK(contains(error_of([] { Simulation::from_string(range_sensor("range_min='3' range_max='2'")); }),
                 "attribute \"range_max\": 2 is not allowed with range_min=\"3\", expected that or more"));
}

TEST_CASE("a feeler is pushed in by what crosses it") {
  const std::string touch = "<sensor type='touch' name='T' insert_at='ROOT' length='0.5'/>";
  CHECK(measured(wall_at(0.375) + touch, "T", "pressed") == 1);
  CHECK(std::abs(measured(wall_at(0.375) + touch, "T", "depth_m") - 0.125) <= kSurface_m);
  CHECK(measured(wall_at(0.75) + touch, "T", "pressed") == 0);
  CHECK(measured(wall_at(0.75) + touch, "T", "depth_m") == 0);
}

// The model of sensors/proximity/sonar.h by quadrature: rays on a fine grid of equal solid angles, against the exact
// range and incidence of a wall.
SonarEcho dense_echo(const SonarDesc& desc, double wall_m, double yaw_rad) {
  constexpr int kRings = 300, kAround = 300;
  const glm::dvec3 normal(std::cos(yaw_rad), std::sin(yaw_rad), 0);
  const double height = 1 - std::cos(desc.opening_rad / 2);
  std::vector<SonarEcho> echoes;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int i = 0; i < kAround; ++i) {
      const double x = 1 - height * (ring + 0.5) / kRings, angle = 2 * std::numbers::pi * (i + 0.5) / kAround;
      const double radius = std::sqrt(1 - x * x);
      const glm::dvec3 ray(x, radius * std::cos(angle), radius * std::sin(angle));
      const double cosine = glm::dot(ray, normal), range_m = wall_m * normal.x / cosine;
      if (!(cosine > 0) || range_m > desc.limits.max_m) continue;
      echoes.push_back({range_m, std::pow(cosine, desc.lobe_exponent) / (range_m * range_m) / (kRings * kAround)});
    }
  }
  return first_crossing(std::move(echoes), desc.threshold, desc.pulse_length_m);
}

TEST_CASE("a sonar measures what a dense cone of rays gives") {
  int found = 0, missed = 0;
  for (const double opening_deg : {15.0, 40.0}) {
    for (const double wall_m : {0.5, 3.5}) {
      for (const double yaw_deg : {0.0, 8.0, 35.0, 50.0}) {
        CAPTURE(opening_deg);
        CAPTURE(wall_m);
        CAPTURE(yaw_deg);
        const SonarDesc desc{.opening_rad = glm::radians(opening_deg)};
        const SonarEcho dense = dense_echo(desc, wall_m, glm::radians(yaw_deg));
        const std::string sonar = "<sensor type='sonar' name='S' insert_at='ROOT' rays='4096' opening='" +
                                  std::to_string(opening_deg) + "'/>";
        const double range_m = measured(wall_at(wall_m, yaw_deg) + sonar, "S", "range_m");
        if (!std::isfinite(dense.range_m)) {
          CHECK(range_m == kInfinity);
          ++missed;
          continue;
        }
        // The share of the cone in front of a range is wrong by the discrepancy of a spiral, at most some 1 /
        // sqrt(rays) of the cone; the range at which a share is reached moves with it by at most the cone's range of
        // ranges.
        const double half = glm::radians(opening_deg / 2), yaw = glm::radians(yaw_deg);
        const double nearest = wall_m * std::cos(yaw) / std::cos(std::max(0.0, yaw - half)),
                     farthest = wall_m * std::cos(yaw) / std::cos(yaw + half);
        CHECK(std::abs(range_m - dense.range_m) <= (farthest - nearest) / std::sqrt(4096) + kSurface_m);
        CHECK(range_m >= nearest - kSurface_m);
        ++found;
      }
    }
  }
  CHECK(found > 5);
  CHECK(missed > 3);
}

TEST_CASE("the first crossing adds up the echoes of one pulse only") {
  const std::vector<SonarEcho> echoes = {{2.03, 0.4}, {1, 0.2}, {2, 0.4}, {2.05, 0.4}, {3, 5}};
  CHECK(first_crossing(echoes, 0.7, 0.04).range_m == 2.03);
  CHECK(first_crossing(echoes, 0.9, 0.04).range_m == 3);
  CHECK(first_crossing(echoes, 1.1, 0.06).range_m == 2.05);
  CHECK(first_crossing(echoes, 0.1, 0).range_m == 1);
  CHECK(first_crossing(echoes, 6, 10).strength == doctest::Approx(6.4));
  CHECK(first_crossing(echoes, 7, 10).range_m == kInfinity);
  CHECK(first_crossing({}, 1, 1).range_m == kInfinity);
}

TEST_CASE("the rays of a cone cover it evenly") {
  const std::vector<glm::dvec3> rays = cone_directions(glm::radians(60.0), 1000);
  int inner = 0;
  glm::dvec3 sum(0);
  for (const glm::dvec3& ray : rays) {
    CHECK(ray.x >= std::cos(glm::radians(30.0)));
    inner += ray.x >= 1 - (1 - std::cos(glm::radians(30.0))) / 4 ? 1 : 0;  // a quarter of the solid angle
    sum += ray;
  }
  CHECK(inner == 250);
  CHECK(std::abs(sum.y) + std::abs(sum.z) <= 5);
}

constexpr std::string_view kBumperRobot = R"(
  <part name="ROBOT" insert_at="ROOT"/>
  <element type="pose" name="MOVE" insert_at="ROBOT"/>
  <part name="BODY" shape="box" size="1 0.5 0.5" insert_at="ROBOT"/>
  <part name="BAR" insert_at="ROBOT" pose_offset="0.5 0 0 0 0 0"/>
  <part name="BAR_BOX" shape="box" size="0.25 0.375 0.125" insert_at="BAR"/>
  <sensor type="bumper" name="B" insert_at="BAR" ignore="ROBOT"/>
  <sensor type="bumper" name="OWN" insert_at="BAR"/>)";

TEST_CASE("a bumper closes while it overlaps with something that is not the robot") {
  // The front of the bar is at x = 0.625 m, and a post of 0.25 m stands at x from 1.875 m on.
  Simulation simulation = Simulation::from_string(
      std::string(kBumperRobot) +
      "<part name='POST' shape='box' size='0.25 0.25 2' insert_at='ROOT' pose_offset='2 0.1 0 0 0 0'/>");
  const auto pressed_at = [&](double x) {
    simulation.set("MOVE", "x", x);
    simulation.step();
    return simulation.value("B", "pressed");
  };
  CHECK(pressed_at(0) == 0);
  CHECK(std::isnan(simulation.value("B", "x_m")));
  CHECK(simulation.value("B", "other_instance") == 0);
  CHECK(simulation.value("OWN", "pressed") == 1);  // the body, which it does not ignore
  CHECK(pressed_at(1.249) == 0);
  CHECK(pressed_at(1.25) == 0);  // touches
  CHECK(pressed_at(1.251) == 1);
  // The vertical edges of the post's front lie 1 mm inside the bar: the crossings are near its front face.
  CHECK(simulation.value("B", "x_m") > 0.12);
  CHECK(simulation.value("B", "x_m") <= 0.125 + kSurface_m);
  CHECK(std::abs(simulation.value("B", "y_m") - 0.1) <= 0.126);
  const auto object_at = [&](const char* side) {
    for (const SceneObject& object : simulation.objects()) {
      if (object.instance == simulation.value("B", side)) return object.path;
    }
    return std::string();
  };
  CHECK(object_at("own_instance") == "ROBOT/BAR/BAR_BOX");
  CHECK(object_at("other_instance") == "POST");
  CHECK(pressed_at(1.4) == 1);
  CHECK(pressed_at(5) == 0);
}

TEST_CASE("a corner that pierces a face of the bumper closes it, and a disabled or distant thing does not") {
  // A thin spike whose end lies inside the front face of the bar: no edge of the bar meets it.
  const std::string spike =
      "<part name='SPIKE' insert_at='ROOT' pose_offset='0.6 0.03 0.02 0 0 0'/><element type='visibility' name='SHOWN' "
      "insert_at='SPIKE'/><part name='NEEDLE' shape='box' size='0.5 0.01 0.01' insert_at='SPIKE' pose_offset='0.25 0 0 "
      "0 0 0'/>";
  Simulation simulation = Simulation::from_string(std::string(kBumperRobot) + spike);
  simulation.step();
  CHECK(simulation.value("B", "pressed") == 1);
  CHECK(simulation.value("B", "crossings") >= 4);  // the needle's four long edges
  simulation.set("SHOWN", "visible", 0);
  simulation.step();
  CHECK(simulation.value("B", "pressed") == 0);
  CHECK(contains(error_of([] { Simulation::from_string("<sensor type='bumper' name='B' insert_at='ROOT'/>"); }),
                 "a bumper at ROOT would be the whole world"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
