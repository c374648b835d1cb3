// The frames of ROS 2: names, parents, what can move, and the transform of an odometry.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <set>

#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "exchange/messages/from_pose.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/marker_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/std_types.h"
#include "simvis/message_tap.h"
#include "tests/messages/mcap_file.h"
#include "tests/messages/tf_listener.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/arm_urdf.h"
#include "tests/support/simvis_run.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

using ros::test::McapFile;
using ros::test::McapReader;
using Listener = ros::test::TfListener;

// A cart with a turret on it, a camera on the turret and a scanner on the cart; a post that nothing moves.
constexpr std::string_view kCart = R"(
<part name="CART" insert_at="ROOT"/>
<element type="pose" name="MOVE" insert_at="CART"/>
<part name="TURRET" insert_at="CART" pose_offset="0 0 0.5 0 0 0"/>
<element type="joint" name="TURN" insert_at="TURRET" axis="0 0 1" lower="-90" upper="90"/>
<part name="POST" insert_at="ROOT" pose_offset="-1 2 0 0 0 30"/>
<part name="MAST" insert_at="CART" pose_offset="-0.2 0 1 0 0 0"/>
<sensor type="camera" name="CAM" insert_at="TURRET" width="8" height="6" outputs="color depth" pose_offset="0.1 0 0 0 10 0"/>
<sensor type="laser_scanner" name="SCAN" insert_at="CART" samples="5" pose_offset="0.3 0 0.2 0 0 0"/>
<sensor type="imu" name="IMU" insert_at="MAST"/>
<sensor type="psd" name="IR" insert_at="POST"/>)";

struct RecordedCart {
  explicit RecordedCart(const std::string& more = "")
      : simulation(Simulation::load(write_wall_scene(folder.path(), std::string(kCart) + more))) {}
  McapFile drive(int frames = 3) {
    simulation.record({.file = folder / "run.mcap"});
    for (int i = 0; i < frames; ++i) {
      simulation.set("MOVE", "x", 0.1 * i);
      simulation.set("MOVE", "yaw", 5.0 * i);
      simulation.set("TURN", "value", 10.0 * i);
      simulation.step();
      glm::dmat4& pose = camera_poses.emplace_back();
      simulation.sensor_pose("CAM", pose);
    }
    simulation.finish_recording();
    return McapReader::read(read_text(folder / "run.mcap"));
  }
  TemporaryFolder folder;
  Simulation simulation;
  std::vector<glm::dmat4> camera_poses;
};

// A model with two links on a cart, and a box that is hidden.
constexpr const char* kObjectsSdf =
    "<sdf version='1.9'><model name='arm'><link name='base'><visual name='v'><geometry><box><size>0.4 0.2 0.1</size>"
    "</box></geometry></visual></link><link name='hand'><pose>1 0 0.5 0 0 0</pose><visual "
    "name='v'><geometry><box><size>"
    "0.1 0.1 0.1</size></box></geometry></visual><visual name='w'><pose>0.2 0 0 0 0 0</pose><geometry><box><size>0.1 "
    "0.3"
    " 0.1</size></box></geometry></visual></link></model></sdf>";
constexpr const char* kObjects = R"(<simvis>
<part name="CART" insert_at="ROOT"/>
<element type="pose" name="MOVE" insert_at="CART"/>
<part name="ARM" insert_at="CART" file="arm.sdf" pose_offset="0 0 1 0 0 0"/>
<part name="HIDDEN" insert_at="ROOT"/>
<element type="visibility" name="OFF" insert_at="HIDDEN" visible="0"/>
<part name="GHOST" insert_at="HIDDEN" shape="box" size="1 1 1"/>
<element type="label" name="L" insert_at="hand" class="gripper" class_id="2"/>
<element type="frame" name="F" insert_at="ROOT" frame="earth"/>
</simvis>)";

