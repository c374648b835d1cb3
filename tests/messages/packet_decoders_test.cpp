// What the decoders of PyPI read of the packets of laser scanners.
#include <doctest/doctest.h>

#include "tests/messages/captured_datagrams.h"
#include "tests/messages/pip_packages.h"
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

namespace fs = std::filesystem;
using test::device_sensor;

const Strings kDecoders{"velodyne-decoder==3.1.0", "ouster-sdk==1.0.1", "numpy"};

}  // namespace

TEST_CASE("the decoders of PyPI read our packets: points, rings, times and reflectivities to the device's resolution") {
  const TemporaryFolder folder;
  const auto packages = test::pip_packages(kDecoders);
  if (!packages) return;
  struct Device {
    const char *preset, *kind, *unit_m;
  };
  for (const Device& device :
       {Device{"velodyne_vlp16", "velodyne", "0.002"}, Device{"velodyne_hdl32e", "velodyne", "0.002"},
        Device{"velodyne_vls128", "velodyne", "0.004"}, Device{"ouster_os1_64", "ouster", "0.001"}}) {
    if (sanitized() && device.preset != std::string("velodyne_vlp16")) continue;  // minutes; the bytes are the same
    CAPTURE(device.preset);
    const fs::path out = folder / device.preset, file = folder / (std::string(device.preset) + ".pcap");
    const std::string sensor = device_sensor(device.preset, R"(firing="pattern" range_noise="0" range_resolution="0")");
    const std::string scene = write_wall_scene(folder.path(), sensor).string();
    const ProcessResult run =
        run_simvis({scene, "--out", out.string(), "--rate", "10", "--frames", "2", "--record-pcap", file.string()});
    INFO(run.err);
    REQUIRE(run.exit_code == 0);
    const Strings command = {"python3",     SIMVIS_SOURCE_DIR "/tests/messages/read_packets.py",
                             device.kind,   file.string(),
                             device.unit_m, (out / "LIDAR.csv").string()};
    const ProcessResult read = Process(command, {"PYTHONPATH=" + packages->string()}).wait();
    INFO(read.err);
    CHECK(read.exit_code == 0);
    CHECK(contains(read.out, " points\n"));
  }
}

TEST_CASE("the decoder of PyPI reads both returns of our packets") {
  const TemporaryFolder folder;
  const auto packages = test::pip_packages(kDecoders);
  if (!packages) return;
  // Boards in front of the wall, whose edges split beams of 0.3 degrees.
  std::string commands;
  for (int i = 0; i < 8; ++i) {
    commands += R"(<part shape="box" size="0.05 0.1 3" name="BOARD)" + std::to_string(i) +
                R"(" insert_at="ROOT" pose_offset="2.5 )" + std::to_string(0.4 * i - 1.4) + " 0 0 0 0\"/>\n";
  }
  commands += device_sensor("velodyne_vlp16", R"(return="dual" divergence="0.3" divergence_samples="16" )"
                                              R"(firing="pattern" range_noise="0" range_resolution="0")");
  const fs::path file = folder / "dual.pcap", out = folder / "out";
  const std::string scene = write_wall_scene(folder.path(), commands).string();
  const ProcessResult run =
      run_simvis({scene, "--out", out.string(), "--rate", "10", "--frames", "2", "--record-pcap", file.string()});
  INFO(run.err);
  REQUIRE(run.exit_code == 0);
  const Strings command = {"python3", SIMVIS_SOURCE_DIR "/tests/messages/read_packets.py",
                           "dual",    file.string(),
                           "0.002",   (out / "LIDAR.csv").string()};
  const ProcessResult read = Process(command, {"PYTHONPATH=" + packages->string()}).wait();
  INFO(read.err);
  CHECK(read.exit_code == 0);
  CHECK(contains(read.out, " points\n"));
}

}  // namespace simvis

TEST_SUITE_END();
