// Measures what sending by DDS does to a frame, and whether a subscriber gets the rates.
//
//   dds [BLOCKS [DOMAIN]]
//
// Prints CSV. Frames are called for at 30 Hz, in blocks of 30 without and with DDS in turn, with one subscriber in
// another process: three scanners of 361 beams and a camera of 640 x 480, or one camera of 1920 x 1080. `caller_ms` is
// the processor time of the simulation's own thread. Measurements are sent reliably; the subscriber's share is of all
// that were made, the ones that the queue dropped included. Loopback and multicast are as CYCLONEDDS_URI says.
#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include <simvis/error.h>
#include <simvis/simulation.h>
#include "bench/timing.h"
#include "exchange/messages/dds/dds_node.h"
#include "exchange/messages/types/sensor_types.h"

namespace {

using namespace simvis;
using namespace simvis::bench;

constexpr int kBlock = 30;
constexpr auto kPeriod = std::chrono::microseconds(33'333);
constexpr std::size_t kMaxBytes = std::size_t{16} << 20;

struct Case {
  const char* name;
  std::vector<std::string> scans, images;
  std::string sensors;
};

std::vector<Case> cases() {
  const auto scanner = [](const std::string& name) {
    return "<sensor type='laser_scanner' name='" + name + "' insert_at='ROOT' samples='361'/>";
  };
  const auto camera = [](const std::string& size) {
    return "<sensor type='camera' name='CAMERA' insert_at='ROOT' " + size + "/>";
  };
  return {{"3 scanners and 640 x 480",
           {"/A/scan", "/B/scan", "/C/scan"},
           {"/CAMERA/image_raw"},
           scanner("A") + scanner("B") + scanner("C") + camera("width='640' height='480'")},
          {"1920 x 1080", {}, {"/CAMERA/image_raw"}, camera("width='1920' height='1080'")}};
}

/// Counts messages until the pipe is closed.
std::size_t count_messages(const Case& each, std::uint32_t domain, int pipe) {
  ros::DdsNode node(domain);
  for (const std::string& topic : each.scans) node.subscribe(topic, ros::describe<ros::LaserScan>(), kMaxBytes);
  for (const std::string& topic : each.images) node.subscribe(topic, ros::describe<ros::Image>(), kMaxBytes);
  std::size_t count = 0;
  char ended = 0;
  for (int silent = 0; silent < 200;) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const std::size_t before = count;
    for (const std::vector<std::string>* const topics : {&each.scans, &each.images}) {
      for (const std::string& topic : *topics) count += node.take(topic).size();
    }
    silent = count > before || ::read(pipe, &ended, 1) != 0 ? 0 : silent + 1;
  }
  return count;
}

void run(const Case& each, std::uint32_t domain, int blocks) {
  int to_child[2], to_parent[2];
  if (::pipe2(to_child, O_NONBLOCK) != 0 || ::pipe(to_parent) != 0) throw MachineError("pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(to_child[1]);
    const std::size_t count = count_messages(each, domain, to_child[0]);
    ::_exit(::write(to_parent[1], &count, sizeof count) == sizeof count ? 0 : 1);
  }
  std::vector<double> wall[2], caller[2];
  DdsReport total;
  std::size_t made = 0;
  {
    Simulation simulation = Simulation::from_string(
        "<part shape='box' size='1 20 20' name='BOX' insert_at='ROOT' pose_offset='8 0 0 0 0 0'/>" + each.sensors);
    auto due = std::chrono::steady_clock::now();
    for (int frame = 0; frame < 2 * blocks * kBlock; ++frame) {
      const bool sends = frame / kBlock % 2 == 1;
      if (frame % kBlock == 0 && sends) {
        simulation.join_dds({.domain = domain, .reliable = true});
        std::this_thread::sleep_for(std::chrono::seconds(2));  // until they have found each other
        due = std::chrono::steady_clock::now();
      }
      const Took took = time_work([&] { simulation.step(); });
      wall[sends].push_back(took.wall_ms);
      caller[sends].push_back(took.caller_ms);
      made += sends ? simulation.measured().size() : 0;
      due += kPeriod;
      std::this_thread::sleep_until(due);
      if (frame % kBlock != kBlock - 1 || !sends) continue;
      const DdsReport report = simulation.leave_dds();
      total.dropped += report.dropped;
      total.bytes += report.bytes;
    }
  }
  ::close(to_child[1]);
  std::size_t received = 0;
  if (::read(to_parent[0], &received, sizeof received) != sizeof received) throw MachineError("no subscriber");
  ::waitpid(child, nullptr, 0);
  std::printf("%s,%.3f,%.3f,%.3f,%.3f,%.3f,%zu,%zu,%llu,%llu\n", each.name, median(wall[0]), median(wall[1]),
              median(wall[1]) / median(wall[0]), median(caller[0]), median(caller[1]), made, received,
              static_cast<unsigned long long>(total.dropped), static_cast<unsigned long long>(total.bytes));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  const int blocks = argc > 1 ? std::atoi(argv[1]) : 10;
  const auto domain = static_cast<std::uint32_t>(argc > 2 ? std::atoi(argv[2]) : 90);
  try {
    std::printf("sensors,plain_ms,sent_ms,ratio,caller_plain_ms,caller_sent_ms,measured,received,dropped,bytes\n");
    for (const Case& each : cases()) run(each, domain, blocks);
    return 0;
  } catch (const Error& error) {
    std::fprintf(stderr, "dds: %s\n", error.what());
    return 1;
  }
}
