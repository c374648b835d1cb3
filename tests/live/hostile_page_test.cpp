// The page's protocol: messages that no page sends are answered with what is wrong, and nothing else happens.
#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "program/live/view_hub.h"
#include "tests/support/long_count.h"

TEST_SUITE_BEGIN("live");

namespace simvis::live {
namespace {

/// A hub with one page that has seen the scene.
struct HostileView {
  HostileView() {
    const FrameTime time = simulation.next_frame();
    simulation.step();
    hub.publish(ViewCopier().copy(simulation, time, 0, {.every_sensor = true}), {});
    drain();
  }
  /// The messages of errors that wait for the page.
  std::vector<std::string> drain() {
    std::vector<std::string> errors;
    while (const std::optional<WireMessage> message = peer->next()) {
      if (!message->head.starts_with(R"({"op":"error")")) continue;
      errors.push_back(nlohmann::json::parse(message->head).at("message"));
    }
    while (controls.next()) {
    }
    return errors;
  }
  std::vector<std::string> errors_after(std::string_view message, bool binary = false) {
    peer->receive(message, binary);
    return drain();
  }
  Simulation simulation = Simulation::from_string(R"(<element type="pose" name="MOVE" insert_at="ROOT"/>
      <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="3"/>)");
  ControlQueue controls;
  ViewHub hub{controls, [](ViewWants) {}};
  std::unique_ptr<Peer> peer = hub.connect(1);
};

}  // namespace

TEST_CASE("a page pulls at a body, and one that goes away meanwhile lets go") {
  HostileView view;
  view.peer->receive(R"({"op": "pull", "body": 3, "at": [1, 2, 3], "to": [4, 5, 6.5]})", false);
  std::optional<Control> control = view.controls.next();
  REQUIRE(control);
  CHECK(control->kind == Control::Kind::pull);
  REQUIRE(control->pull);
  CHECK(control->pull->body == 3);
  CHECK(control->pull->body_m == glm::dvec3(1, 2, 3));
  CHECK(control->pull->target_m == glm::dvec3(4, 5, 6.5));
  for (const char* const wrong : {R"({"op": "pull", "body": 0, "at": [1, 2], "to": [4, 5, 6]})",
                                  R"({"op": "pull", "body": 0, "at": 1, "to": [4, 5, 6]})"}) {
    CHECK(view.errors_after(wrong) == std::vector<std::string>{"expected three numbers"});
  }
  CHECK(view.errors_after(R"({"op": "pull", "body": 0, "at": [1, 2, null], "to": [4, 5, 6]})") ==
        std::vector<std::string>{"expected a number"});
  for (const char* const far : {R"({"op": "pull", "body": 0, "at": [0, 0, 0], "to": [0, 1e308, 0]})",
                                R"({"op": "pull", "body": 0, "at": [-1.1e6, 0, 0], "to": [0, 0, 0]})"}) {
    CHECK(view.errors_after(far) == std::vector<std::string>{"expected a place within 1e6 m"});
  }
  view.peer.reset();
  control = view.controls.next();
  REQUIRE(control);
  CHECK(control->kind == Control::Kind::pull);
  CHECK_FALSE(control->pull);
}

TEST_CASE("a page gets the reason why its message is wrong") {
  HostileView view;
  const std::string no_protocol = "the message is not as the protocol says";
  for (const char* const text : {"", "{", "[]", "null", R"({"op": 1})", R"({"op": "set"})",
                                 R"({"op": "execute", "xml": 3})", R"({"op": "look", "sensors": {}})", "\xff\xfe"}) {
    CAPTURE(text);
    if (std::string(text) == R"({"op": "look", "sensors": {}})") {
      CHECK(view.errors_after(text).empty());  // looks at nothing
    } else {
      CHECK(view.errors_after(text) == std::vector{no_protocol});
    }
  }
  CHECK(view.errors_after(std::string(1 << 20, '[')) == std::vector{no_protocol});
  CHECK(view.errors_after("{}", true) == std::vector<std::string>{"expected text"});
  CHECK(view.errors_after(R"({"op": "fly"})") == std::vector<std::string>{"there is no operation \"fly\""});
  CHECK(view.errors_after(R"({"op": "set", "parameter": -1, "value": 0})") ==
        std::vector<std::string>{"expected an index"});
  CHECK(view.errors_after(R"({"op": "set", "parameter": 0, "value": "x"})") ==
        std::vector<std::string>{"expected a number"});
  CHECK(view.errors_after(R"({"op": "look", "sensors": [99999]})").empty());
}

// By hand: SIMVIS_TEST_DAMAGES=1000000.
TEST_CASE("damaged messages of a page do no harm") {
  HostileView view;
  std::mt19937 random(11);
  const std::string texts[] = {R"({"op":"look","sensors":[0,1],"plan":true})",
                               R"({"op":"set","parameter":3,"value":0.5})",
                               R"({"op":"speed","factor":2})",
                               R"({"op":"execute","xml":"<remove name='X'/>"})",
                               R"({"op":"shown"})",
                               R"({"op":"save"})"};
  const int count = count_of("SIMVIS_TEST_DAMAGES", 20'000);
  for (int i = 0; i < count; ++i) {
    std::string text = texts[random() % std::size(texts)];
    for (unsigned changes = random() % 4; changes > 0 && !text.empty(); --changes) {
      const std::size_t at = random() % text.size();
      if (random() % 2 == 0) {
        text[at] = static_cast<char>(random());
      } else {
        text.erase(at, random() % 5);
      }
    }
    view.peer->receive(text, random() % 50 == 0);
    if (i % 100 == 0) view.drain();
  }
  view.drain();
  CHECK(view.errors_after(R"({"op": "fly"})").size() == 1);
  CHECK(view.hub.viewers() == 1);
}

}  // namespace simvis::live

TEST_SUITE_END();
