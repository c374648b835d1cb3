// MJCF models in physics, against MuJoCo itself where its Python package is there.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/trigonometric.hpp>
#include <map>
#include <sstream>

#include "elements/sensed_physics.h"
#include "tests/support/moving_scene.h"
#include "tests/support/object_names.h"
#include "tests/support/python_package.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

// Prints how far its soft constraints give way at each time, and the place of each body. Arguments: the file, the
// control value of all actuators, the times.
const char* const kMujocoScript = R"(
import sys, mujoco
model = mujoco.MjModel.from_xml_path(sys.argv[1])
data = mujoco.MjData(model)
data.ctrl[:] = float(sys.argv[2])
for time in sys.argv[3:]:
    while data.time < float(time) - 1e-9:
        mujoco.mj_step(model, data)
    mujoco.mj_forward(model, data)
    contacts = max([0] + [-each.dist for each in data.contact])
    equalities = sum(abs(data.efc_pos[i]) for i in range(data.ne))
    print(time, 'contacts', contacts, 0, 0)
    print(time, 'equalities', equalities, 0, 0)
    for i in range(1, model.nbody):
        print(time, model.body(i).name, *data.xpos[i])
)";

// Prints the time of the first contact, and of each body the mass, its centre and the inertia about it, along the
// body's axes.
const char* const kMujocoBodiesScript = R"(
import sys, mujoco, numpy
model = mujoco.MjModel.from_xml_path(sys.argv[1])
data = mujoco.MjData(model)
while data.ncon == 0 and data.time < 10:
    mujoco.mj_step(model, data)
print(data.time)
for i in range(1, model.nbody):
    turn = numpy.zeros(9)
    mujoco.mju_quat2Mat(turn, model.body_iquat[i])
    turn = turn.reshape(3, 3)
    inertia = turn @ numpy.diag(model.body_inertia[i]) @ turn.T
    print(model.body(i).name, model.body_mass[i], *model.body_ipos[i], *inertia.flatten())
)";

bool has_mujoco() { return has_python_module("mujoco"); }

const std::vector<double> kTimes_s = {0.25, 0.5, 0.75, 1};

struct Apart {
  double largest_m = 0, fastest_m_s = 0;
  double soft_m = 0;  // by which constraints of MuJoCo give way: contacts on both sides of a body, and equalities
  std::size_t places = 0;
};

