// Marvin's laboratory, driven through by messages on cmd_vel, by DDS and by Foxglove's protocol, and mapped from the
// recording by a mapper that has nothing but ROS messages: /scan, /tf and /tf_static.
#include <doctest/doctest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <simvis/simulation.h>
#include "exchange/messages/dds/dds_node.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "program/live/foxglove_peer.h"
#include "simvis/message_tap.h"
#include "tests/messages/mcap_file.h"
#include "tests/messages/tf_listener.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

using namespace simvis;

TEST_SUITE_BEGIN("clients");

namespace {

const std::string kLaboratory =
    R"(<simvis>
  <element type="physics" name="PHYSICS" insert_at="ROOT"/>
  <part file=")" SIMVIS_SOURCE_DIR R"(/scenes/marvin/laboratory.glb" name="LAB" insert_at="ROOT"/>
  <element type="body" name="LAB_BODY" insert_at="LAB" kind="static" friction="1"/>
  <part file=")" SIMVIS_SOURCE_DIR
    R"(/scenes/marvin/table.glb" name="TABLE" insert_at="LAB" pose_offset="0.9 0.3 0 0 0 90"/>
  <part file=")" SIMVIS_SOURCE_DIR
    R"(/scenes/marvin/robot.glb" name="ROBOT" insert_at="LAB" pose_offset="-3 -1.5 0.001 0 0 0"/>
  <element type="vehicle" name="DRIVE" insert_at="ROBOT" mass="45" center="-0.05 0 0.25" shape="hull"
           wheel_radius="0.13" track="0.544" caster="-0.17" clearance="0.05" max_torque="30"/>
  <element type="velocity_command" name="COMMAND" insert_at="ROBOT" vehicle="DRIVE" topic="/cmd_vel"/>
  <element type="frame" name="BASE" insert_at="ROBOT" frame="base_link"/>
  <sensor type="odometry" name="ODOM" insert_at="ROBOT" kind="wheel" wheel_separation="0.544" slip_stddev="0.0002"
          tf="map" topics="odometry:=/odom"/>
  <sensor type="laser_scanner" name="FRONT_SCANNER" insert_at="ROBOT" pose_offset="0.33 0 0.1 0 0 0" samples="361"
          min_angle="-90" max_angle="90" method="raycast" topics="scan:=/scan"/>
</simvis>)";

constexpr double kCell_m = 0.05;
using Cell = std::pair<int, int>;

Cell cell_of(const glm::dvec3& point) {
  return {static_cast<int>(std::floor(point.x / kCell_m)), static_cast<int>(std::floor(point.y / kCell_m))};
}

/// A grid of hits and passes, in the world as it stood at the start: what map -> odom was first is taken for good.
class Mapper {
 public:
  explicit Mapper(const ros::test::McapFile& file) : listener_(file) {
    for (const ros::test::McapMessage& message : file.messages) {
      if (message.topic == "/tf") add(ros::decode<ros::TFMessage>(message.bytes));
      if (message.topic == "/scan") add(ros::decode<ros::LaserScan>(message.bytes));
    }
  }
  std::set<Cell> occupied() const {
    std::set<Cell> cells;
    for (const auto& [cell, hits] : hits_) {
      const auto passes = passes_.find(cell);
      if (passes == passes_.end() || hits >= passes->second) cells.insert(cell);
    }
    return cells;
  }
  int scans() const { return scans_; }

 private:
  void add(const ros::TFMessage& message) {
    listener_.add(message);
    if (!world_from_odom_) world_from_odom_ = listener_.find("map", "odom");
  }
  void add(const ros::LaserScan& scan) {
    const std::optional<glm::dmat4> odom_from_scan = listener_.find("odom", scan.header.frame_id);
    if (!odom_from_scan || !world_from_odom_) return;
    ++scans_;
    const glm::dmat4 world_from_scan = *world_from_odom_ * *odom_from_scan;
    for (std::size_t i = 0; i < scan.ranges.size(); ++i) {
      const double range_m = scan.ranges[i], angle = scan.angle_min + static_cast<double>(i) * scan.angle_increment;
      if (!(range_m > scan.range_min && range_m < scan.range_max)) continue;
      const auto point = [&](double at_m) {
        return glm::dvec3(world_from_scan * glm::dvec4(at_m * std::cos(angle), at_m * std::sin(angle), 0, 1));
      };
      for (double at_m = kCell_m; at_m < range_m - 2 * kCell_m; at_m += kCell_m) ++passes_[cell_of(point(at_m))];
      ++hits_[cell_of(point(range_m))];
    }
  }

