// Foxglove's protocol: what its clients get, what they may request, and how mistakes are answered.
#include <doctest/doctest.h>
#include <sys/stat.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <random>

#include "exchange/messages/types/geometry_types.h"
#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/system_types.h"
#include "program/live/foxglove.h"
#include "program/live/foxglove_peer.h"
#include "program/live/message_outlet.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("live");

namespace simvis::live {
namespace {

using Json = nlohmann::json;

/// A hub with a clock, a latched topic and two parameters, and one client.
struct Talk {
  Talk() {
    hub.set_parameters({{"ARM.angle", 1.5}, {"ARM.speed", 2}, {"GONE.x", 0, true}});
    send_frame(0);
    peer = std::make_unique<FoxglovePeer>(hub, 1);
  }
  /// What the simulation sends in a frame.
  void send_frame(std::int64_t time_ns) {
    if (outlet.wants<ros::Clock>("/clock")) outlet.add({.run = clock(time_ns)});
    if (time_ns == 0 && outlet.wants<ros::TFMessage>("/tf_static", ros::TopicForm::own, ros::Durability::latched)) {
      outlet.add({.run = [](ros::MessageSink& sink) {
        sink.write("/tf_static", 0, ros::TFMessage(), ros::Durability::latched);
      }});
    }
    CHECK_FALSE(outlet.wants<ros::Path>("/ARM/path", ros::TopicForm::at_end));
    if (const std::function<void()> batch = outlet.take_batch()) batch();
    hub.set_time(time_ns);
  }
  static std::function<void(ros::MessageSink&)> clock(std::int64_t time_ns) {
    return [time_ns](ros::MessageSink& sink) { sink.write("/clock", time_ns, ros::Clock{}); };
  }
  void say(const Json& message) { peer->receive(message.dump(), false); }
  /// All that waits for the client: texts as JSON, binary messages as bytes.
  std::vector<Json> texts() {
    std::vector<Json> all;
    while (std::optional<WireMessage> message = peer->next()) {
      std::string bytes = message->head + (message->body ? *message->body : "");
      message->binary ? binary.push_back(std::move(bytes)) : all.push_back(Json::parse(bytes));
    }
    return all;
  }
  std::vector<std::string> take_binary() {
    texts();
    return std::exchange(binary, {});
  }
  /// The text of the status that answers `message`.
  std::string status_after(const Json& message) {
    texts();
    say(message);
    const std::vector<Json> all = texts();
    REQUIRE(all.size() == 1);
    CHECK(all[0].at("op") == "status");
    return all[0].at("message");
  }

