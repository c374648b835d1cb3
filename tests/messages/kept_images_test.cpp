// Messages of images are made of the very memory in which a sensor measured, also when they are made late.
#include <doctest/doctest.h>

#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "exchange/messages/from_image.h"
#include "exchange/messages/types/output_types.h"
#include "simvis/message_tap.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

constexpr std::string_view kEyes = R"(
<element type="pose" name="MOVE" insert_at="ROOT"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="16" height="12" outputs="color depth"/>
<sensor type="stereo_camera" name="EYES" insert_at="ROOT" width="16" height="12" outputs="color disparity" baseline="0.2"/>)";
constexpr std::size_t kPixels = std::size_t{16} * 12, kColorBytes = 4 * sizeof(float) * kPixels,
                      kDepthBytes = sizeof(float) * kPixels;

/// Keeps jobs until the test runs them.
struct LateOutlet : ros::MessageOutlet {
  bool wants(const ros::Topic& topic, ros::TopicForm form) override {
    return form == ros::TopicForm::own && (only.empty() || topic.name == only);
  }
  bool add(ros::MessageJob job) override {
    if (job.kind != ros::MessageJob::Kind::measurement) return true;
    if (has_room) jobs.push_back(std::move(job));
    return has_room;
  }
  std::string only;
  bool has_room = true;
  std::vector<ros::MessageJob> jobs;
};

/// The messages of one topic.
struct OneTopicSink : ros::MessageSink {
  explicit OneTopicSink(std::string of) : name(std::move(of)) {}
  void put(const ros::Topic& topic, std::int64_t, std::string_view bytes) override {
    ++messages;
    if (topic.name == name) all.emplace_back(bytes);
  }
  std::string name;
  std::vector<std::string> all;
  std::uint64_t messages = 0;
};

struct LateRobot {
  explicit LateRobot(std::string only = "") {
    outlet.only = std::move(only);
    send_messages(*simulation, &outlet);
  }
  void step(double x) {
    simulation->set("MOVE", "x", x);
    simulation->step();
  }
  std::vector<std::uint8_t> last_depth(std::size_t job) {
    OneTopicSink sink("/CAM/depth/image_raw");
    outlet.jobs[job].run(sink);
    REQUIRE(sink.all.size() == 1);
    return ros::decode<ros::Image>(sink.all[0]).data;
  }

  TemporaryFolder folder;
  LateOutlet outlet;
  std::optional<Simulation> simulation = Simulation::load(write_wall_scene(folder.path(), kEyes));
};

std::vector<std::uint8_t> depth_bytes(const Simulation& simulation) {
  return ros::to_image(simulation.depth("CAM"), {}, "32FC1").data;
}

TEST_CASE("a message holds the sensor's memory until it is made: the next images go elsewhere, and nothing is copied") {
  LateRobot robot("/CAM/depth/image_raw");
  robot.step(0);
  const float *const first = robot.simulation->depth("CAM").pixels.data(), *const color = robot.simulation->color("CAM")
                                                                                              .pixels.data();
  robot.step(1);
  const float* const second = robot.simulation->depth("CAM").pixels.data();
  CHECK(second != first);
  CHECK(robot.simulation->color("CAM").pixels.data() == color);  // no message holds it
  robot.outlet.jobs.clear();
  robot.step(2);
  CHECK(robot.simulation->depth("CAM").pixels.data() == second);
}

TEST_CASE("messages that are made late show their own frame, also after the end of the simulation") {
  LateRobot robot("/CAM/depth/image_raw");
  std::vector<std::vector<std::uint8_t>> measured;
  for (int frame = 0; frame < 5; ++frame) {
    robot.step(0.1 * frame);
    measured.push_back(depth_bytes(*robot.simulation));
  }
  CHECK(measured[0] != measured[4]);
  robot.simulation->execute(R"(<remove name="CAM"/>)");
  CHECK(robot.last_depth(0) == measured[0]);
  robot.simulation.reset();
  REQUIRE(robot.outlet.jobs.size() == 5);
  for (std::size_t frame = 0; frame < 5; ++frame) CHECK(robot.last_depth(frame) == measured[frame]);
}

