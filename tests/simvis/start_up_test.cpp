// What a run loads before its first row: libraries, as the dynamic linker reports them, and files.
#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "simvis/lazy_device.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr const char* kDrivers[] = {"libvulkan_lvp", "libvulkan_intel", "libvulkan_radeon", "libLLVM"};
constexpr const char* kPhysics = "libBullet";

const std::string kStartUpMesh = "<part file='box.obj' name='BOX' insert_at='ROOT' pose_offset='0 -3 -4.5 0 0 0'/>";
const std::string kStartUpImu = "<sensor type='imu' name='IMU' insert_at='ROOT'/>";
const std::string kStartUpScan =
    "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='9' method='raycast'/>";
const std::string kStartUpCamera =
    "<sensor type='camera' name='CAM' insert_at='ROOT' width='8' height='6' outputs='depth'/>";

struct StartUpScene {
  explicit StartUpScene(const std::string& commands) {
    write_text(folder / "box.obj", test::obj_box());
    write_text(folder / "s.xml", "<simvis>" + commands + "</simvis>");
  }
  ProcessResult run(Strings options = {}, const Strings& environment = {"LD_DEBUG=files"}) const {
    Strings all{(folder / "s.xml").string(), "--out", (folder / "out").string()};
    all.insert(all.end(), options.begin(), options.end());
    return run_simvis(all, environment);
  }
  TemporaryFolder folder;
};

bool loads_driver(const ProcessResult& run) {
  bool loads = false;
  for (const char* const driver : kDrivers) loads = loads || run.err.find(driver) != std::string::npos;
  return loads;
}

TEST_CASE("a run loads the libraries that its sensors need, and no others") {
  const ProcessResult imu = StartUpScene(kStartUpMesh + kStartUpImu).run();
  CHECK(imu.exit_code == 0);
  CHECK(imu.err.find("libsimvis") != std::string::npos);  // the linker's report is there
  CHECK_FALSE(loads_driver(imu));
  CHECK(imu.err.find(kPhysics) == std::string::npos);
  const ProcessResult camera = StartUpScene(kStartUpMesh + kStartUpCamera).run();
  CHECK(camera.exit_code == 0);
  CHECK(loads_driver(camera));
  const ProcessResult physics =
      StartUpScene(kStartUpMesh + kStartUpImu + "<element type='physics' name='P' insert_at='ROOT'/>").run();
  CHECK(physics.exit_code == 0);
  CHECK(physics.err.find(kPhysics) != std::string::npos);
  CHECK_FALSE(loads_driver(physics));
}

TEST_CASE("a scan by rays, and one sensor of several, load no driver on a machine without a GPU") {
  if (has_gpu_node()) return test::skip("the machine has a GPU");
  CHECK_FALSE(loads_driver(StartUpScene(kStartUpMesh + kStartUpScan).run()));
  const StartUpScene all(kStartUpMesh + kStartUpImu + kStartUpScan + kStartUpCamera);
  for (const char* const sensor : {"IMU", "SCAN"}) {
    CAPTURE(sensor);
    const ProcessResult run = all.run({"--sensor", sensor});
    CHECK(run.exit_code == 0);
    CHECK_FALSE(loads_driver(run));
  }
  CHECK(loads_driver(all.run({"--sensor", "CAM"})));
}

TEST_CASE("--explain says which files were read, and for what") {
  const StartUpScene all(kStartUpMesh + kStartUpImu + kStartUpScan);
  const ProcessResult imu = all.run({"--explain", "--sensor", "IMU"}, {}), scan = all.run({"--explain"}, {});
  CHECK(contains(imu.out, "box.obj: not its shapes, which no sensor that is on sees"));
  CHECK(contains(imu.out, "physics: not loaded"));
  CHECK(contains(scan.out, "box.obj: its shapes, for sensor \"SCAN\""));
}

TEST_CASE("a mesh that no sensor sees is not read by a run, but by one that exports it, by --check and --list") {
  const StartUpScene stage(kStartUpMesh + kStartUpImu);
  write_text(stage.folder / "box.obj", "v 0 0 0\nf 1 2 3\n");
  CHECK(stage.run({}, {}).exit_code == 0);
  CHECK(stage.run({"--strict"}, {}).exit_code == 2);
  for (const Strings& reading : std::vector<Strings>{{"--export", (stage.folder / "scene.glb").string()},
                                                     {"--page", (stage.folder / "scene.html").string()},
                                                     {"--check"},
                                                     {"--list"}}) {
    CAPTURE(reading.front());
    const ProcessResult run = stage.run(reading, {});
    CHECK(run.exit_code == 2);
    CHECK(contains(run.err, "s.xml:1:10: error: part BOX: "));
    CHECK(contains(run.err, "box.obj"));
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