  ControlQueue controls;
  FoxgloveHub hub{controls, "session"};
  LiveOutlet outlet{hub};
  std::unique_ptr<Peer> peer;
  std::vector<std::string> binary;
};

Json subscription(int id, int channel) { return {{"id", id}, {"channelId", channel}}; }

}  // namespace

TEST_CASE("a client gets the server's name and all channels, with their definitions") {
  Talk talk;
  const std::vector<Json> texts = talk.texts();
  REQUIRE(texts.size() == 3);
  CHECK(texts[0].at("op") == "serverInfo");
  CHECK(texts[0].at("sessionId") == "session");
  CHECK(texts[0].at("capabilities") ==
        Json({"clientPublish", "parameters", "parametersSubscribe", "time", "services", "connectionGraph", "assets"}));
  const Json& channels = texts[1].at("channels");
  REQUIRE(channels.size() == 2);
  CHECK(channels[0].at("topic") == "/clock");
  CHECK(channels[0].at("encoding") == "cdr");
  CHECK(channels[0].at("schemaName") == "rosgraph_msgs/msg/Clock");
  CHECK(channels[0].at("schemaEncoding") == "ros2msg");
  CHECK(channels[0].at("schema").get<std::string>().find("builtin_interfaces/Time clock") != std::string::npos);
  CHECK_FALSE(talk.outlet.wants<ros::LaserScan>("/SCAN/scan"));
  talk.outlet.take_batch()();
  const std::vector<Json> more = talk.texts();
  REQUIRE(more.size() == 1);
  CHECK(more[0].at("channels")[0].at("topic") == "/SCAN/scan");
}

TEST_CASE("messages come while a client is subscribed, and latched ones also to those who come late") {
  Talk talk;
  talk.send_frame(5);
  CHECK(talk.take_binary() == std::vector<std::string>{std::string("\2\5\0\0\0\0\0\0\0", 9)});  // the time alone
  talk.say({{"op", "subscribe"}, {"subscriptions", {subscription(7, 1), subscription(6, 999), subscription(8, 2)}}});
  std::vector<std::string> got = talk.take_binary();
  REQUIRE(got.size() == 1);  // kept
  CHECK(got[0].substr(0, 5) == std::string("\1\x8\0\0\0", 5));
  talk.send_frame(6);
  got = talk.take_binary();
  REQUIRE(got.size() == 2);
  CHECK(got[0][0] == 2);
  CHECK(got[1].substr(0, 13) == std::string("\1\7\0\0\0\6\0\0\0\0\0\0\0", 13));
  CHECK(got[1].substr(13) == ros::encode(ros::Clock{}));
  talk.say({{"op", "unsubscribe"}, {"subscriptionIds", {99, 7}}});  // there is no 99
  talk.send_frame(7);
  CHECK(talk.take_binary().size() == 1);
  talk.peer.reset();
  CHECK_FALSE(talk.outlet.wants<ros::Clock>("/clock"));
}

TEST_CASE("a client that does not read loses the oldest messages, and the outlet leaves measurements out") {
  Talk talk;
  talk.say({{"op", "subscribe"}, {"subscriptions", {subscription(1, 1)}}});
  for (int i = 1; i <= 1000; ++i) talk.send_frame(i);
  const std::vector<std::string> got = talk.take_binary();
  CHECK(got.size() < 100);
  CHECK(got.back().substr(5, 2) == std::string("\xe8\3", 2));  // the last one: 1000
  int runs = 0;
  std::vector<std::function<void()>> batches;
  for (int i = 0; i < 5; ++i) {
    using Kind = ros::MessageJob::Kind;
    talk.outlet.add({.kind = Kind::measurement, .run = [&](ros::MessageSink&) { ++runs; }});
    if (std::function<void()> batch = talk.outlet.take_batch()) batches.push_back(std::move(batch));
  }
  for (const std::function<void()>& batch : batches) batch();
  CHECK(runs == 2);
}

TEST_CASE("parameters are read, set and watched") {
  Talk talk;
  talk.texts();
  talk.say({{"op", "getParameters"}, {"parameterNames", Json::array()}, {"id", "a"}});
  std::vector<Json> texts = talk.texts();
  REQUIRE(texts.size() == 1);
  CHECK(texts[0] == Json::parse(R"({"op":"parameterValues","id":"a","parameters":[
      {"name":"ARM.angle","type":"float64","value":1.5},{"name":"ARM.speed","type":"float64","value":2.0}]})"));
  talk.say(Json::parse(R"({"op":"setParameters","id":"b","parameters":[{"name":"ARM.speed","value":9}]})"));
  const std::optional<Control> control = talk.controls.next();
  REQUIRE(control);
  CHECK(control->kind == Control::Kind::set);
  CHECK(control->values == std::vector<std::pair<std::size_t, double>>{{1, 9}});
  const std::string refused[] = {"ARM.speed: 9 is not allowed"};
  talk.hub.answer_set(*control, refused);
  texts = talk.texts();
  REQUIRE(texts.size() == 2);
  CHECK(texts[0].at("message") == refused[0]);
  CHECK(texts[1].at("id") == "b");
  CHECK(texts[1].at("parameters")[0].at("value") == 2);
  talk.say(Json::parse(R"({"op":"subscribeParameterUpdates","parameterNames":["ARM.angle"]})"));
  talk.hub.set_parameters({{"ARM.angle", 3}, {"ARM.speed", 4}, {"GONE.x", 0, true}});
  talk.hub.set_parameters({{"ARM.angle", 3.5}, {"ARM.speed", 4}, {"GONE.x", 0, true}});
  texts = talk.texts();
  REQUIRE(texts.size() == 1);  // the latest value alone
  CHECK(texts[0].at("parameters") == Json::parse(R"([{"name":"ARM.angle","type":"float64","value":3.5}])"));
  talk.say(Json::parse(R"({"op":"unsubscribeParameterUpdates","parameterNames":[]})"));
  talk.hub.set_parameters({{"ARM.angle", 1}, {"ARM.speed", 1}, {"GONE.x", 0, true}});
  CHECK(talk.texts().empty());
}

