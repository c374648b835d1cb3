// MJCF models in physics, against MuJoCo itself where its Python package is there.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>

#include "tests/support/moving_scene.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// What scripts/python_tools makes.
const char* const kPython = SIMVIS_SOURCE_DIR "/build/python-tools/bin/python";

// Prints the place of each body at each time.
const char* const kMujocoScript = R"(
import sys, mujoco
model = mujoco.MjModel.from_xml_path(sys.argv[1])
data = mujoco.MjData(model)
for time in sys.argv[2:]:
    while data.time < float(time) - 1e-9:
        mujoco.mj_step(model, data)
    mujoco.mj_kinematics(model, data)
    for i in range(1, model.nbody):
        print(time, model.body(i).name, *data.xpos[i])
)";

bool has_mujoco() {
  if (std::filesystem::exists(kPython) && Process({kPython, "-c", "import mujoco"}).wait().exit_code == 0) return true;
  skip("there is no MuJoCo: scripts/python_tools installs its Python package where pip can");
  return false;
}

const std::vector<double> kTimes_s = {0.25, 0.5, 0.75, 1};

struct Apart {
  double largest_m = 0, fastest_m_s = 0;
  std::size_t places = 0;
};

// How far the bodies of a model get from those of MuJoCo until 1 s, and how fast they are.
Apart distance_from_mujoco(const std::string& text) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "m.xml";
  std::ofstream(file) << text;
  std::vector<std::string> command = {kPython, "-c", kMujocoScript, file.string()};
  for (const double t : kTimes_s) command.push_back(format_number(t));
  const ProcessResult mujoco = Process(command).wait();
  REQUIRE_MESSAGE(mujoco.exit_code == 0, mujoco.err);
  MovingScene scene("<part name='M' insert_at='ROOT' file='m.xml'/>\n" + physics("world='M' iterations='200'") +
                        "<element type='models' name='BODIES' insert_at='M'/>",
                    folder.path());
  Apart apart;
  std::istringstream lines(mujoco.out);
  std::string time, name;
  std::string shown = "0";
  std::map<std::string, glm::dvec3> before;
  for (glm::dvec3 place; lines >> time >> name >> place.x >> place.y >> place.z; ++apart.places) {
    if (time != shown) {
      scene.go_to(std::stod(time) - kStep_s);
      for (const std::string_view point : (*scene).scene.insertion_points()) {
        before[std::string(point)] = scene.position(point);
      }
      scene.go_to(std::stod(time));
      shown = time;
    }
    const glm::dvec3 own = scene.position(name);
    apart.largest_m = std::max(apart.largest_m, glm::length(own - place));
    apart.fastest_m_s = std::max(apart.fastest_m_s, glm::length(own - before[name]) / kStep_s);
  }
  return apart;
}

// Both take semi-implicit steps of 1 ms. Their states at a time differ by what one of them does in a step, and a chain
// of bodies lets that grow.
constexpr double kStepsApart = 3;

const std::string kOption = "<mujoco><option timestep='0.001'/>";
const char* const kDoublePendulum =
    "<worldbody><body name='upper' pos='0 0 2'><joint name='a' axis='0 1 0' damping='0.5'/>"
    "<geom type='capsule' fromto='0 0 0 0.5 0 0' size='0.04' contype='0' conaffinity='0'/>"
    "<body name='lower' pos='0.5 0 0'><joint name='b' axis='0 1 0.3' damping='0.2' stiffness='3' springref='20'/>"
    "<geom type='box' pos='0.2 0.05 0' size='0.2 0.03 0.05' contype='0' conaffinity='0'/>"
    "<body name='tip' pos='0.4 0 0'><joint name='c' type='slide' axis='1 0 0' stiffness='100' damping='3'/>"
    "<geom type='ellipsoid' size='0.1 0.05 0.07' contype='0' conaffinity='0'/></body></body></body></worldbody>";

TEST_CASE("a chain of a pendulum, a skew hinge and a slide moves as in MuJoCo") {
  if (!has_mujoco()) return;
  const Apart apart = distance_from_mujoco(kOption + kDoublePendulum + "</mujoco>");
  MESSAGE("chain: " << apart.largest_m << " m apart, at most " << apart.fastest_m_s << " m/s");
  CHECK(apart.places == 3 * kTimes_s.size());
  CHECK(apart.largest_m < kStepsApart * kStep_s * apart.fastest_m_s);
}

// A small figure of capsules, head up along z, that falls on its back: 12 bodies, 14 joints.
std::string limb(const std::string& name, const std::string& place, const std::string& joints, double length,
                 double radius, const std::string& behind) {
  return "<body name='" + name + "' pos='" + place + "'>" + joints + "<geom type='capsule' fromto='0 0 0 0 0 " +
         format_number(-length) + "' size='" + format_number(radius) + "'/>" + behind + "</body>";
}
std::string hinge(const std::string& name, const std::string& axis, const std::string& range) {
  return "<joint name='" + name + "' axis='" + axis + "' range='" + range + "' damping='1' stiffness='2'/>";
}
std::string figure(double height_m) {
  std::string limbs;
  for (const std::string& side : {std::string("left"), std::string("right")}) {
    const double y = side == "left" ? 1 : -1;
    limbs += limb(side + "_arm", "0 " + format_number(0.25 * y) + " 0.25",
                  hinge(side + "_shoulder", "1 0 0", "-90 90") + hinge(side + "_swing", "0 1 0", "-90 90"), 0.25, 0.04,
                  limb(side + "_hand", "0 0 -0.3", hinge(side + "_elbow", "0 1 0", "-120 5"), 0.2, 0.035, ""));
    limbs += limb(side + "_thigh", "0 " + format_number(0.12 * y) + " -0.15",
                  hinge(side + "_abduct", "1 0 0", "-30 30") + hinge(side + "_hip", "0 1 0", "-100 30"), 0.35, 0.06,
                  limb(side + "_shin", "0 0 -0.42", hinge(side + "_knee", "0 1 0", "-2 140"), 0.3, 0.05,
                       limb(side + "_foot", "0 0 -0.38", hinge(side + "_ankle", "0 1 0", "-40 40"), 0.06, 0.04, "")));
  }
  return "<worldbody><geom type='plane' size='5 5 1'/><body name='torso' pos='0 0 " + format_number(height_m) +
         "' euler='0 -80 0'><freejoint/><geom type='capsule' fromto='0 0 -0.05 0 0 0.3' size='0.12'/>"
         "<body name='head' pos='0 0 0.5'><geom type='sphere' size='0.1'/></body>" +
         limbs + "</body></worldbody>";
}

TEST_CASE("a figure that flies moves as in MuJoCo") {
  if (!has_mujoco()) return;
  const Apart apart = distance_from_mujoco(kOption + figure(9) + "</mujoco>");
  MESSAGE("figure in flight: " << apart.largest_m << " m apart, at most " << apart.fastest_m_s << " m/s");
  CHECK(apart.places == 12 * kTimes_s.size());
  CHECK(apart.largest_m < kStepsApart * kStep_s * apart.fastest_m_s);
}

TEST_CASE("a figure that falls on its back comes to lie as in MuJoCo") {
  if (!has_mujoco()) return;
  const Apart apart = distance_from_mujoco(kOption + figure(0.5) + "</mujoco>");
  MESSAGE("figure on the floor: " << apart.largest_m << " m apart, at most " << apart.fastest_m_s << " m/s");
  CHECK(apart.places == 12 * kTimes_s.size());
  // MuJoCo's floor gives way and ours does not: limbs that bounce on it may differ by their thickness.
  CHECK(apart.largest_m < 0.12);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