/// The frame_id of a message whose first field is a header; empty for others.
std::string frame_id_of(const McapFile& file, const ros::test::McapMessage& message) {
  if (!file.schemas.at(message.type).starts_with("std_msgs/Header header")) return "";
  constexpr std::size_t kStart = 4 + 8;  // encapsulation, stamp
  std::uint32_t size = 0;
  std::memcpy(&size, message.bytes.data() + kStart, sizeof size);
  return message.bytes.substr(kStart + sizeof size, size - 1);
}

// Poses are products of a few rigid matrices in metres, and quaternions of them.
constexpr double kPoseRounding = 1e-12;

void check_near(const glm::dmat4& a, const glm::dmat4& b) {
  for (int c = 0; c < 4; ++c) CHECK(glm::distance(a[c], b[c]) < kPoseRounding);
}

TEST_CASE("objects are boxes whose namespaces are their paths, where they stand in each frame") {
  const TemporaryFolder folder;
  write_text(folder / "arm.sdf", kObjectsSdf);
  write_text(folder / "scene.xml", kObjects);
  Simulation simulation = Simulation::load(folder / "scene.xml");
  simulation.record({.file = folder / "run.mcap", .topics = {"/simvis/objects", "/clock"}});
  for (int i = 0; i < 2; ++i) {
    simulation.set("MOVE", "x", 3.0 * i);
    simulation.step();
  }
  simulation.finish_recording();
  const McapFile file = McapReader::read(read_text(folder / "run.mcap"));
  const auto arrays = file.all<ros::MarkerArray>("/simvis/objects");
  REQUIRE(arrays.size() == 2);
  std::map<std::string, std::uint32_t> ids;
  for (const SceneObject& object : simulation.objects()) ids[object.path] = object.instance;
  for (std::size_t i = 0; i < 2; ++i) {
    const std::vector<ros::Marker>& markers = arrays[i].markers;
    REQUIRE(markers.size() == 3);
    CHECK(markers[0].action == ros::Marker::kDeleteAll);
    for (const ros::Marker& marker : markers) CHECK(marker.header.frame_id == "earth");
    const auto [base, hand] = std::pair(markers[1], markers[2]);
    CHECK(base.ns == "CART/ARM/base");
    CHECK(hand.ns == "CART/ARM/hand");
    CHECK(base.text == "link");
    CHECK(hand.text == "link of class gripper");
    CHECK(static_cast<std::uint32_t>(hand.id) == ids.at("CART/ARM/hand"));
    const double x = 3.0 * static_cast<double>(i);
    CHECK(base.pose.position.x == doctest::Approx(x));
    CHECK(base.pose.position.z == doctest::Approx(1));
    CHECK(base.scale.x == doctest::Approx(0.4));
    CHECK(hand.pose.position.x == doctest::Approx(x + 1.1));
    CHECK(hand.pose.position.z == doctest::Approx(1.5));
    CHECK(hand.scale.x == doctest::Approx(0.3));
    CHECK(hand.scale.y == doctest::Approx(0.3));
  }
  // Without its name in the topics, a recording has none.
  simulation.record({.file = folder / "other.mcap"});
  simulation.step();
  simulation.finish_recording();
  CHECK(McapReader::read(read_text(folder / "other.mcap")).counts().count("/simvis/objects") == 0);
}

TEST_CASE("nested frames keep their parent, and what nothing moves is in /tf_static from the start") {
  RecordedCart cart;
  const McapFile file = cart.drive();
  CHECK(file.all<ros::TFMessage>("/tf_static").size() == 1);
  Listener listener(file);
  const auto moving = file.all<ros::TFMessage>("/tf");
  REQUIRE(moving.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    listener.add(moving[i]);
    check_near(listener.find("map", "CAM").value(), cart.camera_poses[i]);
  }
  CHECK(listener.parent("TURRET") == "CART");
  CHECK(listener.parent("MAST") == "CART");
  CHECK(listener.parent("CART") == "map");
  CHECK(listener.moving() == std::set<std::string>{"CART", "TURRET"});
  CHECK(listener.fixed() == std::set<std::string>{"CAM", "CAM_optical", "IMU", "IR", "MAST", "POST", "SCAN"});
}

