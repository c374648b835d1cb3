// Two views of one world. Elements drawn for people change no byte and no count of sensors, and a visualization camera
// sees them in the correct place.
#include <doctest/doctest.h>

#include <cmath>
#include <cstring>
#include <memory>

#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("elements");

namespace simvis {
namespace {

// A robot before the wall at x = 4 m, with a scanner and cameras of both kinds.
const std::string kRobot = R"(
  <part file="wall.gltf" name="ROBOT" insert_at="ROOT" pose_offset="-30 0 0 0 0 0"/>
  <element type="pose" name="MOVE" insert_at="ROBOT"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROBOT" pose_offset="30 0 0 0 0 0" samples="5"
          min_angle="-60" max_angle="120"/>
  <sensor type="camera" name="CAM" insert_at="ROBOT" pose_offset="30 0 0 0 0 0" width="32" height="24" hfov="90"
          outputs="color"/>
  <sensor type="camera" name="DEPTH" insert_at="ROBOT" pose_offset="30 0 0 0 0 0" width="32" height="24" hfov="90"
          outputs="depth"/>)";

// The width of a beam is five pixels of WATCH, which looks straight down from 3 m: world x points up in its image.
constexpr double kBeamWidth_m = 0.1, kHeight_m = 3, kFocal_px = 150;
const std::string kBeams =
    R"(<element type="laser_beams" name="BEAMS" insert_at="ROOT" scanner="SCAN" red="0.25" green="0.5" blue="0.75"
                opacity="1" width="0.1" size="0.2"/>)";
const std::string kWatch =
    R"(<sensor type="camera" name="WATCH" insert_at="ROOT" pose_offset="1 0 3 0 90 0" width="300" height="300"
               hfov="90" outputs="color depth" view="visualization"/>)";

// All five kinds of helpers, each where the simulated cameras would see it. The trail appears only in a run.
const std::string kHelpersOfNow = kBeams + R"(
  <element type="point_cloud" name="HITS" insert_at="ROOT" scanner="SCAN" size="0.5"/>
  <element type="point_cloud" name="POINTS" insert_at="ROOT" file="points.csv" size="0.5"/>
  <element type="graph" name="MAP" insert_at="ROBOT" nodes="31 -1 0, 32 1 0.5" edges="0-1"/>
  <element type="frame_axes" name="AXES" insert_at="ROBOT" length="33"/>)";
const std::string kTrail = R"(<element type="trail" name="TRAIL" insert_at="ROOT" part="ROBOT" width="0.5"/>)";

Simulation simulate(const std::string& commands) {
  TemporaryFolder folder;
  write_text(folder / "wall.gltf", wall_gltf());
  write_text(folder / "points.csv", "2 0 0\n2 0.5 0.5\n");
  return Simulation::from_string(std::string(kWallPart) + kRobot + commands, {}, folder.path());
}

void drive(Simulation& simulation, int frame) {
  simulation.set("MOVE", "x", 0.125 * frame);
  simulation.set("MOVE", "yaw", 0.5 * frame);  // about the origin of the robot, 30 m behind its sensors
}

bool same_bytes(const std::vector<float>& a, const std::vector<float>& b) {
  return !a.empty() && a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0;
}

void check_same_for_sensors(const Simulation& a, const Simulation& b) {
  CHECK(same_bytes(a.scan("SCAN").range_m, b.scan("SCAN").range_m));
  CHECK(same_bytes(a.scan("SCAN").error_bound_m, b.scan("SCAN").error_bound_m));
  CHECK(same_bytes(a.color("CAM").pixels, b.color("CAM").pixels));
  CHECK(same_bytes(a.depth("DEPTH").pixels, b.depth("DEPTH").pixels));
  CHECK(a.diagnostics().counters() == b.diagnostics().counters());
}

glm::vec3 pixel(const Image& image, int x, int y) {
  const float* const p = &image.pixels[4 * (static_cast<std::size_t>(y) * image.width + static_cast<std::size_t>(x))];
  return {p[0], p[1], p[2]};
}

// Vertex colours have steps of 1 / 65535. Interpolation and the product with white add a few roundings of float32.
constexpr float kColorTolerance = 0.5f / 65535 + 8 * 0x1p-24f;
bool same_color(const glm::vec3& seen, const glm::vec3& expected) {
  return glm::all(glm::lessThanEqual(glm::abs(seen - expected), glm::vec3(kColorTolerance)));
}

// The pixel of WATCH for a place in the world.
glm::dvec2 seen_at_px(const glm::dvec3& world) {
  const double depth_m = kHeight_m - world.z;
  return {150 - kFocal_px * world.y / depth_m, 150 - kFocal_px * (world.x - 1) / depth_m};
}