TEST_CASE("requests about parameters wait until the hub has those of the simulation") {
  Talk talk;
  talk.texts();
  const Json get = {{"op", "getParameters"}, {"parameterNames", {"ARM.angle"}}, {"id", "a"}};
  talk.hub.await_parameters();  // another client is there, so they are known
  talk.say(get);
  CHECK(talk.texts().size() == 1);
  talk.peer.reset();
  CHECK_FALSE(talk.hub.has_clients());
  talk.hub.await_parameters();
  FoxglovePeer late(talk.hub, 2);
  const auto said = [&] {
    std::vector<Json> texts;
    while (const std::optional<WireMessage> message = late.next()) {
      if (!message->binary) texts.push_back(Json::parse(message->head));
    }
    return texts;
  };
  said();
  CHECK(talk.hub.has_clients());
  late.receive(get.dump(), false);
  CHECK(said().empty());
  for (int i = 0; i < 100; ++i) late.receive(get.dump(), false);
  const std::vector<Json> refused = said();
  REQUIRE_FALSE(refused.empty());
  CHECK(refused[0].at("message") == "too many requests wait");
  talk.hub.set_parameters({{"ARM.angle", 7}, {"ARM.speed", 2}});
  const std::vector<Json> values = said();
  REQUIRE(values.size() + refused.size() == 101);
  CHECK(values[0].at("parameters")[0].at("value") == 7);
}

TEST_CASE("a watched parameter that is removed has no value, and those of another scene are not watched") {
  Talk talk;
  talk.say(Json::parse(R"({"op":"subscribeParameterUpdates","parameterNames":["ARM.speed"]})"));
  talk.texts();
  talk.hub.set_parameters({{"ARM.angle", 1.5}, {"ARM.speed", 2, true}, {"GONE.x", 0, true}});
  std::vector<Json> texts = talk.texts();
  REQUIRE(texts.size() == 1);
  CHECK(texts[0].at("parameters") == Json::parse(R"([{"name":"ARM.speed"}])"));
  talk.hub.set_parameters({{"OTHER.x", 1}, {"OTHER.y", 1}});
  talk.hub.set_parameters({{"OTHER.x", 2}, {"OTHER.y", 2}});
  CHECK(talk.texts().empty());
  // A scene with as many parameters has others, with their own places.
  talk.hub.set_parameters({{"THIRD.a", 5}, {"OTHER.x", 6}, {"OTHER.y", 7}});
  talk.say(Json::parse(R"({"op":"getParameters","parameterNames":["OTHER.x"]})"));
  texts = talk.texts();
  REQUIRE(texts.size() == 1);
  CHECK(texts[0].at("parameters") == Json::parse(R"([{"name":"OTHER.x","type":"float64","value":6.0}])"));
}

TEST_CASE("a client has a limited number of channels, and ids of a limited length") {
  Talk talk;
  const auto advertise = [](int id) {
    return Json{{"op", "advertise"},
                {"channels",
                 {{{"id", id}, {"topic", "/simvis/execute"}, {"encoding", "cdr"}, {"schemaName", "std_msgs/String"}}}}};
  };
  talk.texts();
  for (int i = 0; i < 64; ++i) talk.say(advertise(i));
  CHECK(talk.texts().empty());
  CHECK(talk.status_after(advertise(64)) == "too many channels");
  const Json request = {{"op", "getParameters"}, {"parameterNames", Json::array()}, {"id", std::string(257, 'i')}};
  CHECK(talk.status_after(request) == "the id of the request is too long");
}

