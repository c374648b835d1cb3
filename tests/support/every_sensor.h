// One sensor of every type, with different attributes, in a scene where it has something to measure.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/moving_scene.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/temporary_folder.h"

namespace simvis::test {

inline constexpr std::string_view kSensor = "S";

/// Attributes of sensors, one set for each measurement. A type that is not here is measured without attributes.
inline const std::multimap<std::string_view, std::string> kAttributes = {
    {"camera", ""},
    {"camera", "outputs='depth'"},
    {"camera", "outputs='color depth' width='32' height='20'"},
    {"camera", "outputs='color depth' width='32' height='20' distortion='brown_conrady' k1='-0.2'"},
    {"camera", "outputs='color instance boxes silhouettes' width='32' height='20'"},
    {"camera", "light='path' samples='3' bounces='2' outputs='color color_stddev depth' width='16' height='10'"},
    {"camera", "light='path' noise='0.05' bounces='1' outputs='color color_stddev' width='32' height='20'"},
    {"camera", "outputs='instance flow_backward scene_flow' width='32' height='20'"},
    {"camera", "outputs='flow_backward flow_forward occlusion layers' max_layers='3' width='32' height='20'"},
    {"stereo_camera", "width='32' height='20'"},
    {"stereo_camera", "outputs='color boxes silhouettes' width='32' height='20'"},
    {"stereo_camera", "outputs='depth flow_forward occlusion layers' layer='first' width='32' height='20'"},
    {"stereo_camera", "outputs='depth' width='32' height='20'"},
    {"stereo_camera", "outputs='color depth disparity' width='32' height='20'"},
    {"stereo_camera", "outputs='color depth disparity' width='32' height='20' distortion='kannala_brandt' fx='16'"},
    {"rgbd_camera", "outputs='color depth depth_state' width='32' height='20'"},
    {"rgbd_camera", "outputs='color depth' width='32' height='20' distortion='brown_conrady' k1='-0.1'"},
    {"tof_camera", "width='16' height='10' distortion='kannala_brandt' fx='8'"},
    {"event_camera", "width='16' height='10' leak='200' distortion='brown_conrady' k1='-0.1'"},
    {"thermal_camera", "width='16' height='10' distortion='kannala_brandt' fx='8'"},
    {"tof_camera", "outputs='depth range amplitude' width='16' height='10' signal_e='10000' bounce_rays='2'"},
    {"event_camera", "width='16' height='10' leak='200'"},
    {"event_camera", "width='16' height='10' picture='on' leak='200'"},
    {"thermal_camera", "outputs='temperature raw16 color' width='16' height='10' netd='0.05' time_constant='0.01'"},
    {"laser_scanner", "samples='21'"},
    {"laser_scanner", "samples='21' vertical_samples='3' vertical_min_angle='-10' vertical_max_angle='10'"},
    {"laser_scanner", "samples='21' method='planar'"},
    {"laser_scanner", "samples='21' truth='range hit'"},
    {"laser_scanner", "samples='21' truth='hit' intensity='on' return='last' sweep='0.01' range_min='2.9'"},
    {"gnss", ""},
    {"gnss", "satellites='gps' reflection='0.5'"},
    {"gnss_satellites", "reflection='0.5'"},
    {"magnetometer", "model='wmm2025'"},
    {"odometry", "kind='wheel'"},
    {"range", "range_max='1'"},
    {"range", "range_max='4'"},
    {"psd", "range_max='3'"},
    {"force_torque", "joint='j'"},
    {"contact", ""},
    {"keypoints", "points='*' width='32' height='20'"},
    {"keypoints", "width='32' height='20' distortion='kannala_brandt' row_time='0.001'"},
};

/// A scene in which every sensor has something to measure; `S` stands at the part POINT.
inline std::string scene_with(const std::string& sensor) {
  const std::string label =
      "<element type='label' name='WALLS' insert_at='ROOT' part='WALL' class='wall' class_id='2'/>";
  return R"(
    <part name="WALL" shape="box" size="0.25 4 4" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>
    <element type="light" name="SUN" insert_at="ROOT"/>
    <part name="ROBOT" insert_at="ROOT"/>
    <element type="pose" name="MOVE" insert_at="ROBOT"/>
    <element type="joint" name="NECK" insert_at="ROBOT" axis="0 0 1" lower="-9" upper="9"/>
    <element type="joint" name="LIFT" insert_at="ROBOT" kind="prismatic" axis="0 0 1" lower="-9" upper="9"/>)" +
         (sensor.find("boxes") == sensor.npos ? "" : label) + sensor;
}

