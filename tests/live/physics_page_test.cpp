// The recorded page of a scene with physics in a closed room: contacts, graphs, picking, and a link that keeps all of
// it.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/live/live_program.h"
#include "tests/live/page_client.h"
#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("live");

namespace simvis {
namespace {

// A box falls to the floor of a room without a window. browse_physics.py knows its numbers.
const std::string kRoom = R"(<simvis>
<element type="physics" name="PHYSICS" insert_at="ROOT"/>
<part name="FLOOR" insert_at="ROOT" shape="box" size="8 8 0.2" pose_offset="0 0 -0.1 0 0 0"/>
<element type="body" name="FLOOR_BODY" insert_at="FLOOR" kind="static" shape="box"/>
<part name="CEILING" insert_at="ROOT" shape="box" size="8 8 0.2" pose_offset="0 0 3.1 0 0 0"/>
<part name="WALL_A" insert_at="ROOT" shape="box" size="0.2 8 3" pose_offset="4 0 1.5 0 0 0"/>
<part name="WALL_B" insert_at="ROOT" shape="box" size="0.2 8 3" pose_offset="-4 0 1.5 0 0 0"/>
<part name="WALL_C" insert_at="ROOT" shape="box" size="8 0.2 3" pose_offset="0 4 1.5 0 0 0"/>
<part name="WALL_D" insert_at="ROOT" shape="box" size="8 0.2 3" pose_offset="0 -4 1.5 0 0 0"/>
<part name="BOX" insert_at="ROOT" shape="box" size="0.2 0.4 0.6" pose_offset="2 0 0.4 0 0 0"/>
<element type="body" name="BOX_BODY" insert_at="BOX" mass="3" shape="box"/>
<element type="label" name="BOXES" insert_at="ROOT" part="BOX" class="parcel" class_id="7"/>
<part name="ROBOT" insert_at="ROOT" shape="cylinder" radius="0.2" length="0.4" pose_offset="0 0 0.2 0 0 0"/>
<element type="light" name="LAMP" insert_at="ROOT" kind="point" z="2.5" intensity="30" red="1" green="0.5" blue="0.25"/>
<element type="laser_beams" name="BEAMS" insert_at="ROOT" scanner="SCAN"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROBOT" samples="41" min_angle="-20" max_angle="20"
        pose_offset="0.3 0 0.1 0 0 0" truth="instance semantic"/>
<sensor type="camera" name="CAM" insert_at="ROBOT" width="64" height="48" outputs="color depth semantic"
        pose_offset="0.3 0 0.1 0 0 0"/>
<sensor type="imu" name="IMU" insert_at="BOX"/>
</simvis>
)";

/// Runs a program of this folder. Debian's Python has Debian's packages.
void browse(const std::string& program, const std::vector<std::string>& arguments) {
  std::vector<std::string> command{"/usr/bin/python3", SIMVIS_SOURCE_DIR "/tests/live/" + program};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const ProcessResult browser = Process(command).wait(std::chrono::seconds(250));
  INFO(browser.out << browser.err);
  if (browser.exit_code == test::kSkippedExitCode) return test::skip(browser.out);
  CHECK(browser.exit_code == 0);
}

TEST_CASE("a page shows where bodies touch, graphs of the whole run, and what a click means") {
  const TemporaryFolder folder;
  write_text(folder / "room.xml", kRoom);
  const ProcessResult run = run_simvis({(folder / "room.xml").string(), "--frames", "16", "--rate", "15", "--out",
                                        (folder / "out").string(), "--page", (folder / "room.html").string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  browse("browse_physics.py", {(folder / "room.html").string()});
}

TEST_CASE("a page pulls at a body of a running simulation, and puts all bodies back") {
  const TemporaryFolder folder;
  write_text(folder / "room.xml", kRoom);
  browse("browse_pull.py", {simvis_run(), (folder / "room.xml").string()});
}

/// A page without a browser that knows how high two boxes are above where they rest.
struct HoldingPage {
  explicit HoldingPage(std::uint16_t port) : socket(port, test::kView) {
    const nlohmann::json parameters = socket.receive_op("scene").at("parameters");
    left_z = test::index_of(parameters, "element", "LEFT_BODY", "z");
    right_z = test::index_of(parameters, "element", "RIGHT_BODY", "z");
  }
  void pull(std::size_t body, double y_m) {
    socket.send({{"op", "pull"}, {"body", body}, {"at", {0, 0, 0}}, {"to", {0, y_m, 1}}});
  }
  template <typename Predicate>
  void wait_until(const Predicate& fits) {
    do {
      const nlohmann::json message = socket.receive_until([](const nlohmann::json& each) {
        return each.at("op") == "values" || (each.at("op") == "frame" && each.at("time_s") > kPatience_s);
      });
      REQUIRE(message.at("op") == "values");
      for (const nlohmann::json& value : message.at("values")) {
        if (value[0] == left_z) left_m = value[1];
        if (value[0] == right_z) right_m = value[1];
      }
    } while (!fits());
  }
  static constexpr double kPatience_s = 20;  // of the simulation, which takes less than 2 s for all of it
  test::WebSocketClient socket;
  std::size_t left_z = 0, right_z = 0;
  double left_m = 0, right_m = 0;
};

TEST_CASE("two pages pull at two bodies of a running simulation, and one lets go of its own") {
  const TemporaryFolder folder;
  write_text(folder / "boxes.xml", R"(<simvis><element type="physics" name="PHYSICS" insert_at="ROOT"/>
<part name="FLOOR" insert_at="ROOT" shape="box" size="8 8 0.2" pose_offset="0 0 -0.1 0 0 0"/>
<element type="body" name="FLOOR_BODY" insert_at="FLOOR" kind="static" shape="box"/>
<part name="LEFT" insert_at="ROOT" shape="box" size="0.2 0.2 0.2" pose_offset="0 1 0.1 0 0 0"/>
<element type="body" name="LEFT_BODY" insert_at="LEFT" mass="3" shape="box"/>
<part name="RIGHT" insert_at="ROOT" shape="box" size="0.2 0.2 0.2" pose_offset="0 -1 0.1 0 0 0"/>
<element type="body" name="RIGHT_BODY" insert_at="RIGHT" mass="3" shape="box"/></simvis>)");
  test::LiveProcess live;
  live.start({(folder / "boxes.xml").string(), "--real-time", "1"}, "0", folder / "live.txt");
  HoldingPage one(live.port), other(live.port);
  one.pull(1, 1);
  other.pull(2, -1);
  // Both hang 0.15 m below the place 0.9 m above where they rest.
  other.wait_until([&] { return other.left_m > 0.7 && other.right_m > 0.7; });
  other.socket.send({{"op", "release"}});
  other.wait_until([&] { return other.right_m < 0.01; });
  CHECK(other.left_m > 0.7);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
