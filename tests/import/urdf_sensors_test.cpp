// Sensors in the <gazebo> blocks of URDF and xacro files: what they become, their topics and frames.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <simvis/attributes.h>
#include <simvis/simulation.h>
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "simvis/ros/frame_tree.h"
#include "simvis/ros/sensor_topics.h"
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

/// A plug-in of the robot that is a sensor of scan_link by itself.
std::string own_plugin(const std::string& file, const std::string& content) {
  return "<gazebo><plugin name=\"p\" filename=\"" + file + "\"><bodyName>scan_link</bodyName>" + content +
         "</plugin></gazebo>";
}

/// An attribute of a sensor as written; empty: it has none.
std::string attribute_of(const BuiltScene& scene, const std::string& name, const std::string& attribute) {
  for (const BuiltSensor& each : scene.sensors) {
    if (each.name != name) continue;
    const CommandAttribute* const found = each.command.find(attribute);
    return found == nullptr ? "" : found->value;
  }
  FAIL("there is no sensor " << name);
  return "";
}
std::string attribute_of(UrdfScene& scene, const std::string& name, const std::string& attribute) {
  return attribute_of(scene.built(), name, attribute);
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
       "camera_info:=/bot/cam/camera_info image_raw:=/bot/picture", ""},
      {"depth_camera", plugin("camera", "<ros/><camera_name>cam</camera_name>"),
       "image_raw:=/cam/image_raw camera_info:=/cam/camera_info depth/image_raw:=/cam/depth/image_raw "
       "depth/camera_info:=/cam/depth/camera_info",
       ""},
      {"segmentation", plugin("camera", "<cameraName>cam</cameraName><imageTopicName>rgb</imageTopicName>"), "", ""},
      // Topics that the sensor has by its name, and others below it.
      {"camera", plugin("camera", "<ros/>"), "", ""},
      {"camera", plugin("camera", "<cameraName>own</cameraName><imageTopicName>rgb/image</imageTopicName>"),
       "image_raw:=/own/rgb/image", ""},
      {"depth", plugin("camera", "<ros><remapping>own/points:=own/points</remapping></ros>"), "points:=/own/points",
       ""},
      {"lidar", "<topic>own</topic>", "scan:=/own points:=/own/points", ""},
      // gz-sim
      {"lidar", "<topic>lidar</topic><gz_frame_id>lidar_frame</gz_frame_id>", "scan:=/lidar points:=/lidar/points",
       "lidar_frame"},
      {"camera", "<topic>front</topic>", "image_raw:=/front", ""},
      {"depth_camera", "<topic>front</topic>", "depth/image_raw:=/front", ""},
      {"rgbd_camera", "<topic>front</topic>",
       "image_raw:=/front/image depth/image_raw:=/front/depth_image points:=/front/points", ""},
      {"segmentation", "<topic>front</topic>", "", ""}};
  for (const Case& each : cases) {
    CAPTURE(each.plugin);
    const std::string content = each.type == "ray" || each.type == "lidar" ? kScan : kCamera;
    UrdfScene scene(kLinks + gazebo("scan_link", sensor(each.type, "own", content + each.plugin)));
    CHECK(scene.warnings().empty());
    CHECK(attribute_of(scene, "own", "topics") == each.topics);
    CHECK(attribute_of(scene, "own", "frame") == each.frame);
    CHECK_NOTHROW(check_topics(scene.built(), "/simvis"));
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
       "the sensor is left out"},
      // Values that the sensor's type does not take.
      {own_plugin("libhector_gazebo_ros_gps.so", "<referenceLatitude>91</referenceLatitude>"),
       "\"latitude\": 91 is not allowed"},
      {own_plugin("libgazebo_ros_imu.so", "<accelGaussianNoise>-1</accelGaussianNoise>"), "\"p\" is left out"},
      {own_plugin("libgazebo_ros_imu.so", "<updateRate>inf</updateRate>"), "\"p\" is left out"},
      // What would stand elsewhere.
      {own_plugin("libgazebo_ros_imu.so", "<xyzOffset>0 0 1</xyzOffset>"), "moves the sensor"},
      {gazebo("scan_link", sensor("imu", "i", "<pose relative_to='base'>0 0 0 0 0 0</pose>")),
       "has a <pose> relative to \"base\""},
      // What has no counterpart.
      {own_plugin("libgazebo_ros_imu.so", "<referenceLatitude>4</referenceLatitude>"),
       "element <referenceLatitude> of a plug-in is not taken over"},
      {own_plugin("libhector_gazebo_ros_gps.so", "<velocityTopicName>v</velocityTopicName>"),
       "element <velocityTopicName> of a plug-in is not taken over"},
      {gazebo("scan_link",
              sensor("camera", "c", kCamera + plugin("camera", "<ros><remapping>two words:=/a</remapping></ros>"))),
       "a <remapping> of a message that the sensor does not send"},
      {gazebo("scan_link",
              sensor("camera", "c", kCamera + plugin("camera", "<ros><remapping>*:=/a</remapping></ros>"))),
       "a <remapping> of a message that the sensor does not send"},
      {gazebo("scan_link",
              sensor("camera", "c", kCamera + plugin("camera", "<ros><remapping>c/points:=/a</remapping></ros>"))),
       "a <remapping> of a message that the sensor does not send"},
      {gazebo("scan_link", sensor("camera", "c",
                                  kCamera + plugin("camera",
                                                   "<cameraName>x</cameraName>"
                                                   "<frameName>camera_optical_frame</frameName>"))),
       "an optical frame of a camera"},
      // Names of others.
      {gazebo("scan_link", sensor("ray", "s", kScan + plugin("laser", "<topicName>other/scan</topicName>"))),
       "the topic \"/other/scan\" of the sensor \"s\" belongs to another"},
      {gazebo("scan_link", sensor("ray", "s", kScan + plugin("laser", "<topicName>/tf</topicName>"))),
       "the topic \"/tf\" of the sensor \"s\" belongs to the simulation"},
      {gazebo("scan_link", sensor("ray", "s", kScan + plugin("laser", "<topicName>/robot_description</topicName>"))),
       "the topic \"/robot_description\" of the sensor \"s\" belongs to the simulation"},
      {gazebo("scan_link", sensor("ray", "s", kScan + plugin("laser", "<topicName>/simvis/scan</topicName>"))),
       "the topic \"/simvis/scan\" of the sensor \"s\" belongs to the simulation"},
      {gazebo("scan_link", sensor("ray", "s", kScan + plugin("laser", "<frameName>other</frameName>"))),
       "the frame \"other\" of the sensor \"s\" belongs to another"},
      {gazebo("scan_link", sensor("ray", "s", kScan + plugin("laser", "<frameName>ROBOT</frameName>"))),
       "the frame \"ROBOT\" of the sensor \"s\" belongs to another"}};
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