TEST_CASE("a sensor whose measurements are late stands still on the part that carries it") {
  // It measures in every second frame, and its measurements arrive in the frames between.
  RecordedCart cart(
      "<sensor type='imu' name='LATE' insert_at='CART' rate='7.5' delay='0.05' pose_offset='0.3 0 0.2 0 0 0'/>");
  const McapFile file = cart.drive(6);
  Listener listener(file);
  for (const ros::TFMessage& each : file.all<ros::TFMessage>("/tf")) listener.add(each);
  CHECK(listener.fixed().contains("LATE"));
  CHECK_FALSE(listener.moving().contains("LATE"));
}

TEST_CASE("every frame_id is reachable from the world") {
  RecordedCart cart(R"(<sensor type="odometry" name="ODOM" insert_at="CART" tf="map"/>)");
  const McapFile file = cart.drive();
  Listener listener(file);
  for (const auto& each : file.all<ros::TFMessage>("/tf")) listener.add(each);
  std::set<std::string> frames;
  for (const ros::test::McapMessage& message : file.messages) frames.insert(frame_id_of(file, message));
  frames.erase("");  // without a header, or of the whole simulation
  CHECK(frames.contains("odom"));
  CHECK(frames.size() > 6);
  for (const std::string& frame : frames) {
    CAPTURE(frame);
    CHECK(listener.find("map", frame));
  }
}

TEST_CASE("frames and topics have the names that the scene gives them") {
  RecordedCart cart(R"(
    <element type="frame" name="WORLD" insert_at="ROOT" frame="world"/>
    <element type="frame" name="BASE" insert_at="CART" frame="base_link"/>
    <sensor type="laser_scanner" name="L" insert_at="CART" samples="5" frame="laser" topics="scan:=/scan *:=/front"/>
    <sensor type="odometry" name="O" insert_at="CART" topics="odometry:=/odom"/>)");
  const McapFile file = cart.drive();
  Listener listener(file);
  for (const auto& each : file.all<ros::TFMessage>("/tf")) listener.add(each);
  CHECK(listener.parent("base_link") == "world");
  CHECK(listener.parent("TURRET") == "base_link");
  CHECK(listener.parent("laser") == "base_link");
  REQUIRE(file.all<ros::LaserScan>("/scan").size() == 3);
  CHECK(file.all<ros::LaserScan>("/scan")[0].header.frame_id == "laser");
  CHECK(file.all<ros::PoseStamped>("/front/pose")[0].header.frame_id == "world");
  CHECK(file.counts().count("/L/pose") == 0);
  CHECK(file.all<ros::Odometry>("/odom")[1].child_frame_id == "base_link");
  CHECK(file.all<ros::Odometry>("/CART/odom")[0].child_frame_id == "base_link");
  CHECK(file.all<ros::Odometry>("/CART/odom")[0].header.frame_id == "world");
}

TEST_CASE("names that are taken, and that are none, are refused") {
  const auto refused = [](const std::string& more) { return error_of([&] { RecordedCart(more).drive(1); }); };
  CHECK(contains(refused(R"(<element type="frame" name="A" insert_at="CART" frame="POST"/>)"),
                 "would have the same frame \"POST\""));
  CHECK(contains(refused(R"(<element type="frame" name="A" insert_at="CART" frame="a"/>
                            <element type="frame" name="B" insert_at="CART" frame="b"/>)"),
                 "has two elements of type \"frame\""));
  CHECK(contains(refused(R"(<element type="frame" name="A" insert_at="CART" frame="/base_link"/>)"),
                 "expected a name without spaces and without '/' in front"));
  const auto sensor = [&](const std::string& attributes) {
    return refused("<sensor type=\"psd\" name=\"P\" insert_at=\"CART\" " + attributes + "/>");
  };
  CHECK(contains(sensor("frame=\"two words\""), "\"two words\" is not allowed"));
  CHECK(contains(sensor("frame=\"CAM\""), "would have the same frame \"CAM\""));
  CHECK(contains(sensor("topics=\"range\""), "\"range\" is not allowed, expected WHAT:=/TOPIC"));
  CHECK(contains(sensor("topics=\"range:=front\""), "expected WHAT:=/TOPIC"));
  CHECK(contains(sensor("topics=\"range:=/a range:=/b\""), "comes twice"));
  CHECK(contains(sensor("topics=\"range:=/tf\""), "belongs to the simulation"));
  CHECK(contains(sensor("topics=\"range:=/CAM/image_raw\""), "belongs to the sensor \"CAM\""));
  CHECK(contains(sensor("topics=\"range:=/CART/odom\""), "belongs to the part \"CART\""));
  CHECK(contains(sensor("topics=\"*:=/CAM\""), "would have the same topics"));
  CHECK(contains(refused(R"(<sensor type="odometry" name="O" insert_at="CART" tf="odom"/>
                            <sensor type="odometry" name="P" insert_at="CART" tf="odom" odom_frame="o2"/>)"),
                 "both give the transform of the frame \"CART\""));
  CHECK(contains(refused(R"(<sensor type="odometry" name="O" insert_at="ROOT" tf="odom"/>)"), "expected a part"));
}

