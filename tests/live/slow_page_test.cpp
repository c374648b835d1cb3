// Pages that show frames more slowly than the simulation makes them: they lose frames, and nothing waits for them.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "program/live/view_hub.h"
#include "tests/live/live_program.h"
#include "tests/live/web_client.h"

TEST_SUITE_BEGIN("live");

namespace simvis::live {
namespace {

using ShownJson = nlohmann::json;

/// A simulation whose camera measures in every frame and whose scanner in every second one, a hub and one page.
struct SlowView {
  SlowView() {
    publish();
    received();
    peer->receive(R"({"op": "look", "sensors": [0, 1]})", false);
    shown();
  }
  /// Makes a frame; the hub gets it if the page can take one.
  void publish() {
    const FrameTime time = simulation.next_frame();
    simulation.step();
    if (hub.can_show() == 0) return copier.skip(simulation, time);
    hub.publish(copier.copy(simulation, time, 0, {.every_sensor = true}), {});
  }
  void shown() { peer->receive(R"({"op": "shown"})", false); }
  /// The numbers of the frames that have come, and the kinds and times of measurements in `measured`.
  std::vector<std::uint64_t> received() {
    std::vector<std::uint64_t> frames;
    while (const std::optional<WireMessage> message = peer->next()) {
      const std::string bytes = message->head + (message->body ? *message->body : "");
      if (message->binary) {
        std::int64_t time_ns = 0;
        std::memcpy(&time_ns, bytes.data() + 8, sizeof time_ns);
        if (bytes[0] != 1) measured.emplace_back(bytes[0], time_ns);
        continue;
      }
      const ShownJson json = ShownJson::parse(bytes);
      if (json.at("op") == "frame") frames.push_back(json.at("frame"));
      if (json.at("op") == "error") errors.push_back(json.at("message"));
    }
    return frames;
  }
  Simulation simulation = Simulation::from_string(R"(
      <part name="BOX" insert_at="ROOT" shape="box" size="1 1 1" pose_offset="3 0 0 0 0 0"/>
      <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="3" rate="7.5"/>
      <sensor type="camera" name="CAM" insert_at="ROOT" width="8" height="6"/>)");
  ControlQueue controls;
  ViewHub hub{controls, [](ViewWants) {}};
  std::unique_ptr<Peer> peer = hub.connect(1);
  ViewCopier copier;
  std::vector<std::pair<int, std::int64_t>> measured;
  std::vector<std::string> errors;
};

TEST_CASE("a page that shows nothing gets two frames, and then the latest with the latest of each sensor") {
  SlowView view;
  std::vector<std::uint64_t> frames;
  for (int i = 1; i <= 6; ++i) {
    view.publish();
    for (const std::uint64_t frame : view.received()) frames.push_back(frame);
  }
  CHECK(frames == std::vector<std::uint64_t>{1, 2});
  CHECK(view.hub.can_show() == 0);
  view.measured.clear();
  view.shown();
  CHECK(view.hub.can_show() == 1);
  CHECK(view.received().empty());  // the hub has no other frame yet
  view.publish();
  CHECK(view.received() == std::vector<std::uint64_t>{7});
  const std::int64_t rate_15hz_ns = view.simulation.next_frame().time_ns / 8;
  REQUIRE(view.measured.size() == 2);
  CHECK(view.measured[0].first == 2);
  CHECK(std::abs(view.measured[0].second - 6 * rate_15hz_ns) <= 6);  // the scan of a frame that was left out
  CHECK(view.measured[1].first == 3);
  CHECK(std::abs(view.measured[1].second - 7 * rate_15hz_ns) <= 7);
}

TEST_CASE("an image goes back to its sensor as soon as its message is made") {
  SlowView view;
  const auto address = [&] { return view.simulation.color("CAM").pixels.data(); };
  view.publish();
  const float* const held = address();
  view.simulation.step();
  CHECK(address() != held);
  view.publish();
  view.received();
  const float* const free = address();
  view.simulation.step();
  CHECK(address() == free);
}

TEST_CASE("of a sensor that measures again a page gets what it has now, also if outputs of before are gone") {
  SlowView view;
  const FrameTime time = view.simulation.next_frame();
  view.simulation.step();
  ViewFrame frame = view.copier.copy(view.simulation, time, 0, {.every_sensor = true});
  REQUIRE(frame.images.size() == 1);
  REQUIRE(frame.scene->sensors[frame.images[0].sensor].name == "CAM");
  constexpr std::int64_t kNames = 100;
  for (std::int64_t i = 0; i < kNames; ++i) {
    ViewFrame named = frame;
    named.images[0].array.name = "image " + std::to_string(i);
    named.images[0].time_ns = i;
    view.hub.publish(std::move(named), {});
  }
  view.received();
  const auto images = std::ranges::count(view.measured, 3, &std::pair<int, std::int64_t>::first);
  CHECK(images == 1);
  CHECK(view.measured.back() == std::pair<int, std::int64_t>(3, kNames - 1));
}

TEST_CASE("a page that shows more than it got gets an error, and one that is gone frees its place") {
  SlowView view;
  view.shown();
  view.received();
  CHECK(view.errors == std::vector<std::string>{"no frame is under way"});
  CHECK(view.hub.viewers() == 1);
  view.peer.reset();
  CHECK(view.hub.viewers() == 0);
  CHECK(view.hub.can_show() == 0);
}

TEST_CASE("the host and other pages go on beside a page that reads nothing, which then finds few frames") {
  test::LiveProgram program;
  test::WebSocketClient slow(program.port, "simvis.live.v1"), quick(program.port, "simvis.live.v1");
  slow.shows_frames = false;
  const auto look = [](test::WebSocketClient& page) {
    const ShownJson scene = page.receive_op("scene");
    std::vector<std::size_t> all(scene.at("sensors").size());
    for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
    page.send({{"op", "look"}, {"sensors", all}});
  };
  look(slow);
  look(quick);
  std::uint64_t last = quick.receive_op("frame").at("frame");
  for (const std::uint64_t end = last + 200; last < end;) last = quick.receive_op("frame").at("frame");
  for (std::size_t i = 0; i < kMaxUnshown; ++i) CHECK(slow.receive_op("frame").at("frame") < last);
  slow.send({{"op", "shown"}});
  CHECK(slow.receive_op("frame").at("frame") >= last);
  CHECK(program.interrupt().exit_code == 130);
}

}  // namespace
}  // namespace simvis::live

TEST_SUITE_END();
