// The marvin scene itself: its generator, its size, the sight of its scanners and its walls. No device is needed.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <glm/glm.hpp>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <simvis/command.h>
#include <simvis/pose.h>
#include <simvis/scene.h>
#include "scenegraph/flattener.h"

TEST_SUITE_BEGIN("scenes");

namespace {

using namespace simvis;

const std::filesystem::path kMarvinFolder = std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/marvin";

struct Triangle {
  glm::dvec3 a, ab, ac;
  bool lets_beams_pass;  ///< glass
};

std::vector<Triangle> triangles_of(Scene& scene) {
  Flattener flattener(scene.root());
  const DrawList& list = flattener.update();
  std::vector<Triangle> triangles;
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    const Material& material = *list.materials[item.material];
    if (mesh.topology != Topology::triangles) continue;
    const bool glass = material.alpha_mode == AlphaMode::blend && material.base_color.a < 0.5f;
    const auto place = [&](std::uint32_t index) {
      return glm::dvec3(list.world_from_node[item.transform] * glm::dvec4(glm::dvec3(mesh.positions[index]), 1));
    };
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
      const glm::dvec3 a = place(mesh.indices[i]);
      triangles.push_back({a, place(mesh.indices[i + 1]) - a, place(mesh.indices[i + 2]) - a, glass});
    }
  }
  return triangles;
}

/// Whether the ray meets one of the triangles, from either side (after Moeller and Trumbore, 1997).
bool is_blocked(const std::vector<Triangle>& triangles, const glm::dvec3& from, const glm::dvec3& direction) {
  // Barycentric coordinates of a few units are off by some 1e-15 in double; the slack keeps shared edges closed.
  constexpr double kEdgeSlack = 1e-12;
  for (const Triangle& t : triangles) {
    if (t.lets_beams_pass) continue;
    const glm::dvec3 p = glm::cross(direction, t.ac);
    const double det = glm::dot(t.ab, p);
    if (det == 0) continue;
    const glm::dvec3 s = from - t.a;
    const double u = glm::dot(s, p) / det;
    if (u < -kEdgeSlack || u > 1 + kEdgeSlack) continue;
    const glm::dvec3 q = glm::cross(s, t.ab);
    const double v = glm::dot(direction, q) / det;
    if (v < -kEdgeSlack || u + v > 1 + kEdgeSlack) continue;
    if (glm::dot(t.ac, q) / det > 0) return true;
  }
  return false;
}

std::vector<Command> marvin_commands() { return read_commands(kMarvinFolder / "marvin.xml"); }

std::string attribute(const Command& command, std::string_view name) {
  const CommandAttribute* found = command.find(name);
  REQUIRE_MESSAGE(found, to_string(command), " has no ", name);
  return found->value;
}

const Command& named(const std::vector<Command>& commands, std::string_view name) {
  for (const Command& command : commands) {
    if (attribute(command, "name") == name) return command;
  }
  FAIL("marvin.xml has no ", name);
  std::abort();
}

std::array<double, 6> pose_offset(const Command& command) {
  std::array<double, 6> values{};
  std::istringstream text(attribute(command, "pose_offset"));
  for (double& value : values) text >> value;
  REQUIRE(text);
  return values;
}

glm::dmat4 matrix_of(const std::array<double, 6>& v) {
  return matrix_from_degrees({v[0], v[1], v[2]}, v[3], v[4], v[5]);
}

/// The robot alone, standing in the origin, its upper scanner's head turned down by `tilt_deg`.
std::vector<Triangle> robot_triangles(const std::vector<Command>& commands, double tilt_deg) {
  const std::array<double, 6> head = pose_offset(named(commands, "TILT_HEAD"));
  std::ostringstream xml;
  xml << R"(<part file="robot.glb" name="ROBOT" insert_at="ROOT"/>)"
      << R"(<part file="tilt_head.glb" name="TILT_HEAD" insert_at="ROBOT" pose_offset=")" << head[0] << ' ' << head[1]
      << ' ' << head[2] << " 0 " << tilt_deg << R"( 0"/>)";
  Scene scene;
  for (const Command& command : parse_commands(xml.str(), "robot", kMarvinFolder)) scene.insert_part(command);
  return triangles_of(scene);
}

/// How many beams of a half circle the robot itself stops.
int blocked_beams(const std::vector<Triangle>& robot, const glm::dmat4& robot_from_scanner) {
  int blocked = 0;
  for (int beam = 0; beam < 361; ++beam) {
    const double azimuth = glm::radians(-90 + 0.5 * beam);
    const glm::dvec3 direction(robot_from_scanner * glm::dvec4(std::cos(azimuth), std::sin(azimuth), 0, 0));
    blocked += is_blocked(robot, glm::dvec3(robot_from_scanner[3]), direction);
  }
  return blocked;
}

}  // namespace

