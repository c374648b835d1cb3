// Messages of images are made of the very memory in which a sensor measured, also when they are made late.
#include <doctest/doctest.h>

#include <optional>

#include <simvis/simulation.h>
#include "messages/from_image.h"
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
  void add(ros::MessageJob job) override {
    if (job.kind == ros::MessageJob::Kind::measurement) jobs.push_back(std::move(job));
  }
  std::string only;
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

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
