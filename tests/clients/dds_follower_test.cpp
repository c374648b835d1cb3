// simvis-run --follow dds:NAME: a follower that shares no memory with its host holds the same scene, frame by frame.
#include <doctest/doctest.h>
#include <signal.h>

#include <map>
#include <set>
#include <sstream>
#include <thread>

#include <simvis/simulation.h>
#include "exchange/messages/types/follow_types.h"
#include "simvis/sharing/follow_messages.h"
#include "simvis/sharing/network_host.h"
#include "simvis/sharing/output_message.h"
#include "tests/clients/shared_host.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"
#include "tests/support/two_machines.h"
#include "tests/support/wall_scene.h"

using namespace simvis;
using namespace std::chrono_literals;

TEST_SUITE_BEGIN("clients");

namespace {

constexpr const char* kHostScene = R"(
    <part name="CART" insert_at="ROOT"/>
    <element type="pose" name="MOVE" insert_at="CART"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="CART" samples="181" min_angle="-45" max_angle="45"/>)";
// The follower's own scanner stands where that of the host does.
constexpr const char* kSeen = R"(
    <sensor type="laser_scanner" name="SEEN" insert_at="CART" samples="181" min_angle="-45" max_angle="45"/>)";
// Two robots, of which the second is the same as the first, and one that goes again.
constexpr const char* kRobots = R"(
    <part shape="box" size="0.4 0.3 1" name="ROBOT" insert_at="ROOT" pose_offset="2 1 0 0 0 0"/>
    <part shape="box" size="0.4 0.3 1" name="ROBOT_2" insert_at="ROOT" pose_offset="2 -1 0 0 0 0"/>
    <part shape="box" size="1 1 1" name="GONE" insert_at="CART" pose_offset="1 0 0 0 0 0"/>
    <element type="pose" name="PLACE" insert_at="ROBOT_2" x="0.25"/>)";

/// The rows of each whole frame of a table; the last one may be unfinished.
std::map<std::string, std::string> rows_by_frame(const std::filesystem::path& file) {
  std::map<std::string, std::string> rows;
  std::istringstream lines(read_text(file));
  std::string line, last;
  std::getline(lines, line);  // names of columns
  while (std::getline(lines, line)) rows[last = line.substr(0, line.find(','))] += line + '\n';
  rows.erase(last);
  return rows;
}

/// A host in a process of its own, and the commands of those who follow it.
struct DdsHost {
  explicit DdsHost(const std::string& test) : name(unique_name(test)), domain(std::to_string(own_domain())) {
    scene = write_wall_scene(folder.path(), kHostScene).string();
    write_text(folder / "seen.xml", kSeen);
  }
  std::vector<std::string> command(const std::string& out) const {
    return {program,    "--serve", name,          "--dds", domain,  "--dds-qos",
            "reliable", "--quiet", "--real-time", "1",     "--out", (folder / out).string(),
            scene};
  }
  std::vector<std::string> follower(const std::string& out, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all{program,
                                 "--follow",
                                 "dds:" + domain + "/" + name,
                                 "--quiet",
                                 "--out",
                                 (folder / out).string(),
                                 (folder / "seen.xml").string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Executes commands and sets values, as a client of the host's machine, where `on_host` makes a command run.
  template <typename OnHost>
  void change(const OnHost& on_host) const {
    write_text(folder / "robots.xml", kRobots);
    write_text(folder / "gone.xml", "<remove name='GONE'/>");
    const auto run = [&](const std::vector<std::string>& words) {
      std::vector<std::string> command{tested_build() + "/bin/simvis-ctl", name};
      command.insert(command.end(), words.begin(), words.end());
      return Process(on_host(command)).wait();
    };
    const auto end = std::chrono::steady_clock::now() + 60s;
    while (run({"list"}).exit_code != 0) REQUIRE(std::chrono::steady_clock::now() < end);
    for (const std::vector<std::string>& words : {std::vector<std::string>{"send", (folder / "robots.xml").string()},
                                                  {"send", (folder / "gone.xml").string()},
                                                  {"set", "PLACE.y=0.5", "MOVE.yaw=7"}}) {
      const ProcessResult result = run(words);
      REQUIRE_MESSAGE(result.exit_code == 0, result.err);
    }
  }
  void change() const {
    change([](const std::vector<std::string>& command) { return command; });
  }
  std::size_t frames_of(const std::string& out) const {
    const std::filesystem::path file = folder / out / "SEEN.csv";
    return std::filesystem::exists(file) ? rows_by_frame(file).size() : 0;
  }

  const std::string program = tested_build() + "/bin/simvis-run";
  TemporaryFolder folder;
  std::string name, domain, scene;
};

/// Waits until `done`, but not for ever.
template <typename Done>
void await(const Done& done) {
  const auto end = std::chrono::steady_clock::now() + 90s;
  while (!done()) {
    REQUIRE(std::chrono::steady_clock::now() < end);
    std::this_thread::sleep_for(5ms);
  }
}

/// Checks the frames that both have, and returns how many they are.
std::size_t same_frames(const DdsHost& host, const std::string& own, const std::string& seen) {
  const auto rows = rows_by_frame(host.folder / own / "SCAN.csv");
  std::size_t same = 0;
  for (const auto& [frame, text] : rows_by_frame(host.folder / seen / "SEEN.csv")) {
    const auto found = rows.find(frame);
    if (found == rows.end()) continue;
    CHECK_MESSAGE(found->second == text, "frame " << frame);
    ++same;
  }
  return same;
}

}  // namespace

TEST_CASE("a follower by DDS that comes late measures what its host measures, byte by byte") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const DdsHost host("dds-follow");
  Process running(host.command("own"));
  host.change();
  const ProcessResult seen = Process(host.follower("seen", {"--frames", "4"})).wait();
  REQUIRE_MESSAGE(seen.exit_code == 0, seen.err);
  running.send(SIGINT);
  CHECK(running.wait().exit_code == 130);
  CHECK(same_frames(host, "own", "seen") >= 3);
  // The frames are those after the changes, which can be seen.
  const auto rows = rows_by_frame(host.folder / "own" / "SCAN.csv");
  const std::string first = rows.begin()->second,
                    last = rows_by_frame(host.folder / "seen" / "SEEN.csv").begin()->second;
  CHECK(first.substr(first.find(',', 2)) != last.substr(last.find(',', 2)));
}

