// Warnings: each where it belongs and nowhere else, each once, and errors if strict.
#include <simvis/simulation.h>

#include <doctest/doctest.h>

#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/splat_file.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

const std::string kCam = R"(<sensor type="camera" name="CAM" insert_at="ROOT" width="4" height="4"/>)";
const std::string kMoveElement = R"(<element type="pose" name="MOVE" insert_at="ROOT"/>)";

SimulationDesc strict_desc() {
  SimulationDesc desc;
  desc.strict = true;
  return desc;
}

const std::string kNothing = error_of([] {});

Simulation walled(const std::string& commands, const SimulationDesc& desc = {}) {
  const TemporaryFolder folder;
  write_text(folder / "wall.gltf", wall_gltf());
  return Simulation::from_string(std::string(kWallPart) + commands, desc, folder.path(), "s.xml");
}

/// The warnings of loading and of one step.
std::vector<std::string> warnings_of(const std::string& commands, SimulationDesc desc = {}) {
  Simulation simulation = walled(commands, desc);
  simulation.step();
  const std::vector<std::string> warnings = simulation.warnings();
  simulation.step();
  CHECK(simulation.warnings() == warnings);  // each once
  desc.strict = true;
  const std::string refused = error_of([&] { walled(commands, desc).step(); });
  CHECK((refused == kNothing) == warnings.empty());
  if (!warnings.empty()) CHECK(contains(refused, warnings[0].substr(warnings[0].find(": ") + 2)));
  return warnings;
}

TEST_CASE("a sensor in front of the element that was meant to move it") {
  CHECK(warnings_of(kCam + kMoveElement) ==
        std::vector<std::string>{"s.xml:1:55: sensor \"CAM\" does not move with element \"MOVE\", which comes later at "
                                 "insertion point \"ROOT\" and moves only what follows it; expected the sensor behind "
                                 "the element"});
  CHECK(warnings_of(kMoveElement + kCam).empty());
  // The element moves another sensor, or the sensor is moved by another element.
  const std::string other = R"(<sensor type="camera" name="OTHER" insert_at="ROOT" width="4" height="4"/>)";
  const std::string joint = R"(<element type="joint" name="TURN" insert_at="ROOT" axis="0 0 1"/>)";
  CHECK(warnings_of(kCam + kMoveElement + other).empty());
  CHECK(warnings_of(kMoveElement + kCam + joint).empty());
  CHECK(warnings_of(kCam + joint).size() == 1);
  // An element at a part moves the part.
  const std::string at_wall = R"(<sensor type="psd" name="PSD" insert_at="WALL" pose_offset="-1 0 0 0 0 0"/>)";
  const std::string move_wall = R"(<element type="pose" name="W" insert_at="WALL"/>)";
  CHECK(warnings_of(at_wall + move_wall).size() == 1);
  CHECK(warnings_of(move_wall + at_wall).empty());
  // Elements that move nothing.
  CHECK(warnings_of(kCam + R"(<element type="light" name="L" insert_at="ROOT"/>)").empty());
  CHECK(warnings_of(kCam + R"(<element type="scale" name="S" insert_at="ROOT"/>)").empty());
}

TEST_CASE("rates that the frames do not keep") {
  const auto rated = [](const std::string& rate, const std::string& name = "R") {
    return "<sensor type=\"camera\" name=\"" + name + "\" insert_at=\"ROOT\" width=\"4\" height=\"4\" rate=\"" + rate +
           "\"/>";
  };
  const auto first = [](const std::vector<std::string>& warnings) { return warnings.empty() ? "" : warnings[0]; };
  CHECK(
      first(warnings_of(rated("10"))) ==
      "s.xml:1:123: sensor \"R\" is due 10 times a second, but frames come 15 times, so it measures at the next frame "
      "and its intervals differ; expected --rate 10 or --rate auto");
  CHECK(contains(first(warnings_of(rated("40"))), "measures once in each frame; expected --rate 40 or"));
  CHECK(contains(first(warnings_of(rated("10") + rated("15", "S"))), "expected --rate 30 or --rate auto"));
  CHECK(contains(first(warnings_of(rated("2000"))), "expected --rate auto"));
  for (const char* rate : {"15", "5", "7.5", "0.1", "3.75"}) CHECK(warnings_of(rated(rate)).empty());
  SimulationDesc desc;
  desc.rate_hz = 30;
  CHECK(warnings_of(rated("10"), desc).empty());
  desc.frames_when_due = true;
  CHECK(warnings_of(rated("40"), desc).empty());

  Simulation off = walled(rated("10"));
  off.enable("R", false);
  off.step();
  CHECK(off.warnings().empty());
  Simulation stepped = walled(rated("10"));
  stepped.step(std::chrono::milliseconds(7));
  stepped.step(std::chrono::milliseconds(7));
  CHECK(stepped.warnings().empty());
}

