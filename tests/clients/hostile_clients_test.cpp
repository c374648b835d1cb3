// Clients that are killed, that write nonsense, and hosts that are killed.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <cstring>
#include <random>

#include "tests/clients/shared_host.h"
#include "tests/support/error_of.h"
#include "tests/support/long_count.h"
#include "tests/support/tested_build.h"

using namespace simvis;
using client::Connection;

TEST_SUITE_BEGIN("clients");

namespace {

/// Runs `body` in another process, until it is killed.
template <typename Body>
pid_t in_child(const Body& body) {
  const pid_t child = ::fork();
  if (child != 0) return child;
  try {
    body();
  } catch (...) {
    ::_exit(1);
  }
  ::_exit(0);
}

void kill_child(pid_t child) {
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
}

/// Returns whether the host finds a killed client gone within a second. The kernel drops the client's locks with its
/// memory, and a program that lists processes may hold that memory a moment longer.
bool is_gone(const SharedHost& host, std::string_view client) {
  constexpr int kTries = 1000, kPause_us = 1000;
  for (int i = 0; i < kTries && host.is_connected(client); ++i) ::usleep(kPause_us);
  return !host.is_connected(client);
}

}  // namespace

TEST_CASE("a client that is killed at any moment leaves a host that goes on and a place that is free") {
  const std::string name = unique_name("killed-client");
  SharedHost host(name);
  host.publish();
  add_pose(host, "A");
  std::mt19937 random(1);
  const int kills = count_of("SIMVIS_TEST_KILLS", sanitized() ? 20 : 200);
  for (int i = 0; i < kills; ++i) {
    const pid_t child = in_child([&] {
      Connection connection(name, "victim", 1000);
      for (double value = 0;; value += 1e-6) {
        std::array<double, kPoseValues> pose;
        pose.fill(value);
        connection.set_element(0, pose);
        connection.set(0, value);
        if (static_cast<int>(value * 1e6) % 16 == 0) {
          try {
            connection.send("<request/>");
          } catch (const client::Error&) {  // the ring is full
          }
        }
      }
    });
    for (int take = 0; take < 20; ++take) {
      for (const WrittenElement& written : host.take().elements) {
        for (const double value : written.values) CHECK(value == written.values.front());
      }
      ::usleep(random() % 100);
    }
    kill_child(child);
    for (const ChangeRequest& request : host.take().requests) CHECK(request.text == "<request/>");
    CHECK(is_gone(host, "victim"));
  }
  Connection after(name, "after");
  after.send("<last/>");
  const ClientInputs inputs = host.take();
  REQUIRE(inputs.requests.size() == 1);
  CHECK(inputs.requests[0].text == "<last/>");
}

TEST_CASE("a host that is killed at any moment leaves nothing that stops the next one, and its clients notice") {
  const std::string name = unique_name("killed-host");
  std::mt19937 random(2);
  const int kills = count_of("SIMVIS_TEST_KILLS", sanitized() ? 20 : 200);
  std::uint64_t generation = 0;
  for (int i = 0; i < kills; ++i) {
    const pid_t child = in_child([&] {
      SharedHost host(name);
      host.publish();
      const std::size_t sensor = host.add_sensor("S", "laser_scanner");
      for (std::uint64_t frame = 0;; ++frame) {
        add_pose(host, "P" + std::to_string(frame));
        host.take();
        publish_scan(host, sensor, frame, 1);
        host.finish_frame(frame + 1, 0);
      }
    });
    if (i % 2 == 0) {
      const Connection connection(name, "client", 5000);
      CHECK(simvis_generation(connection.get()) != generation);
      generation = simvis_generation(connection.get());
      CHECK_NOTHROW(connection.wait_frame(0, 5000));
      kill_child(child);
      CHECK_FALSE(connection.alive());
      CHECK_THROWS(connection.wait_frame(UINT64_MAX - 1, 5000));
    } else {
      ::usleep(random() % 2000);
      kill_child(child);
    }
  }
  {
    SharedHost host(name);
    host.publish();
    CHECK(is_served(name));
  }
  CHECK_FALSE(is_served(name));
}

TEST_CASE("what makes no sense is refused until the client connects again") {
  const std::string name = unique_name("refused");
  SharedHost host(name);
  host.publish();
  add_pose(host, "P");
  const auto tell = [&](std::uint64_t head) {
    const Connection connection(name, "teller");
    simvis_header header{};
    const int file = open_object(name);
    REQUIRE(::pread(file, &header, sizeof header, 0) == sizeof header);
    const auto at =
        static_cast<off_t>(header.clients_offset + simvis_slot_of(connection.get()) * sizeof(simvis_client_area) +
                           offsetof(simvis_client_area, request_head));
    REQUIRE(::pwrite(file, &head, sizeof head, at) == sizeof head);
    ::close(file);
    CHECK(host.take().requests.empty());
    std::uint64_t position = 0;
    std::vector<std::string> log;
    while (const auto entry = connection.next_log(position)) log.emplace_back(entry->text);
    return log;
  };
  CHECK(contains(tell(SIMVIS_SHM_REQUEST_BYTES + 8).back(), "more requests than the ring holds"));
  CHECK(contains(tell(8).back(), "a piece of a request"));
  Connection good(name, "good");
  good.send("<request/>");
  CHECK(host.take().requests.size() == 1);
}