TEST_CASE("sensors give the same bytes at the same cost with and without helpers for people") {
  Simulation plain = simulate(""), shown = simulate(kHelpersOfNow + kTrail + kWatch);
  for (int frame = 0; frame < 4; ++frame) {
    CAPTURE(frame);
    drive(plain, frame);
    drive(shown, frame);
    plain.step();
    shown.step();
    check_same_for_sensors(plain, shown);
  }
  // The helpers would be visible: a visualization camera in the place of CAM gives another picture.
  Simulation people = simulate(kHelpersOfNow + kTrail +
                               R"(<sensor type="camera" name="EYE" insert_at="ROBOT" pose_offset="30 0 0 0 0 0"
                                          width="32" height="24" hfov="90" view="visualization"/>)");
  people.step();
  CHECK_FALSE(same_bytes(people.color("EYE").pixels, people.color("CAM").pixels));
}

TEST_CASE("helpers cost nothing without a visualization camera") {
  Simulation plain = simulate(""), shown = simulate(kHelpersOfNow + kTrail);
  for (int frame = 0; frame < 2; ++frame) {
    plain.step();
    shown.step();
    check_same_for_sensors(plain, shown);
    CHECK(same_content(plain.diagnostics().draw_list(), shown.diagnostics().draw_list()));
  }
}

TEST_CASE("a visualization camera sees each beam and each hit in its place") {
  Simulation simulation = simulate(kBeams + kWatch);
  for (int frame = 0; frame < 3; ++frame) {
    drive(simulation, frame);
    simulation.step();
    const Scan& scan = simulation.scan("SCAN");
    glm::dmat4 world_from_sensor;
    REQUIRE(simulation.sensor_pose("SCAN", world_from_sensor));
    int hits = 0;
    for (std::size_t beam = 0; beam < scan.beams; ++beam) {
      const double range_m = scan.range_m[beam], a = scan.azimuth_rad[beam];
      if (std::isinf(range_m)) continue;
      ++hits;
      for (const double part : {0.25, 0.5, 0.75}) {
        const glm::dvec3 on_beam =
            world_from_sensor * glm::dvec4(part * range_m * std::cos(a), part * range_m * std::sin(a), 0, 1);
        const glm::dvec2 at = seen_at_px(on_beam);
        if (!(at.x > 5 && at.x < 295 && at.y > 5 && at.y < 295)) continue;  // outside the picture
        CAPTURE(beam);
        CAPTURE(part);
        // The centre of the pixel is within 0.71 px of the point, and the beam's edge 2.5 px away.
        static_assert(kBeamWidth_m / 2 * kFocal_px / kHeight_m > 0.71);
        const glm::vec3 color = pixel(simulation.color("WATCH"), static_cast<int>(at.x), static_cast<int>(at.y));
        CHECK(same_color(color, {0.25f, 0.5f, 0.75f}));
      }
    }
    CHECK(hits >= 2);
  }
}

TEST_CASE("a single frame equals the same frame of a run") {
  const std::string scene = kHelpersOfNow + kWatch;
  Simulation run = simulate(scene), alone = simulate(scene);
  for (int frame = 0; frame < 3; ++frame) {
    drive(run, frame);
    run.step();
  }
  drive(alone, 2);
  alone.step();
  CHECK(same_bytes(run.color("WATCH").pixels, alone.color("WATCH").pixels));
  CHECK(same_bytes(run.depth("WATCH").pixels, alone.depth("WATCH").pixels));
}

TEST_CASE("the trail is behind the robot") {
  // Seen from above, centred on the path of the robot's origin: from x = -30 m on, 1.5 m per frame.
  Simulation simulation = simulate(
      R"(<element type="trail" name="TRAIL" insert_at="ROOT" part="ROBOT" width="0.2" red="0" green="1" blue="0"/>
         <sensor type="camera" name="ABOVE" insert_at="ROOT" pose_offset="-28.5 0 3 0 90 0" width="300" height="300"
                 hfov="90" view="visualization"/>)");
  const auto is_trail = [&](double x) {
    const int row = static_cast<int>(150 - kFocal_px * (x + 28.5) / kHeight_m);
    return same_color(pixel(simulation.color("ABOVE"), 150, row), {0, 1, 0});
  };
  simulation.step();
  CHECK_FALSE(is_trail(-29.5));
  simulation.set("MOVE", "x", 1.5);
  simulation.step();
  CHECK(is_trail(-29.5));
  CHECK(is_trail(-28.6));
  CHECK_FALSE(is_trail(-28.0));
  simulation.set("MOVE", "x", 3);
  simulation.step();
  CHECK(is_trail(-29.5));
  CHECK(is_trail(-27.5));
}

TEST_CASE("a beam stays where it was measured while its scanner is off") {
  Simulation simulation = simulate(kBeams + kWatch);
  simulation.step();
  const std::vector<float> before = simulation.color("WATCH").pixels;
  simulation.enable("SCAN", false);
  drive(simulation, 3);
  simulation.step();
  CHECK(same_bytes(before, simulation.color("WATCH").pixels));
  simulation.enable("SCAN", true);
  simulation.step();
  CHECK_FALSE(same_bytes(before, simulation.color("WATCH").pixels));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