TEST_CASE("commands of robots are published as CDR, on topics that elements take") {
  Talk talk;
  talk.hub.set_command_inputs({{"/cmd_vel", &ros::describe<ros::Twist>()}});
  talk.texts();
  const auto advertise = [](const char* topic, const char* schema, const char* encoding) {
    return Json{{"op", "advertise"},
                {"channels", {{{"id", 5}, {"topic", topic}, {"encoding", encoding}, {"schemaName", schema}}}}};
  };
  const std::string allowed = "expected one of: /simvis/execute, /cmd_vel of type geometry_msgs/msg/Twist";
  for (const Json& wrong : {advertise("/cmd_vel", "sensor_msgs/msg/Image", "cdr"),
                            advertise("/other", "geometry_msgs/msg/Twist", "cdr"), advertise("/cmd_vel", "", "cdr")}) {
    CHECK(talk.status_after(wrong).find(allowed) != std::string::npos);
  }
  CHECK(talk.status_after(advertise("/cmd_vel", "geometry_msgs/Twist", "json")).find("expected cdr") !=
        std::string::npos);
  for (const char* schema : {"geometry_msgs/Twist", "geometry_msgs/msg/Twist"}) {
    talk.say(advertise("/cmd_vel", schema, "cdr"));
    CHECK(talk.texts().empty());
    const std::string twist = ros::encode(ros::Twist{{1, 0, 0}, {}});
    talk.peer->receive(std::string("\1\5\0\0\0", 5) + twist, true);
    const std::optional<Control> control = talk.controls.next();
    REQUIRE(control);
    CHECK(control->kind == Control::Kind::command);
    CHECK(control->input == CommandInput{"/cmd_vel", &ros::describe<ros::Twist>()});
    CHECK(control->text == twist);
    talk.hub.answer_execute(control->client, "/cmd_vel: a number is not finite");
    CHECK(talk.texts().at(0).at("message") == "/cmd_vel: a number is not finite");
  }
}

TEST_CASE("change requests are published as CDR or JSON") {
  Talk talk;
  for (const std::string encoding : {"cdr", "json"}) {
    CAPTURE(encoding);
    talk.say({{"op", "advertise"},
              {"channels", {{{"id", 3}, {"topic", "/simvis/execute"}, {"encoding", encoding}, {"schemaName", "x"}}}}});
    const std::string payload = encoding == "json" ? R"({"data":"<a/>"})" : std::string("\0\1\0\0\5\0\0\0<a/>\0", 13);
    talk.peer->receive(std::string("\1\3\0\0\0", 5) + payload, true);
    const std::optional<Control> control = talk.controls.next();
    REQUIRE(control);
    CHECK(control->kind == Control::Kind::execute);
    CHECK(control->text == "<a/>");
    talk.texts();
    talk.peer->receive(std::string("\1\3\0\0\0", 5) + payload.substr(0, payload.size() - 1), true);
    CHECK(talk.texts().at(0).at("message") == "expected a std_msgs/msg/String");
    CHECK_FALSE(talk.controls.next());
  }
}

namespace {

/// A call as the client sends it: the service, the call 77, an encoding, and an empty request.
std::string service_call(std::uint8_t service, const std::string& encoding) {
  std::string bytes("\2\0\0\0\0\x4d\0\0\0\0\0\0\0", 13);
  bytes[1] = static_cast<char>(service);
  bytes[9] = static_cast<char>(encoding.size());
  return bytes + encoding;
}

}  // namespace

