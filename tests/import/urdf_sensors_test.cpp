// Sensors in the <gazebo> blocks of URDF and xacro files: what they become, their topics and frames.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "tests/messages/mcap_file.h"
#include "tests/support/error_of.h"
#include "tests/support/urdf_scene.h"

TEST_SUITE_BEGIN("import");

namespace simvis::test {
namespace {

std::string gazebo(const std::string& link, const std::string& content) {
  return "<gazebo reference=\"" + link + "\">" + content + "</gazebo>\n";
}
std::string sensor(const std::string& type, const std::string& name, const std::string& content) {
  return "<sensor type=\"" + type + "\" name=\"" + name + "\">" + content + "</sensor>";
}
std::string plugin(const std::string& file, const std::string& content) {
  return "<plugin name=\"p\" filename=\"libgazebo_ros_" + file + ".so\">" + content + "</plugin>";
}

const std::string kLinks =
    link_xml("base") + link_xml("scan_link") + joint_xml("j", "fixed", "base", "scan_link", "<origin xyz='0 0 0.5'/>");
const std::string kScan =
    "<update_rate>10</update_rate><ray><scan><horizontal><samples>7</samples><min_angle>-1</min_angle>"
    "<max_angle>1</max_angle></horizontal></scan><range><min>0.1</min><max>12</max></range></ray>";
const std::string kCamera =
    "<update_rate>30</update_rate><camera><horizontal_fov>1.0</horizontal_fov><image><width>32</width>"
    "<height>24</height></image><clip><near>0.02</near></clip></camera>";

/// An attribute of a sensor as written; empty: it has none.
std::string attribute_of(UrdfScene& scene, const std::string& name, const std::string& attribute) {
  for (const BuiltSensor& each : scene.built().sensors) {
    if (each.name != name) continue;
    const CommandAttribute* const found = each.command.find(attribute);
    return found == nullptr ? "" : found->value;
  }
  FAIL("there is no sensor " << name);
  return "";
}

TEST_CASE("each kind of sensor in a <gazebo> block is an ordinary sensor of its link") {
  struct Case {
    std::string type, content, ours, attribute, value;
  };
  const std::vector<Case> cases = {
      {"ray", kScan, "laser_scanner", "samples", "7"},
      {"gpu_ray", kScan, "laser_scanner", "range_max", "12"},
      {"lidar", kScan, "laser_scanner", "rate", "10"},
      {"camera", kCamera, "camera", "width", "32"},
      {"depth", kCamera, "camera", "outputs", "depth"},
      {"rgbd_camera", kCamera, "camera", "outputs", "color depth"},
      {"thermal", kCamera, "thermal_camera", "outputs", "raw16 temperature"},
      {"segmentation", kCamera, "camera", "outputs", "semantic instance"},
      {"boundingbox_camera", kCamera, "camera", "outputs", "color boxes"},
      {"wideanglecamera", kCamera, "camera", "near", "0.02"},
      {"imu",
       "<imu><angular_velocity><x><noise type='gaussian'><stddev>0.5</stddev></noise></x><y><noise type='gaussian'>"
       "<stddev>0.5</stddev></noise></y><z><noise type='gaussian'><stddev>0.5</stddev></noise></z>"
       "</angular_velocity></imu>",
       "imu", "gyroscope_stddev", "0.5"},
      {"gps",
       "<gps><position_sensing><horizontal><noise type='gaussian'><stddev>2</stddev></noise></horizontal>"
       "</position_sensing></gps>",
       "gnss", "horizontal_stddev", "2"},
      {"magnetometer", "", "magnetometer", "insert_at", "scan_link"},
      {"altimeter", "", "altimeter", "insert_at", "scan_link"},
      {"air_pressure", "", "barometer", "insert_at", "scan_link"},
      {"contact", "<contact><collision>c</collision></contact>", "contact", "without_physics", "nothing"}};
  for (const Case& each : cases) {
    CAPTURE(each.type);
    UrdfScene scene(kLinks +
                    gazebo("scan_link", sensor(each.type, "own", "<pose>0.1 0 0 0 0 0</pose>" + each.content)));
    CHECK(scene.warnings().empty());
    REQUIRE(scene.built().sensors.size() == 1);
    CHECK(attribute_of(scene, "own", "type") == each.ours);
    CHECK(attribute_of(scene, "own", "insert_at") == "scan_link");
    CHECK(attribute_of(scene, "own", "pose_offset") == "0.1 0 0");
    CHECK(attribute_of(scene, "own", each.attribute) == each.value);
  }
}

TEST_CASE("plug-ins name topics and frames") {
  struct Case {
    std::string type, plugin, topics, frame;
  };
  const std::vector<Case> cases = {
      {"ray", plugin("laser", "<topicName>scan</topicName><frameName>scan_link</frameName>"), "scan:=/scan",
       "scan_link"},
      {"ray", plugin("gpu_laser", "<robotNamespace>/bot/</robotNamespace><topicName>front/scan</topicName>"),
       "scan:=/bot/front/scan", ""},
      {"ray", plugin("block_laser", "<topicName>/cloud</topicName>"), "points:=/cloud", ""},
      {"ray",
       plugin("ray_sensor",
              "<ros><namespace>/bot</namespace><remapping>~/out:=scan</remapping></ros>"
              "<output_type>sensor_msgs/LaserScan</output_type><frame_name>laser</frame_name>"),
       "scan:=/bot/scan", "laser"},
      {"ray",
       plugin("ray_sensor",
              "<ros><remapping>~/out:=pts</remapping></ros>"
              "<output_type>sensor_msgs/PointCloud2</output_type>"),
       "points:=/pts", ""},
      {"imu", plugin("imu_sensor", "<topicName>imu/data</topicName><frameName>scan_link</frameName>"), "imu:=/imu/data",
       "scan_link"},
      {"gps", plugin("gps_sensor", "<ros><remapping>~/out:=/gps/fix</remapping></ros>"), "fix:=/gps/fix", ""},
      {"camera",
       plugin("camera",
              "<cameraName>front</cameraName><imageTopicName>image</imageTopicName>"
              "<cameraInfoTopicName>camera_info</cameraInfoTopicName>"
              "<frameName>front_optical</frameName>"),
       "image_raw:=/front/image camera_info:=/front/camera_info", "front"},
      {"depth",
       plugin("openni_kinect",
              "<cameraName>kinect</cameraName><imageTopicName>rgb/image_raw</imageTopicName>"
              "<depthImageTopicName>depth/image_raw</depthImageTopicName>"
              "<pointCloudTopicName>depth/points</pointCloudTopicName>"),
       "image_raw:=/kinect/rgb/image_raw depth/image_raw:=/kinect/depth/image_raw points:=/kinect/depth/points", ""},
      {"camera",
       plugin("camera",
              "<ros><namespace>bot</namespace><remapping>cam/image_raw:=picture</remapping></ros>"
              "<camera_name>cam</camera_name>"),
       "camera_info:=/bot/cam/camera_info depth/image_raw:=/bot/cam/depth/image_raw "
       "depth/camera_info:=/bot/cam/depth/camera_info points:=/bot/cam/points image_raw:=/bot/picture",
       ""},
      {"lidar", "<topic>lidar</topic><gz_frame_id>lidar_frame</gz_frame_id>", "scan:=/lidar points:=/lidar/points",
       "lidar_frame"}};
  for (const Case& each : cases) {
    CAPTURE(each.plugin);
    const std::string content = each.type == "ray" || each.type == "lidar" ? kScan : kCamera;
    UrdfScene scene(kLinks + gazebo("scan_link", sensor(each.type, "own", content + each.plugin)));
    CHECK(scene.warnings().empty());
    CHECK(attribute_of(scene, "own", "topics") == each.topics);
    CHECK(attribute_of(scene, "own", "frame") == each.frame);
  }
  UrdfScene kinect(kLinks + gazebo("scan_link", sensor("depth", "own", kCamera + plugin("openni_kinect", ""))));
  CHECK(attribute_of(kinect, "own", "outputs") == "color depth");
}

TEST_CASE("plug-ins of a robot that are sensors by themselves") {
  UrdfScene scene(kLinks +
                  "<gazebo><plugin name=\"gps\" filename=\"libhector_gazebo_ros_gps.so\"><updateRate>4</updateRate>"
                  "<bodyName>scan_link</bodyName><topicName>navsat/fix</topicName>"
                  "<referenceLatitude>49.9</referenceLatitude><referenceLongitude>8.9</referenceLongitude></plugin>"
                  "<plugin name=\"imu\" filename=\"libgazebo_ros_imu.so\"><updateRate>50</updateRate>"
                  "<bodyName>base</bodyName><topicName>imu/data</topicName></plugin>"
                  "<plugin name=\"drive\" filename=\"libgazebo_ros_diff_drive.so\"/></gazebo>");
  CHECK(scene.warnings().empty());
  REQUIRE(scene.built().sensors.size() == 2);
  CHECK(attribute_of(scene, "gps", "type") == "gnss");
  CHECK(attribute_of(scene, "gps", "insert_at") == "scan_link");
  CHECK(attribute_of(scene, "gps", "rate") == "4");
  CHECK(attribute_of(scene, "gps", "latitude") == "49.9");
  CHECK(attribute_of(scene, "gps", "topics") == "fix:=/navsat/fix");
  // The x axis points north by default, a quarter turn counter-clockwise from east.
  CHECK(attribute_of(scene, "gps", "heading") == "90");
  CHECK(attribute_of(scene, "imu", "type") == "imu");
  CHECK(attribute_of(scene, "imu", "insert_at") == "base");
}

TEST_CASE("what cannot be taken over is one warning, and the rest is there") {
  struct Case {
    std::string content, warning;
  };
  const std::vector<Case> cases = {
      {gazebo("scan_link", sensor("multicamera", "m", kCamera)), "sensor of type \"multicamera\" is not taken over"},
      {gazebo("nowhere", sensor("ray", "s", kScan)), "is a sensor of the link \"nowhere\", which is not there"},
      {gazebo("scan_link", sensor("ray", "s", "<ray/>" + plugin("laser", "<topicName>two words</topicName>"))),
       "a topic that ROS 2 does not take"},
      {gazebo("scan_link", sensor("ray", "s", kScan + plugin("laser", "<frameName>base</frameName>"))),
       "a frame of a sensor that is another link"},
      {gazebo("scan_link", sensor("camera", "c", kCamera + "<plugin name='x' filename='libown.so'/>")),
       "element <plugin> is not taken over"},
      {gazebo("scan_link", sensor("camera", "c", "<camera><horizontal_fov>9</horizontal_fov></camera>")),
       "the sensor is left out"},
      {gazebo("scan_link", sensor("imu", "i",
                                  "<imu><angular_velocity><x><noise type='gaussian'><stddev>-1</stddev>"
                                  "</noise></x></angular_velocity></imu>")),
       "the sensor is left out"}};
  for (const Case& each : cases) {
    CAPTURE(each.content);
    UrdfScene scene(kLinks + each.content + gazebo("base", sensor("imu", "other", "")));
    REQUIRE(scene.warnings().size() == 1);
    CHECK(contains(scene.warnings()[0], each.warning));
    CHECK(attribute_of(scene, "other", "type") == "imu");
  }
  // Two sensors cannot have one topic.
  const std::string same = kScan + plugin("laser", "<topicName>scan</topicName>");
  UrdfScene twice(kLinks + gazebo("base", sensor("ray", "a", same)) + gazebo("scan_link", sensor("ray", "b", same)));
  REQUIRE(twice.warnings().size() == 1);
  CHECK(attribute_of(twice, "a", "topics") == "scan:=/scan");
  CHECK(attribute_of(twice, "b", "topics").empty());
}

TEST_CASE("a scan has the topic and the frame of its file, and two robots of one file have their own") {
  const TemporaryFolder folder;
  write_text(folder / "r.urdf",
             robot(kLinks + gazebo("scan_link", sensor("ray", "lidar",
                                                       kScan + plugin("laser",
                                                                      "<topicName>scan</topicName>"
                                                                      "<frameName>scan_link</frameName>")))));
  write_text(
      folder / "s.xml",
      "<simvis><part name='WALL' insert_at='ROOT' shape='box' size='0.2 4 4' pose_offset='3 0 0 0 0 0'/>"
      "<part file='r.urdf' name='ONE' insert_at='ROOT'/><part file='r.urdf' name='TWO' insert_at='ROOT'/></simvis>");
  Simulation simulation = Simulation::load(folder / "s.xml");
  simulation.record({.file = folder / "run.mcap"});
  simulation.step();
  simulation.finish_recording();
  const auto file = ros::test::McapReader::read(read_text(folder / "run.mcap"));
  const auto one = file.all<ros::LaserScan>("/ONE/scan"), two = file.all<ros::LaserScan>("/TWO/scan");
  REQUIRE(one.size() == 1);
  REQUIRE(two.size() == 1);
  CHECK(one[0].header.frame_id == "ONE/scan_link");
  CHECK(two[0].header.frame_id == "TWO/scan_link");
  CHECK(one[0].ranges.size() == 7);
  // No frame is its own parent, and none has two.
  std::vector<std::string> children;
  for (const ros::TFMessage& message : file.all<ros::TFMessage>("/tf_static")) {
    for (const ros::TransformStamped& each : message.transforms) {
      CHECK(each.header.frame_id != each.child_frame_id);
      children.push_back(each.child_frame_id);
    }
  }
  std::ranges::sort(children);
  CHECK(std::ranges::adjacent_find(children) == children.end());
  CHECK(std::ranges::count(children, "ONE/scan_link") == 1);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