std::string mujoco_says(const char* script, const std::filesystem::path& file,
                        const std::vector<std::string>& arguments = {}) {
  std::vector<std::string> command = {kToolsPython, "-c", script, file.string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const ProcessResult mujoco = Process(command).wait();
  REQUIRE_MESSAGE(mujoco.exit_code == 0, mujoco.err);
  return mujoco.out;
}

MovingScene scene_of(const std::filesystem::path& folder) {
  return MovingScene("<part name='M' insert_at='ROOT' file='m.xml'/>\n" + physics("world='M' iterations='200'") +
                         "<element type='models' name='BODIES' insert_at='M'/>",
                     folder);
}

// How far the bodies of a model get from those of MuJoCo until 1 s, and how fast they are. `target` has the control
// value.
Apart distance_from_mujoco(const std::string& text, double control = 0, const std::string& target = "",
                           const std::map<std::string, std::string>& files = {}) {
  const TemporaryFolder folder;
  std::ofstream(folder / "m.xml") << text;
  for (const auto& [name, content] : files) std::ofstream(folder / name) << content;
  std::vector<std::string> arguments = {format_number(control)};
  for (const double t : kTimes_s) arguments.push_back(format_number(t));
  std::istringstream lines(mujoco_says(kMujocoScript, folder / "m.xml", arguments));
  MovingScene scene = scene_of(folder.path());
  if (!target.empty()) scene.set("BODIES", target, control);
  Apart apart;
  std::string time, name;
  std::string shown = "0";
  std::map<std::string, glm::dvec3> before;
  for (glm::dvec3 place; lines >> time >> name >> place.x >> place.y >> place.z;) {
    if (name == "contacts" || name == "equalities") {
      apart.soft_m += name == "contacts" ? 2 * place.x : place.x;
      continue;
    }
    ++apart.places;
    if (time != shown) {
      scene.go_to(std::stod(time) - kStep_s);
      for (const std::string& point : test::object_names((*scene).scene)) before[point] = scene.position(point);
      scene.go_to(std::stod(time));
      shown = time;
    }
    const glm::dvec3 own = scene.position(name);
    apart.largest_m = std::max(apart.largest_m, glm::length(own - place));
    apart.fastest_m_s = std::max(apart.fastest_m_s, glm::length(own - before[name]) / kStep_s);
  }
  apart.soft_m /= static_cast<double>(kTimes_s.size());
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

// Boxes that overlap. By the default of their class they collide with the floor only.
TEST_CASE("bodies whose masks do not meet pass through each other as in MuJoCo") {
  if (!has_mujoco()) return;
  const Apart apart = distance_from_mujoco(
      kOption +
      "<default><geom contype='1' conaffinity='0'/></default><worldbody>"
      "<geom name='floor' type='plane' size='5 5 1' conaffinity='1'/><body name='a' pos='0 0 1'>"
      "<geom type='box' size='.1 .1 .1'/><joint name='ja' type='hinge' axis='0 1 0' damping='1'/>"
      "<body name='b' pos='0 0 .15'><joint name='jb' type='hinge' axis='0 1 0' damping='1'/>"
      "<geom type='sphere' size='.02'/><body name='c' pos='0.02 0 -.1'>"
      "<joint name='jc' type='hinge' axis='0 1 0' damping='1'/><geom type='box' size='.1 .1 .1'/></body></body></body>"
      "</worldbody></mujoco>");
  MESSAGE("masks: " << apart.largest_m << " m apart, at most " << apart.fastest_m_s << " m/s");
  CHECK(apart.places == 3 * kTimes_s.size());
  CHECK(apart.largest_m < kStepsApart * kStep_s * apart.fastest_m_s);
}

TEST_CASE("a chain whose joints have rotors moves as in MuJoCo") {
  if (!has_mujoco()) return;
  // From light rotors to some that are heavier than what they move.
  for (const std::string armature : {"0.01", "0.3", "5"}) {
    CAPTURE(armature);
    const Apart apart = distance_from_mujoco(kOption + "<default><joint armature='" + armature + "'/></default>" +
                                             kDoublePendulum + "</mujoco>");
    MESSAGE("chain with rotors of " << armature << ": " << apart.largest_m << " m apart, at most " << apart.fastest_m_s
                                    << " m/s");
    CHECK(apart.places == 3 * kTimes_s.size());
    // The passes of the solver end at changes of 1e-8 m/s: over 1000 steps, in all three joints.
    CHECK(apart.largest_m < 3 * 1000 * 1e-8);
  }
}

const char* const kBallChain =
    "<worldbody><body name='upper' pos='0 0 2' euler='10 20 30'><joint name='a' type='ball' damping='0.3' "
    "stiffness='2'/><geom type='capsule' fromto='0 0 0 0.5 0 0.1' size='0.04' contype='0' conaffinity='0'/>"
    "<body name='lower' pos='0.5 0 0.1'><joint name='b' type='ball' pos='0 0.02 0'/>"
    "<geom type='box' pos='0.2 0.05 0' size='0.2 0.03 0.05' contype='0' conaffinity='0'/>"
    "<body name='tip' pos='0.4 0 0'><joint name='c' axis='1 1 0' damping='0.1'/>"
    "<geom type='ellipsoid' size='0.1 0.05 0.07' contype='0' conaffinity='0'/></body></body></body></worldbody>";

TEST_CASE("two attached arms with a joint in a frame and a hull of vertices move as in MuJoCo") {
  if (!has_mujoco()) return;
  const std::string arm =
      "<mujoco model='arm'><compiler angle='radian'/><asset><mesh name='hull' vertex='0 -0.1 -0.1 0 0.1 -0.1 0 0 0.2 "
      "0.6 0 0 0.1 0 0'/></asset><default><geom contype='0' conaffinity='0'/></default><worldbody>"
      "<body name='upper' pos='0.2 0 0' euler='0 0.5 0'><frame euler='0 0 1.5707963267948966'>"
      "<joint name='shoulder' axis='1 0 0' pos='0.05 0 0'/></frame><geom type='mesh' mesh='hull'/>"
      "<body name='lower' pos='0.6 0 0'><joint name='elbow' axis='0 1 0' damping='0.02'/>"
      "<geom type='capsule' fromto='0 0 0 0.3 0 0' size='0.04'/></body></body></worldbody>"
      "<actuator><position joint='elbow' kp='3' kv='0.3' ctrlrange='-1 1'/></actuator></mujoco>";
  const Apart apart = distance_from_mujoco(
      kOption +
          "<asset><model name='arm' file='arm.xml'/></asset><worldbody><attach model='arm' body='upper' "
          "prefix='left_'/><frame pos='0 3 1' euler='0 0 70'><attach model='arm' prefix='right_'/></frame>"
          "</worldbody></mujoco>",
      0, "", {{"arm.xml", arm}});
  MESSAGE("attached arms: " << apart.largest_m << " m apart, " << apart.fastest_m_s << " m/s");
  CHECK(apart.places == 4 * kTimes_s.size());
  CHECK(apart.fastest_m_s > 0.5);
  CHECK(apart.largest_m < kStepsApart * kStep_s * apart.fastest_m_s);
}

TEST_CASE("a chain of two balls and a hinge moves as in MuJoCo") {
  if (!has_mujoco()) return;
  const Apart apart = distance_from_mujoco(kOption + kBallChain + "</mujoco>");
  MESSAGE("balls: " << apart.largest_m << " m apart, at most " << apart.fastest_m_s << " m/s");
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

// A body's mass, as MuJoCo computes it from the geoms.
struct FigureBody {
  std::string name;
  double mass_kg = 0;
  glm::dvec3 center_m{0};
  glm::dmat3 inertia_kg_m2{0};
};

struct Figure {
  double first_contact_s = 0;
  std::vector<FigureBody> bodies;
};

Figure mujoco_figure(const std::filesystem::path& file) {
  std::istringstream lines(mujoco_says(kMujocoBodiesScript, file));
  Figure figure;
  lines >> figure.first_contact_s;
  for (FigureBody body; lines >> body.name >> body.mass_kg >> body.center_m.x >> body.center_m.y >> body.center_m.z;) {
    for (int i = 0; i < 9; ++i) lines >> body.inertia_kg_m2[i / 3][i % 3];
    figure.bodies.push_back(body);
  }
  return figure;
}

constexpr double kJointStiffness = 2;  // N m/rad, of each joint of the figure

// Kinetic energy, that of heights, and that of springs. Speeds are those of the last step: positions follow from them.
double energy_at(MovingScene& scene, const Figure& figure, double time_s, double& fastest_m_s) {
  scene.go_to(time_s - kStep_s);
  std::map<std::string, glm::dmat4> before;
  for (const FigureBody& body : figure.bodies) before[body.name] = scene.pose(body.name);
  scene.go_to(time_s);
  double energy = 0;
  for (const FigureBody& body : figure.bodies) {
    const glm::dmat4 now = scene.pose(body.name);
    const glm::dvec3 place(now * glm::dvec4(body.center_m, 1)),
        way = place - glm::dvec3(before[body.name] * glm::dvec4(body.center_m, 1));
    const glm::dmat3 turn = glm::transpose(glm::dmat3(before[body.name])) * glm::dmat3(now);
    const glm::dvec3 rate =
        glm::dvec3(turn[1][2] - turn[2][1], turn[2][0] - turn[0][2], turn[0][1] - turn[1][0]) / (2 * kStep_s);
    fastest_m_s = std::max(fastest_m_s, glm::length(way) / kStep_s);
    energy += body.mass_kg * (9.81 * place.z + glm::dot(way, way) / (2 * kStep_s * kStep_s)) +
              glm::dot(rate, body.inertia_kg_m2 * rate) / 2;
  }
  for (const ElementDescriptor& element : (*scene).parameters.elements()) {
    if (element.type != "joint") continue;
    const double angle = glm::radians(scene.get(element.name, "value"));
    energy += kJointStiffness * angle * angle / 2;
  }
  return energy;
}

TEST_CASE("a figure falls on its back when MuJoCo's does, and its energy never grows") {
  if (!has_mujoco()) return;
  const TemporaryFolder folder;
  std::ofstream(folder / "m.xml") << kOption + figure(0.5) + "</mujoco>";
  const Figure mujoco = mujoco_figure(folder / "m.xml");
  REQUIRE(mujoco.bodies.size() == 12);
  double mass_kg = 0;
  for (const FigureBody& body : mujoco.bodies) mass_kg += body.mass_kg;
  MovingScene scene = scene_of(folder.path());
  double fastest_m_s = 0, before = 0, first_contact_s = 0, lowest_m = 1;
  const auto physics_of_scene = find_physics((*scene).scene);
  const auto touches = [&] {
    return std::ranges::any_of(mujoco.bodies, [&](const FigureBody& body) {
      const auto contacts = physics_of_scene->contacts_at(body.name);
      return contacts && !contacts->empty();
    });
  };
  constexpr int kSteps = 1000;
  for (int i = 1; i <= kSteps; ++i) {
    const double energy = energy_at(scene, mujoco, i * kStep_s, fastest_m_s);
    if (first_contact_s == 0 && touches()) first_contact_s = i * kStep_s;
    // Heights and speeds belong to times that are up to a step apart.
    if (i > 1) CHECK(energy - before < kStep_s * mass_kg * 9.81 * fastest_m_s);
    before = energy;
    for (const FigureBody& body : mujoco.bodies) lowest_m = std::min(lowest_m, scene.position(body.name).z);
  }
  MESSAGE("figure: first contact after " << first_contact_s << " s, in MuJoCo after " << mujoco.first_contact_s
                                         << " s");
  CHECK(std::abs(first_contact_s - mujoco.first_contact_s) < kStepsApart * kStep_s);
  CHECK(lowest_m > 0);  // a body's origin lies within its capsule
}

// A gripper pushes a box from one side, and an equality the other finger against it.
std::string gripper(const std::string& softness) {
  const std::string finger = "<geom type='box' size='0.01 0.02 0.05' mass='0.1' friction='1'/>";
  return kOption + "<default><geom " + softness + "/></default>" +
         "<worldbody><body name='palm' pos='0 0 0.5'><geom type='box' size='0.1 0.05 0.02' pos='0 0 0.1'/>"
         "<body name='left' pos='-0.06 0 0'><joint name='l' type='slide' axis='1 0 0' damping='20' range='0 0.05'/>" +
         finger +
         "</body><body name='right' pos='0.06 0 0'><joint name='r' type='slide' axis='-1 0 0' damping='20' "
         "range='0 0.05'/>" +
         finger +
         "</body></body><body name='box' pos='0 0 0.47'><freejoint/><geom type='box' size='0.03 0.03 0.03' "
         "mass='0.05' friction='1'/></body><body name='table' pos='0 0 0.42'><geom type='box' size='0.2 0.2 0.02'/>"
         "</body></worldbody><equality><joint joint1='r' joint2='l' " +
         softness +
         "/></equality><actuator><position joint='l' kp='1000' kv='20' ctrlrange='0 0.05'/></actuator></mujoco>";
}

// The equality carries half of the 30 N of the drive. By MuJoCo's default it gives way by 5.1 mm for that: the force by
// the inverse masses of both fingers, 20/kg, (1 - d) / d, and the time constant of 0.02 s, with d = 0.95.
TEST_CASE("a gripper that closes on a box holds it as in MuJoCo, as far as MuJoCo's constraints hold") {
  if (!has_mujoco()) return;
  double hard_m = 0;
  for (const std::string softness : {"", "solref='0.002 1'"}) {
    CAPTURE(softness);
    const Apart apart = distance_from_mujoco(gripper(softness), 0.05, "target_l");
    MESSAGE("gripper: " << apart.largest_m << " m apart, of which MuJoCo's softness is " << apart.soft_m << " m");
    CHECK(apart.places == 5 * kTimes_s.size());
    CHECK(apart.largest_m < apart.soft_m);
    hard_m = apart.largest_m;
  }
  // A hundredth of the softness, but not of d, which falls to 0.9 for such small ways.
  constexpr double kHardEquality_m = 15 * 20 * (0.1 / 0.9) * 0.95 * 0.95 * 0.002 * 0.002 / 0.9;
  CHECK(hard_m < 2 * kHardEquality_m);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
