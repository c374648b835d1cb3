// Foxglove's playback control: the bytes of its messages, and a run that a client pauses, plays and sends ahead.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "program/live/foxglove.h"
#include "program/live/foxglove_peer.h"
#include "program/live/foxglove_playback.h"
#include "tests/live/live_program.h"
#include "tests/live/web_client.h"
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("live");

namespace simvis {

using Json = nlohmann::json;
using live::Control;
using live::ControlQueue;
using live::FoxgloveHub;
using live::FoxglovePeer;
using live::PlaybackRange;
using live::PlaybackState;
using live::read_playback_request;
using live::WireMessage;
using test::LiveProcess;
using test::WebSocketClient;

namespace {

using Status = PlaybackState::Status;

/// A request as a client writes it.
std::string playback_request(std::uint8_t command, float speed, std::optional<std::uint64_t> time,
                             const std::string& id = "some-id") {
  std::string bytes(1, '\3');
  const auto append = [&](auto value) {
    char raw[sizeof value];
    std::memcpy(raw, &value, sizeof value);
    bytes.append(raw, sizeof value);
  };
  append(command);
  append(speed);
  append(static_cast<std::uint8_t>(time ? 1 : 0));
  append(time.value_or(0));
  append(static_cast<std::uint32_t>(id.size()));
  return bytes + id;
}

/// A state as a client reads it.
PlaybackState read_state(const std::string& bytes) {
  REQUIRE(bytes.size() >= 19);
  REQUIRE(bytes[0] == 5);
  PlaybackState state;
  float speed = 0;
  std::memcpy(&state.status, bytes.data() + 1, 1);
  std::memcpy(&state.time_ns, bytes.data() + 2, 8);
  std::memcpy(&speed, bytes.data() + 10, 4);
  state.speed = speed;
  state.did_seek = bytes[14] != 0;
  state.request = bytes.substr(19);
  std::uint32_t size = 0;
  std::memcpy(&size, bytes.data() + 15, 4);
  CHECK(size == state.request.size());
  return state;
}

/// The next state of a run; empty: any one.
PlaybackState next_state(WebSocketClient& client, const std::string& request) {
  return read_state(client.receive_binary([&](const std::string& bytes) {
    return bytes[0] == 5 && (request.empty() || read_state(bytes).request == request);
  }));
}

/// The peer's messages of kind 5, and its texts.
struct Sent {
  explicit Sent(FoxglovePeer& peer) {
    while (std::optional<WireMessage> message = peer.next()) {
      if (!message->binary) texts.push_back(Json::parse(message->head));
      if (message->binary && message->head[0] == 5) states.push_back(read_state(message->head));
    }
  }
  std::vector<Json> texts;
  std::vector<PlaybackState> states;
};

}  // namespace

// The bytes are those of the protocol's own tests: foxglove-sdk, rust/foxglove/src/protocol/v1/snapshots.
TEST_CASE("requests and states are the bytes of the protocol") {
  const std::string play("\x03\x00\x00\x00\x80\x3f\x01\x15\xcd\x5b\x07\0\0\0\0\x07\0\0\0some-id", 26);
  CHECK(playback_request(0, 1, 123'456'789) == play);
  live::PlaybackRequest request = read_playback_request(play);
  CHECK(request.play);
  CHECK(request.speed == 1);
  CHECK(request.seek_ns == 123'456'789);
  CHECK(request.id == "some-id");
  request = read_playback_request(std::string("\x03\x01\x00\x00\x80\x3f\0\0\0\0\0\0\0\0\0\x07\0\0\0some-id", 26));
  CHECK_FALSE(request.play);
  CHECK_FALSE(request.seek_ns);
  CHECK(live::playback_message({.status = Status::playing, .time_ns = 12'345, .speed = 1, .did_seek = true}) ==
        std::string("\x05\x00\x39\x30\0\0\0\0\0\0\0\0\x80\x3f\x01\0\0\0\0", 19));
  CHECK(
      live::playback_message({.status = Status::playing, .time_ns = 12'345, .speed = 1, .request = "i-am-a-request"}) ==
      std::string("\x05\x00\x39\x30\0\0\0\0\0\0\0\0\x80\x3f\x00\x0e\0\0\0i-am-a-request", 33));
  CHECK(live::playback_time(7'000'000'005) == Json{{"sec", 7}, {"nsec", 5}});
}

TEST_CASE("requests that are cut off or make no sense are refused") {
  const std::string whole = playback_request(1, 2, 5);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CHECK(error_of([&] { read_playback_request(whole.substr(0, size)); }) == "this is no request of playback control");
  }
  CHECK(contains(error_of([] { read_playback_request(playback_request(2, 1, {})); }), "command 2 is not known"));
  for (const float speed :
       {0.f, -1.f, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    CHECK(contains(error_of([&] { read_playback_request(playback_request(0, speed, {})); }),
                   "expected a number above 0"));
  }
  CHECK(contains(error_of([] { read_playback_request(playback_request(0, 1, std::uint64_t{1} << 63)); }), "292 years"));
  CHECK(
      contains(error_of([] { read_playback_request(playback_request(0, 1, {}, std::string(257, 'x'))); }), "too long"));
}

TEST_CASE("only a run that has an end offers playback control; all clients get its state") {
  ControlQueue controls;
  FoxgloveHub endless(controls, "session"), hub(controls, "session", PlaybackRange{0, 9'900'000'000});
  FoxglovePeer none(endless, 1), one(hub, 2), other(hub, 3);
  const auto offers = [](const Json& info) {
    return std::ranges::count(info.at("capabilities"), Json("playbackControl")) == 1;
  };
  Json info = Sent(none).texts.at(0);
  CHECK_FALSE(offers(info));
  CHECK_FALSE(info.contains("dataEndTime"));
  info = Sent(one).texts.at(0);
  CHECK(offers(info));
  CHECK(info.at("dataStartTime") == Json{{"sec", 0}, {"nsec", 0}});
  CHECK(info.at("dataEndTime") == Json{{"sec", 9}, {"nsec", 900'000'000}});
  none.receive(playback_request(0, 1, {}), true);
  CHECK(contains(Sent(none).texts.at(0).at("message").get<std::string>(), "has no end"));
  CHECK_FALSE(controls.next());
  one.receive(playback_request(1, 0.5f, 7), true);
  const std::optional<Control> control = controls.next();
  REQUIRE(control);
  CHECK(control->kind == Control::Kind::playback);
  CHECK(control->playback->seek_ns == 7);
  hub.set_playback({.status = Status::paused, .time_ns = 3, .speed = 0.5, .did_seek = true, .request = "some-id"});
  for (FoxglovePeer* const peer : {&one, &other}) {
    const std::vector<PlaybackState> states = Sent(*peer).states;
    REQUIRE(states.size() == 1);
    CHECK(states[0].request == "some-id");
  }
  hub.set_time(4);
  FoxglovePeer late(hub, 4);
  const std::vector<PlaybackState> states = Sent(late).states;
  REQUIRE(states.size() == 1);
  CHECK(states[0].status == Status::paused);
  CHECK(states[0].time_ns == 4);
  CHECK_FALSE(states[0].did_seek);
  CHECK(states[0].request.empty());
}

TEST_CASE("a client pauses a run, sends it ahead, and lets it go on to its end") {
  TemporaryFolder folder;
  write_wall_scene(folder.path(), kWallSensors);
  LiveProcess program;  // 100 frames, the last one at 9.9 s
  program.start({"--frames", "100", "--rate", "10", "--real-time", "0.5", (folder / "scene.xml").string()}, "0",
                folder / "out.txt");
  WebSocketClient client(program.port, "foxglove.sdk.v1", "/?token=" + program.token);
  CHECK(client.receive_op("serverInfo").at("dataEndTime") == Json{{"sec", 9}, {"nsec", 900'000'000}});
  const auto ask = [&](std::uint8_t command, float speed, std::optional<std::uint64_t> time, const std::string& id) {
    client.send_binary(playback_request(command, speed, time, id));
    return next_state(client, id);
  };
  PlaybackState state = ask(1, 0.5f, {}, "pause");
  CHECK(state.status == Status::paused);
  CHECK(state.speed == 0.5);
  CHECK_FALSE(state.did_seek);
  const std::int64_t paused_ns = state.time_ns;
  REQUIRE(paused_ns < 5'000'000'000);  // 10 s of the wall clock: the machine is slow, but not so slow

  // The frame that is made is the last one that is not later: 5.0 s.
  state = ask(1, 0.25f, 5'050'000'000, "ahead");
  CHECK(state.status == Status::buffering);
  CHECK(state.time_ns == paused_ns);
  state = next_state(client, "");
  CHECK(state.status == Status::paused);
  CHECK(state.did_seek);
  CHECK(state.time_ns == 5'000'000'000);
  CHECK(state.speed == 0.25);

  client.send_binary(playback_request(1, 1, 4'000'000'000, "back"));
  CHECK(contains(client.receive_op("status").at("message").get<std::string>(), "does not go back"));
  state = next_state(client, "back");
  CHECK(state.time_ns == 5'000'000'000);
  CHECK_FALSE(state.did_seek);

  state = ask(1, 1, 5'100'000'000, "one frame");
  CHECK(next_state(client, "").time_ns == 5'100'000'000);
  // At this speed the rest would take 5,000 s.
  state = ask(0, 0.001f, {}, "slowly");
  CHECK(state.status == Status::playing);
  CHECK(state.time_ns == 5'100'000'000);
  // The server closes the connection when the run has ended, whatever waits.
  client.send_binary(playback_request(0, 1, 50'000'000'000, "to the end"));
  std::int64_t last_ns = 0;
  while (const std::optional<test::WebMessage> message = client.receive()) {
    if (!message->binary || message->bytes[0] != 5) continue;
    state = read_state(message->bytes);
    CHECK(state.time_ns >= last_ns);
    last_ns = state.time_ns;
    CHECK((state.status == Status::ended) == (state.time_ns == 9'900'000'000));
  }
  CHECK(client.close_reason() == "the simulation has ended");
  CHECK(program.process->wait().exit_code == 0);
}

}  // namespace simvis

TEST_SUITE_END();