TEST_CASE("an odometry gives odom -> part as it measures it, and map -> odom on request") {
  constexpr std::string_view kOdometry =
      R"(<sensor type="odometry" name="ODOM" insert_at="CART" kind="wheel" left_scale_error="0.1" tf="@"/>)";
  for (const std::string tf : {"odom", "map", "none"}) {
    CAPTURE(tf);
    std::string more(kOdometry);
    more.replace(more.find('@'), 1, tf);
    RecordedCart cart(more);
    const McapFile file = cart.drive();
    Listener listener(file);
    const auto moving = file.all<ros::TFMessage>("/tf");
    const auto measured = file.all<ros::Odometry>("/ODOM/odometry");
    REQUIRE(moving.size() == 3);
    REQUIRE(measured.size() == 3);
    for (std::size_t i = 0; i < 3; ++i) {
      listener.add(moving[i]);
      CHECK(measured[i].header.frame_id == "odom");
      CHECK(measured[i].child_frame_id == "CART");
      if (tf == "none") {
        CHECK(listener.parent("CART") == "map");
        continue;
      }
      CHECK(listener.parent("CART") == "odom");
      const glm::dmat4 odom_from_cart = listener.find("odom", "CART").value();
      CHECK(odom_from_cart[3].x == measured[i].pose.pose.position.x);
      CHECK(odom_from_cart[3].y == measured[i].pose.pose.position.y);
      CHECK(listener.find("map", "CART").has_value() == (tf == "map"));
      if (tf == "map") check_near(listener.find("map", "CAM").value(), cart.camera_poses[i]);
    }
  }
}

TEST_CASE("an odometry that stands beside the part's origin speaks of the part") {
  // The sensor stands 1 m ahead of the part, turned by 90 degrees; the part turns about its own origin.
  RecordedCart cart(
      R"(<sensor type="odometry" name="ODOM" insert_at="CART" pose_offset="1 0 0 0 0 90" topics="odometry:=/odom"/>)");
  cart.simulation.record({.file = cart.folder / "run.mcap", .topics = {"/odom"}});
  constexpr double kTurn_deg = 3;
  for (int i = 0; i < 3; ++i) {
    cart.simulation.set("MOVE", "yaw", kTurn_deg * i);
    cart.simulation.step();
  }
  cart.simulation.finish_recording();
  const auto odometry = McapReader::read(read_text(cart.folder / "run.mcap")).all<ros::Odometry>("/odom");
  REQUIRE(odometry.size() == 3);
  // The part turns where it stands: without a speed of its own, and with the pose of a point at rest in odom.
  const double rate_rad_s = glm::radians(kTurn_deg) * 15;  // of frames
  for (std::size_t i = 1; i < 3; ++i) {
    CHECK(std::abs(odometry[i].twist.twist.linear.x) < kPoseRounding * 15);
    CHECK(std::abs(odometry[i].twist.twist.linear.y) < kPoseRounding * 15);
    CHECK(std::abs(odometry[i].twist.twist.angular.z - rate_rad_s) <
          rate_rad_s * 15e-9);  // times are whole nanoseconds
    CHECK(std::abs(odometry[i].pose.pose.position.x - odometry[0].pose.pose.position.x) < kPoseRounding);
    CHECK(std::abs(odometry[i].pose.pose.position.y - odometry[0].pose.pose.position.y) < kPoseRounding);
  }
}

