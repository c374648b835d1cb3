// A recorded simulation: what the messages say is what the API says, to the last bit.
#include <doctest/doctest.h>

#include <cstring>
#include <fstream>

#include <simvis/simulation.h>
#include "exchange/messages/from_scan.h"
#include "exchange/messages/mcap_writer.h"
#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/system_types.h"
#include "scenegraph/pictures/png_file.h"
#include "scenegraph/pose3.h"
#include "simvis/message_tap.h"
#include "tests/messages/mcap_file.h"
#include "tests/support/error_of.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

using ros::test::McapFile;
using ros::test::McapReader;

constexpr std::string_view kRobot = R"(
<part name="ROBOT" insert_at="ROOT"/>
<element type="pose" name="MOVE" insert_at="ROBOT" z="0.5" yaw="10"/>
<sensor type="camera" name="CAM" insert_at="ROBOT" width="16" height="12" outputs="color depth" pose_offset="0 0.1 0 0 5 0"/>
<sensor type="stereo_camera" name="EYES" insert_at="ROBOT" width="16" height="12" outputs="color disparity" baseline="0.2"/>
<sensor type="laser_scanner" name="FRONT" insert_at="ROBOT" samples="5" min_angle="-80" max_angle="80" intensity="on"/>
<sensor type="laser_scanner" name="TOP" insert_at="ROBOT" samples="4" vertical_samples="2" vertical_max_angle="5" rate="5"/>
<sensor type="psd" name="IR" insert_at="ROOT" pose_offset="3.5 0 0 0 0 0"/>)";

SimulationDesc ten_hertz() {
  SimulationDesc desc;
  desc.rate_hz = 10;
  return desc;
}

struct RecordedRobot {
  TemporaryFolder folder;
  std::filesystem::path file = folder / "run.mcap";
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), kRobot), ten_hertz());

  McapFile read() const { return McapReader::read(read_text(file)); }
};

glm::dmat4 matrix_of(const ros::Transform& transform) {
  const ros::Quaternion& q = transform.rotation;
  glm::dmat4 matrix = glm::mat4_cast(glm::dquat(q.w, q.x, q.y, q.z));
  matrix[3] = glm::dvec4(transform.translation.x, transform.translation.y, transform.translation.z, 1);
  return matrix;
}

TEST_CASE("every topic of a robot, and nothing else") {
  RecordedRobot robot;
  robot.simulation.record({.file = robot.file});
  for (int i = 0; i < 3; ++i) robot.simulation.step();
  const RecordReport report = robot.simulation.finish_recording();
  const McapFile file = robot.read();
  CHECK(file.has_end);
  CHECK(report.messages == file.messages.size());
  CHECK(report.dropped == 0);
  CHECK(report.bytes == std::filesystem::file_size(robot.file));
  const std::map<std::string, std::size_t> expected = {{"/clock", 3},
                                                       {"/tf", 3},
                                                       {"/tf_static", 1},
                                                       {"/parameter_events", 1},
                                                       {"/ROBOT/odom", 2},
                                                       {"/ROBOT/path", 1},
                                                       {"/CAM/pose", 3},
                                                       {"/CAM/twist", 2},
                                                       {"/CAM/image_raw", 3},
                                                       {"/CAM/depth/image_raw", 3},
                                                       {"/CAM/depth/camera_info", 3},
                                                       {"/CAM/camera_info", 3},
                                                       {"/EYES/pose", 3},
                                                       {"/EYES/twist", 2},
                                                       {"/EYES/left/image_raw", 3},
                                                       {"/EYES/right/image_raw", 3},
                                                       {"/EYES/left/camera_info", 3},
                                                       {"/EYES/right/camera_info", 3},
                                                       {"/EYES/disparity", 3},
                                                       {"/FRONT/pose", 3},
                                                       {"/FRONT/twist", 2},
                                                       {"/FRONT/scan", 3},
                                                       {"/FRONT/points", 3},
                                                       {"/FRONT/azimuth_rad", 1},
                                                       {"/FRONT/elevation_rad", 1},
                                                       {"/FRONT/azimuth_deg", 1},
                                                       {"/FRONT/elevation_deg", 1},
                                                       {"/TOP/azimuth_rad", 1},
                                                       {"/TOP/elevation_rad", 1},
                                                       {"/TOP/azimuth_deg", 1},
                                                       {"/TOP/elevation_deg", 1},
                                                       {"/TOP/pose", 2},
                                                       {"/TOP/twist", 1},
                                                       {"/TOP/points", 2},
                                                       {"/IR/pose", 3},
                                                       {"/IR/twist", 2},
                                                       {"/IR/range", 3},
                                                       {"/IR/voltage_v", 3}};
  CHECK(file.counts() == expected);
}