TEST_CASE("a follower on another machine that comes late measures what its host measures") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const DdsHost host("dds-machines");
  const TwoMachines machines(host.folder.path());
  if (!machines.exist()) return test::skip(machines.why_not());
  const std::vector<std::string> own_settings{"CYCLONEDDS_URI="};  // as on machines without a configuration
  Process running(machines.on_first(host.command("own")), own_settings);
  host.change([&](const std::vector<std::string>& command) { return machines.on_first(command); });
  const ProcessResult seen = Process(machines.on_second(host.follower("seen", {"--frames", "4"})), own_settings).wait();
  REQUIRE_MESSAGE(seen.exit_code == 0, seen.err);
  running.send(SIGINT);
  CHECK(running.wait().exit_code == 130);
  CHECK(same_frames(host, "own", "seen") >= 3);
}

TEST_CASE("a host sends what its sensors measured to followers only while one reads it") {
  if (!has_dds()) return test::skip("this build has no DDS");
  constexpr std::size_t kWidth = 64, kHeight = 48, kColorBytes = kWidth * kHeight * 4 * sizeof(float);
  const std::uint32_t domain = own_domain();
  Simulation simulation =
      Simulation::from_string("<sensor type='camera' name='CAM' insert_at='ROOT' width='64' height='48'/>");
  ServeDesc serve;
  serve.name = unique_name("read");
  simulation.serve(serve);
  DdsDesc desc;
  desc.domain = domain;
  simulation.join_dds(desc);
  for (int i = 0; i < 2; ++i) simulation.step();
  // The image of the camera as rgb8 in two messages, three sixteenths of its colour each, and small messages.
  CHECK(simulation.leave_dds().bytes < kColorBytes);
  simulation.join_dds(desc);
  ros::DdsNode node(domain);
  const std::string topic = follow_topic(serve.name + "/CAM", kFollowMeasurement);
  node.subscribe(topic, ros::describe<ros::HostMeasurement>(), 2 * kColorBytes);
  std::vector<std::string> read;
  const auto end = std::chrono::steady_clock::now() + 60s;
  while (read.empty()) {
    REQUIRE(std::chrono::steady_clock::now() < end);
    simulation.step();
    std::this_thread::sleep_for(2ms);
    read = node.take(topic);
  }
  const ros::HostMeasurement message = ros::decode<ros::HostMeasurement>(read.back());
  REQUIRE(message.outputs.size() == 1);
  CHECK(message.outputs[0].name == "color");
  CHECK(message.outputs[0].data.size() == kColorBytes);
}

TEST_CASE("a follower by DDS sees changes, and the successor of a host that was killed") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const DdsHost host("dds-killed");
  Process first(host.command("own"));
  Process follower(host.follower("seen"));
  await([&] { return host.frames_of("seen") > 1; });
  host.change();
  const std::size_t before = host.frames_of("seen");
  await([&] { return host.frames_of("seen") > before + 2; });
  first.send(SIGKILL);
  first.wait();
  CHECK(same_frames(host, "own", "seen") > 2);
  Process second(host.command("next"));
  await([&] { return follower.err_so_far().find("has ended; waiting for the next one") != std::string::npos; });
  const std::size_t with_first = host.frames_of("seen");
  await([&] { return host.frames_of("seen") > with_first + 2; });
  follower.send(SIGINT);
  CHECK(follower.wait().exit_code == 130);
}

