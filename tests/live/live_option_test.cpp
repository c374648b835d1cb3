// simvis-run --live: what a browser and Foxglove see of a run, and what they change in it.
#include <doctest/doctest.h>
#include <signal.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "exchange/messages/types/marker_types.h"
#include "tests/live/live_program.h"
#include "tests/live/page_client.h"
#include "tests/live/web_client.h"
#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"

TEST_SUITE_BEGIN("live");

namespace simvis {

using Json = nlohmann::json;
using test::http_get;
using test::index_of;
using test::LiveProcess;
using test::LiveProgram;
using test::Page;
using test::WebSocketClient;

TEST_CASE("a page gets the scene, and a slider moves its sensors: the next scan has another range") {
  LiveProgram program;
  Page page(program.port), other(program.port);
  CHECK(page.range([](float) { return true; }) == doctest::Approx(3));
  page.socket.send({{"op", "set"}, {"parameter", page.move_x}, {"value", 0.5}});
  CHECK(page.range([](float range) { return range < 2.75f; }) == doctest::Approx(2.5));
  CHECK(other.range([](float range) { return range < 2.75f; }) == doctest::Approx(2.5));  // two pages see the same
  const std::string glb = http_get(program.port, "/" + page.scene.at("glb").get<std::string>()).body;
  CHECK(glb.starts_with("glTF"));
  CHECK(http_get(program.port, "/scene.glb?structure=999").status == 404);
  CHECK(http_get(program.port, "/").status == 200);
  page.socket.send({{"op", "set"}, {"parameter", page.move_x}, {"value", "text"}});
  CHECK(page.socket.receive_op("error").at("about") == "set");
  page.socket.send({{"op", "set"}, {"parameter", 99'999}, {"value", 1}});
  CHECK(page.socket.receive_op("error").at("about") == "set");
  page.socket.socket().close();  // as a browser that is killed
  CHECK(other.frame().at("playing") == true);
  const ProcessResult result = program.interrupt();
  CHECK(result.exit_code == 130);
  CHECK_FALSE(std::filesystem::exists("out"));
}

TEST_CASE("a page pauses the run, makes single frames and plays on") {
  LiveProgram program;
  Page page(program.port);
  page.socket.send({{"op", "pause"}});
  const auto is_paused = [](const Json& message) {
    return message.at("op") == "frame" && message.at("playing") == false;
  };
  const std::uint64_t frame = page.socket.receive_until(is_paused).at("frame");
  page.socket.send({{"op", "step"}});
  const auto is_next = [&](const Json& message) {
    return message.at("op") == "frame" && message.at("frame") == frame + 1;
  };
  CHECK(page.socket.receive_until(is_next).at("playing") == false);
  Page late(program.port);  // sees the frame although none is made
  CHECK(late.frame().at("frame") == frame + 1);
  page.socket.send({{"op", "play"}});
  page.socket.receive_until([&](const Json& message) {
    return message.at("op") == "frame" && message.at("playing") == true && message.at("frame") > frame + 3;
  });
  page.socket.send({{"op", "speed"}, {"factor", -1}});
  CHECK(page.socket.receive_op("error").at("about") == "speed");
  CHECK(program.interrupt().exit_code == 130);
}

TEST_CASE("commands are executed or refused, and the scene is saved with its comments") {
  LiveProgram program;
  const std::string before = read_text(program.scene());
  Page page(program.port);
  page.socket.send({{"op", "execute"}, {"xml", "<sensor type='laser_scaner' name='NEW' insert_at='ROOT'/>"}});
  const Json refused = page.socket.receive_op("error");
  CHECK(refused.at("about") == "execute");
  CHECK(refused.at("message").get<std::string>().find("laser_scanner") != std::string::npos);
  page.socket.send({{"op", "execute"}, {"xml", "<sensor type='laser_scanner' name='NEW' insert_at='ROOT'/>"}});
  const Json scene = page.socket.receive_op("scene");
  CHECK(index_of(scene.at("sensors"), "name", "NEW") > 0);
  page.socket.send({{"op", "set"}, {"parameter", page.move_x}, {"value", 0.25}});
  page.socket.send({{"op", "save"}});
  const std::string saved = page.socket.receive_op("saved").at("xml");
  CHECK(saved == read_text(program.scene()));
  CHECK(saved.find("x=\"0.25\"") != std::string::npos);
  CHECK(saved.find("name=\"NEW\"") != std::string::npos);
  write_text(program.scene(), before);
  page.socket.send({{"op", "save"}});
  CHECK(page.socket.receive_op("error").at("message").get<std::string>().find("has changed") != std::string::npos);
  CHECK(read_text(program.scene()) == before);
  program.interrupt();
}

TEST_CASE("a frame that cannot be made pauses the run, and does not end it") {
  LiveProgram program;
  Page page(program.port);
  page.socket.send({{"op", "execute"},
                    {"xml",
                     "<sensor type='laser_scanner' name='EXACT' insert_at='ROOT' "
                     "method='hybrid' max_error_m='1e-30' samples='3'/>"}});
  const Json error = page.socket.receive_op("error");
  CAPTURE(error.dump());
  CHECK(error.at("about") == "step");
  page.socket.send({{"op", "execute"}, {"xml", "<remove name='EXACT'/>"}});
  page.socket.send({{"op", "play"}});
  page.socket.receive_until(
      [](const Json& message) { return message.at("op") == "frame" && message.at("playing") == true; });
  program.interrupt();
}

TEST_CASE("a page reads no file outside of the allowed folders, and no message quotes what a file holds") {
  LiveProgram program;
  const TemporaryFolder elsewhere;
  const std::string secret = "secret-of-another-folder";
  write_text(elsewhere / "shadow", secret + ":$6$:19000\n");
  write_text(elsewhere / "shadow.obj", "v 0 0 0\n");
  write_text(program.folder / "own.txt", secret + " in the own folder\n");
  write_text(program.folder / "own.mtl", secret + "\n");
  write_text(program.folder / "own.obj", "mtllib own.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  Page page(program.port);
  const auto refusal = [&](const std::string& xml) {
    page.socket.send({{"op", "execute"}, {"xml", xml}});
    const std::string text = page.socket.receive_op("error").dump();
    CHECK_MESSAGE(text.find("secret") == std::string::npos, text);
    return text;
  };
  const std::string outside = elsewhere.path().string();
  for (const std::string& xml :
       {"<include file='" + outside + "/shadow'/>", "<include file='" + outside + "/missing'/>",
        "<part name='P' insert_at='ROOT' file='" + outside + "/shadow.obj'/>",
        "<part name='P' insert_at='ROOT' shape='box' size='1 1 1' texture='" + outside + "/shadow'/>",
        "<part name='P' insert_at='ROOT' shape='heightmap' size='1 1' heights='" + outside + "/shadow'/>"}) {
    CHECK_MESSAGE(refusal(xml).find("a request may not use the file") != std::string::npos, xml);
  }
  CHECK(refusal("<element type='sky_light' name='S' insert_at='ROOT' picture='" + outside + "/shadow.exr'/>")
            .find("a request may not use the file") != std::string::npos);
  // The scene is read again when it is saved.
  write_text(program.folder / "points.xyz", "1 2 3\n");
  page.socket.send(
      {{"op", "execute"}, {"xml", "<element type='point_cloud' name='CLOUD' insert_at='ROOT' file='points.xyz'/>"}});
  page.socket.receive_until([](const Json& message) {
    return message.at("op") == "scene" && message.dump().find("CLOUD") != std::string::npos;
  });
  std::filesystem::remove(program.folder / "points.xyz");
  std::filesystem::create_symlink(elsewhere / "shadow", program.folder / "points.xyz");
  page.socket.send({{"op", "save"}});
  const std::string unsaved = page.socket.receive_op("error").dump();
  CHECK_MESSAGE(unsaved.find("secret") == std::string::npos, unsaved);
  CHECK(refusal("<include file='own.txt'/>").find("text \\\"...\\\" between commands") != std::string::npos);
  CHECK(refusal("<part name='P' insert_at='ROOT' file='own.obj'/>").find("own.mtl") != std::string::npos);
  CHECK(refusal("<part name='P' insert_at='ROOT' shape='bax'/>").find("did you mean \\\"box\\\"?") !=
        std::string::npos);
  program.interrupt();

  LiveProcess allowed;
  allowed.start({program.scene().string(), "--allow", outside}, "0", program.folder / "allowed.txt");
  Page other(allowed.port);
  other.socket.send({{"op", "execute"}, {"xml", "<part name='P' insert_at='ROOT' shape='box' size='1 1 1'/>"}});
  other.socket.send({{"op", "save"}});  // the scene lies elsewhere now
  CHECK(other.socket.receive_op("error").dump().find("a request may not use the file") != std::string::npos);
  allowed.interrupt();
}

TEST_CASE("the page has a policy that lets in nothing but its own files") {
  LiveProgram program;
  const test::HttpAnswer page = http_get(program.port, "/");
  std::smatch nonce;
  REQUIRE(std::regex_search(
      page.head, nonce,
      std::regex("Content-Security-Policy: default-src 'self'; script-src 'self' 'nonce-(\\w{32})';")));
  CHECK(page.head.find("object-src 'none'") != std::string::npos);
  CHECK(page.head.find("frame-ancestors 'none'") != std::string::npos);
  CHECK(page.body.find("<script nonce=\"" + nonce[1].str() + "\" type=\"importmap\">") != std::string::npos);
  program.interrupt();
}

TEST_CASE("Foxglove's clients get topics and parameters under both names of the protocol") {
  LiveProgram program;
  for (const char* const protocol : {"foxglove.sdk.v1", "foxglove.websocket.v1"}) {
    CAPTURE(protocol);
    WebSocketClient client(program.port, protocol, "/?token=" + program.token, "Origin: https://foreign.example\r\n");
    CHECK(client.head().find(std::string("Sec-WebSocket-Protocol: ") + protocol + "\r\n") != std::string::npos);
    std::size_t channel = 0;
    client.receive_until([&](const Json& message) {
      if (message.at("op") != "advertise") return false;
      for (const Json& each : message.at("channels")) {
        if (each.at("topic") == "/SCAN/points") channel = each.at("id");
      }
      return channel > 0;
    });
    client.send({{"op", "subscribe"}, {"subscriptions", {{{"id", 4}, {"channelId", channel}}}}});
    client.receive_binary([](const std::string& bytes) { return bytes.starts_with(std::string("\1\4\0\0\0", 5)); });
    client.send(Json::parse(R"({"op":"setParameters","id":"q","parameters":[{"name":"MOVE.x","value":0.75}]})"));
    const Json values = client.receive_op("parameterValues");
    CHECK(values.at("id") == "q");
    CHECK(values.at("parameters")[0].at("value") == 0.75);
  }
  CHECK_THROWS(WebSocketClient(program.port, "foxglove.sdk.v1", "/", "Origin: https://foreign.example\r\n"));
  program.interrupt();
}

TEST_CASE("Foxglove's clients get the objects of the scene as boxes with their paths") {
  LiveProgram program;
  WebSocketClient client(program.port, "foxglove.sdk.v1", "/?token=" + program.token);
  std::size_t channel = 0;
  client.receive_until([&](const Json& message) {
    if (message.at("op") != "advertise") return false;
    for (const Json& each : message.at("channels")) {
      if (each.at("topic") != "/simvis/objects") continue;
      CHECK(each.at("schemaName") == "visualization_msgs/msg/MarkerArray");
      channel = each.at("id");
    }
    return channel > 0;
  });
  client.send({{"op", "subscribe"}, {"subscriptions", {{{"id", 4}, {"channelId", channel}}}}});
  const std::string head("\1\4\0\0\0", 5);
  const std::string bytes = client.receive_binary([&](const std::string& each) { return each.starts_with(head); });
  constexpr std::size_t kTimeBytes = 8;
  const auto array = ros::decode<ros::MarkerArray>(std::string_view(bytes).substr(head.size() + kTimeBytes));
  REQUIRE(array.markers.size() == 2);  // the first one deletes those of earlier frames
  CHECK(array.markers[0].action == ros::Marker::kDeleteAll);
  CHECK(array.markers[1].ns == "WALL");
  CHECK(array.markers[1].pose.position.x == 4);
  CHECK(array.markers[1].scale.y == 20);
  program.interrupt();
}

TEST_CASE("Foxglove's clients pause a run, make one frame and let it go on by services") {
  LiveProgram program;
  Page page(program.port);
  WebSocketClient client(program.port, "foxglove.sdk.v1", "/?token=" + program.token);
  const auto call = [&](char service) {
    std::string request("\2\0\0\0\0\7\0\0\0\4\0\0\0json", 17);
    request[1] = service;
    client.send_binary(request);
    std::string answer;
    client.receive_binary([&](const std::string& bytes) {
      answer = bytes;
      return bytes[0] == 3;
    });
    REQUIRE(answer.substr(0, 17) == std::string("\3") + service + std::string("\0\0\0\7\0\0\0\4\0\0\0json", 15));
    return Json::parse(answer.substr(17));
  };
  CHECK(call(2) == Json{{"success", true}, {"message", "the simulation is paused"}});
  Json frame = page.frame();
  while (frame.at("playing") == true) frame = page.frame();
  const auto index = frame.at("frame").get<std::uint64_t>();
  CHECK(call(3).at("success") == true);
  frame = page.frame();
  while (frame.at("frame").get<std::uint64_t>() == index) frame = page.frame();
  CHECK(frame.at("frame").get<std::uint64_t>() == index + 1);
  CHECK(frame.at("playing") == false);
  CHECK(call(1).at("success") == true);
  while (page.frame().at("frame").get<std::uint64_t>() < index + 3) {
  }
  program.interrupt();
}

TEST_CASE("a run that was killed begins again at the same port") {
  LiveProgram program;
  const std::uint16_t port = program.port;
  Page page(port);
  program.process->send(SIGKILL);
  program.process->wait();
  const auto read_to_the_end = [&] {  // frames may have arrived before
    while (true) page.frame();
  };
  CHECK_THROWS(read_to_the_end());
  program.start(std::to_string(port));
  CHECK(program.port == port);
  Page again(port);
  CHECK(again.range([](float) { return true; }) == doctest::Approx(3));
  program.interrupt();
}

TEST_CASE("--live with --frames ends by itself, and a port that is taken is an error") {
  LiveProgram program;
  const ProcessResult taken = run_simvis({"--live", std::to_string(program.port), program.scene().string()});
  CHECK(taken.exit_code == 1);
  CHECK(taken.err.find("cannot listen at 127.0.0.1") != std::string::npos);
  program.interrupt();
  const ProcessResult done = run_simvis({program.scene().string(), "--frames", "3", "--live", "0"});
  CHECK(done.exit_code == 0);
  CHECK(run_simvis({"--live-address", "127.0.0.1", program.scene().string()}).exit_code == 2);
  CHECK(run_simvis({"--live", "70000", program.scene().string()}).exit_code == 2);
}

}  // namespace simvis

TEST_SUITE_END();
