// Rooms of simple shapes: ranges against geometry, and scenes that must measure the same.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <simvis/simulation.h>
#include "tests/support/sensor_bytes.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

constexpr const char* kRoomScanner = R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="181"/>)";

// Corners and ranges are float32: below 8 m each rounds by at most 2.4e-7 m. A corner's two coordinates and the range
// make three of these, times the slant of a side, which is below 20.
constexpr double kRange_m = 3 * 2.4e-7 * 20;
// Of a round shape only the range is rounded.
constexpr double kRoundRange_m = 2.4e-7;

/// Where a ray from the origin meets a segment: its range, or infinity. A hit within 1e-6 of an end counts.
double meet(double azimuth, const glm::dvec2& a, const glm::dvec2& b) {
  const glm::dvec2 d(std::cos(azimuth), std::sin(azimuth)), s = b - a;
  const double cross = d.x * s.y - d.y * s.x;
  const double range = (a.x * s.y - a.y * s.x) / cross, along = (a.x * d.y - a.y * d.x) / cross;
  const bool hits = range > 0 && along > -1e-6 && along < 1 + 1e-6;
  return hits ? range : std::numeric_limits<double>::infinity();
}

/// Where a ray from the origin meets a circle from outside: its range, or infinity.
double meet_circle(double azimuth, const glm::dvec2& middle, double radius) {
  const glm::dvec2 d(std::cos(azimuth), std::sin(azimuth));
  const double nearest = glm::dot(middle, d), aside = d.x * middle.y - d.y * middle.x;
  const double half_chord_square = radius * radius - aside * aside;
  const bool hits = nearest > 0 && half_chord_square > 0;
  return hits ? nearest - std::sqrt(half_chord_square) : std::numeric_limits<double>::infinity();
}

double meet_polygon(double azimuth, std::span<const glm::dvec2> corners) {
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    nearest = std::min(nearest, meet(azimuth, corners[i], corners[(i + 1) % corners.size()]));
  }
  return nearest;
}

TEST_CASE("a scanner reads the distance to the sides of boxes and cylinders") {
  auto simulation = Simulation::from_string(std::string(R"(
    <part name="WALL" insert_at="ROOT" shape="box" size="0.1 8 2" pose_offset="5 0 0 0 0 0"/>
    <part name="CRATE" insert_at="ROOT" shape="box" size="1 2 1" pose_offset="2 3 0 0 0 30"/>
    <part name="COLUMN" insert_at="ROOT" shape="cylinder" radius="0.5" length="2" pose_offset="3 -1 0 0 0 0"/>)") +
                                            kRoomScanner);
  simulation.step();
  std::vector<glm::dvec2> wall{{4.95, -4}, {5.05, -4}, {5.05, 4}, {4.95, 4}}, crate;
  for (const glm::dvec2 c : {glm::dvec2(-0.5, -1), {0.5, -1}, {0.5, 1}, {-0.5, 1}}) {
    const double turn = std::numbers::pi / 6;
    crate.emplace_back(2 + c.x * std::cos(turn) - c.y * std::sin(turn),
                       3 + c.x * std::sin(turn) + c.y * std::cos(turn));
  }
  const Scan& scan = simulation.scan("SCAN");
  REQUIRE(scan.beams == 181);
  int on_wall = 0, on_crate = 0, on_column = 0, on_nothing = 0;
  for (std::size_t i = 0; i < scan.beams; ++i) {
    const double azimuth = scan.azimuth_rad[i];
    const double to_wall = meet_polygon(azimuth, wall), to_crate = meet_polygon(azimuth, crate),
                 to_column = meet_circle(azimuth, {3, -1}, 0.5);
    const double expected = std::min({to_wall, to_crate, to_column});
    CAPTURE(i);
    if (std::isinf(expected)) {
      CHECK(std::isinf(scan.range_m[i]));
      ++on_nothing;
    } else {
      CHECK(std::abs(scan.range_m[i] - expected) < (expected == to_column ? kRoundRange_m : kRange_m));
      ++(expected == to_wall ? on_wall : expected == to_crate ? on_crate : on_column);
    }
  }
  CHECK(on_wall > 20);
  CHECK(on_crate > 20);
  CHECK(on_column > 10);
  CHECK(on_nothing > 20);
}

std::uint64_t measured(const std::string& commands, const std::filesystem::path& folder = ".") {
  auto simulation = Simulation::from_string(commands, {}, folder);
  simulation.step();
  REQUIRE(simulation.measured().size() == 2);
  return measured_hash(simulation);
}

const std::string kRoomSensors =
    std::string(kRoomScanner) +
    R"(<sensor type="camera" name="CAM" insert_at="ROOT" pose_offset="-2 0 2" look_at="2 0 0"
                                        width="64" height="48" outputs="color depth"/>)";

TEST_CASE("a scene with repetition or an included file measures the bytes of the scene written out") {
  const TemporaryFolder folder;
  write_text(folder / "posts.xml", R"(<repeat count="3" as="i"><part name="POST_${i}" insert_at="ROOT" shape="capsule"
    radius="${0.1 * (i + 1)}" length="1" color="${i / 2} 0.5 0" pose_offset="2 ${i - 1} 0 0 0 0"/></repeat>)");
  const std::string post = R"(" insert_at="ROOT" shape="capsule" length="1" )";
  const std::uint64_t written_out = measured(R"(<part name="POST_0)" + post +
                                             R"(radius="0.1" color="0 0.5 0" pose_offset="2 -1 0 0 0 0"/>
         <part name="POST_1)" + post + R"(radius="0.2" color="0.5 0.5 0" pose_offset="2 0 0 0 0 0"/>
         <part name="POST_2)" + post + R"(radius="0.30000000000000004" color="1 0.5 0" pose_offset="2 1 0 0 0 0"/>)" +
                                             kRoomSensors);
  CHECK(measured(read_text(folder / "posts.xml") + kRoomSensors) == written_out);
  CHECK(measured("<include file='posts.xml'/>" + kRoomSensors, folder.path()) == written_out);
  CHECK(measured("<include file='posts.xml' prefix='A/'/>" + kRoomSensors, folder.path()) == written_out);
  CHECK(measured(kRoomSensors) != written_out);
}

TEST_CASE("shapes, repetitions and expressions can be added to a running scene") {
  auto simulation = Simulation::from_string(kRoomScanner);
  simulation.step();
  CHECK(std::isinf(simulation.scan("SCAN").range_m[90]));
  simulation.execute(R"(<set name="x" value="2"/><repeat count="2" as="i">
    <part name="B_${i}" insert_at="ROOT" shape="box" size="1 1 1" pose_offset="${x + i} 0 0 0 0 0"/></repeat>)");
  simulation.step();
  CHECK(simulation.scan("SCAN").range_m[90] == 1.5f);
  CHECK_THROWS_AS(simulation.execute("<part name='C' insert_at='ROOT' shape='box' size='1 1'/>"), InputError);
  simulation.step();
  CHECK(simulation.scan("SCAN").range_m[90] == 1.5f);
}

}  // namespace
}  // namespace simvis
