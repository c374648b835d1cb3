// The page of a running simulation in real browsers.
#include <doctest/doctest.h>

#include <string>

#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("live");

namespace simvis {
namespace {

const std::string kDrivenScene =
    "<simvis>\n<part file=\"" SIMVIS_SOURCE_DIR
    "/scenes/marvin/robot.glb\" name=\"ROBOT\" insert_at=\"ROOT\"/>\n"
    "<part name=\"WALL\" insert_at=\"ROOT\" shape=\"box\" size=\"0.1 4 2\" pose_offset=\"9 0 1 0 0 0\"/>\n"
    "<element type=\"pose\" name=\"MOVE\" insert_at=\"ROBOT\"/>\n"
    "<element type=\"light\" name=\"LAMP\" insert_at=\"ROOT\" kind=\"directional\"/>\n"
    "<sensor type=\"laser_scanner\" name=\"SCAN\" insert_at=\"ROBOT\" samples=\"5\" min_angle=\"-20\" max_angle=\"20\" "
    "pose_offset=\"0.4 0 0.2 0 0 0\"/>\n"
    "<sensor type=\"camera\" name=\"CAM\" insert_at=\"ROOT\" width=\"64\" height=\"48\" outputs=\"color depth\" "
    "pose_offset=\"-3 0 1 0 0 0\"/>\n</simvis>\n";

// Runs a script of this folder on the scene.
void run_browsers(const std::string& script) {
  const TemporaryFolder folder;
  write_text(folder / "scene.xml", kDrivenScene);
  // Debian's Python has Debian's packages.
  const ProcessResult browsers =
      Process({"/usr/bin/python3", SIMVIS_SOURCE_DIR "/tests/live/" + script, simvis_run(), folder.path().string()})
          .wait(std::chrono::seconds(250));
  INFO(browsers.out << browsers.err);
  if (browsers.exit_code == test::kSkippedExitCode) return test::skip(browsers.out);
  CHECK(browsers.exit_code == 0);
}

}  // namespace

TEST_CASE("two browsers show marvin, drive and change it, and outlive each other and the host") {
  run_browsers("browse_live.py");
}

TEST_CASE("a server at another port of the machine gets no secret of the page, however the browser comes to it") {
  run_browsers("browse_neighbour.py");
}

}  // namespace simvis

TEST_SUITE_END();