TEST_CASE("services pause the simulation and let it go on, and answer as CDR or JSON") {
  Talk talk;
  const std::vector<Json> texts = talk.texts();
  const Json& services = texts.back().at("services");
  REQUIRE(texts.back().at("op") == "advertiseServices");
  REQUIRE(services.size() == 4);
  CHECK(services[1].at("name") == "/simvis/pause");
  CHECK(services[1].at("type") == "std_srvs/srv/Trigger");
  talk.peer->receive(service_call(2, "cdr"), true);
  std::optional<Control> control = talk.controls.next();
  REQUIRE(control);
  CHECK(control->kind == Control::Kind::pause);
  REQUIRE(control->call);
  CHECK(talk.take_binary().empty());  // not before it is carried out
  talk.hub.answer_call(1, *control->call, "");
  std::vector<std::string> answers = talk.take_binary();
  REQUIRE(answers.size() == 1);
  CHECK(answers[0].substr(0, 16) == std::string("\3\2\0\0\0\x4d\0\0\0\3\0\0\0cdr", 16));
  // CDR: encapsulation, the bool, three bytes to a multiple of four, the text with its zero.
  CHECK(answers[0].substr(16, 12) == std::string("\0\1\0\0\1\0\0\0\x19\0\0\0", 12));
  CHECK(answers[0].substr(28) == std::string("the simulation is paused\0", 25));
  talk.peer->receive(service_call(4, "json"), true);
  control = talk.controls.next();
  REQUIRE(control);
  CHECK(control->kind == Control::Kind::save);
  talk.hub.answer_call(1, *control->call, "s.xml: error: has changed");
  answers = talk.take_binary();
  REQUIRE(answers.size() == 1);
  CHECK(Json::parse(answers[0].substr(17)) == Json{{"success", false}, {"message", "s.xml: error: has changed"}});
}

TEST_CASE("a call of no service, in no encoding or cut off is refused") {
  Talk talk;
  talk.texts();
  for (const std::string& wrong : {service_call(0, "cdr"), service_call(5, "cdr"), service_call(1, "protobuf")}) {
    talk.peer->receive(wrong, true);
    const std::vector<Json> texts = talk.texts();
    REQUIRE(texts.size() == 1);
    CHECK(texts[0].at("op") == "serviceCallFailure");
    CHECK(texts[0].at("callId") == 77);
  }
  for (const std::size_t size : {1u, 12u, 15u}) {
    talk.peer->receive(service_call(1, "cdr").substr(0, size), true);
    CHECK(talk.texts().at(0).at("message") == "this is no call of a service");
  }
  CHECK_FALSE(talk.controls.next());
}

TEST_CASE("who asks for it gets the graph of topics and services, and again when it changes") {
  Talk talk;
  talk.texts();
  talk.say({{"op", "subscribeConnectionGraph"}});
  std::vector<Json> texts = talk.texts();
  REQUIRE(texts.size() == 1);
  CHECK(texts[0].at("op") == "connectionGraphUpdate");
  CHECK(texts[0].at("publishedTopics").at(0) == Json{{"name", "/clock"}, {"publisherIds", Json::array({"/simvis"})}});
  CHECK(texts[0].at("subscribedTopics").at(0).at("name") == "/simvis/execute");
  CHECK(texts[0].at("advertisedServices").size() == 4);
  talk.hub.set_command_inputs({{"/cmd_vel", &ros::describe<ros::Twist>()}});
  texts = talk.texts();
  REQUIRE(texts.size() == 1);
  CHECK(texts[0].at("subscribedTopics").at(1).at("name") == "/cmd_vel");
  talk.say({{"op", "unsubscribeConnectionGraph"}});
  talk.hub.set_command_inputs({});
  CHECK(talk.texts().empty());
}

