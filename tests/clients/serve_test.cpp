// A served simulation: what clients write changes what it measures, and what it measures reaches them.
#include <doctest/doctest.h>

#include <cmath>
#include <memory>
#include <new>
#include <thread>

#include <simvis/element.h>
#include <simvis/simulation.h>
#include <simvis_client/connection.h>
#include "tests/clients/python_client.h"
#include "tests/clients/shared_host.h"
#include "tests/support/error_of.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

using namespace simvis;
using client::Connection;

TEST_SUITE_BEGIN("clients");

namespace {

constexpr double kWall_m = 4;
// A range is a float: half a unit in its last place, relative.
constexpr double kRounding = 0x1p-24;

/// A scanner of one beam that looks along x and stands at the element MOVE, before a wall.
struct ServedWall {
  explicit ServedWall(const std::string& test, ServeDesc desc = {}) : name(unique_name(test)) {
    desc.name = name;
    desc.folders.push_back(folder.path());
    simulation.serve(desc);
  }
  TemporaryFolder folder;
  std::string name;
  Simulation simulation = Simulation::load(write_wall_scene(folder.path(), R"(
    <element type="pose" name="MOVE" insert_at="ROOT"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="1" min_angle="0" max_angle="0"/>)"));

  /// The range that a client reads after the next frame.
  double range_m(const Connection& connection) {
    simulation.step();
    return connection.latest(connection.sensor("SCAN"))->output<float>("range_m")[0];
  }
};

/// The entries of the log of these kinds, as texts.
std::vector<std::string> log_of(const Connection& connection, std::initializer_list<simvis_log_kind> kinds) {
  std::vector<std::string> texts;
  std::uint64_t position = 0;
  while (const auto entry = connection.next_log(position)) {
    if (std::ranges::find(kinds, entry->kind) != kinds.end()) texts.emplace_back(entry->text);
  }
  return texts;
}

const ElementRegistration kTooLarge({.name = "test_too_large",
                                     .summary = "does not fit into memory",
                                     .attributes = {},
                                     .create = [](const ElementContext&) -> std::unique_ptr<Element> {
                                       throw std::bad_alloc();
                                     }});

}  // namespace

TEST_CASE("a request for which the memory does not suffice is refused, and the host lives on") {
  ServedWall served("serve-memory");
  Connection connection(served.name, "editor");
  connection.send(R"(<element type="test_too_large" name="LARGE" insert_at="ROOT"/>)");
  CHECK(served.range_m(connection) == doctest::Approx(kWall_m).epsilon(kRounding));
  const std::vector<std::string> refused = log_of(connection, {SIMVIS_REQUEST_REFUSED});
  REQUIRE(refused.size() == 1);
  CHECK(contains(refused[0], "memory"));
  CHECK(served.range_m(connection) == doctest::Approx(kWall_m).epsilon(kRounding));
}

TEST_CASE("a value that a client writes moves the scanner in the next frame") {
  ServedWall served("serve-values");
  Connection connection(served.name, "driver");
  CHECK(served.range_m(connection) == doctest::Approx(kWall_m).epsilon(kRounding));
  const std::int64_t x = connection.parameter("MOVE", "x");
  connection.set(x, 1.5);
  CHECK(served.range_m(connection) == doctest::Approx(kWall_m - 1.5).epsilon(kRounding));
  CHECK(served.simulation.get("MOVE", "x") == 1.5);
  const auto measurement = connection.latest(0);
  CHECK(measurement->slot().frame == 1);
  CHECK(measurement->slot().world_from_sensor[12] == 1.5);
  connection.set_element(connection.element("MOVE"), std::array<double, kPoseValues>{2, 0, 0, 0, 0, 60});
  CHECK(served.range_m(connection) == doctest::Approx((kWall_m - 2) * 2).epsilon(kRounding * 4));  // 1 / cos 60
  served.simulation.set("MOVE", "yaw", 0);  // the host's own values reach clients
  CHECK(served.range_m(connection) == doctest::Approx(kWall_m - 2).epsilon(kRounding));
  CHECK(connection.value(connection.parameter("MOVE", "yaw")) == 0);
}

TEST_CASE("a value that is not allowed is refused with its reason, and the old one comes back") {
  ServedWall served("serve-refused");
  Connection connection(served.name, "driver");
  const std::int64_t x = connection.parameter("MOVE", "x");
  connection.set(x, 1);
  served.range_m(connection);
  connection.set(x, std::nan(""));
  connection.set_element(0, std::array<double, kPoseValues>{3, 0, 0, 0, HUGE_VAL, 0});
  CHECK(served.range_m(connection) == doctest::Approx(kWall_m - 1).epsilon(kRounding));
  CHECK(connection.value(x) == 1);
  const std::vector<std::string> refused = log_of(connection, {SIMVIS_VALUE_REFUSED});
  REQUIRE(refused.size() == 2);
  CHECK(refused[0].starts_with("MOVE.x: nan"));
  CHECK(refused[1].starts_with("MOVE.pitch: inf"));
}

TEST_CASE("requests: executed as a whole or refused as a whole, with the outcome in the log") {
  ServedWall served("serve-requests");
  Connection connection(served.name, "editor");
  const std::size_t before = log_of(connection, {SIMVIS_CHANGE}).size();
  CHECK(before == 3);
  connection.send(R"(<element type="pose" name="NEAR_POSE" insert_at="ROOT" x="-1"/>
                     <part file="wall.gltf" name="NEAR" insert_at="ROOT"/>)");
  // The second wall stands at the new element, 1 m nearer.
  CHECK(served.range_m(connection) == doctest::Approx(kWall_m - 1).epsilon(kRounding));
  CHECK(log_of(connection, {SIMVIS_REQUEST_DONE}).size() == 1);
  CHECK(log_of(connection, {SIMVIS_CHANGE}).size() == before + 2);
  CHECK_NOTHROW(connection.parameter("NEAR_POSE", "x"));
  connection.send(
      R"(<element type="pose" name="HALF" insert_at="ROOT"/><part file="none.gltf" name="X" insert_at="ROOT"/>)");
  connection.send("<part file='/etc/passwd' name='P' insert_at='ROOT'/>");
  connection.send("<part file='../wall.gltf' name='P' insert_at='ROOT'/>");
  connection.send("no XML");
  served.range_m(connection);
  const std::vector<std::string> refused = log_of(connection, {SIMVIS_REQUEST_REFUSED});
  REQUIRE(refused.size() == 4);
  CHECK(refused[0].starts_with("request 2:1:"));
  CHECK(refused[0].find("there is no part file") != std::string::npos);
  CHECK(refused[1].find("a request may not use") != std::string::npos);
  CHECK(refused[2].find("a request may not use") != std::string::npos);
  CHECK(refused[3].starts_with("request 5"));
  CHECK_THROWS(connection.element("HALF"));
  CHECK(log_of(connection, {SIMVIS_CHANGE}).size() == before + 2);
}

TEST_CASE("serving changes no byte of a measurement; a simulation is served once, under a name that is free") {
  ServedWall served("serve-bytes"), other("serve-other");
  TemporaryFolder folder;
  Simulation alone = Simulation::load(served.folder.path() / "scene.xml");
  for (int frame = 0; frame < 3; ++frame) {
    served.simulation.set("MOVE", "y", 0.1 * frame);
    alone.set("MOVE", "y", 0.1 * frame);
    served.simulation.step();
    alone.step();
    CHECK(served.simulation.scan("SCAN").range_m == alone.scan("SCAN").range_m);
  }
  CHECK(error_of([&] { served.simulation.serve({.name = "again"}); }).find("served already") != std::string::npos);
  CHECK(error_of([&] { alone.serve({.name = other.name}); }).find("a living simulation") != std::string::npos);
  CHECK(error_of([&] {
          alone.serve({.name = unique_name("f"), .folders = {folder.path() / "none"}});
        }).find("there is no folder") != std::string::npos);
}

TEST_CASE("lock-step: a frame waits for the client that is named, and says which one is missing") {
  ServedWall served("serve-lockstep", {.name = "", .folders = {}, .lockstep = {"driver"}, .lockstep_timeout_s = 0.2});
  const auto failure = [&]() -> std::string {
    try {
      served.simulation.step();
    } catch (const MachineError& error) {
      return error.what();
    }
    return "";
  };
  CHECK(failure().find("client \"driver\" is not connected for frame 0") != std::string::npos);
  Connection driver(served.name, "driver");
  CHECK(failure().find("client \"driver\" is not ready for frame 0") != std::string::npos);
  constexpr int kFrames = 5;
  std::thread client([&] {
    for (int frame = 0; frame < kFrames; ++frame) {
      driver.set(0, 0.5 * frame);
      driver.ready();
      driver.wait_frame(static_cast<std::uint64_t>(frame), 5000);
    }
  });
  for (int frame = 0; frame < kFrames; ++frame) {
    served.simulation.step();
    CHECK(served.simulation.scan("SCAN").range_m[0] == doctest::Approx(kWall_m - 0.5 * frame).epsilon(kRounding));
  }
  client.join();
}

namespace {

/// Steps the simulation until the program ends.
ProcessResult run_beside(Simulation& simulation, const std::vector<std::string>& arguments) {
  bool done = false;
  ProcessResult result;
  std::thread runner([&] {
    result = Process(arguments, python_client_environment()).wait(std::chrono::seconds(30));
    done = true;
  });
  while (!__atomic_load_n(&done, __ATOMIC_ACQUIRE)) simulation.step();
  runner.join();
  return result;
}

}  // namespace

TEST_CASE("simvis-ctl: list, get, set, send and log") {
  ServedWall served("serve-ctl");
  const std::string ctl = tested_build() + "/bin/simvis-ctl";
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {ctl, served.name});
    return run_beside(served.simulation, arguments);
  };
  CHECK(run({"list"}).out.find("  MOVE.yaw = 0 deg (-inf, inf)\n") != std::string::npos);
  CHECK(run({"set", "MOVE.x=1.25", "MOVE.yaw=5"}).exit_code == 0);
  CHECK(run({"get", "MOVE.x", "MOVE.yaw"}).out == "1.25\n5\n");
  write_text(served.folder.path() / "more.xml", R"(<element type="pose" name="MORE" insert_at="ROOT"/>)");
  CHECK(run({"send", (served.folder.path() / "more.xml").string()}).exit_code == 0);
  const ProcessResult twice = run({"send", (served.folder.path() / "more.xml").string()});
  CHECK(twice.exit_code == 1);
  CHECK(twice.err.find("\"MORE\"") != std::string::npos);
  CHECK(run({"log"}).out.find("refused, request 1 of client") != std::string::npos);
  CHECK(run({"get", "MOVE.w"}).exit_code == 2);
  CHECK(run({"get"}).exit_code == 2);
  CHECK(run({"set", "MOVE.x=much"}).exit_code == 2);
  const ProcessResult beyond = run({"set", "MOVE.x=1e99", "MOVE.y=2"});
  CHECK(beyond.exit_code == 2);
  CHECK(beyond.err.find("simvis-ctl: MOVE.x: 1e+99") != std::string::npos);
  CHECK(run({"get", "MOVE.x", "MOVE.y"}).out == "1.25\n0\n");
  CHECK(Process({ctl, unique_name("none"), "list"}).wait().exit_code == 1);
}