TEST_CASE("covariances of an odometry are carried to another frame of the body") {
  ros::Odometry own;
  own.pose.pose.orientation.w = 1;
  own.pose.covariance[35] = own.twist.covariance[35] = 0.04;  // of the heading, and of the turn rate
  glm::dmat4 body_from_own(1);
  body_from_own[3] = {2, 0, 0, 1};
  const ros::Odometry body = ros::of_body(own, body_from_own, "base_link");
  CHECK(body.child_frame_id == "base_link");
  CHECK(body.pose.pose.position.x == -2);
  // The body's origin is 2 m behind: a turn by d moves it by -2 d to the left, and turns it at rate d by the same.
  constexpr double kRounding = 1e-15;
  CHECK(std::abs(body.pose.covariance[7] - 4 * 0.04) < kRounding);
  CHECK(std::abs(body.pose.covariance[11] + 2 * 0.04) < kRounding);
  CHECK(std::abs(body.twist.covariance[7] - 4 * 0.04) < kRounding);
  CHECK(std::abs(body.twist.covariance[11] + 2 * 0.04) < kRounding);
  CHECK(body.twist.covariance[35] == 0.04);
  CHECK(body.pose.covariance[0] == 0);
}

TEST_CASE("what wheels do not measure is not carried over a lever arm") {
  constexpr double kMeasured = 1e-4;
  ros::Odometry own;
  own.pose.pose.orientation.w = 1;
  for (const std::size_t i : {2, 3, 4}) own.pose.covariance[i * 7] = ros::kUnmeasured;
  for (const std::size_t i : {0, 1, 5}) own.pose.covariance[i * 7] = kMeasured;
  for (const std::size_t i : {1, 2, 3, 4}) own.twist.covariance[i * 7] = ros::kUnmeasured;
  for (const std::size_t i : {0, 5}) own.twist.covariance[i * 7] = kMeasured;
  glm::dmat4 body_from_own(1);
  body_from_own[3] = {0, 0, 0.2, 1};  // straight above: nothing of what is measured changes
  const ros::Odometry above = ros::of_body(own, body_from_own, "base_link");
  CHECK(above.twist.covariance == own.twist.covariance);
  CHECK(above.pose.covariance == own.pose.covariance);
  body_from_own = glm::rotate(body_from_own, glm::radians(90.0), glm::dvec3(0, 0, 1));
  const ros::Odometry turned = ros::of_body(own, body_from_own, "base_link");
  // Sideways of the body is what the wheels count. The sine of a right angle is exact, the cosine within 1e-16.
  constexpr double kRounding = 1e-9;  // of 1e6
  CHECK(std::abs(turned.twist.covariance[7] - kMeasured) < kRounding);
  CHECK(std::abs(turned.twist.covariance[0] - ros::kUnmeasured) < kRounding);
  CHECK(turned.twist.covariance[35] == kMeasured);
}

TEST_CASE("an odometry that is off leaves the part in the tree") {
  RecordedCart cart(R"(<sensor type="odometry" name="ODOM" insert_at="CART" tf="odom"/>)");
  cart.simulation.enable("ODOM", false);
  const McapFile file = cart.drive();
  Listener listener(file);
  for (const auto& each : file.all<ros::TFMessage>("/tf")) listener.add(each);
  CHECK(listener.parent("CART") == "map");
  check_near(listener.find("map", "CAM").value(), cart.camera_poses.back());
}

