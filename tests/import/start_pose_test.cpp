// Joints for which 0 is outside of their limits start at the nearest limit, and one warning says so.
#include <doctest/doctest.h>

#include <cmath>
#include <fstream>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("import");

namespace simvis::test {
namespace {

struct Format {
  std::string file, text, place;  // of the first joint
};

// A hinge from 0.25 to 1 rad, a slide from -3 to -0.5 m, and a hinge that may start at 0.
std::vector<Format> formats() {
  const std::string link =
      "<inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>";
  const auto urdf = [&](const char* name, const char* type, const char* limits) {
    return "<link name='" + std::string(name) + "_link'>" + link + "</link>\n<joint name='" + name + "' type='" + type +
           "'><parent link='base'/><child link='" + name + "_link'/><limit " + limits +
           " effort='1' velocity='1'/></joint>\n";
  };
  const auto sdf = [](const char* name, const char* type, const char* lower, const char* upper) {
    return "<link name='" + std::string(name) + "_link'/>\n<joint name='" + name + "' type='" + type +
           "'><parent>base</parent><child>" + name + "_link</child><axis><limit><lower>" + lower + "</lower><upper>" +
           upper + "</upper></limit></axis></joint>\n";
  };
  return {
      {"r.urdf",
       "<robot name='r'>\n<link name='base'/>\n" + urdf("bent", "revolute", "lower='0.25' upper='1'") +
           urdf("low", "prismatic", "lower='-3' upper='-0.5'") + urdf("free", "revolute", "lower='-1' upper='0'") +
           "</robot>",
       "r.urdf:4:"},
      {"r.xml",
       "<mujoco><compiler angle='radian' autolimits='true'/><worldbody>\n<body name='a'>\n"
       "<joint name='bent' range='0.25 1'/>\n<geom size='1'/></body>\n<body name='b'><joint name='low' type='slide' "
       "range='-3 -0.5'/><geom size='1'/></body><body name='c'><joint name='free' range='-1 0'/><geom size='1'/>"
       "</body></worldbody></mujoco>",
       "r.xml:3:"},
      {"r.sdf",
       "<sdf version='1.9'><model name='r'>\n<link name='base'/>\n" + sdf("bent", "revolute", "0.25", "1") +
           sdf("low", "prismatic", "-3", "-0.5") + sdf("free", "revolute", "-1", "0") + "</model></sdf>",
       "r.sdf:4:"}};
}

Simulation load(const Format& format, bool strict = false) {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / format.file) << format.text;
  SimulationDesc desc;
  desc.strict = strict;
  return Simulation::from_string("<part name='R' insert_at='ROOT' file='" + format.file + "'/>", desc, folder.path());
}

std::size_t start_warnings(const Simulation& simulation, std::string& text) {
  std::size_t count = 0;
  for (const std::string& warning : simulation.warnings()) {
    if (!contains(warning, "cannot start at")) continue;
    text = warning;
    ++count;
  }
  return count;
}

TEST_CASE("a start pose outside of joint limits is one warning with place, joint, value and limits, in each format") {
  for (const Format& format : formats()) {
    CAPTURE(format.file);
    const Simulation simulation = load(format);
    std::string warning;
    REQUIRE(start_warnings(simulation, warning) == 1);
    CHECK(contains(warning, format.place));
    CHECK(contains(warning,
                   "joint \"bent\" cannot start at 0 deg, outside of its limits 14.3239448782706 and "
                   "57.2957795130823 deg; it starts at 14.3239448782706 deg. Joints that start at a limit: 2"));
    CHECK(simulation.get("bent", "value") == 14.3239448782706);
    CHECK(simulation.get("low", "value") == -0.5);
    CHECK(simulation.get("free", "value") == 0);
    CHECK(contains(error_of([&] { load(format, true); }), "cannot start at 0 deg"));
  }
}

TEST_CASE("joints that may start at 0, and those that follow others, give no warning") {
  Format followed = formats().front();
  followed.text =
      "<robot name='r'><link name='base'/><link name='a'/><link name='b'/><joint name='j' type='revolute'>"
      "<parent link='base'/><child link='a'/><limit lower='0' upper='1' effort='1' velocity='1'/></joint>"
      "<joint name='k' type='revolute'><parent link='base'/><child link='b'/><mimic joint='j'/>"
      "<limit lower='0.5' upper='1' effort='1' velocity='1'/></joint></robot>";
  std::string warning;
  CHECK(start_warnings(load(followed), warning) == 0);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
