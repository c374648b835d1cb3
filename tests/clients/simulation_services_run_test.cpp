// The services of simulation_interfaces of a run: by DDS, with clients that are not ours, beside the page; and what
// starts such a run for people who have ROS.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include <simvis/version.h>
#include "exchange/messages/types/sensor_types.h"
#include "tests/messages/mcap_file.h"
#include "tests/messages/pip_packages.h"
#include "tests/support/error_of.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("clients");

namespace simvis {
namespace {

constexpr std::string_view kControlledScene = R"(<simvis>
  <part name="CART" insert_at="ROOT" shape="box" size="1 1 1" pose_offset="4 0 0 0 0 0"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5"/>
</simvis>
)";
constexpr std::string_view kControlledChair =
    R"(<robot name="c"><link name="seat"><visual><geometry><box size="1 1 1"/></geometry></visual></link></robot>)";

struct ControlledScene {
  ControlledScene() {
    write_text(folder / "scene.xml", kControlledScene);
    write_text(folder / "chair.urdf", kControlledChair);
  }
  std::string file() const { return (folder / "scene.xml").string(); }
  TemporaryFolder folder;
};

/// The lines of a text.
Strings lines_of(const std::string& text) {
  Strings lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

/// Checks that the recording shows what control_run.py did. CHAIR stands at 2 m for two frames. CART is missing in the
/// last frame, and no frame shows it where set_entity_state put it.
void check_recorded_drive(const std::filesystem::path& file) {
  constexpr double kHalf_m = 0.5;              // of the size of each box
  constexpr double kRounding_m = 8 * 0x1p-23;  // of a float32 below 8 m
  constexpr std::uint64_t kPeriod_ns = 100'000'000;
  const ros::test::McapFile recorded = ros::test::McapReader::read(read_text(file));
  CHECK(recorded.has_end);
  const auto scans = recorded.all<ros::LaserScan>("/SCAN/scan");
  REQUIRE(scans.size() > 8);
  REQUIRE(recorded.counts().at("/clock") == scans.size());
  std::uint64_t frame = 0;
  std::size_t with_chair = 0;
  for (const ros::test::McapMessage& message : recorded.messages) {
    if (message.topic != "/clock") continue;
    CHECK(message.time_ns == frame * kPeriod_ns);
    const auto range_m = static_cast<double>(scans[frame].ranges[1]);
    const double cart_m = 4 + 0.01 * static_cast<double>(frame) - kHalf_m;
    const bool is_chair = std::abs(range_m - (2 - kHalf_m)) <= kRounding_m;
    with_chair += is_chair ? 1 : 0;
    ++frame;
    if (frame == scans.size()) {
      CHECK(std::isinf(range_m));
    } else if (!is_chair) {
      CHECK(std::abs(range_m - cart_m) <= kRounding_m);
    }
  }
  CHECK(with_chair == 2);
}

}  // namespace

TEST_CASE("two clients of another implementation's package control a run, with and without a page") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const auto packages = test::pip_packages({"cyclonedds"});
  if (!packages) return;
  for (const bool with_page : {false, true}) {
    CAPTURE(with_page);
    const ControlledScene scene;
    const std::string domain = std::to_string(own_domain());
    Strings command{simvis_run(), "--dds", domain, "--dds-node", "/lab/sim", "--dds-requests", "--rate", "100"};
    if (with_page) {
      command.insert(command.end(), {"--live", "0", "--real-time", "2"});
      command.insert(command.begin(),
                     {"sh", "-c", "trap '' TERM; exec \"$@\"", "sh"});  // a client ends it all the same
    }
    command.push_back(scene.file());
    Process host(command);
    const ProcessResult client =
        Process({"python3", SIMVIS_SOURCE_DIR "/tests/clients/control_run.py", domain, "/lab/sim"},
                {"PYTHONPATH=" + packages->string()})
            .wait(std::chrono::seconds(120));
    INFO(client.out, client.err, host.err_so_far());
    CHECK(client.exit_code == 0);
    CHECK(contains(client.out, "the run was controlled"));
    if (client.exit_code != 0) host.send(SIGINT);
    const ProcessResult ended = host.wait(std::chrono::seconds(60));
    CHECK(ended.exit_code == 130);  // as by a signal: it had no end of its own
    CHECK(contains(ended.err, "stopped by a signal (Terminated)"));
    CHECK_FALSE(std::filesystem::exists("out/run.json"));
  }
}