TEST_CASE("commands after which frames have no messages are refused, and a recording goes on") {
  RecordedCart cart(R"(<sensor type="odometry" name="ODOM" insert_at="CART" tf="odom"/>)");
  Simulation& simulation = cart.simulation;
  simulation.record({.file = cart.folder / "run.mcap"});
  simulation.step();
  const std::size_t changes = simulation.parameters().changes().size();
  const auto refused = [&](const std::string& commands) {
    const std::string why = error_of([&] { simulation.execute(commands); });
    simulation.step();
    CHECK(simulation.parameters().changes().size() == changes);
    return why;
  };
  CHECK(contains(refused(R"(<sensor type="psd" name="P" insert_at="ROOT" frame="map"/>)"), "same frame \"map\""));
  CHECK(contains(refused(R"(<element type="frame" name="A" insert_at="CART" frame="a"/>
                            <element type="frame" name="B" insert_at="CART" frame="b"/>)"),
                 "has two elements of type \"frame\""));
  CHECK(contains(refused(R"(<sensor type="odometry" name="O" insert_at="CART" tf="odom" odom_frame="o"/>)"),
                 "both give the transform"));
  CHECK(contains(refused(R"(<sensor type="psd" name="P" insert_at="CART" topics="range:=/tf"/>)"),
                 "belongs to the simulation"));
  // What follows takes the names that were given back.
  simulation.execute(R"(<sensor type="psd" name="P" insert_at="CART"/>)");
  simulation.step();
  simulation.finish_recording();
  const McapFile file = McapReader::read(read_text(cart.folder / "run.mcap"));
  CHECK(file.counts().at("/clock") == 6);
  CHECK(file.counts().at("/P/range") == 1);
  // Without messages, names of messages do not matter.
  simulation.execute(R"(<sensor type="psd" name="Q" insert_at="CART" frame="map"/>)");
}

TEST_CASE("topics of descriptions, commands and views that something else has are refused") {
  const auto refused = [](const std::string& more) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "arm.urdf") << test::kArm;
    const std::filesystem::path scene = write_wall_scene(folder.path(), R"(
        <element type="physics" name="PHYSICS" insert_at="ROOT"/>
        <part name="ARM" insert_at="ROOT" file="arm.urdf"/>
        <element type="robot" name="ROBOT" insert_at="ARM"/>
        <sensor type="joint_state" name="JOINTS" insert_at="ARM" topics="joint_states:=/joint_states"/>)" +
                                                                            more);
    Simulation simulation = Simulation::load(scene);
    return error_of([&] { simulation.record({.file = folder / "run.mcap"}); });
  };
  CHECK(refused("") == "nothing was thrown");
  CHECK(contains(refused(R"(<element type="robot_description" name="D" insert_at="ARM"/>
                            <element type="robot_description" name="E" insert_at="ARM"/>)"),
                 R"(the element "E": the topic /robot_description belongs to the element "D")"));
  CHECK(contains(refused(R"(<element type="robot_description" name="D" insert_at="ARM" topic="/tf"/>)"),
                 "belongs to the simulation"));
  const auto command = [&](const std::string& topic) {
    return refused(R"(<element type="joint_command" name="J" insert_at="ARM" robot="ROBOT" topic=")" + topic +
                   R"("/>)");
  };
  CHECK(contains(command("/joint_states"), R"(the topic /joint_states of commands belongs to the sensor "JOINTS")"));
  CHECK(contains(command("/simvis/set"), "belongs to the simulation"));
  CHECK(command("/targets") == "nothing was thrown");
  // All that a sensor sends has its folder, a default topic of commands too, if both have one name.
  CHECK(contains(refused(R"(<sensor type="psd" name="P" insert_at="ARM"/>
                            <element type="joint_command" name="J" insert_at="ARM" robot="ROBOT" topic="/P/range"/>)"),
                 R"(the topic /P/range of commands belongs to the sensor "P")"));
  CHECK(refused(R"(<sensor type="psd" name="P" insert_at="ARM"/>
                   <element type="joint_command" name="P" insert_at="ARM" robot="ROBOT"/>)") == "nothing was thrown");
  CHECK(contains(refused(R"(<sensor type="camera" name="CAM" insert_at="ARM" width="8" height="6"/>
                            <sensor type="psd" name="P" insert_at="ARM" frame="CAM_optical"/>)"),
                 R"(would have the same frame "CAM_optical")"));
  CHECK(contains(refused(R"(<sensor type="stereo_camera" name="EYES" insert_at="ARM" width="8" height="6"/>
                            <sensor type="psd" name="P" insert_at="ARM" frame="EYES_left_optical"/>)"),
                 R"(would have the same frame "EYES_left_optical")"));
}