TEST_CASE("wrong messages give a status, and nothing else") {
  Talk talk;
  CHECK(talk.status_after({{"op", "fly"}}) == "there is no operation \"fly\" here");
  CHECK(talk.status_after({{"op", 3}}) == "the message is not as the protocol says");
  CHECK(talk.status_after({{"op", "subscribe"}, {"subscriptions", {subscription(1, 99)}}}) == "there is no channel 99");
  CHECK(talk.status_after({{"op", "subscribe"}, {"subscriptions", {subscription(1, 0)}}}).starts_with("there is no"));
  CHECK(talk.status_after({{"op", "subscribe"}, {"subscriptions", {subscription(-1, 1)}}}).starts_with("an id"));
  talk.say({{"op", "subscribe"}, {"subscriptions", {subscription(1, 1)}}});
  CHECK(
      talk.status_after({{"op", "subscribe"}, {"subscriptions", {subscription(1, 2)}}}).starts_with("subscription 1"));
  CHECK(talk.status_after({{"op", "unsubscribe"}, {"subscriptionIds", {5}}}) == "there is no subscription 5");
  CHECK(talk.status_after({{"op", "getParameters"}, {"parameterNames", 3}, {"id", 1}}).starts_with("the message"));
  std::mt19937 random(3);
  const std::string texts[] = {
      R"({"op":"subscribe","subscriptions":[{"id":3,"channelId":1}]})", R"({"op":"unsubscribe","subscriptionIds":[3]})",
      R"({"op":"setParameters","id":"x","parameters":[{"name":"ARM.speed","value":3}]})",
      R"({"op":"getParameters","parameterNames":["ARM.speed"]})",
      R"({"op":"advertise","channels":[{"id":1,"topic":"simvis/execute","encoding":"cdr","schemaName":"s"}]})"};
  for (int i = 0; i < 20'000; ++i) {
    std::string text = texts[random() % std::size(texts)];
    for (int changes = static_cast<int>(random() % 4); changes > 0; --changes) {
      const std::size_t at = random() % text.size();
      if (random() % 2 == 0)
        text[at] = static_cast<char>(random());
      else
        text.erase(at, random() % 5);
    }
    CHECK_NOTHROW(talk.peer->receive(text, random() % 5 == 0));
    while (talk.controls.next()) {
    }
    if (i % 100 == 0) talk.take_binary();
  }
  talk.take_binary();
  CHECK(talk.status_after({{"op", "fly"}}) == "there is no operation \"fly\" here");
}

TEST_CASE("a client fetches the files that the descriptions of robots name, and no others") {
  const TemporaryFolder folder;
  write_text(folder / "base.stl", std::string("solid\0base", 10));
  Talk talk;
  talk.texts();
  talk.hub.set_assets(
      {{"package://arm/base.stl", folder / "base.stl"}, {"package://arm/gone.stl", folder / "gone.stl"}});
  const auto fetched = [&](const std::string& uri) {
    talk.say({{"op", "fetchAsset"}, {"uri", uri}, {"requestId", 7}});
    const std::vector<std::string> got = talk.take_binary();
    REQUIRE(got.size() == 1);
    CHECK(got[0].substr(0, 5) == std::string("\4\7\0\0\0", 5));
    return got[0].substr(5);
  };
  // The status, the length of the error, the error, and the bytes of the file.
  CHECK(fetched("package://arm/base.stl") == std::string("\0\0\0\0\0solid\0base", 15));
  for (const std::string& other :
       {(folder / "base.stl").string(), std::string("package://arm/../base.stl"), std::string()}) {
    const std::string refused = fetched(other);
    CHECK(refused[0] == 1);
    CHECK(refused.ends_with(": no description of a robot names such a file"));
  }
  const std::string gone = fetched("package://arm/gone.stl");
  CHECK(gone[0] == 1);
  // A link or a FIFO that has taken the name, or the folder's, since the file was read for the robot.
  const TemporaryFolder elsewhere;
  for (const char* const file : {"gone.stl", "secret"}) write_text(elsewhere / file, "secret");
  std::filesystem::create_symlink(elsewhere / "secret", folder / "gone.stl");
  CHECK(fetched("package://arm/gone.stl") == gone);
  std::filesystem::remove(folder / "gone.stl");
  REQUIRE(::mkfifo((folder / "gone.stl").c_str(), 0600) == 0);
  CHECK(fetched("package://arm/gone.stl") == gone);
  talk.hub.set_assets({{"package://arm/gone.stl", folder / "meshes/gone.stl"}});
  std::filesystem::create_directory_symlink(elsewhere.path(), folder / "meshes");
  CHECK(fetched("package://arm/gone.stl") == gone);
  CHECK(talk.status_after({{"op", "fetchAsset"}, {"uri", 1}, {"requestId", 7}}) ==
        "the message is not as the protocol says");
}

}  // namespace simvis::live

TEST_SUITE_END();