TEST_CASE("the Python client reads and writes") {
  if (Process({"/usr/bin/python3", "-c", "import numpy"}).wait().exit_code != 0) {
    return test::skip("there is no NumPy for /usr/bin/python3");
  }
  ServedWall served("serve-python");
  const std::string script = R"(
import math, os, socket, threading
import simvis_client
with simvis_client.connect(")" +
                             served.name + R"(", client="python", timeout_s=5) as sim:
    assert sim.elements() == ["MOVE"] and sim.sensors() == ["SCAN"], sim.elements()
    sim["MOVE"].set(x=1.5, yaw=60)
    for _ in range(2):
        assert sim.wait_frame(timeout_s=5)
    scan = sim.latest("SCAN")
    assert scan["range_m"].shape == (1, 1) and abs(scan["range_m"][0, 0] - 5) <= 5 * 2**-22, scan["range_m"]
    assert scan.world_from_sensor[0, 3] == 1.5 and abs(scan.world_from_sensor[1, 0] - math.sin(math.pi / 3)) < 1e-15
    sim["MOVE"]["yaw"] = 0
    number = sim.send('<element type="pose" name="MORE" insert_at="ROOT"/>')
    for _ in range(2):
        assert sim.wait_frame(timeout_s=5)
    assert sim["MOVE"]["yaw"] == 0 and "MORE" in sim
    assert (simvis_client.REQUEST_DONE, number) in [entry[:2] for entry in sim.log()[0]]
    frame, values = sim.applied()
    assert list(values[:2]) == [1.5, 0] and frame >= 4
    try:
        sim["MOVE"]["w"]
    except simvis_client.SimvisError as error:
        assert "expected one of: x, y, z" in str(error)
# What a client wrote counts although its arrays keep the memory, and its place is free.
with simvis_client.connect(")" +
                             served.name +
                             R"(", client="leaver") as left:
    left.send('<element type="pose" name="LAST" insert_at="ROOT"/>')
with simvis_client.connect(")" +
                             served.name +
                             R"(", client="after") as sim:
    for _ in range(3):
        assert sim.wait_frame(timeout_s=5)
    assert "LAST" in sim
files = len(os.listdir("/proc/self/fd"))
for wrong in "a/b", "", 64 * "n", ")" +
                             served.name +
                             R"(-none":
    for _ in range(3):
        try:
            simvis_client.connect(wrong)
            assert False, wrong
        except simvis_client.SimvisError:
            pass
false_host = socket.socket(socket.AF_UNIX)
false_host.bind("\0simvis-)" +
                             served.name +
                             R"(-broken")
false_host.listen()
def answer(memory):
    with false_host.accept()[0] as client:
        socket.send_fds(client, [b"x"], [memory])
for memory in os.open("/dev/null", os.O_RDWR), os.memfd_create("sparse"):
    thread = threading.Thread(target=answer, args=(memory,))
    thread.start()
    try:
        simvis_client.connect(")" +
                             served.name +
                             R"(-broken")
        assert False
    except simvis_client.SimvisError as error:
        assert "is no simulation" in str(error), error
    thread.join()
    os.close(memory)
false_host.close()
assert len(os.listdir("/proc/self/fd")) == files
)";
  const ProcessResult result = run_beside(served.simulation, {"/usr/bin/python3", "-c", script});
  CHECK(result.err == "");
  CHECK(result.exit_code == 0);
}

TEST_SUITE_END();
