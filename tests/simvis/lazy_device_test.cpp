// A Vulkan device is opened for what draws, and for nothing else.
#include "simvis/lazy_device.h"

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

std::string sensor(const std::string& type, const std::string& attributes = "") {
  return "<sensor type='" + type + "' name='S' insert_at='ROOT' " + attributes + "/>";
}
const std::string kWallBox =
    "<part name='WALL' shape='box' size='0.2 9 9' insert_at='ROOT' pose_offset='3 0 0 0 0 0'/>";

bool opens_device(const std::string& commands) {
  Simulation simulation = Simulation::from_string(kWallBox + commands);
  const bool at_once = simulation.diagnostics().device() != nullptr;
  simulation.step();
  CHECK((simulation.diagnostics().device() != nullptr) == at_once);
  return at_once;
}

TEST_CASE("sensors that neither draw nor cast need no device, those that draw open it when they are made") {
  for (const char* const type : {"imu", "gnss", "magnetometer", "barometer", "altimeter", "odometry"}) {
    CAPTURE(type);
    CHECK_FALSE(opens_device(sensor(type)));
  }
  for (const std::string& drawing :
       {sensor("camera", "width='8' height='6'"), sensor("camera", "width='8' height='6' outputs='depth'"),
        sensor("stereo_camera", "width='8' height='6'"), sensor("rgbd_camera", "width='8' height='6'"),
        sensor("laser_scanner", "samples='9' method='planar'"), sensor("laser_scanner", "samples='9' method='nearest'"),
        sensor("psd"), sensor("light_sensor")}) {
    CAPTURE(drawing);
    CHECK(opens_device(drawing));
  }
}

TEST_CASE("rays open a device only on a machine with a GPU") {
  const bool has_gpu = has_gpu_node();
  for (const std::string& casting :
       {sensor("laser_scanner", "samples='9' method='raycast'"), sensor("sonar"), sensor("radar"), sensor("range"),
        sensor("tof_camera", "width='8' height='6'"), sensor("thermal_camera", "width='8' height='6'"),
        sensor("event_camera", "width='8' height='6'")}) {
    CAPTURE(casting);
    Simulation simulation = Simulation::from_string(kWallBox + casting);
    CHECK(simulation.diagnostics().device() == nullptr);
    simulation.step();
    CHECK((simulation.diagnostics().device() != nullptr) == has_gpu);
  }
}

TEST_CASE("a camera that is added later opens the device, and changes nothing of what rays measure") {
  const std::string scanner = "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='31'/>";
  Simulation alone = Simulation::from_string(kWallBox + scanner), later = Simulation::from_string(kWallBox + scanner);
  for (int frame = 0; frame < 3; ++frame) {
    if (frame == 1) later.execute("<sensor type='camera' name='CAM' insert_at='ROOT' width='8' height='6'/>");
    alone.step();
    later.step();
    CHECK(alone.scan("SCAN").range_m == later.scan("SCAN").range_m);
  }
  CHECK(later.diagnostics().device() != nullptr);
  CHECK(later.diagnostics().counters().draws > 0);
}

TEST_CASE("a device that is asked for by name, or for its times, is opened at once") {
  SimulationDesc named, timed;
  named.device.select = "no such device";
  CHECK(contains(error_of([&] { Simulation::from_string(sensor("imu"), named); }), "no Vulkan device matches"));
  timed.device.instrumented = true;
  CHECK(Simulation::from_string(sensor("imu"), timed).diagnostics().device() != nullptr);
}

TEST_CASE("without a Vulkan driver, runs that draw nothing work, and others say what to install") {
  const TemporaryFolder folder;
  const Strings no_driver = {"VK_ICD_FILENAMES=" + (folder / "none.json").string(),
                             "VK_DRIVER_FILES=" + (folder / "none.json").string()};
  const auto run_with = [&](const std::string& commands) {
    write_text(folder / "scene.xml", "<simvis>" + kWallBox + commands + "</simvis>");
    return run_simvis({(folder / "scene.xml").string(), "--frames", "2", "--out", (folder / "out").string()},
                      no_driver);
  };
  const ProcessResult imu = run_with(sensor("imu"));
  CHECK_MESSAGE(imu.exit_code == 0, imu.err);
  CHECK(contains(read_text(folder / "out/run.json"), "\"device\": null"));
  if (!has_gpu_node()) {
    const ProcessResult scan = run_with(sensor("laser_scanner", "samples='9'"));
    CHECK_MESSAGE(scan.exit_code == 0, scan.err);
  }
  const ProcessResult camera = run_with(sensor("camera", "width='8' height='6'"));
  CHECK(camera.exit_code == 1);
  CHECK(contains(camera.err, "mesa-vulkan-drivers"));
}

TEST_CASE("the files by which GPUs are known") {
  const TemporaryFolder dev;
  CHECK_FALSE(has_gpu_node(dev.path()));
  CHECK_FALSE(has_gpu_node(dev / "missing"));
  std::filesystem::create_directories(dev / "dri");
  write_text(dev / "dri/card0", "");  // a display without a renderer
  write_text(dev / "null", "");
  CHECK_FALSE(has_gpu_node(dev.path()));
  for (const char* const node : {"dri/renderD128", "nvidia0", "nvhost-gpu", "dxg"}) {
    CAPTURE(node);
    write_text(dev / node, "");
    CHECK(has_gpu_node(dev.path()));
    std::filesystem::remove(dev / node);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
