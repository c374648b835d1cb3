// What people write who come from other simulators, and the word that the message gives them.
#include <doctest/doctest.h>

#include <string>
#include <utility>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

using namespace simvis;

TEST_CASE("a word of another simulator gets the word that has its meaning here") {
  const TemporaryFolder folder;
  write_text(folder / "robot.glb", "");
  const std::string camera = "<sensor type='camera' name='C' insert_at='ROOT' ";
  const std::pair<std::string, std::string> mistakes[] = {
      {"<camera name='C' insert_at='ROOT'/>", R"(unknown command "camera", expected <sensor type="camera" .../>)"},
      {"<lidar name='C' insert_at='ROOT'/>", R"(expected <sensor type="laser_scanner" .../>)"},
      {"<light name='L' insert_at='ROOT'/>", R"(expected <element type="light" .../>)"},
      {"<sun name='L' insert_at='ROOT'/>", R"(expected <element type="light" .../>)"},
      {"<camra name='L' insert_at='ROOT'/>", R"(expected <sensor type="camera" .../>)"},
      {"<sphere name='B' insert_at='ROOT'/>", R"(expected <part shape="sphere" .../>)"},
      {"<robot name='R'/>", R"(expected <part file="..." .../>)"},
      {"<sensor type='lidar' name='C' insert_at='ROOT'/>", R"(did you mean "laser_scanner"?)"},
      {"<sensor type='LiDAR' name='C' insert_at='ROOT'/>", R"(did you mean "laser_scanner"?)"},
      {"<sensor type='depth_camera' name='C' insert_at='ROOT'/>", R"(did you mean "rgbd_camera"?)"},
      {"<sensor type='gps' name='C' insert_at='ROOT'/>", R"(did you mean "gnss"?)"},
      {"<part name='P' insert_at='ROOT' pose='0 0 0 0 0 0'/>", R"(did you mean "pose_offset"?)"},
      {"<part name='P' insert_at='ROOT' pos='0 0 0'/>", R"(did you mean "pose_offset"?)"},
      {"<part name='P' parent='ROOT'/>", R"(did you mean "insert_at"?)"},
      {camera + "fps='3'/>", R"(did you mean "rate"?)"},
      {camera + "fov='60'/>", R"(did you mean "hfov"?)"},
      {camera + "resolution='640 480'/>", R"(did you mean "width"?)"},
      {camera + "outputs='rgb depth'/>", R"(; "rgb" is none of them, did you mean "color"?)"},
      {camera + "outputs='segmentation'/>", R"(did you mean "semantic"?)"},
      {camera + "outputs='color,depth'/>", "; separated by spaces"},
      {"<sensor type='laser_scanner' name='C' insert_at='ROOT' preset='vlp16'/>", R"(did you mean "velodyne_vlp16"?)"},
      {"<part name='P' insert_at='world'/>", R"(did you mean "ROOT"?)"},
      {"<part name='A' insert_at='ROOT'><sensor type='camera' name='C'/></part>",
       R"(expected <part .../>; <sensor> stands beside it, with insert_at="A")"},
      {"<part name='A insert_at='ROOT'/>",
       R"(malformed XML: an attribute is not NAME="VALUE"; a quote may be missing)"},
      {"<mujoco><worldbody/></mujoco>", R"(this is a model in MJCF, expected a scene; put it into one: <part file=)"},
      {"<part name='A' insert_at='ROOT' file='robt.glb'/>", R"(robt.glb", did you mean "robot.glb"?)"},
  };
  for (const auto& [scene, right] : mistakes) {
    const std::string message = error_of([&] { Simulation::from_string(scene, {}, folder.path()); });
    CHECK_MESSAGE(message.find(right) != message.npos, message);
  }
}

TEST_CASE("an option of another program gets the option that has its meaning here") {
  for (const auto& [option, right] :
       {std::pair("--output", "--out"), {"--duration", "--frames"}, {"--gui", "--live"}, {"-n", "--frames"}}) {
    const std::string message = run_simvis({option}).err;
    CHECK_MESSAGE(
        message.find("there is no option " + std::string(option) + ", did you mean \"" + right + "\"?") != message.npos,
        message);
  }
  CHECK(run_simvis({"--describe", "lidar"}).err.find("did you mean \"laser_scanner\"?") != std::string::npos);
}

TEST_SUITE_END();
