// Host and clients at once, as threads of one process. The thread sanitizer looks at this file too.
#include <doctest/doctest.h>

#include <atomic>
#include <thread>

#include "tests/clients/shared_host.h"
#include "tests/support/tested_build.h"

using namespace simvis;
using client::Connection;

TEST_SUITE_BEGIN("clients");

TEST_CASE("several clients write whole poses at once: none is seen torn, and the last of each arrives") {
  constexpr int kClients = 4, kPoses = 50;
  const int writes = sanitized() ? 200 : 2000;
  const std::string name = unique_name("torn");
  SharedHost host(name);
  host.publish();
  for (int i = 0; i < kClients * kPoses; ++i) add_pose(host, "P" + std::to_string(i));
  std::atomic<int> running = kClients;
  std::vector<std::thread> clients;
  for (int c = 0; c < kClients; ++c) {
    clients.emplace_back([&, c] {
      Connection connection(name, "client" + std::to_string(c));
      for (int w = 1; w <= writes; ++w) {
        for (int p = 0; p < kPoses; ++p) {
          std::array<double, kPoseValues> values;
          values.fill(w);
          connection.set_element(c * kPoses + p, values);
        }
      }
      --running;
      while (simvis_frame(connection.get()) == 0) std::this_thread::yield();  // leaves when all is taken
    });
  }
  std::vector<double> last(kClients * kPoses);
  std::size_t seen = 0, torn = 0;
  for (bool more = true; more;) {
    more = running > 0;
    for (const WrittenElement& written : host.take().elements) {
      ++seen;
      for (const double value : written.values) torn += value != written.values.front();
      CHECK(written.values.front() >= last[written.element]);
      last[written.element] = written.values.front();
    }
  }
  host.finish_frame(1, 0);
  for (std::thread& client : clients) client.join();
  CHECK(torn == 0);
  CHECK(seen >= last.size());
  CHECK(last == std::vector<double>(last.size(), writes));
}

TEST_CASE("clients read values, the log and scans while the host writes them: each is of one frame") {
  const int frames = sanitized() ? 300 : 3000;
  const std::string name = unique_name("readers");
  SharedHost host(name);
  host.publish();
  add_pose(host, "A");
  const std::size_t sensor = host.add_sensor("S", "laser_scanner");
  publish_scan(host, sensor, 0, 0);
  std::vector<std::thread> clients;
  std::atomic<int> torn = 0, seen = 0, connected = 0;
  for (int c = 0; c < 2; ++c) {
    clients.emplace_back([&, c] {
      Connection connection(name, "client" + std::to_string(c));
      ++connected;
      std::uint64_t position = 0;
      do {
        std::array<double, kPoseValues> values;
        simvis_frame_info frame;
        if (simvis_applied_frame(connection.get(), 0, values.data(), values.size(), &frame) == 0) {
          for (const double value : values) torn += value != static_cast<double>(frame.frames);
        }
        const std::optional<client::Measurement> scan = connection.latest(0);
        const float first = scan->output<float>("range_m")[0], last = scan->output<float>("range_m")[360];
        const std::uint64_t of_frame = scan->slot().frame;
        if (scan->whole()) {
          ++seen;
          torn += first != last || first != static_cast<float>(of_frame);
        }
        while (const auto entry = connection.next_log(position)) torn += entry->text != "entry";
        simvis_send(connection.get(), "<request/>");  // or the ring is full
        connection.ready();
      } while (simvis_frame(connection.get()) < static_cast<std::uint64_t>(frames));
    });
  }
  while (connected < 2) std::this_thread::yield();
  for (int frame = 1; frame <= frames; ++frame) {
    host.take();
    for (std::size_t i = 0; i < kPoseValues; ++i) host.set_value(i, frame);
    publish_scan(host, sensor, static_cast<std::uint64_t>(frame), static_cast<float>(frame));
    if (frame % 16 == 0) host.log(SIMVIS_CHANGE, "entry");
    host.finish_frame(static_cast<std::uint64_t>(frame), 0);
  }
  for (std::thread& client : clients) client.join();
  CHECK(torn == 0);
  CHECK(seen >= 2);
}

TEST_SUITE_END();