TEST_CASE("a scene without sensors, once it makes a frame") {
  Simulation simulation = walled("");
  CHECK(simulation.warnings().empty());
  simulation.execute(kCam);
  simulation.step();
  CHECK(simulation.warnings().empty());
  for (const char* nothing : {"", "<svg/>"}) {
    Simulation empty = Simulation::from_string(nothing, {}, ".", "empty.xml");
    empty.step();
    REQUIRE(empty.warnings().size() == 1);
    CHECK(contains(empty.warnings()[0], "empty.xml: the scene has no sensor"));
  }
}

TEST_CASE("a sensor that sees nothing in its first frame") {
  const auto facing = [](const std::string& type, const std::string& attributes, int yaw) {
    return "<sensor type=\"" + type + "\" name=\"S\" insert_at=\"ROOT\" pose_offset=\"0 0 0 0 0 " +
           std::to_string(yaw) + "\" " + attributes + "/>";
  };
  const std::string scan = R"(samples="3" min_angle="-5" max_angle="5" range_max="7")",
                    size = R"(width="4" height="4")",
                    // more than one depth image
      strips = R"(samples="9" min_angle="-100" max_angle="100" range_max="7" method="planar")";
  for (const auto& [type, attributes] : {std::pair<std::string, std::string>{"laser_scanner", scan},
                                         {"laser_scanner", scan + R"( method="planar")"},
                                         {"laser_scanner", strips},
                                         {"camera", size},
                                         {"camera", size + R"( outputs="depth")"},
                                         {"stereo_camera", size}}) {
    INFO(type, " ", attributes);
    CHECK(warnings_of(facing(type, attributes, 0)).empty());
    const std::vector<std::string> warnings = warnings_of(facing(type, attributes, 180));
    REQUIRE(warnings.size() == 1);
    CHECK(contains(warnings[0], "s.xml:1:55: sensor \"S\" sees nothing in its first frame"));
  }
}

TEST_CASE("a camera that shows points or splats alone sees something") {
  const TemporaryFolder folder;
  write_text(folder / "points.pcd",
             "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
             "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n2 0 0\n");
  write_text(folder / "splats.ply", test::splat_file({{.center_m = {2, 0, 0}}}));
  const auto warnings_with = [&](const std::string& file, const std::string& sensor, int yaw) {
    Simulation simulation = Simulation::from_string(
        "<simvis><part name='P' insert_at='ROOT' file='" + file + "'/><sensor name='S' insert_at='ROOT' " +
            "pose_offset='0 0 0 0 0 " + std::to_string(yaw) + "' width='41' height='41' " + sensor + "/></simvis>",
        {}, folder.path(), "s.xml");
    simulation.step();
    return simulation.warnings();
  };
  // The depth of a splat is that of its half, so that a thin one shows in colour alone.
  write_text(folder / "thin.ply", test::splat_file({{.center_m = {2, 0, 0}, .opacity = 0.2}}));
  for (const char* const file : {"points.pcd", "splats.ply", "thin.ply"}) {
    for (const char* const sensor :
         {"type='camera' hfov='30'", "type='camera' hfov='30' outputs='color depth'", "type='stereo_camera' hfov='30'",
          "type='camera' distortion='kannala_brandt' fx='40'"}) {
      CAPTURE(file);
      CAPTURE(sensor);
      CHECK(warnings_with(file, sensor, 0).empty());
      const std::vector<std::string> warnings = warnings_with(file, sensor, 180);
      REQUIRE(warnings.size() == 1);
      CHECK(contains(warnings[0], "sees nothing in its first frame"));
    }
  }
}

TEST_CASE("a step that a warning ends can be tried again") {
  Simulation simulation = walled(
      kMoveElement +
          R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="2" min_angle="0" max_angle="1"/>)",
      strict_desc());
  simulation.set("MOVE", "yaw", 180);
  CHECK(contains(error_of([&] { simulation.step(); }), "s.xml:1:106: error: sensor \"SCAN\" sees nothing"));
  CHECK(simulation.measured().empty());
  CHECK(simulation.next_frame().index == 0);
  simulation.set("MOVE", "yaw", 0);
  simulation.step();
  CHECK(simulation.measured().size() == 1);
  CHECK(simulation.next_frame().index == 1);
}

TEST_CASE("warnings of a command that is refused go with it, those of steps and programs stay") {
  Simulation simulation = walled(kCam);
  simulation.warn("mine.csv:3: odd");
  simulation.warn("mine.csv:3: odd");
  const std::vector<std::string> own{"mine.csv:3: odd"};
  CHECK(simulation.warnings() == own);
  const std::string late =
      R"(<sensor type="camera" name="B" insert_at="ROOT"/><element type="pose" name="P" insert_at="ROOT"/>)";
  CHECK(error_of([&] { simulation.execute(late + "<part/>"); }) != kNothing);
  CHECK(simulation.warnings() == own);
  simulation.execute(late);
  CHECK(simulation.warnings().size() == 2);
  CHECK(contains(error_of([&] { walled(kCam, strict_desc()).warn("mine.csv:3: odd"); }), "mine.csv:3: error: odd"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
