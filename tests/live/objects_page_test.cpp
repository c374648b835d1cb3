// The page of a world of SDF: its tree of models and links, and what a click on a link says.
#include <doctest/doctest.h>

#include <string>

#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("live");

namespace simvis {
namespace {

std::string world_link(const std::string& name, const std::string& pose, const std::string& size,
                       const std::string& mass = "1") {
  const std::string box = "<geometry><box><size>" + size + "</size></box></geometry>";
  return "<link name='" + name + "'><pose>" + pose + "</pose><inertial><mass>" + mass +
         "</mass><inertia><ixx>0.2</ixx><iyy>0.2</iyy><izz>0.2</izz></inertia></inertial><collision name='c'>" + box +
         "</collision><visual name='v'>" + box + "</visual></link>";
}

// A crate of 4 kg with a lid of 1 kg on a hinge stands on the ground before a wall. browse_objects.py knows the
// numbers.
const std::string kWorld =
    "<sdf version='1.9'><world name='w'><model name='ground'><static>true</static>" +
    world_link("slab", "0 0 -0.1 0 0 0", "8 8 0.2") + "</model><model name='wall'><static>true</static>" +
    world_link("slab", "3 0 1 0 0 0", "0.2 4 2") + "</model><model name='crate'><pose>1.5 0 0.25 0 0 0</pose>" +
    world_link("base", "0 0 0 0 0 0", "0.5 0.5 0.5", "4") + world_link("lid", "0 0 0.3 0 0 0", "0.5 0.5 0.1") +
    "<joint name='hinge' type='revolute'><parent>base</parent><child>lid</child><axis><xyz>0 0 1</xyz><limit>"
    "<lower>-0.1</lower><upper>0.1</upper></limit></axis></joint></model></world></sdf>";

const std::string kWorldScene = R"(<simvis>
<element type="physics" name="PHYSICS" insert_at="ROOT"/>
<part name="WORLD" insert_at="ROOT" file="world.sdf"/>
<element type="models" name="MODELS" insert_at="WORLD"/>
<element type="label" name="L" insert_at="ROOT" part="crate" class="crate" class_id="3"/>
<part name="POST" insert_at="ROOT" shape="cylinder" radius="0.1" length="1" pose_offset="0.5 1.5 0.5 0 0 0"/>
<sensor type="imu" name="IMU" insert_at="crate/base"/>
<sensor type="camera" name="CAM" insert_at="ROOT" pose_offset="-1 0 1 0 15 0" width="64" height="48"
        outputs="color instance shape"/>
</simvis>
)";

TEST_CASE("the tree of a page has models and links, and a click selects the link with its mass, contacts and box") {
  const TemporaryFolder folder;
  write_text(folder / "world.sdf", kWorld);
  write_text(folder / "scene.xml", kWorldScene);
  const ProcessResult run = run_simvis({(folder / "scene.xml").string(), "--frames", "8", "--rate", "10", "--out",
                                        (folder / "out").string(), "--page", (folder / "page.html").string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const ProcessResult browser =
      Process({"/usr/bin/python3", SIMVIS_SOURCE_DIR "/tests/live/browse_objects.py", (folder / "page.html").string()})
          .wait(std::chrono::seconds(250));
  INFO(browser.out << browser.err);
  if (browser.exit_code == test::kSkippedExitCode) return test::skip(browser.out);
  CHECK(browser.exit_code == 0);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
