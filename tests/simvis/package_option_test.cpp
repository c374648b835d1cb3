// --package and SimulationDesc::packages; joints of robots whose names have dots, on the command line and in
// trajectories.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include <simvis/trajectory.h>
#include "tests/support/error_of.h"
#include "tests/support/run_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

// A robot whose mesh lies in the folder `elsewhere`, which only --package makes the package `pkg`.
class RobotScene {
 public:
  RobotScene() {
    std::filesystem::create_directories(folder_ / "robot");
    std::filesystem::create_directories(folder_ / "elsewhere");
    write_text(folder_ / "elsewhere/m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_text(folder_ / "robot/r.urdf",
               "<robot name='r'><link name='a'><visual><geometry><mesh filename='package://pkg/m.obj'/></geometry>"
               "</visual></link><link name='b'/><joint name='arm.0/j' type='continuous'><parent link='a'/>"
               "<child link='b'/></joint></robot>");
    write_text(folder_ / "scene.xml",
               "<scene><part file='robot/r.urdf' name='R' insert_at='ROOT'/>"
               "<sensor type='laser_scanner' name='S' insert_at='ROOT' samples='2'/></scene>");
  }
  ProcessResult run(const std::vector<std::string>& options) const {
    std::vector<std::string> arguments = {tested_build() + "/bin/simvis-run", path("scene.xml"), "--out", path("out")};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return Process(arguments).wait();
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

 private:
  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("--package: the folder of a package, and what is wrong with one") {
  const RobotScene scene;
  const ProcessResult without = scene.run({});
  CHECK(without.exit_code == 2);
  CHECK(contains(without.err, "none of its visuals can be shown: mesh file \"package://pkg/m.obj\""));
  const ProcessResult with = scene.run({"--package", "pkg=" + scene.path("elsewhere"), "--set", "arm.0/j.value=3"});
  CHECK(with.exit_code == 0);
  // The scanner looks past the robot, and nothing else is to be warned of.
  CHECK(std::ranges::count(with.err, '\n') == 1);
  CHECK(contains(with.err, "sees nothing in its first frame"));
  CHECK(contains(scene.run({"--package", "pkg"}).err, "--package pkg: expected NAME=DIR"));
  CHECK(contains(scene.run({"--package", "=x"}).err, "--package =x: expected NAME=DIR"));
  CHECK(contains(scene.run({"--package", "pkg=/none"}).err, "--package pkg=/none: there is no such folder"));
}

TEST_CASE("packages of the API, and a trajectory of a joint whose name has a dot") {
  const RobotScene scene;
  SimulationDesc desc;
  desc.packages = {{"pkg", scene.path("elsewhere")}};
  Simulation simulation = Simulation::load(scene.path("scene.xml"), desc);
  write_text(scene.path("t.csv"), "time_s,arm.0/j.value\n0,7\n");
  Trajectory(scene.path("t.csv"), simulation.parameters()).apply(0, simulation.parameters());
  CHECK(simulation.get("arm.0/j", "value") == 7);
  desc.packages = {{"pkg", scene.path("nowhere")}};
  CHECK(contains(error_of([&] { Simulation::load(scene.path("scene.xml"), desc); }),
                 "package \"pkg\": there is no folder \"" + scene.path("nowhere") + "\""));
}

}  // namespace simvis

TEST_SUITE_END();