TEST_CASE("a frame that a sensor of another file has, or one of its views, is left out with a warning") {
  const TemporaryFolder folder;
  const auto write = [&](const std::string& file, const std::string& name, const std::string& type,
                         const std::string& frame) {
    const std::string own = "<frameName>" + frame + "</frameName>";
    const std::string content = type == "camera" ? kCamera + plugin("camera", own) : kScan + plugin("laser", own);
    write_text(folder / file, robot(link_xml(name + "_link") + gazebo(name + "_link", sensor(type, name, content))));
  };
  struct Case {
    std::string first, first_frame, second, second_frame, kept;
  };
  const std::vector<Case> cases = {{"camera", "eye", "camera", "eye", ""},
                                   {"ray", "eye", "ray", "eye", ""},
                                   {"camera", "eye", "ray", "eye_optical", ""},
                                   {"ray", "eye_optical", "camera", "eye", ""},
                                   {"ray", "eye", "ray", "eye_optical", "eye_optical"},
                                   {"ray", "ear", "camera", "eye", "eye"}};
  for (const Case& each : cases) {
    CAPTURE(each.first);
    CAPTURE(each.first_frame);
    CAPTURE(each.second);
    CAPTURE(each.second_frame);
    write("a.urdf", "one", each.first, each.first_frame);
    write("b.urdf", "two", each.second, each.second_frame);
    const BuiltScene scene = build_scene(
        parse_commands("<part file='a.urdf' name='A' insert_at='ROOT'/><part file='b.urdf' name='B' insert_at='ROOT'/>",
                       "s.xml", folder.path()));
    CHECK_NOTHROW(FrameTree().follow(scene));
    CHECK(attribute_of(scene, "two", "frame") == each.kept);
    REQUIRE(scene.scene.warnings().size() == (each.kept.empty() ? 1 : 0));
    if (each.kept.empty()) {
      CHECK(
          contains(scene.scene.warnings()[0], "the frame " + in_quotes(each.second_frame) + " of the sensor \"two\""));
    }
  }
  // Two sensors may share the frame of their link, but not that of their images.
  const std::string own = "<frameName>scan_link</frameName>";
  for (const bool are_cameras : {false, true}) {
    CAPTURE(are_cameras);
    UrdfScene scene(kLinks + gazebo("scan_link", sensor("camera", "a", kCamera + plugin("camera", own))) +
                    gazebo("scan_link", are_cameras ? sensor("camera", "b", kCamera + plugin("camera", own))
                                                    : sensor("ray", "b", kScan + plugin("laser", own))));
    CHECK_NOTHROW(FrameTree().follow(scene.built()));
    CHECK(attribute_of(scene, "a", "frame") == "scan_link");
    CHECK(attribute_of(scene, "b", "frame") == (are_cameras ? "" : "scan_link"));
    CHECK(scene.warnings().size() == (are_cameras ? 1 : 0));
  }
}