  ros::test::TfListener listener_;
  std::optional<glm::dmat4> world_from_odom_;
  std::map<Cell, int> hits_, passes_;
  int scans_ = 0;
};

bool has_near(const std::set<Cell>& cells, const Cell& cell, int distance) {
  for (int x = -distance; x <= distance; ++x) {
    for (int y = -distance; y <= distance; ++y) {
      if (cells.contains({cell.first + x, cell.second + y})) return true;
    }
  }
  return false;
}

/// Drives for some seconds, records, and compares the map with where the beams have really hit.
void drive_and_map(Simulation& simulation, const std::function<void(const ros::Twist&)>& send) {
  const TemporaryFolder folder;
  simulation.record({.file = folder / "drive.mcap", .topics = {"/scan", "/tf*", "/odom"}});
  std::set<Cell> truth;
  glm::dmat4 start, end;
  constexpr int kFrames = 90;
  for (int frame = 0; frame < kFrames; ++frame) {
    send({{0.5, 0, 0}, {0, 0, frame < kFrames / 2 ? 0.4 : -0.4}});
    simulation.step();
    glm::dmat4 world_from_sensor;
    REQUIRE(simulation.sensor_pose("FRONT_SCANNER", world_from_sensor));
    if (frame == 0) start = world_from_sensor;
    end = world_from_sensor;
    const Scan& scan = simulation.scan("FRONT_SCANNER");
    const std::vector<glm::dvec3> points = scan.points();
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (std::isfinite(scan.range_m[i]) && scan.range_m[i] > 0) {
        truth.insert(cell_of(glm::dvec3(world_from_sensor * glm::dvec4(points[i], 1))));
      }
    }
  }
  simulation.finish_recording();
  // 6 s at 0.5 m/s, to the left and back to the old heading.
  CHECK(glm::distance(glm::dvec3(start[3]), glm::dvec3(end[3])) > 2.4);

  const Mapper mapper(ros::test::McapReader::read(read_text(folder / "drive.mcap")));
  CHECK(mapper.scans() == kFrames);
  const std::set<Cell> map = mapper.occupied();
  REQUIRE(map.size() > 200);
  // In 3 m the heading is counted wrong by some 1e-3 rad, which is 1 cm at the far wall, and the place by some mm.
  std::size_t far = 0;
  for (const Cell& cell : map) far += has_near(truth, cell, 1) ? 0 : 1;
  CHECK(far == 0);
  // The south wall of the room of 12 m x 9 m, from beside the robot to the corner.
  std::set<int> along_wall;
  for (const auto& [x, y] : map) {
    if (std::abs((y + 0.5) * kCell_m + 4.5) <= 1.5 * kCell_m) along_wall.insert(x);
  }
  CHECK(static_cast<double>(along_wall.size()) * kCell_m > 4);
}

}  // namespace

TEST_CASE("a drive by cmd_vel on DDS is mapped from its recording") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const std::uint32_t domain = own_domain();
  Simulation simulation = Simulation::from_string(kLaboratory);
  simulation.join_dds({.domain = domain, .topics = {"/clock"}});
  ros::DdsNode node(domain);
  const auto sink = node.sink(ros::SensorQos::reliable);
  // Until the reader has found the writer, nothing arrives.
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (simulation.get("COMMAND", "command") == 0) {
    REQUIRE(std::chrono::steady_clock::now() < end);
    sink->write("/cmd_vel", 0, ros::Twist{});
    simulation.step();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
  drive_and_map(simulation, [&](const ros::Twist& twist) {
    sink->write("/cmd_vel", 0, twist);
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  });
}

TEST_CASE("a drive by cmd_vel of a Foxglove client is mapped from its recording") {
  Simulation simulation = Simulation::from_string(kLaboratory);
  live::ControlQueue controls;
  live::FoxgloveHub hub(controls, "session");
  hub.set_command_inputs(command_inputs(simulation));
  live::FoxglovePeer client(hub, 1);
  const nlohmann::json channel = {
      {"id", 1}, {"topic", "/cmd_vel"}, {"encoding", "cdr"}, {"schemaName", "geometry_msgs/msg/Twist"}};
  client.receive(nlohmann::json{{"op", "advertise"}, {"channels", {channel}}}.dump(), false);
  drive_and_map(simulation, [&](const ros::Twist& twist) {
    client.receive(std::string("\1\1\0\0\0", 5) + ros::encode(twist), true);
    const std::optional<live::Control> control = controls.next();
    REQUIRE(control);
    send_command(simulation, *control->input, control->text, 0);  // a Twist has no stamp
  });
}

TEST_SUITE_END();