TEST_CASE("measurements are those of the API to the bit, with its times") {
  RecordedRobot robot;
  robot.simulation.record({.file = robot.file, .topics = {"/CAM/*", "/EYES/disparity", "/FRONT/*", "/IR/*"}});
  std::vector<Scan> scans;
  std::vector<Image> colors, depths, disparities;
  std::vector<double> ranges, voltages;
  std::vector<glm::dmat4> poses;
  for (int i = 0; i < 3; ++i) {
    robot.simulation.set("MOVE", "x", 0.3 * i);
    robot.simulation.step();
    scans.push_back(robot.simulation.scan("FRONT"));
    colors.push_back(robot.simulation.color("CAM"));
    depths.push_back(robot.simulation.depth("CAM"));
    disparities.push_back(robot.simulation.picture("EYES", "disparity"));
    ranges.push_back(robot.simulation.value("IR", "range_m"));
    voltages.push_back(robot.simulation.value("IR", "voltage_v"));
    robot.simulation.sensor_pose("CAM", poses.emplace_back());
  }
  robot.simulation.finish_recording();
  const McapFile file = robot.read();
  const auto lasers = file.all<ros::LaserScan>("/FRONT/scan");
  const auto clouds = file.all<ros::PointCloud2>("/FRONT/points");
  const auto images = file.all<ros::Image>("/CAM/image_raw"),
             depth_images = file.all<ros::Image>("/CAM/depth/image_raw");
  const auto stereo = file.all<ros::DisparityImage>("/EYES/disparity");
  const auto poses_told = file.all<ros::PoseStamped>("/CAM/pose");
  REQUIRE(lasers.size() == 3);
  REQUIRE(stereo.size() == 3);
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(lasers[i].header.stamp.nanosec == i * 100'000'000);
    CHECK(lasers[i].range_min == 0.05f);
    CHECK(lasers[i].range_max == 80);
    CHECK(lasers[i].scan_time == 0.1f);
    CHECK(lasers[i].ranges == scans[i].range_m);
    CHECK(ros::encode(clouds[i]) == ros::encode(ros::point_cloud(scans[i], "FRONT")));
    CHECK(images[i].header.frame_id == "CAM_optical");
    CHECK(images[i].header.stamp.nanosec == i * 100'000'000);
    CHECK(images[i].data == srgb_codes(colors[i]));
    CHECK(std::memcmp(depth_images[i].data.data(), depths[i].pixels.data(), depth_images[i].data.size()) == 0);
    CHECK(stereo[i].header.frame_id == "EYES_left_optical");
    CHECK(stereo[i].t == 0.2f);
    CHECK(std::memcmp(stereo[i].image.data.data(), disparities[i].pixels.data(), stereo[i].image.data.size()) == 0);
    CHECK(file.all<ros::Range>("/IR/range")[i].range == static_cast<float>(ranges[i]));
    CHECK(file.all<ros::Float64>("/IR/voltage_v")[i].data == voltages[i]);
    const Pose3 pose = pose_of(poses[i]);
    CHECK(poses_told[i].header.frame_id == "map");
    CHECK(poses_told[i].pose.position.x == pose.position_m.x);
    CHECK(poses_told[i].pose.orientation.w == pose.orientation.w);
    CHECK(poses_told[i].pose.orientation.z == pose.orientation.z);
  }
}

