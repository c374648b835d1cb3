// simvis-run --live --follow: a page beside a simulation that runs already.
#include <doctest/doctest.h>
#include <signal.h>
#include <unistd.h>

#include <nlohmann/json.hpp>

#include <simvis_client/connection.h>
#include "tests/live/live_program.h"
#include "tests/live/page_client.h"

TEST_SUITE_BEGIN("live");

namespace simvis {
namespace {

/// A host of the wall's scene, and a page's server beside it.
struct FollowedHost {
  FollowedHost() {
    write_wall_scene(folder.path(), kWallSensors);
    serve();
    live.start({"--follow", name}, "0", folder / "live.txt");
  }
  void serve() {
    host = std::make_unique<Process>(Strings{simvis_run(), (folder / "scene.xml").string(), "--serve", name, "--quiet",
                                             "--real-time", "1", "--out", (folder / "out").string()});
  }
  TemporaryFolder folder;
  std::string name = "test-live-follow-" + std::to_string(::getpid());
  std::unique_ptr<Process> host;
  test::LiveProcess live;
};

}  // namespace

TEST_CASE("a page beside a host shows what the host measures, changes it, and finds the next host") {
  FollowedHost followed;
  test::Page page(followed.live.port);
  CHECK(page.range([](float) { return true; }) == doctest::Approx(3));
  page.socket.send({{"op", "set"}, {"parameter", page.move_x}, {"value", 0.5}});
  CHECK(page.range([](float range) { return range < 2.75f; }) == doctest::Approx(2.5));  // the host's own scan
  page.socket.send({{"op", "set"}, {"parameter", page.move_x}, {"value", 1e300 * 1e10}});
  CHECK(page.socket.receive_op("error").at("about") == "set");
  page.socket.send({{"op", "execute"}, {"xml", "<sensor type='laser_scanner' name='NEW' insert_at='ROOT'/>"}});
  CHECK(test::index_of(page.socket.receive_op("scene").at("sensors"), "name", "NEW") > 0);
  {
    client::Connection connection(followed.name, "test", test::kPatience_ms);
    CHECK_NOTHROW(connection.sensor("NEW"));
  }
  page.socket.send({{"op", "save"}});
  const std::string refused = page.socket.receive_op("error").at("message");
  CHECK(refused.find("another process") != std::string::npos);
  const auto host_is = [](test::Page& of, const std::string& state) {
    while (of.frame().at("host") != state) {
    }
  };
  CHECK(page.frame().at("host") == "runs");
  followed.host->send(SIGSTOP);
  host_is(page, "stands");
  {
    test::Page late(followed.live.port);  // it gets the scene and the last scan nevertheless
    CHECK(late.range([](float) { return true; }) == doctest::Approx(2.5));
    host_is(late, "stands");
  }
  followed.host->send(SIGCONT);
  host_is(page, "runs");
  followed.host->send(SIGKILL);
  followed.host->wait();
  host_is(page, "ended");
  page.socket.send({{"op", "set"}, {"parameter", page.move_x}, {"value", 0.25}});
  CHECK(page.socket.receive_op("error").at("message").get<std::string>().find("has ended") != std::string::npos);
  followed.serve();
  const nlohmann::json scene = page.socket.receive_op("scene");
  for (const nlohmann::json& sensor : scene.at("sensors")) CHECK(sensor.at("name") != "NEW");
  page.socket.send({{"op", "look"}, {"sensors", {page.scanner}}});
  CHECK(page.range([](float range) { return range > 2.75f; }) == doctest::Approx(3));
  CHECK(followed.live.interrupt().exit_code == 130);
  followed.host->send(SIGINT);
  CHECK(followed.host->wait().exit_code == 130);
}

}  // namespace simvis

TEST_SUITE_END();
