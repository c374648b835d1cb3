// What clients see of a host, and the host of its clients, in one process.
#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/clients/shared_host.h"
#include "tests/support/error_of.h"

using namespace simvis;
using client::Connection;

TEST_SUITE_BEGIN("clients");

TEST_CASE("a client finds elements, parameters with units and limits, and sensors by name") {
  const std::string name = unique_name("find");
  SharedHost host(name);
  host.publish();
  add_pose(host, "A");
  add_pose(host, "B");
  host.add_sensor("FRONT", "laser_scanner");
  const Connection connection(name, "tester");
  CHECK(connection.alive());
  CHECK(connection.element("B") == 1);
  CHECK(connection.parameter("B", "yaw") == 11);
  CHECK(connection.sensor("FRONT") == 0);
  const simvis_parameter& row = *simvis_parameter_at(connection.get(), connection.parameter("B", "x"));
  CHECK(row.min == -10);
  CHECK(row.max == 10);
  CHECK(std::string(simvis_text_at(connection.get(), row.unit), row.unit.size) == "m");
  CHECK_THROWS_WITH(connection.element("C"), "there is no element \"C\"");
  CHECK_THROWS_WITH(connection.parameter("A", "w"), "element \"A\" has no parameter \"w\"");
  CHECK_THROWS_WITH(connection.sensor("BACK"), "there is no sensor \"BACK\"");
}

TEST_CASE("no client finds a host before its elements are there") {
  const std::string name = unique_name("early");
  SharedHost host(name);
  add_pose(host, "A");
  CHECK_THROWS(Connection(name, "tester"));
  host.publish();
  CHECK(Connection(name, "tester").element("A") == 0);
}

TEST_CASE("what is removed is not found by name, keeps its id, and its name can be given again") {
  const std::string name = unique_name("remove");
  SharedHost host(name);
  host.publish();
  const std::size_t first = add_pose(host, "A");
  Connection connection(name, "tester");
  const std::int64_t old = connection.parameter("A", "x");
  host.remove_element(first);
  CHECK_THROWS(connection.element("A"));
  CHECK(add_pose(host, "A") == first + 1);
  CHECK(connection.parameter("A", "x") == old + static_cast<std::int64_t>(kPoseValues));
  connection.set_element(static_cast<std::int64_t>(first), std::array<double, kPoseValues>{1});
  CHECK(host.take().elements.empty());
}

TEST_CASE("values: single ones and whole elements arrive once; the host answers with what holds") {
  const std::string name = unique_name("values");
  SharedHost host(name);
  host.publish();
  add_pose(host, "A");
  Connection connection(name, "tester");
  const std::int64_t x = connection.parameter("A", "x");
  connection.set(x, 2.5);
  ClientInputs inputs = host.take();
  REQUIRE(inputs.values.size() == 1);
  CHECK(inputs.values[0].parameter == 0);
  CHECK(inputs.values[0].value == 2.5);
  CHECK(host.take().values.empty());
  host.set_value(0, 1);  // refused: the old value comes back
  CHECK(connection.value(x) == 1);
  const std::array<double, kPoseValues> pose{1, 2, 3, 4, 5, 6};
  connection.set_element(0, pose);
  inputs = host.take();
  REQUIRE(inputs.elements.size() == 1);
  CHECK(inputs.elements[0].values == std::vector<double>(pose.begin(), pose.end()));
  CHECK(host.take().elements.empty());
  connection.set(x, 7);  // between the host's look and its answer: the newer value is not lost
  host.set_value(0, 3);
  CHECK(connection.value(x) == 7);
  inputs = host.take();
  REQUIRE(inputs.values.size() == 1);
  CHECK(inputs.values[0].value == 7);
  CHECK_THROWS(connection.set(99, 1));
  CHECK_THROWS(connection.set_element(0, std::array<double, 2>{1, 2}));
  CHECK(std::isnan(connection.value(-1)));
}