TEST_CASE("both cameras of a pair have the frame of the left one") {
  RecordedRobot robot;
  robot.simulation.record({.file = robot.file, .topics = {"/EYES/*"}});
  robot.simulation.step();
  robot.simulation.finish_recording();
  const McapFile file = robot.read();
  REQUIRE(file.all<ros::CameraInfo>("/EYES/right/camera_info").size() == 1);
  REQUIRE(file.all<ros::Image>("/EYES/right/image_raw").size() == 1);
  // P[3] leads from the frame of the left camera to the right one's image, so that is the frame of both.
  for (const ros::CameraInfo& info : file.all<ros::CameraInfo>("/EYES/right/camera_info")) {
    CHECK(info.header.frame_id == "EYES_left_optical");
    CHECK(info.p[3] == doctest::Approx(-0.2 * info.p[0]).epsilon(1e-12));
  }
  for (const ros::Image& image : file.all<ros::Image>("/EYES/right/image_raw")) {
    CHECK(image.header.frame_id == "EYES_left_optical");
  }
  for (const ros::CameraInfo& info : file.all<ros::CameraInfo>("/EYES/left/camera_info")) {
    CHECK(info.header.frame_id == "EYES_left_optical");
    CHECK(info.p[3] == 0);
  }
}

TEST_CASE("the tree of frames leads from the world to each sensor") {
  RecordedRobot robot;
  robot.simulation.record({.file = robot.file, .topics = {"/tf*"}});
  std::vector<glm::dmat4> poses;
  for (int i = 0; i < 2; ++i) {
    robot.simulation.set("MOVE", "yaw", 20.0 * i);
    robot.simulation.step();
    robot.simulation.sensor_pose("CAM", poses.emplace_back());
  }
  robot.simulation.finish_recording();
  const McapFile file = robot.read();
  const auto fixed = file.all<ros::TFMessage>("/tf_static");
  REQUIRE(fixed.size() == 1);
  std::map<std::string, ros::TransformStamped> by_child;
  for (const ros::TransformStamped& each : fixed[0].transforms) by_child[each.child_frame_id] = each;
  CHECK(by_child.at("CAM_optical").header.frame_id == "CAM");
  CHECK(by_child.at("EYES_left_optical").header.frame_id == "EYES");
  CHECK(by_child.at("IR").header.frame_id == "map");  // which stands in the world
  // Optical frames look along z; the right camera stands to the right of the left one.
  const glm::dmat4 right = matrix_of(by_child.at("EYES_right_optical").transform);
  constexpr double kRounding = 1e-12;
  CHECK(glm::distance(glm::dvec3(right[2]), glm::dvec3(1, 0, 0)) < kRounding);
  CHECK(glm::distance(glm::dvec3(right[0]), glm::dvec3(0, -1, 0)) < kRounding);
  CHECK(glm::distance(glm::dvec3(right[3]), glm::dvec3(0, -0.2, 0)) < kRounding);
  const auto moving = file.all<ros::TFMessage>("/tf");
  REQUIRE(moving.size() == 2);
  for (std::size_t i = 0; i < 2; ++i) {
    REQUIRE(moving[i].transforms.size() == 1);
    const ros::TransformStamped& body = moving[i].transforms[0];
    CHECK(body.header.frame_id == "map");
    CHECK(body.child_frame_id == "ROBOT");
    CHECK(by_child.at("CAM").header.frame_id == "ROBOT");
    const glm::dmat4 world_from_camera = matrix_of(body.transform) * matrix_of(by_child.at("CAM").transform);
    for (int c = 0; c < 4; ++c) {
      CHECK(glm::distance(world_from_camera[c], poses[i][c]) < 1e3 * kRounding);  // inverted and multiplied again
    }
  }
}

