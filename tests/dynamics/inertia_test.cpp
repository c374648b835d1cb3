// Inertias that no body has: which ones replace them, for every element and format that gives one.
#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <random>
#include <string>
#include <string_view>

#include "elements/dynamics/world/mass.h"
#include "simvis/live_scene.h"
#include "tests/support/moving_scene.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("dynamics");

namespace simvis::test {
namespace {

bool obeys_triangle(const glm::dvec3& d) {
  // The perpendicular's foot is rounded a few times.
  constexpr double kRounding = 1e-14;
  return std::min({d.x, d.y, d.z}) > 0 && 2 * std::max({d.x, d.y, d.z}) <= (d.x + d.y + d.z) * (1 + kRounding);
}

TEST_CASE("no possible inertia is nearer than the one that replaces an impossible one") {
  constexpr double kMass_kg = 1e-3, kBall = 0.4 * kMass_kg * 1e-6;
  std::mt19937_64 random(53);
  std::uniform_real_distribution<double> moment(-1, 2), second_moment(0, 1);
  int impossible = 0;
  for (int i = 0; i < 300; ++i) {
    const PrincipalInertia given{glm::dmat3(1), {moment(random), moment(random), moment(random)}};
    if (is_possible(given)) continue;
    ++impossible;
    const glm::dvec3 nearest = nearest_possible(given, kMass_kg).diagonal_kg_m2;
    CHECK(obeys_triangle(nearest));
    const double away = glm::length(nearest - given.diagonal_kg_m2);
    for (int j = 0; j < 300; ++j) {
      // Any body has second moments of at least 0. Some of them are small, so that the edges are tried too.
      glm::dvec3 s(second_moment(random), second_moment(random), second_moment(random));
      if (j % 3 > 0) s[j % 3] = 0;
      if (j % 5 == 0) s *= 1e-3;
      const glm::dvec3 other(s.y + s.z, s.x + s.z, s.x + s.y);
      CHECK(away <= glm::length(other - given.diagonal_kg_m2) + 2 * kBall);
    }
  }
  CHECK(impossible > 100);
}

TEST_CASE("a correction keeps the axes, and gives a point the inertia of a small ball") {
  const glm::dmat3 turned = glm::dmat3(glm::mat3_cast(glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3)))));
  const PrincipalInertia given = principal_inertia(inertia_of({turned, {1, 1, 5}}));
  const glm::dmat3 nearest = inertia_of(nearest_possible(given, 1)), expected = inertia_of({turned, {2, 2, 4}});
  for (int i = 0; i < 3; ++i) CHECK(glm::length(nearest[i] - expected[i]) < 1e-14);
  const glm::dvec3 point = nearest_possible({}, 2).diagonal_kg_m2;
  CHECK(glm::length(point - glm::dvec3(0.4 * 2 * 1e-6)) < 1e-20);
}

struct Written {
  std::string_view file, text;
  std::string_view element, where, whose;  // the warning's place and beginning
};

// The thigh of a public robot, whose largest moment is 4.4 % above the sum of the two others.
constexpr std::string_view kUrdf =
    "<robot name='r'><link name='b'><inertial><mass value='1'/><inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' "
    "iyz='0'/></inertial></link>\n<link name='thigh'><inertial><mass value='0.634'/><inertia ixx='0.00179082' "
    "iyy='0.00229528' izz='0.00040789' ixy='0' ixz='0' iyz='0'/></inertial></link><joint name='j' type='continuous'>"
    "<parent link='b'/><child link='thigh'/><axis xyz='0 1 0'/></joint></robot>";
constexpr std::string_view kFreeUrdf =
    "<robot name='r'>\n<link name='thigh'><inertial><mass value='0.634'/><inertia ixx='0.00179082' iyy='0.00229528' "
    "izz='0.00040789' ixy='0' ixz='0' iyz='0'/></inertial></link></robot>";
constexpr std::string_view kSdf =
    "<sdf version='1.7'><model name='m'>\n<link name='thigh'><inertial><mass>0.634</mass><inertia><ixx>0.00179082</ixx>"
    "<iyy>0.00229528</iyy><izz>0.00040789</izz></inertia></inertial></link></model></sdf>";
constexpr std::string_view kMjcf =
    "<mujoco><worldbody>\n<body name='thigh'><inertial pos='0 0 0' mass='0.634' diaginertia='0.00179082 0.00229528 "
    "0.00040789'/><joint name='j' axis='0 1 0'/></body></worldbody></mujoco>";
constexpr Written kWritten[] = {
    {"m.urdf", kUrdf, "robot", "m.urdf:2:", "link \"thigh\""},
    {"m.urdf", kUrdf, "models", "m.urdf:2:", "link \"thigh\""},
    {"m.urdf", kFreeUrdf, "robot' base='free", "m.urdf:2:", "link \"thigh\""},
    {"m.sdf", kSdf, "models", "m.sdf:2:", "link \"thigh\""},
    {"m.sdf", kSdf, "robot' base='free", "m.sdf:2:", "link \"thigh\""},
    {"m.xml", kMjcf, "models", "m.xml:2:", "link \"thigh\""},
};

std::string scene_of(const Written& written) {
  return kPhysics + "<part name='P' insert_at='ROOT' file='" + std::string(written.file) +
         "'/><element name='E' insert_at='P' type='" + std::string(written.element) + "'/>";
}

int corrections(const BuiltScene& built, const std::string& beginning) {
  return static_cast<int>(std::ranges::count_if(built.scene.warnings(), [&](const std::string& warning) {
    return warning.find(beginning + " has an inertia that no body has: its principal moments are ") < warning.size() &&
           warning.find("0.00179082") < warning.size() && warning.find("0.00182301") < warning.size();
  }));
}

TEST_CASE("robots of all formats get the nearest inertia with one warning, which is an error if the scene is strict") {
  for (const Written& written : kWritten) {
    CAPTURE(written.file);
    CAPTURE(written.element);
    const TemporaryFolder folder;
    std::ofstream(folder.path() / written.file) << written.text;
    MovingScene scene(scene_of(written), folder.path());
    CHECK(corrections(*scene, std::string(written.whose)) == 1);
    scene.go_to(0.1);
    const std::vector<Command> commands = parse_commands(scene_of(written), "s.xml", folder.path());
    const std::string strict = error_of([&] { LiveScene({}, commands, 0, {}, {}, true); });
    CHECK(contains(strict, std::string(written.where)));
    CHECK(contains(strict, "error: "));
  }
}

TEST_CASE("bodies and vehicles get the nearest inertia with a warning") {
  for (const std::string type : {"body", "vehicle"}) {
    const std::string more = type == "vehicle" ? "drive='differential' axle='0.1'" : "";
    MovingScene scene(kPhysics + "<part name='A' insert_at='ROOT' shape='box' size='1 1 1'/>\n<element type='" + type +
                      "' name='B' insert_at='A' mass='0.634' inertia='0.00179082 0.00229528 0.00040789' " + more +
                      "/>");
    CHECK(corrections(*scene, "element \"B\"") == 1);
    CHECK(contains((*scene).scene.warnings().front(), "s.xml:3:"));
  }
}

TEST_CASE("a body of a flat shape has no mass, whatever its inertia") {
  for (const std::string inertia : {"", "inertia='1 1 1'"}) {
    CHECK(contains(error_of([&] {
                     MovingScene(kPhysics + body("A", "shape='plane' size='1 1'", "mass='1' shape='box' " + inertia));
                   }),
                   "has no volume"));
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