TEST_CASE("a client goes on with its own count of elements when another one damages the shared one") {
  const std::string name = unique_name("damaged-client");
  SharedHost host(name);
  host.publish();
  for (int i = 0; i < 3; ++i) add_pose(host, "P" + std::to_string(i));
  Connection connection(name, "victim");
  const int file = open_object(name);
  REQUIRE(file >= 0);
  simvis_header header{};
  REQUIRE(::pread(file, &header, sizeof header, 0) == sizeof header);
  const std::uint64_t none = UINT64_MAX;
  const auto at = static_cast<off_t>(header.clients_offset + offsetof(simvis_client_area, group_count));
  REQUIRE(::pwrite(file, &none, sizeof none, at) == sizeof none);
  ::close(file);
  for (const std::int64_t element : {2, 1}) {
    connection.set_element(element, std::array<double, kPoseValues>{1, 2, 3, 4, 5, 6});
    const ClientInputs inputs = host.take();
    REQUIRE(inputs.elements.size() == 1);
    CHECK(inputs.elements[0].element == static_cast<std::size_t>(element));
  }
}

TEST_CASE("every byte of the shared memory can be damaged: the host goes on with its own values") {
  const std::string name = unique_name("fuzz");
  SharedHost host(name);
  host.publish();
  for (int i = 0; i < 3; ++i) add_pose(host, "P" + std::to_string(i));
  const std::size_t sensor = host.add_sensor("S", "laser_scanner");
  Connection connection(name, "tester");
  connection.send("<request/>");
  connection.set_element(1, std::array<double, kPoseValues>{1, 2, 3, 4, 5, 6});
  const int file = open_object(name);
  REQUIRE(file >= 0);
  const auto layout =
      *reinterpret_cast<const simvis_header*>(::mmap(nullptr, sizeof(simvis_header), PROT_READ, MAP_SHARED, file, 0));
  const std::size_t size = layout.outputs.offset + 65536;
  auto* const memory = static_cast<unsigned char*>(::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0));
  REQUIRE(memory != MAP_FAILED);
  // Most damage goes where the host reads: the areas of the first clients and the values.
  struct Range {
    std::uint64_t offset, bytes;
  };
  const std::uint64_t area = layout.clients_offset;
  const Range ranges[] = {{0, sizeof(simvis_header)},
                          {area, 256},
                          {area + offsetof(simvis_client_area, acknowledged), 256},
                          {area, 2 * sizeof(simvis_client_area)},
                          {area + offsetof(simvis_client_area, groups), 4 * sizeof(simvis_group)},
                          {area + offsetof(simvis_client_area, requests), 512},
                          {layout.values.offset, 32 * 8},
                          {layout.elements.offset, 512},
                          {layout.strings.offset, 256},
                          {layout.log.offset, 512},
                          {layout.sensors.offset, 256},
                          {layout.outputs.offset, 4096}};
  std::mt19937_64 random(3);
  const int damages = count_of("SIMVIS_TEST_DAMAGES", sanitized() ? 20'000 : 100'000);
  std::size_t taken = 0;
  for (int i = 0; i < damages; ++i) {
    const Range& range = ranges[random() % std::size(ranges)];
    const std::uint64_t at = range.offset + random() % range.bytes;
    const std::uint64_t word = random() % 4 == 0 ? random() % 300 : random();
    const std::size_t bytes = random() % 2 == 0 ? 1 : std::min<std::size_t>(8, size - at);
    std::memcpy(memory + at, &word, bytes);
    const ClientInputs inputs = host.take();
    for (const WrittenValue& value : inputs.values) {
      REQUIRE(value.parameter < 3 * kPoseValues);
      host.set_value(value.parameter, 0);
    }
    for (const WrittenElement& element : inputs.elements) REQUIRE(element.values.size() == kPoseValues);
    for (const ChangeRequest& request : inputs.requests) REQUIRE(request.text.size() <= SIMVIS_SHM_REQUEST_BYTES);
    taken += inputs.values.size() + inputs.elements.size() + inputs.requests.size();
    if (i % 64 == 0) publish_scan(host, sensor, static_cast<std::uint64_t>(i), 1);
    if (i % 16 == 0) host.finish_frame(static_cast<std::uint64_t>(i), 0);
    // Requests of a client that connects again are executed.
    if (i % 256 == 0) {
      auto& damaged = *reinterpret_cast<simvis_client_area*>(memory + area);
      damaged.connection = 2 * static_cast<std::uint64_t>(i) + 1024;
    }
  }
  CHECK(taken > 0);
  // Beyond the part of the log that was damaged, it says what was refused.
  const std::string_view log(reinterpret_cast<const char*>(memory) + layout.log.offset, 65536);
  CHECK(log.find("makes no sense and is ignored") != std::string_view::npos);
  add_pose(host, "AFTER");  // the host's tables are its own
  ::munmap(memory, size);
  ::close(file);
}

TEST_SUITE_END();