TEST_CASE("the first frame has all parameters, later frames those that changed; warnings come once") {
  RecordedRobot robot;
  robot.simulation.record({.file = robot.file, .topics = {"/parameter_events", "/diagnostics"}});
  robot.simulation.step();
  robot.simulation.warn("scene.xml: a warning");
  robot.simulation.set("MOVE", "x", 0.125);
  robot.simulation.step();
  robot.simulation.step();
  robot.simulation.finish_recording();
  const McapFile file = robot.read();
  const auto events = file.all<ros::ParameterEvent>("/parameter_events");
  REQUIRE(events.size() == 2);
  CHECK(events[0].new_parameters.size() == robot.simulation.parameters().values().size());
  REQUIRE(events[1].changed_parameters.size() == 1);
  CHECK(events[1].changed_parameters[0].name == "MOVE.x");
  CHECK(events[1].changed_parameters[0].value.double_value == 0.125);
  std::string told;
  for (const ros::DiagnosticArray& each : file.all<ros::DiagnosticArray>("/diagnostics")) {
    for (const ros::DiagnosticStatus& status : each.status) told += status.message + "\n";
  }
  CHECK(told == "scene.xml: a warning\n");
}

/// A listener that wants the changes of parameters from some frame on.
class ParameterListener : public ros::MessageOutlet {
 public:
  bool wants(const ros::Topic& topic, ros::TopicForm) override {
    if (topic.name != "/parameter_events") return false;
    CHECK(topic.durability == ros::Durability::transient);
    return is_there;
  }
  bool add(ros::MessageJob job) override {
    struct Decoder : ros::MessageSink {
      void put(const ros::Topic& topic, std::int64_t, std::string_view bytes) override {
        CHECK(topic.durability == ros::Durability::transient);
        events.push_back(ros::decode<ros::ParameterEvent>(bytes));
      }
      std::vector<ros::ParameterEvent> events;
    } decoder;
    job.run(decoder);
    events.insert(events.end(), decoder.events.begin(), decoder.events.end());
    return true;
  }
  bool is_there = false;
  std::vector<ros::ParameterEvent> events;
};

TEST_CASE("changes of parameters cost nothing without a listener, whose first event has all parameters") {
  RecordedRobot robot;
  ParameterListener listener;
  send_messages(robot.simulation, &listener);
  robot.simulation.step();
  robot.simulation.set("MOVE", "x", 0.125);
  robot.simulation.step();
  CHECK(listener.events.empty());
  listener.is_there = true;
  robot.simulation.step();
  REQUIRE(listener.events.size() == 1);
  CHECK(listener.events[0].new_parameters.size() == robot.simulation.parameters().values().size());
  robot.simulation.set("MOVE", "x", 0.25);
  robot.simulation.step();
  REQUIRE(listener.events.size() == 2);
  CHECK(listener.events[1].changed_parameters.size() == 1);
  send_messages(robot.simulation, nullptr);
}

TEST_CASE("elements and sensors come and go while they are recorded") {
  RecordedRobot robot;
  Simulation& simulation = robot.simulation;
  simulation.record({.file = robot.file});
  simulation.step();
  simulation.execute(R"(<remove name="IR"/><element type="light" name="LAMP" insert_at="ROOT"/>)");
  simulation.step();
  simulation.execute(R"(<remove name="LAMP"/><sensor type="psd" name="IR" insert_at="ROOT" range_max="0.5"/>)");
  simulation.step();
  simulation.finish_recording();
  const McapFile file = robot.read();
  const auto events = file.all<ros::ParameterEvent>("/parameter_events");
  REQUIRE(events.size() == 3);
  REQUIRE_FALSE(events[1].new_parameters.empty());
  CHECK(events[1].new_parameters[0].name.starts_with("LAMP."));
  CHECK(events[2].deleted_parameters.size() == events[1].new_parameters.size());
  CHECK(events[2].deleted_parameters[0].name == events[1].new_parameters[0].name);
  const auto ranges = file.all<ros::Range>("/IR/range");
  REQUIRE(ranges.size() == 2);
  CHECK(ranges[0].max_range == 0.8f);
  CHECK(ranges[1].max_range == 0.5f);
}