TEST_CASE("a clash of topics or frames is reported with its place") {
  const auto place_of_error = [](const std::string& more) {
    const TemporaryFolder folder;
    std::ofstream(folder.path() / "arm.urdf") << test::kArm;
    write_text(folder / "scene.xml", R"(<simvis>
<element type="physics" name="PHYSICS" insert_at="ROOT"/>
<part name="ARM" insert_at="ROOT" file="arm.urdf"/>
<element type="robot" name="ROBOT" insert_at="ARM"/>
<sensor type="psd" name="A" insert_at="ARM"/>
)" + more + "</simvis>");
    Simulation simulation = Simulation::load(folder / "scene.xml");
    const std::string error = error_of([&] { simulation.record({.file = folder / "run.mcap"}); });
    const std::size_t name = error.find("scene.xml:");
    return name == error.npos ? error : error.substr(name + 10, error.find(": error: ") - name - 10);
  };
  // Line 6 is the first of `more`; columns are those of the attributes' names.
  CHECK(place_of_error(R"(<sensor type="psd" name="B" topics="range:=/tf" insert_at="ARM"/>)") == "6:29");
  CHECK(place_of_error(R"(<sensor type="psd" name="B" topics="*:=/A" insert_at="ARM"/>)") == "6:29");
  CHECK(place_of_error(R"(<sensor type="psd" name="B" frame="ARM" insert_at="ARM" pose_offset="1 0 0 0 0 0"/>)") ==
        "6:29");
  CHECK(place_of_error(R"(<sensor type="odometry" name="O" insert_at="ROOT" tf="odom"/>)") == "6:51");
  CHECK(place_of_error(R"(<element type="frame" name="F" insert_at="ARM" frame="map"/>)") == "6:48");
  CHECK(place_of_error(R"(<element type="frame" name="F" insert_at="ARM" frame="f"/>
                          <element type="frame" name="G" insert_at="ARM" frame="g"/>)") == "7:74");
  CHECK(place_of_error(R"(<element type="robot_description" name="D" insert_at="ARM" topic="/tf"/>)") == "6:60");
  CHECK(place_of_error(R"(<element type="joint_command" name="J" robot="ROBOT" insert_at="ARM" topic="/tf"/>)") ==
        "6:70");
}

TEST_CASE("a robot's description is latched, and all its links have frames") {
  const TemporaryFolder folder;
  std::ofstream(folder.path() / "arm.urdf") << test::kArm;
  const std::filesystem::path scene = write_wall_scene(folder.path(), R"(
      <part name="ARM" insert_at="ROOT" file="arm.urdf"/>
      <element type="robot_description" name="DESCRIPTION" insert_at="ARM"/>)");
  Simulation simulation = Simulation::load(scene);
  simulation.record({.file = folder / "run.mcap"});
  simulation.step();
  simulation.step();
  simulation.finish_recording();
  const McapFile file = McapReader::read(read_text(folder / "run.mcap"));
  const auto described = file.all<ros::String>("/robot_description");
  REQUIRE(described.size() == 1);
  CHECK(described[0].data == test::kArm);
  Listener listener(file);
  for (const auto& each : file.all<ros::TFMessage>("/tf")) listener.add(each);
  // Fixed joints are fixed, others can move, as robot_state_publisher has it.
  CHECK(listener.moving() == std::set<std::string>{"upper", "lower"});
  CHECK(listener.fixed() == std::set<std::string>{"ARM", "base", "grip"});
  CHECK(listener.parent("lower") == "upper");
  CHECK(listener.parent("base") == "ARM");
  CHECK(listener.find("map", "grip").value()[3] == glm::dvec4(1, 0, 0, 1));
  CHECK(contains(error_of([&] { simulation.execute("<element type='robot_description' name='D' insert_at='WALL'/>"); }),
                 "expected the name of a part from a URDF"));
}

TEST_CASE("the files of a described robot are those that its URDF names for what is seen") {
  const std::string arm = SIMVIS_SOURCE_DIR "/scenes/arm/";
  Simulation simulation =
      Simulation::from_string(R"(<simvis><part name="ARM" insert_at="ROOT" file=")" + arm + R"(arm.urdf"/>
      <part name="OTHER" insert_at="ROOT" file=")" +
                              arm + R"(mug.glb"/></simvis>)");
  CHECK(files_of_robots(simulation).empty());
  simulation.execute("<element type='robot_description' name='D' insert_at='ARM'/>");
  const std::map<std::string, std::filesystem::path> files = files_of_robots(simulation);
  REQUIRE(files.contains("meshes/base.obj"));
  CHECK(std::filesystem::equivalent(files.at("meshes/base.obj"), arm + "meshes/base.obj"));
  for (const auto& [name, file] : files) CHECK(contains(read_text(arm + "arm.urdf"), '"' + name + '"'));
}

TEST_CASE("files of a description that are no meshes, or that its part may not read, are not among those of robots") {
  const TemporaryFolder folder;
  const TemporaryFolder elsewhere;
  const std::string triangle = "v 1 0 0\nv 1 1 0\nv 1 0 1\nf 1 2 3\n";
  write_text(folder / "mesh.obj", triangle);
  write_text(folder / "secret.txt", "secret");
  write_text(elsewhere / "secret.obj", triangle);
  const std::string outside = (elsewhere / "secret.obj").string(), file = (folder / "r.urdf").string();
  std::string visuals;
  for (const std::string& name : {std::string("mesh.obj"), std::string("secret.txt"), outside}) {
    visuals += "<visual><geometry><mesh filename=\"" + name + "\"/></geometry></visual>";
  }
  write_text(file, "<robot name=\"r\"><link name=\"base\">" + visuals + "</link></robot>");
  const Simulation simulation =
      Simulation::from_string("<simvis><part name='R' insert_at='ROOT' missing_visuals='any' file='" + file +
                              "'/><element type='robot_description' name='D' insert_at='R'/></simvis>");
  CHECK(files_of_robots(simulation) == std::map<std::string, std::filesystem::path>{{"mesh.obj", folder / "mesh.obj"}});
}

TEST_CASE("/tf says what the files of poses say") {
  const TemporaryFolder folder;
  const std::filesystem::path scene = write_wall_scene(folder.path(), std::string(kCart));
  write_text(folder / "drive.csv", "time_s,MOVE.x,MOVE.yaw,TURN.value\n0,0,0,0\n1,2,50,40\n");
  const std::filesystem::path file = folder / "run.mcap";
  const ProcessResult run = run_simvis({"--frames", "5", "--trajectory", (folder / "drive.csv").string(), "--out",
                                        (folder / "out").string(), "--record", file.string(), scene.string()});
  REQUIRE_MESSAGE(run.exit_code == 0, run.err);
  const McapFile recorded = McapReader::read(read_text(file));
  const auto moving = recorded.all<ros::TFMessage>("/tf");
  for (const std::string sensor : {"CAM", "SCAN", "IMU", "IR"}) {
    const Table poses = read_csv(folder / "out" / (sensor + "_poses.csv"));
    REQUIRE(poses.rows.size() == 5);
    Listener listener(recorded);
    for (std::size_t i = 0; i < poses.rows.size(); ++i) {
      listener.add(moving.at(i));
      const glm::dmat4 found = listener.find("map", sensor).value();
      const Strings& row = poses.rows[i];
      const auto number = [&](std::size_t column) { return std::stod(row.at(column)); };
      glm::dmat4 pose = glm::mat4_cast(glm::dquat(number(8), number(5), number(6), number(7)));
      pose[3] = glm::dvec4(number(2), number(3), number(4), 1);
      check_near(found, pose);
    }
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