TEST_CASE("the images of a sensor are one job, which counts those that it holds") {
  LateRobot all;
  all.step(0);
  REQUIRE(all.outlet.jobs.size() == 2);
  CHECK(all.outlet.jobs[0].held_bytes == kColorBytes + kDepthBytes);
  CHECK(all.outlet.jobs[0].messages == 2);
  CHECK(all.outlet.jobs[1].held_bytes == 2 * kColorBytes + kDepthBytes);
  CHECK(all.outlet.jobs[1].messages == 3);
  LateRobot depth("/CAM/depth/image_raw");
  depth.step(0);
  REQUIRE(depth.outlet.jobs.size() == 1);
  CHECK(depth.outlet.jobs[0].held_bytes == kDepthBytes);
  CHECK(depth.outlet.jobs[0].messages == 1);
  OneTopicSink sink("/CAM/depth/image_raw");
  depth.outlet.jobs[0].run(sink);
  CHECK(sink.messages == 1);
}

constexpr std::size_t kBeams = 10, kFrames = 4;

/// A scanner whose pattern runs on, so that each scan has other angles, and one with a grid.
struct RunningPattern {
  RunningPattern() {
    std::string table = "Time/s,Azimuth/deg,Zenith/deg\n";
    for (int i = 0; i < 50; ++i) table += std::to_string(i * 0.01) + "," + std::to_string(i) + ",90\n";
    write_text(folder / "table.csv", table);
    SimulationDesc desc;
    desc.rate_hz = 10;
    simulation = Simulation::load(write_wall_scene(folder.path(), R"(
      <sensor type="laser_scanner" name="RUNS" insert_at="ROOT" pattern="table.csv" pattern_beams="10"/>
      <sensor type="laser_scanner" name="GRID" insert_at="ROOT" samples="21"/>)"),
                                  desc);
    send_messages(*simulation, &outlet);
  }
  TemporaryFolder folder;
  LateOutlet outlet;
  std::optional<Simulation> simulation;
};

std::vector<double> angles_of(const std::string& message) {
  const std::vector<std::uint8_t> data = ros::decode<ros::OutputStamped>(message).output.data;
  std::vector<double> angles(data.size() / sizeof(double));
  std::memcpy(angles.data(), data.data(), data.size());
  return angles;
}

TEST_CASE("angles of a pattern that runs on go out with each scan, as measurements that count the bytes they hold") {
  RunningPattern scene;
  scene.outlet.only = "/RUNS/azimuth_rad";
  std::vector<std::vector<double>> measured;
  for (std::size_t frame = 0; frame < kFrames; ++frame) {
    scene.simulation->step();
    measured.push_back(scene.simulation->scan("RUNS").azimuth_rad.numbers());
  }
  REQUIRE(scene.outlet.jobs.size() == kFrames);
  OneTopicSink sink("/RUNS/azimuth_rad");
  for (const ros::MessageJob& job : scene.outlet.jobs) {
    CHECK(job.held_bytes == kBeams * sizeof(double));
    job.run(sink);
  }
  REQUIRE(sink.all.size() == kFrames);
  for (std::size_t frame = 0; frame < kFrames; ++frame) CHECK(angles_of(sink.all[frame]) == measured[frame]);
  CHECK(measured[0] != measured[1]);
}

TEST_CASE("angles that an outlet had no room for come with the next scan, and those of a grid come once") {
  RunningPattern scene;
  scene.outlet.only = "/GRID/azimuth_rad";
  scene.outlet.has_room = false;
  scene.simulation->step();
  CHECK(scene.outlet.jobs.empty());
  scene.outlet.has_room = true;
  for (std::size_t frame = 0; frame < kFrames; ++frame) scene.simulation->step();
  CHECK(scene.outlet.jobs.size() == 1);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