inline std::string sensor_xml(std::string_view type, const std::string& attributes) {
  const bool of_physics = type == "contact" || type == "force_torque";
  return "<sensor type='" + std::string(type) + "' name='S' insert_at='" + (of_physics ? "BOX" : "ROBOT") + "' " +
         attributes + "/>";
}

/// What stands around a sensor, and how its scene is simulated.
struct Surroundings {
  std::string before{}, after{};  ///< commands in front of the sensor's and behind it
  SimulationDesc desc{};
};

/// The text of a scene with a sensor S of this type; its files are written to `folder`.
inline std::string scene_text_of(std::string_view type, const std::string& attributes, const TemporaryFolder& folder,
                                 const Surroundings& around = {}) {
  const std::string sensor = around.before + sensor_xml(type, attributes) + around.after;
  if (type == "contact") {
    return kPhysics + ground() + body("BOX", "shape='box' size='0.4 0.3 0.2' pose_offset='1 2 0.1 0 0 0'", "mass='3'") +
           sensor;
  }
  if (type != "force_torque") return scene_with(sensor);
  std::ofstream(folder.path() / "arm.urdf")
      << "<robot name='a'><link name='base'>" + inertial(1, "0 0 0", 0.02) + "</link><link name='upper'>" +
             inertial(1, "0.2 0 0", 0.02) +
             "</link><joint name='j' type='revolute'><parent link='base'/><child link='upper'/><axis xyz='0 1 0'/>"
             "<limit lower='-1' upper='1' effort='500' velocity='1'/></joint></robot>";
  return kPhysics +
         "<part name='BOX' insert_at='ROOT' file='arm.urdf'/>"
         "<element type='robot' name='ARM' insert_at='BOX' base='fixed'/>" +
         sensor;
}

/// A scene with a sensor S of this type, before its first frame.
inline Simulation scene_of(std::string_view type, const std::string& attributes, const Surroundings& around = {}) {
  const TemporaryFolder folder;
  return Simulation::from_string(scene_text_of(type, attributes, folder, around), around.desc, folder.path());
}

/// Makes three frames, in which the robot moves.
inline void drive(Simulation& simulation) {
  const std::vector<ElementDescriptor>& elements = simulation.parameters().elements();
  const bool moves = std::ranges::count(elements, "MOVE", &ElementDescriptor::name) == 1;
  for (int frame = 0; frame < 3; ++frame) {
    if (moves) simulation.set("MOVE", "x", 0.1 * frame);
    simulation.step();
  }
}

/// The sets of attributes with which a type is tested; one without attributes if it has no other.
inline std::vector<std::string> attributes_of(std::string_view type) {
  std::vector<std::string> all;
  const auto [first, end] = kAttributes.equal_range(type);
  for (auto each = first; each != end; ++each) all.push_back(each->second);
  if (all.empty()) all.emplace_back();
  return all;
}

/// Outputs of one name for each thing are repeated for the things of `things`, in the order of the scene.
inline std::vector<OutputSpec> expanded(const std::vector<OutputSpec>& specs) {
  if (specs.empty() || specs.front().name.find('*') == std::string::npos) return specs;
  REQUIRE(specs.size() == 6);  // of joints that turn and of joints that slide; without physics they have no effort
  std::vector<OutputSpec> all;
  for (const auto& [joint, first] : {std::pair("NECK", 0), {"LIFT", 3}}) {
    for (int i = first; i < first + 2; ++i) {
      all.push_back(specs[static_cast<std::size_t>(i)]);
      all.back().name.replace(all.back().name.find('*'), 1, joint);
    }
  }
  return all;
}

}  // namespace simvis::test