TEST_CASE("a reset at real time goes on at real time, and the frames of --frames are those that follow it") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const auto packages = test::pip_packages({"cyclonedds"});
  if (!packages) return;
  const ControlledScene scene;
  const std::string domain = std::to_string(own_domain());
  // 20 s, in which the client begins its part.
  Process host({simvis_run(), "--dds", domain, "--dds-requests", "--rate", "10", "--frames", "200", "--real-time", "1",
                scene.file()});
  const ProcessResult client =
      Process({"python3", SIMVIS_SOURCE_DIR "/tests/clients/control_run.py", domain, "/simvis", "reset", "200"},
              {"PYTHONPATH=" + packages->string()})
          .wait(std::chrono::seconds(120));
  INFO(client.out, client.err, host.err_so_far());
  CHECK(client.exit_code == 0);
  CHECK(contains(client.out, "the run was reset"));
  if (client.exit_code != 0) host.send(SIGINT);
  const ProcessResult ended = host.wait(std::chrono::seconds(60));
  CHECK(ended.exit_code == (client.exit_code == 0 ? 0 : 130));
}

TEST_CASE("services control a run that follows a trajectory, and one that is recorded, which can't go back in time") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const auto packages = test::pip_packages({"cyclonedds"});
  if (!packages) return;
  for (const bool records : {false, true}) {
    CAPTURE(records);
    const ControlledScene scene;
    write_text(scene.folder / "scene.xml",
               "<part name=\"CART\" insert_at=\"ROOT\" shape=\"box\" size=\"1 1 1\"/>"
               "<element type=\"pose\" name=\"PATH\" insert_at=\"CART\"/>"
               "<sensor type=\"laser_scanner\" name=\"SCAN\" insert_at=\"ROOT\" samples=\"3\"/>");
    write_text(scene.folder / "path.csv", "time_s,PATH.x\n0,4\n1000,104\n");
    const std::string domain = std::to_string(own_domain());
    Strings command{simvis_run(), "--dds",       domain, "--dds-requests", "--rate",
                    "10",         "--real-time", "1",    "--trajectory",   (scene.folder / "path.csv").string()};
    const Strings record = {"--record", (scene.folder / "run.mcap").string(), "--record-topics",
                            "/clock,/SCAN/scan,/nothing"};
    if (records) command.insert(command.end(), record.begin(), record.end());
    command.push_back(scene.file());
    Process host(command);
    const ProcessResult client = Process({"python3", SIMVIS_SOURCE_DIR "/tests/clients/control_run.py", domain,
                                          "/simvis", records ? "record" : "drive"},
                                         {"PYTHONPATH=" + packages->string()})
                                     .wait(std::chrono::seconds(120));
    INFO(client.out, client.err, host.err_so_far());
    CHECK(client.exit_code == 0);
    CHECK(contains(client.out, "the run was driven"));
    if (client.exit_code != 0) host.send(SIGINT);
    const ProcessResult ended = host.wait(std::chrono::seconds(60));
    CHECK(ended.exit_code == 130);
    CHECK(contains(ended.err, "of 10001\n"));  // without the hint to --resume, which goes on with no run of others
    CHECK(ended.err.find("no topic has matched") == std::string::npos);
    const std::string stopped = "before frame ", next = ended.err.substr(ended.err.rfind(stopped) + stopped.size());
    CHECK(ended.err.find(" s at frame " + next.substr(0, next.find(' ')) + ";") == std::string::npos);
    if (records && client.exit_code == 0) check_recorded_drive(scene.folder / "run.mcap");
  }
}

TEST_CASE("without --dds-requests, services that read answer by DDS, and those that change something refuse") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const auto packages = test::pip_packages({"cyclonedds"});
  if (!packages) return;
  const ControlledScene scene;
  const std::string domain = std::to_string(own_domain());
  Process host({simvis_run(), "--dds", domain, "--rate", "100", scene.file()});
  const ProcessResult client =
      Process({"python3", SIMVIS_SOURCE_DIR "/tests/clients/control_run.py", domain, "/simvis", "read"},
              {"PYTHONPATH=" + packages->string()})
          .wait(std::chrono::seconds(120));
  INFO(client.out, client.err, host.err_so_far());
  CHECK(client.exit_code == 0);
  CHECK(contains(client.out, "the run was read"));
  host.send(SIGINT);
  CHECK(host.wait(std::chrono::seconds(60)).exit_code == 130);
}