TEST_CASE("a follower by DDS passes over what strangers say") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const std::uint32_t domain = own_domain();
  constexpr std::uint64_t kHost = 7, kStranger = 5;
  ros::DdsNode node(domain), stranger(domain);
  const auto good = node.sink(ros::SensorQos::reliable), bad = stranger.sink(ros::SensorQos::reliable);
  const auto say = [](ros::RecorderSink& sink, const auto& message, const std::string& what, ros::Durability how) {
    sink.write(follow_topic("demo", what), 0, message, how);
  };
  const std::string log(kFollowLog), frame(kFollowFrame);
  say(*bad, ros::ChangeLog{kStranger, 1000, 0, {"<nonsense"}}, log, ros::Durability::log);
  say(*bad, ros::ChangeLog{kHost + 1, 0, 0, {"<nonsense"}}, log, ros::Durability::log);
  say(*bad, ros::HostFrame{kHost + 1, "other", 0, 0, 0, {}}, frame, ros::Durability::latched);
  say(*good, ros::ChangeLog{kHost, 0, 0, {"first", "second"}}, log, ros::Durability::log);
  say(*good, ros::ChangeLog{kHost, 1, 3, {"second", "third"}}, log, ros::Durability::log);  // the second again
  say(*good, ros::HostFrame{kHost, "demo", 3, 40, 3, {1, 2}}, frame, ros::Durability::latched);
  const std::unique_ptr<FollowedHost> host = host_by_dds("demo", domain);
  await([&] { return host->connect(50); });
  std::vector<double> values;
  const FollowedHost::Frame found = host->read(values);
  CHECK(found.next_frame == 4);
  CHECK(found.time_ns == 40);
  CHECK(values == std::vector<double>{1, 2});
  std::vector<std::string> changes;
  for (std::uint64_t position = 0; const auto change = host->next_change(position);) changes.emplace_back(change->xml);
  CHECK(changes == std::vector<std::string>{"first", "second", "third"});

  // Frames of a time that cannot be, and outputs whose numbers do not fit together.
  say(*bad, ros::HostFrame{kHost + 1, "demo", 9, -1, 0, {}}, frame, ros::Durability::latched);
  ros::HostMeasurement measurement;
  measurement.host = kHost;
  const MeasuredArray labels{
      {.name = "instance", .kind = OutputKind::image, .value_type = ValueType::u32, .shape = {1, 2}},
      SharedArray<std::uint32_t>{7, 4'000'000'000}};
  CHECK_FALSE(host->measurement("CAM", 0));
  std::optional<FollowedHost::HostMeasurement> seen;
  await([&] {
    measurement.outputs = {to_message(labels)};
    measurement.outputs[0].data.pop_back();
    good->write(follow_topic("demo/CAM", kFollowMeasurement), 0, measurement);
    measurement.outputs = {to_message(labels)};
    good->write(follow_topic("demo/CAM", kFollowMeasurement), 0, measurement);
    return (seen = host->measurement("CAM", 0)).has_value();
  });
  REQUIRE(seen->measurement.arrays.size() == 1);
  CHECK(seen->measurement.arrays[0].numbers == labels.numbers);
  CHECK(host->wait(1, 0) == FollowedHost::Waited::time_over);
  good->finish();
  await([&] { return host->wait(1, 50) == FollowedHost::Waited::host_ended; });
}

TEST_CASE("--follow dds: a name that no process serves is reported, and names that no process can have are refused") {
  if (!has_dds()) return test::skip("this build has no DDS");
  const DdsHost host("dds-nobody");
  Process follower(host.follower("seen"));
  await([&] { return !follower.err_so_far().empty(); });
  follower.send(SIGINT);
  const ProcessResult result = follower.wait();
  CHECK(result.exit_code == 130);
  CHECK(result.err.find("no process in this domain of DDS serves \"" + host.name + "\"") != std::string::npos);
  for (const std::string name : {"dds:", "dds:7/", "dds:/demo", "dds:233/demo", "dds:seven/demo", "dds:a b"}) {
    const ProcessResult refused = Process({host.program, "--follow", name, "--quiet"}).wait();
    CHECK(refused.exit_code == 2);
    CHECK_MESSAGE(refused.err.find("--follow: ") != std::string::npos, refused.err);
  }
}

TEST_SUITE_END();