TEST_CASE("the generator makes what is committed, and its drive keeps clear of the furniture") {
  const std::string command = "python3 \"" + (kMarvinFolder / "generate.py").string() + "\" --check";
  CHECK(std::system(command.c_str()) == 0);
}

TEST_CASE("the scene has at least 20,000 triangles, and repeated parts share their meshes") {
  Scene scene;
  std::size_t parts = 0;
  for (const Command& command : marvin_commands()) {
    if (command.kind != CommandKind::part) continue;
    scene.insert_part(command);
    ++parts;
  }
  CHECK(scene.warnings().empty());
  const std::vector<Triangle> triangles = triangles_of(scene);
  MESSAGE(parts << " parts, " << triangles.size() << " triangles");
  CHECK(triangles.size() >= 20'000);

  Flattener flattener(scene.root());
  const DrawList& list = flattener.update();
  CHECK(list.meshes.size() * 2 < list.items.size());
  CHECK(list.lights.size() == 7);
}

TEST_CASE("the robot stands in no scanner's way") {
  const std::vector<Command> commands = marvin_commands();
  const std::vector<Triangle> robot = robot_triangles(commands, 0);
  for (const std::string name : {"FRONT_SCANNER", "REAR_SCANNER"}) {
    CAPTURE(name);
    const glm::dmat4 mount = matrix_of(pose_offset(named(commands, name)));
    CHECK(mount[3].z == doctest::Approx(0.1));
    CHECK(blocked_beams(robot, mount) == 0);
    // The other way round the robot is in the way: the check above can fail.
    CHECK(blocked_beams(robot, mount * matrix_of({0, 0, 0, 0, 0, 180})) > 0);
  }
  for (double tilt_deg = -45; tilt_deg <= 45; tilt_deg += 7.5) {
    CAPTURE(tilt_deg);
    const std::array<double, 6> head = pose_offset(named(commands, "TILT_HEAD"));
    const glm::dmat4 mount = matrix_of({head[0], head[1], head[2], 0, tilt_deg, 0}) *
                             matrix_of(pose_offset(named(commands, "TILT_SCANNER")));
    CHECK(blocked_beams(robot_triangles(commands, tilt_deg), mount) == 0);
  }
}

TEST_CASE("no beam leaves the laboratory, windows and the open door included") {
  Scene scene;
  for (const Command& command : marvin_commands()) {
    if (command.kind == CommandKind::part && attribute(command, "name") != "ROBOT" &&
        attribute(command, "insert_at") != "ROBOT") {
      scene.insert_part(command);
    }
  }
  const std::vector<Triangle> triangles = triangles_of(scene);
  std::mt19937_64 random(1);
  const auto between = [&](double low, double high) { return low + (high - low) * (random() >> 11) * 0x1p-53; };
  int escaped = 0;
  for (int i = 0; i < 1'500; ++i) {
    const glm::dvec3 from(between(-5.9, 5.9), between(-4.4, 4.4), between(0.05, 2.9));
    const double up = between(-1, 1), azimuth = between(0, 2 * 3.141592653589793), across = std::sqrt(1 - up * up);
    escaped += !is_blocked(triangles, from, {across * std::cos(azimuth), across * std::sin(azimuth), up});
  }
  CHECK(escaped == 0);
}

TEST_CASE("the drive begins where the scene puts the robot, and ends there after one turn") {
  std::ifstream file(kMarvinFolder / "drive.csv");
  std::string header, line;
  REQUIRE(std::getline(file, header));
  CHECK(header == "time_s,R_POSE.x,R_POSE.y,R_POSE.yaw,TILT.value");
  std::vector<std::array<double, 5>> rows;
  while (std::getline(file, line)) {
    std::istringstream text(line);
    std::array<double, 5> row{};
    for (double& value : row) {
      text >> value;
      text.ignore(1, ',');
    }
    rows.push_back(row);
  }
  REQUIRE(rows.size() > 100);
  CHECK(rows.back()[0] >= 20);
  const std::vector<Command> commands = marvin_commands();
  const Command& pose = named(commands, "R_POSE");
  CHECK(rows.front()[1] == std::stod(attribute(pose, "x")));
  CHECK(rows.front()[2] == std::stod(attribute(pose, "y")));
  CHECK(rows.front()[3] == std::stod(attribute(pose, "yaw")));
  CHECK(rows.back()[1] == rows.front()[1]);
  CHECK(rows.back()[2] == rows.front()[2]);
  CHECK(rows.back()[3] == doctest::Approx(rows.front()[3] + 360));
}

TEST_SUITE_END();
