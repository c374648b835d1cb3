// The arm scene: its generator, the kinematics of its robot against the numbers in its URDF, its gripper, its work.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <glm/glm.hpp>
#include <map>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "scenegraph/flattener.h"
#include "simvis/scene_builder.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("scenes");

namespace {

using namespace simvis;

const std::filesystem::path kArmFolder = std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/arm";

// Where arm.xml puts the arm.
const glm::dmat4 kWorldFromArm = matrix_from_degrees({-0.35, 0, 0.74}, 0, 0, 0);

std::array<double, 3> three(const std::string& text) {
  std::array<double, 3> values{};
  std::istringstream stream(text);
  for (double& value : values) stream >> value;
  return values;
}

struct UrdfJoint {
  std::string name, parent;
  glm::dmat4 origin{1.0};
  glm::dvec3 axis{0};
  bool slides = false;
  double lower = 0, upper = 0;  // deg or m
};

// What stands between the first `begin` and the next `end`; `otherwise` where there is no `begin`.
std::string between(const std::string& text, const std::string& begin, const std::string& end,
                    const std::string& otherwise = "") {
  const std::size_t at = text.find(begin);
  if (at == std::string::npos) return otherwise;
  return text.substr(at + begin.size(), text.find(end, at + begin.size()) - at - begin.size());
}

// The joint above each link, by the link's name: read here once more, without an XML library, as generate.py writes it.
std::map<std::string, UrdfJoint> joints_of_arm() {
  const std::string file = read_text(kArmFolder / "arm.urdf");
  std::map<std::string, UrdfJoint> joints;
  for (std::size_t at = file.find("<joint "); at != std::string::npos; at = file.find("<joint ", at + 1)) {
    const std::string text = file.substr(at, file.find("</joint>", at) - at);
    UrdfJoint joint;
    joint.name = between(text, "name=\"", "\"");
    joint.parent = between(text, "<parent link=\"", "\"");
    const std::string origin = between(text, "<origin ", "/>");
    const auto place = three(between(origin, "xyz=\"", "\"")), angles = three(between(origin, "rpy=\"", "\"", "0 0 0"));
    joint.origin = to_matrix({.position_m = {place[0], place[1], place[2]},
                              .roll_rad = angles[0],
                              .pitch_rad = angles[1],
                              .yaw_rad = angles[2]});
    const auto axis = three(between(text, "<axis xyz=\"", "\"", "0 0 0"));
    joint.axis = {axis[0], axis[1], axis[2]};
    joint.slides = between(text, "type=\"", "\"") == "prismatic";
    const double unit = joint.slides ? 1 : 180 / std::numbers::pi;
    joint.lower = unit * std::stod(between(text, "lower=\"", "\"", "0"));
    joint.upper = unit * std::stod(between(text, "upper=\"", "\"", "0"));
    joints[between(text, "<child link=\"", "\"")] = joint;
  }
  return joints;
}

// The arm's axes are unit vectors along x, y or z.
glm::dmat4 motion(const UrdfJoint& joint, double value) {
  if (joint.slides) return matrix_from_degrees(value * joint.axis, 0, 0, 0);
  return matrix_from_degrees({0, 0, 0}, joint.axis.x * value, joint.axis.y * value, joint.axis.z * value);
}

glm::dmat4 world_from_link(const std::map<std::string, UrdfJoint>& joints, std::string link,
                           const std::map<std::string, double>& values) {
  glm::dmat4 matrix{1.0};
  for (auto joint = joints.find(link); joint != joints.end(); joint = joints.find(link)) {
    const auto value = values.find(joint->second.name);
    const glm::dmat4 moved = value == values.end() ? glm::dmat4(1) : motion(joint->second, value->second);
    matrix = joint->second.origin * moved * matrix;
    link = joint->second.parent;
  }
  return kWorldFromArm * matrix;
}

double difference(const glm::dmat4& a, const glm::dmat4& b) {
  double worst = 0;
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) worst = std::max(worst, std::abs(a[column][row] - b[column][row]));
  }
  return worst;
}

// Two products of up to 18 matrices with entries of at most 1.5, multiplied in different orders: 4 roundings of half an
// ulp per entry and product, each growing by at most 1.5 on the way.
constexpr double kRoundings = 2 * 18 * 4 * 1.5 * 0x1p-53;

const char* const kTurning[] = {"TURRET", "SHOULDER", "ELBOW", "FOREARM_ROLL", "WRIST", "HAND_ROLL"};

// reach.csv: the columns' names and the rows.
struct Reach {
  std::vector<std::string> names;
  std::vector<std::map<std::string, double>> rows;
};
Reach read_reach() {
  Reach reach;
  std::istringstream lines(read_text(kArmFolder / "reach.csv"));
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::map<std::string, double> row;
    std::size_t column = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++column) {
      if (reach.names.size() <= column && reach.rows.empty()) {
        reach.names.push_back(cell);
      } else {
        row[reach.names.at(column)] = std::stod(cell);
      }
    }
    if (!row.empty()) reach.rows.push_back(row);
  }
  return reach;
}

}  // namespace

TEST_CASE("the generator makes what is committed, and it is small") {
  const std::string command = "python3 \"" + (kArmFolder / "generate.py").string() + "\" --check";
  CHECK(std::system(command.c_str()) == 0);
  std::uintmax_t bytes = 0;
  for (const std::string& file : files_below(kArmFolder)) bytes += std::filesystem::file_size(kArmFolder / file);
  CHECK(bytes < 1'500'000);
}