TEST_CASE("names of sensors have no control characters and are not blank") {
  UrdfScene scene(kLinks + gazebo("scan_link", sensor("imu", "a&#127;b.c", "") + sensor("imu", "/ /", "") +
                                                   sensor("imu", "//", "")));
  std::vector<std::string> names;
  for (const BuiltSensor& each : scene.built().sensors) names.push_back(each.name);
  CHECK(names == std::vector<std::string>{"a_b_c", "sensor", "sensor_2"});
}

TEST_CASE("a magnetometer of hector_gazebo_plugins has the field of its declination and inclination") {
  UrdfScene scene(kLinks + own_plugin("libhector_gazebo_ros_magnetic.so",
                                      "<referenceHeading>90</referenceHeading><declination>0</declination>"
                                      "<inclination>30</inclination><magnitude>2</magnitude>"));
  CHECK(scene.warnings().empty());
  const std::string field = attribute_of(scene, "p", "field");
  std::array<double, 3> values{};
  REQUIRE(parse_numbers(field, values));
  constexpr double kRounding = 1e-15;  // some operations in double on numbers up to 2
  CHECK(std::abs(values[0]) <= kRounding);
  CHECK(std::abs(values[1] - std::sqrt(3.0)) <= kRounding);  // 2 cos 30
  CHECK(std::abs(values[2] + 1) <= kRounding);               // -2 sin 30
}

TEST_CASE("an IMU of a file gives its orientation unless the file says no") {
  for (const bool is_on : {true, false}) {
    CAPTURE(is_on);
    const std::string content = is_on ? "" : "<imu><enable_orientation>false</enable_orientation></imu>";
    UrdfScene scene(kLinks + gazebo("scan_link", sensor("imu", "i", content)));
    CHECK(attribute_of(scene, "i", "orientation") == (is_on ? "on" : ""));
  }
}

TEST_CASE("a scene's own sensor takes the place of one that the file declares under its name") {
  const std::string own = "<sensor type='imu' name='lidar' insert_at='scan_link'/>";
  UrdfScene after(kLinks + gazebo("scan_link", sensor("ray", "lidar", kScan)), own);
  REQUIRE(after.built().sensors.size() == 1);
  CHECK(attribute_of(after, "lidar", "type") == "imu");
  REQUIRE(after.warnings().size() == 1);
  CHECK(contains(after.warnings()[0], "the scene has a sensor \"lidar\" of its own; the file's is left out"));
  // In front of the part too, which keeps its names.
  const TemporaryFolder folder;
  write_text(folder / "r.urdf", robot(kLinks + gazebo("scan_link", sensor("ray", "lidar", kScan))));
  const BuiltScene before = build_scene(parse_commands(
      "<sensor type='imu' name='lidar' insert_at='ROOT'/><part file='r.urdf' name='R' insert_at='ROOT'/>", "s.xml",
      folder.path()));
  CHECK(before.sensors.size() == 1);
  CHECK(before.scene.has_insertion_point("scan_link"));
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