TEST_CASE("requests arrive in order, also when they go round the ring, and a full ring is said") {
  const std::string name = unique_name("requests");
  SharedHost host(name);
  host.publish();
  Connection connection(name, "tester");
  std::uint64_t expected = 0;
  for (int round = 0; round < 40; ++round) {
    std::vector<std::string> sent;
    for (int i = 0; i < 5; ++i) {
      sent.push_back(std::string(4001 + 13 * static_cast<std::size_t>(round), static_cast<char>('a' + i)));
      connection.send(sent.back());
    }
    const ClientInputs inputs = host.take();
    REQUIRE(inputs.requests.size() == sent.size());
    for (std::size_t i = 0; i < sent.size(); ++i) {
      CHECK(inputs.requests[i].number == ++expected);
      CHECK(inputs.requests[i].text == sent[i]);
    }
  }
  CHECK_THROWS_WITH(connection.send(std::string(SIMVIS_SHM_REQUEST_BYTES, 'x')),
                    doctest::Contains("a request has at most"));
  const std::string half(SIMVIS_SHM_REQUEST_BYTES / 2, 'x');
  connection.send(half);
  CHECK_THROWS_WITH(connection.send(half), "the host has not taken the earlier requests yet");
  CHECK(host.take().requests.size() == 1);
  CHECK(connection.send(half) == expected + 2);
}

TEST_CASE("what a client wrote that leaves at once is taken, also when others come in the same frame") {
  const std::string name = unique_name("visits");
  SharedHost host(name);
  host.publish();
  add_pose(host, "A");
  constexpr int kVisits = 20;
  for (int round = 0; round < 3; ++round) {
    for (int visit = 0; visit < kVisits; ++visit) {
      Connection connection(name, "visitor");
      connection.set_element(0, std::array<double, kPoseValues>{0.1 * visit});
      connection.send("<part/>");
    }
    const ClientInputs inputs = host.take();
    REQUIRE(inputs.elements.size() == kVisits);
    for (int visit = 0; visit < kVisits; ++visit) CHECK(inputs.elements[visit].values[0] == 0.1 * visit);
    CHECK(inputs.requests.size() == kVisits);
    CHECK(host.take().elements.empty());
  }
}

TEST_CASE("every client reads the log from its start, at any time") {
  const std::string name = unique_name("log");
  SharedHost host(name);
  host.publish();
  host.log(SIMVIS_CHANGE, "<part/>");
  host.log(SIMVIS_REQUEST_REFUSED, "no", 3, 9);
  const Connection late(name, "late");
  std::uint64_t position = 0;
  const auto first = late.next_log(position), second = late.next_log(position);
  REQUIRE(first);
  REQUIRE(second);
  CHECK(first->text == "<part/>");
  CHECK(first->kind == SIMVIS_CHANGE);
  CHECK(second->text == "no");
  CHECK(second->client == 3);
  CHECK(second->request == 9);
  CHECK_FALSE(late.next_log(position));
  host.log(SIMVIS_CHANGE, "<element/>");
  CHECK(late.next_log(position)->text == "<element/>");
}

TEST_CASE("measurements: the latest one, its pose, whole for three more, and larger ones later") {
  const std::string name = unique_name("outputs");
  SharedHost host(name);
  host.publish();
  const std::size_t sensor = host.add_sensor("FRONT", "laser_scanner");
  const Connection connection(name, "tester");
  CHECK_FALSE(connection.latest(0));
  publish_scan(host, sensor, 5, 2.5f);
  const auto first = connection.latest(0);
  REQUIRE(first);
  CHECK(first->slot().frame == 5);
  CHECK(first->slot().time_ns == 5000);
  CHECK(first->output<float>("range_m").size() == 361);
  CHECK(first->output<float>("range_m")[360] == 2.5f);
  CHECK(first->output<double>("range_m").empty());
  CHECK(first->output<float>("color").empty());
  for (int i = 0; i < 3; ++i) publish_scan(host, sensor, 6, 1);
  CHECK(first->whole());
  publish_scan(host, sensor, 7, 1);
  CHECK_FALSE(first->whole());
  const SharedArray<std::uint8_t> large(std::vector<std::uint8_t>(1 << 20, 7));
  const MeasuredArray output{{.name = "picture", .shape = {1024, 1024}}, large};
  host.publish(sensor, 8, 8000, kIdentity, {&output, 1});
  const auto latest = connection.latest(0);
  REQUIRE(latest);
  CHECK(latest->output<std::uint8_t>("picture").size() == large.size());
  CHECK(latest->output<std::uint8_t>("picture").back() == 7);
}