TEST_CASE("the launch file of the ROS package starts simvis-run with the values of a parameter file") {
  const TemporaryFolder folder;
  const ControlledScene scene;
  // What the launch file uses of the package launch.
  std::filesystem::create_directories(folder / "launch");
  write_text(folder / "launch/__init__.py", "class LaunchDescription(list): pass\n");
  write_text(folder / "launch/substitutions.py",
             "class LaunchConfiguration:\n"
             "    def __init__(self, name): self.name = name\n"
             "    def perform(self, context): return context[self.name]\n");
  write_text(folder / "launch/actions.py",
             "class DeclareLaunchArgument:\n"
             "    def __init__(self, name, *, default_value, description):\n"
             "        self.name, self.default, self.description = name, default_value, description\n"
             "class OpaqueFunction:\n"
             "    def __init__(self, *, function): self.function = function\n"
             "class ExecuteProcess:\n"
             "    def __init__(self, *, cmd, output): self.cmd = cmd\n");
  write_text(folder / "start.py",
             "import runpy, sys\n"
             "*declared, start = runpy.run_path(sys.argv[1])['generate_launch_description']()\n"
             "values = {each.name: each.default for each in declared}\n"
             "values |= dict(each.split(':=', 1) for each in sys.argv[2:])\n"
             "print('\\n'.join(start.function(values)[0].cmd))\n");
  const std::string package = SIMVIS_SOURCE_DIR "/program/ros";
  const auto command_of = [&](Strings arguments) {
    Strings line{"/usr/bin/python3", (folder / "start.py").string(), package + "/launch/simvis.launch.py"};
    line.insert(line.end(), arguments.begin(), arguments.end());
    const ProcessResult result = Process(line, {"PYTHONPATH=" + folder.path().string()}).wait();
    REQUIRE_MESSAGE(result.exit_code == 0, result.err);
    return lines_of(result.out);
  };
  if (Process({"/usr/bin/python3", "-c", "import yaml"}).wait().exit_code != 0) {
    return test::skip("Python's yaml (python3-yaml) is not installed");
  }
  const std::string first = SIMVIS_SOURCE_DIR "/scenes/first/first.xml";
  CHECK(command_of({"scene:=s.xml"}) ==
        Strings{"simvis-run", "--dds", "--dds-node", "simvis", "--real-time", "1", "--dds-requests", "--", "s.xml"});
  Strings command = command_of({"scene:=" + first, "real_time:=0", "requests:=False", "live:=True",
                                "params_file:=" + package + "/config/simvis.yaml", "options:=--quiet"});
  CHECK(command == Strings{"simvis-run", "--dds", "--dds-node", "simvis", "--live", "--set", "R_POSE.x=1.5", "--set",
                           "R_POSE.yaw=30.0", "--quiet", "--", first});
  write_text(folder / "own.yaml",
             "/lab/sim:\n  ros__parameters:\n    R_POSE: {x: 1.5}\n    R_POSE.y: 0.25\n"
             "/other:\n  ros__parameters: {R_POSE: {z: 9.0}}\n"
             "/**:\n  ros__parameters: {use_sim_time: true, R_POSE: {yaw: 30.0}}\n"
             "lab/sim:\n  ros__parameters:\n");
  command =
      command_of({"scene:=" + first, "node:=/lab/sim", "real_time:=0", "params_file:=" + (folder / "own.yaml").string(),
                  "options:=--frames 1 --sensor SCANNER --save-state '" + (folder / "a state").string() + "'"});
  for (const char* const set : {"R_POSE.x=1.5", "R_POSE.y=0.25", "R_POSE.yaw=30.0"}) {
    CHECK(std::ranges::count(command, set) == 1);
  }
  CHECK(std::ranges::count(command, "R_POSE.z=9.0") == 0);
  CHECK(std::ranges::count(command, "use_sim_time=True") == 0);
  if (!has_dds()) return;
  command[0] = simvis_run();
  const ProcessResult run = Process(command, {"ROS_DOMAIN_ID=" + std::to_string(own_domain())}).wait();
  CHECK_MESSAGE(run.exit_code == 0, run.err);
  CHECK(std::filesystem::exists(folder / "a state"));
}

TEST_CASE("the ROS package has the version and the authors of SimVis, and is installed where ROS finds it") {
  const TemporaryFolder folder;
  const std::string package = SIMVIS_SOURCE_DIR "/program/ros", build = (folder / "build").string();
  const ProcessResult read =
      Process({"python3", "-c",
               "import sys, xml.etree.ElementTree as tree\n"
               "root = tree.parse(sys.argv[1]).getroot()\n"
               "print(root.tag, root.get('format'), root.findtext('name'), root.findtext('version'))\n"
               "print(root.findtext('maintainer'))\n",
               package + "/package.xml"})
          .wait();
  const std::string authors = "The SimVis developers";
  CHECK(read.out == "package 3 simvis " + std::string(version()) + "\n" + authors + "\n");
  for (const char* const file : {"/CITATION.cff", "/tools/cmake/debian_package.cmake"}) {
    CHECK(contains(read_text(std::string(SIMVIS_SOURCE_DIR) + file), authors));
  }
  const std::string prefix = (folder / "prefix").string();
  REQUIRE(Process({"cmake", "-S", package, "-B", build}).wait().exit_code == 0);
  REQUIRE(Process({"cmake", "--install", build, "--prefix", prefix}).wait().exit_code == 0);
  for (const char* const file : {"simvis/package.xml", "simvis/launch/simvis.launch.py", "simvis/config/simvis.yaml",
                                 "ament_index/resource_index/packages/simvis"}) {
    CHECK(std::filesystem::exists(folder / "prefix/share" / file));
  }
}

}  // namespace simvis

TEST_SUITE_END();
