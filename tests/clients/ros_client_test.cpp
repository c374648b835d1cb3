// A robot that a client library of ROS 2 drives by DDS: the package dora-rs of PyPI, which holds the crates ros2-client
// and RustDDS, and shares no code with SimVis or with Cyclone DDS.
#include <doctest/doctest.h>

#include <sstream>

#include "exchange/messages/description.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "tests/messages/pip_packages.h"
#include "tests/support/error_of.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("clients");

namespace simvis {
namespace {

// The wall's face is at 3.9 m, the scanner 0.3 m in front of the robot's origin and 0.2 m above it.
constexpr const char* kDrivenRobot = R"(<simvis>
  <element type="physics" name="PHYSICS" insert_at="ROOT"/>
  <part name="FLOOR" insert_at="ROOT" shape="box" size="20 20 1" pose_offset="0 0 -0.5 0 0 0"/>
  <element type="body" name="FLOOR_BODY" insert_at="FLOOR" kind="static"/>
  <part name="WALL" insert_at="ROOT" shape="box" size="0.2 8 2" pose_offset="4 0 1 0 0 0"/>
  <part name="ROBOT" insert_at="ROOT" shape="box" size="0.6 0.3 0.2"/>
  <element type="vehicle" name="DRIVE" insert_at="ROBOT" mass="10" clearance="0.05" center="-0.05 0 0.1"/>
  <element type="velocity_command" name="COMMAND" insert_at="ROBOT" vehicle="DRIVE" topic="/cmd_vel"/>
  <sensor type="laser_scanner" name="LIDAR" insert_at="ROBOT" pose_offset="0.3 0 0.2 0 0 0" samples="3"
          min_angle="-10" max_angle="10" topics="scan:=/scan"/>
</simvis>
)";

/// Writes a message's definition and those of its fields where packages of ROS 2 install them.
void write_definitions(const std::filesystem::path& root, const ros::TypeDescription& type) {
  const auto write = [&](const std::string& package, const std::string& name, const std::string& text) {
    std::filesystem::create_directories(root / "share" / package / "msg");
    write_text(root / "share" / package / "msg" / (name + ".msg"), text);
    write_text(root / "share" / package / "package.xml", "<package/>");  // by which the client finds packages
  };
  const std::string full(type.name);
  std::string package = full.substr(0, full.find('/')), name = full.substr(full.rfind('/') + 1), text;
  std::istringstream lines(ros::msg_text(type));
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("====")) continue;
    if (!line.starts_with("MSG: ")) {
      text += line + "\n";
      continue;
    }
    write(package, name, text);
    package = line.substr(5, line.find('/') - 5);
    name = line.substr(line.find('/') + 1);
    text.clear();
  }
  write(package, name, text);
}

}  // namespace

TEST_CASE("a client of ROS 2 finds the topics of a robot, drives it by cmd_vel and reads its odometry and its scans") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const TemporaryFolder folder;
  const auto packages = test::pip_packages({"dora-rs==1.1.0", "pyarrow==26.0.1"});
  if (!packages) return;
  for (const ros::TypeDescription* const type :
       {&ros::describe<ros::Twist>(), &ros::describe<ros::Odometry>(), &ros::describe<ros::LaserScan>()}) {
    write_definitions(folder / "ros", *type);
  }
  write_text(folder / "scene.xml", kDrivenRobot);
  const std::string domain = std::to_string(own_domain());
  // The client finds others by multicast alone, on the interfaces of the machine.
  const Strings environment{"CYCLONEDDS_URI=", "ROS_DOMAIN_ID=" + domain,
                            "AMENT_PREFIX_PATH=" + (folder / "ros").string(), "PYTHONPATH=" + packages->string()};
  const Process host({simvis_run(), "--dds", domain, "--real-time", "1", "--quiet", "--out", (folder / "out").string(),
                      (folder / "scene.xml").string()},
                     environment);
  const ProcessResult drive =
      Process({"python3", SIMVIS_SOURCE_DIR "/tests/clients/drive_by_ros_client.py"}, environment)
          .wait(std::chrono::seconds(120));
  INFO(drive.out, drive.err, host.err_so_far());
  if (drive.exit_code == test::kSkippedExitCode) return test::skip(drive.out);
  CHECK(drive.exit_code == 0);
  CHECK(contains(drive.out, "the robot was driven"));
}

}  // namespace simvis

TEST_SUITE_END();