TEST_CASE("the hand's camera stands where the product of the URDF's transforms says") {
  const std::map<std::string, UrdfJoint> joints = joints_of_arm();
  auto sim = Simulation::load(kArmFolder / "arm.xml");
  CHECK(sim.warnings().empty());
  for (const SensorInfo& sensor : sim.sensors()) sim.enable(sensor.name, false);
  constexpr double kShares[][6] = {
      {0.5, 0.4, 0.3, 0.5, 0.6, 0.5}, {0, 1, 0, 1, 0, 1}, {1, 0, 1, 0, 1, 0}, {0.7, 0.3, 0.9, 0.2, 0.1, 0.6}};
  for (const auto& shares : kShares) {
    std::map<std::string, double> values;
    for (std::size_t i = 0; i < 6; ++i) {
      for (const auto& [link, joint] : joints) {
        if (joint.name != kTurning[i]) continue;
        // Whole degrees, which lie within limits that were rounded to radians and back.
        const double lower = std::ceil(joint.lower), upper = std::floor(joint.upper);
        values[joint.name] = std::round(lower + shares[i] * (upper - lower));
        sim.set(joint.name, "value", values[joint.name]);
      }
    }
    REQUIRE(values.size() == 6);
    sim.step();
    glm::dmat4 seen{0.0};
    REQUIRE(sim.sensor_pose("HAND_CAM", seen));
    CHECK(difference(seen, world_from_link(joints, "camera", values)) <= kRoundings);
  }
}

TEST_CASE("the right finger follows the left one; both show one mesh") {
  const std::map<std::string, UrdfJoint> joints = joints_of_arm();
  std::vector<Command> commands = read_commands(kArmFolder / "arm.xml");
  for (const Command& more : parse_commands("<sensor type='camera' name='L' insert_at='left_finger'/>"
                                            "<sensor type='camera' name='R' insert_at='right_finger'/>",
                                            "test", kArmFolder)) {
    commands.push_back(more);
  }
  BuiltScene built = build_scene(commands);
  Flattener flattener(built.scene.root());
  for (const double grip_m : {0.0, 0.015, 0.04}) {
    built.parameters.set(built.parameters.index("GRIP", "value"), grip_m);
    for (const std::size_t i : built.parameters.drain_changed_elements()) {
      const ElementDescriptor& element = built.parameters.elements()[i];
      built.elements[i]->update(built.parameters.values().subspan(element.first_value, element.parameters.size()));
    }
    flattener.update();
    for (const BuiltSensor& sensor : built.sensors) {
      if (sensor.name != "L" && sensor.name != "R") continue;
      glm::dmat4 seen{0.0};
      REQUIRE(flattener.find_mount(*sensor.mount, seen));
      const std::string link = sensor.name == "L" ? "left_finger" : "right_finger";
      const std::map<std::string, double> values{{"GRIP", grip_m}, {"GRIP_RIGHT", grip_m}};
      CHECK(difference(seen, world_from_link(joints, link, values)) <= kRoundings);
      const glm::dmat4 hand = world_from_link(joints, "hand", {});
      const double apart_m = glm::dot(glm::dvec3(seen[3]) - glm::dvec3(hand[3]), glm::dvec3(hand[1]));
      CHECK(std::abs(apart_m - (sensor.name == "L" ? grip_m : -grip_m)) <= kRoundings);
    }
  }
  const DrawList& list = flattener.update();
  int fingers = 0;
  std::size_t triangles = 0;
  for (const DrawItem& item : list.items) triangles += list.meshes[item.mesh]->indices.size() / 3;
  for (const DrawItem& item : list.items) {
    fingers += list.materials[item.material]->name == "steel" && list.meshes[item.mesh]->indices.size() == 3 * 216;
  }
  CHECK(fingers == 2);
  int meshes = 0;
  for (const auto& mesh : list.meshes) meshes += mesh->indices.size() == 3 * 216;
  CHECK(meshes == 1);
  MESSAGE(triangles << " triangles");
  CHECK(triangles > 15'000);
}

TEST_CASE("reach.csv: joints stay within their limits, and the hand carries the block") {
  const std::map<std::string, UrdfJoint> joints = joints_of_arm();
  const Reach reach = read_reach();
  REQUIRE(reach.rows.size() > 100);
  constexpr double kClosed_m = 0.025;
  // Cells have five decimals: three coordinates off by half of the last, and six angles that turn up to 0.9 m.
  const double printed_m = std::sqrt(3.0) * 0.5e-5 + 6 * glm::radians(0.5e-5) * 0.9;
  int carried = 0;
  double before_s = 0;
  glm::dvec3 held{0};
  for (std::size_t i = 0; i < reach.rows.size(); ++i) {
    const std::map<std::string, double>& row = reach.rows[i];
    std::map<std::string, double> values;
    for (const auto& [link, joint] : joints) {
      const auto cell = row.find(joint.name + ".value");
      if (cell == row.end()) continue;
      values[joint.name] = cell->second;
      CHECK(cell->second >= joint.lower);
      CHECK(cell->second <= joint.upper);
    }
    CHECK(values.size() == 7);
    if (i > 0) CHECK(row.at("time_s") > before_s);
    before_s = row.at("time_s");
    if (values["GRIP"] != kClosed_m) continue;
    const glm::dmat4 hand = world_from_link(joints, "hand", values);
    const glm::dvec4 block = kWorldFromArm * glm::dvec4(row.at("BLOCK.x"), row.at("BLOCK.y"), row.at("BLOCK.z"), 1);
    const glm::dvec3 in_hand(rigid_inverse(hand) * block);
    if (carried++ == 0) held = in_hand;
    CHECK(glm::length(in_hand - held) <= 2 * printed_m);
    CHECK(std::abs(in_hand.y) <= 2 * printed_m);  // between the fingers
  }
  CHECK(carried > 30);
}

TEST_SUITE_END();