TEST_CASE("frames: waiting ends with a frame, with the time, or with the host; values are those of the frame") {
  const std::string name = unique_name("frames");
  auto host = std::make_unique<SharedHost>(name);
  host->publish();
  add_pose(*host, "A");
  Connection connection(name, "tester");
  CHECK_FALSE(connection.wait_frame(0, 1));
  host->set_value(2, 4.5);
  host->finish_frame(1, 66);
  CHECK(connection.wait_frame(0, 1));
  CHECK(simvis_time_ns(connection.get()) == 66);
  std::array<double, kPoseValues> values{};
  CHECK(simvis_applied(connection.get(), 0, values.data(), values.size()) == 1);
  CHECK(values == std::array<double, kPoseValues>{0, 0, 4.5});
  CHECK(simvis_applied(connection.get(), 3, values.data(), 4) == -1);
  host.reset();
  CHECK_FALSE(connection.alive());
  CHECK_THROWS_WITH(connection.wait_frame(1, 1000), "the host is gone");
  CHECK_THROWS_WITH(Connection(name, "tester"), doctest::Contains("no simulation is served as"));
}

TEST_CASE("lock-step: a client is ready for the frame that comes next, and for no other") {
  const std::string name = unique_name("ready");
  SharedHost host(name);
  host.publish();
  host.finish_frame(1, 0);
  CHECK_FALSE(host.is_connected("driver"));
  {
    Connection driver(name, "driver");
    CHECK(host.is_connected("driver"));
    CHECK_FALSE(host.is_connected("drive"));
    CHECK_FALSE(host.is_ready("driver", 1));
    const std::uint32_t before = host.ready_counter();
    driver.ready();
    CHECK(host.ready_counter() != before);
    CHECK(host.is_ready("driver", 1));
    CHECK_FALSE(host.is_ready("driver", 2));
  }
  CHECK_FALSE(host.is_connected("driver"));
}

TEST_CASE("names: what is not allowed, and one living host for each") {
  for (const char* wrong : {"", "a/b", "..\n", "a name"}) {
    CHECK(error_of([&] { SharedHost host(wrong); }).find("can't name a served simulation") != std::string::npos);
  }
  const std::string name = unique_name("twice");
  {
    SharedHost host(name);
    host.publish();
    const auto open_files = [] {
      const std::filesystem::directory_iterator files("/proc/self/fd");
      return std::distance(begin(files), end(files));
    };
    const auto before = open_files();
    CHECK(error_of([&] { SharedHost(name).publish(); }).find("a living simulation is served as") != std::string::npos);
    CHECK(open_files() == before);
  }
  {
    SharedHost after(name);
    after.publish();
    CHECK_THROWS_WITH(Connection(name, "no/name"), doctest::Contains("expected 1 to 63"));
  }
}

TEST_CASE("32 clients are connected at a time, and a place that is left is taken again") {
  const std::string name = unique_name("many");
  SharedHost host(name);
  host.publish();
  std::vector<Connection> connections;
  for (int i = 0; i < SIMVIS_SHM_CLIENTS; ++i) connections.emplace_back(name, "c" + std::to_string(i));
  CHECK_THROWS_WITH(Connection(name, "more"), "32 clients are connected, no more can be");
  connections.pop_back();
  CHECK_NOTHROW(Connection(name, "more"));
}

TEST_SUITE_END();