TEST_CASE("other forms of an image are recorded when they are asked for") {
  RecordedRobot robot;
  robot.simulation.record(
      {.file = robot.file, .topics = {"/CAM/image_raw/*", "/CAM/depth/image_raw/*", "/CAM/depth/millimetres"}});
  robot.simulation.step();
  robot.simulation.finish_recording();
  const McapFile file = robot.read();
  CHECK(file.counts() == std::map<std::string, std::size_t>{{"/CAM/image_raw/bgr8", 1},
                                                            {"/CAM/image_raw/mono16", 1},
                                                            {"/CAM/image_raw/compressed", 1},
                                                            {"/CAM/image_raw/compressed_png", 1},
                                                            {"/CAM/depth/image_raw/compressedDepth", 1},
                                                            {"/CAM/depth/millimetres", 1}});
  const std::vector<std::uint8_t> png = file.all<ros::CompressedImage>("/CAM/image_raw/compressed_png")[0].data;
  CHECK(std::string(png.begin(), png.end()) == encode_png(robot.simulation.color("CAM")));
}

TEST_CASE("recordings begin and end on request") {
  RecordedRobot robot;
  Simulation& simulation = robot.simulation;
  CHECK(contains(error_of([&] { simulation.finish_recording(); }), "the simulation is not recorded"));
  simulation.step();
  simulation.record({.file = robot.file, .topics = {"/clock"}});
  CHECK(contains(error_of([&] { simulation.record({.file = robot.file}); }), "recorded already"));
  CHECK_FALSE(std::filesystem::exists(robot.file));  // before the first frame
  simulation.skip_frame();
  simulation.step_async();
  simulation.finish();
  simulation.finish_recording();
  CHECK(robot.read().all<ros::Clock>("/clock").at(0).clock.nanosec == 200'000'000);
  simulation.record({.file = robot.file, .topics = {"/clock"}});  // replaces the file
  simulation.step();
  simulation.step();
  simulation.finish_recording();
  CHECK(robot.read().messages.size() == 2);
  write_text(robot.folder / "text.mcap", "not ours");
  CHECK(contains(error_of([&] { simulation.record({.file = robot.folder / "text.mcap"}); }), "is no MCAP file"));
  CHECK_THROWS_AS(simulation.record({.file = robot.folder / "none" / "run.mcap"}), MachineError);
}

TEST_CASE("a simulation that ends ends its recording") {
  const TemporaryFolder folder;
  {
    Simulation simulation = Simulation::load(write_wall_scene(folder.path(), kRobot));
    simulation.record({.file = folder / "run.mcap"});
    simulation.step();
  }
  CHECK(McapReader::read(read_text(folder / "run.mcap")).has_end);
}

TEST_CASE("two runs write the same bytes, and recording changes no measurement") {
  std::string bytes[2];
  for (std::string& each : bytes) {
    RecordedRobot robot;
    robot.simulation.record({.file = robot.file});
    for (int i = 0; i < 3; ++i) robot.simulation.step();
    robot.simulation.finish_recording();
    each = read_text(robot.file);
    RecordedRobot plain;
    for (int i = 0; i < 3; ++i) plain.simulation.step();
    CHECK(plain.simulation.scan("FRONT").range_m == robot.simulation.scan("FRONT").range_m);
    CHECK(plain.simulation.color("CAM").pixels == robot.simulation.color("CAM").pixels);
  }
  CHECK(bytes[0] == bytes[1]);
}

TEST_CASE("two sensors whose topics would be the same") {
  const TemporaryFolder folder;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), R"(
    <sensor type="psd" name="A-B" insert_at="ROOT"/><sensor type="psd" name="A_B" insert_at="ROOT"/>)"));
  CHECK(contains(error_of([&] { simulation.record({.file = folder / "run.mcap"}); }),
                 R"(sensors "A-B" and "A_B" would have the same topics, such as /A_B/pose)"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
