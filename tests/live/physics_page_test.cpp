// The recorded page of a scene with physics in a closed room: contacts, graphs, picking, and a link that keeps all of
// it.
#include <doctest/doctest.h>

#include <string>
#include <vector>

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

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
