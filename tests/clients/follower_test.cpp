// simvis-run --follow: another process shows the scene of the host, joins late, is killed, and outlives the host.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <set>
#include <thread>

#include <simvis/simulation.h>
#include "tests/clients/shared_host.h"
#include "tests/support/long_count.h"
#include "tests/support/run_process.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

using namespace simvis;

TEST_SUITE_BEGIN("clients");

namespace {

constexpr const char* kScene = R"(
    <part name="CART" insert_at="ROOT"/>
    <element type="pose" name="MOVE" insert_at="CART"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="CART" samples="21" min_angle="-20" max_angle="20"/>)";
constexpr const char* kVisuals = R"(
    <sensor type="camera" view="visualization" name="VIEW" insert_at="ROOT" width="64" height="48"
            pose_offset="-3 -1 2" look_at="2 0 0"/>
    <element type="laser_beams" name="BEAMS" insert_at="ROOT" scanner="SCAN" width="0.1"/>
    <element type="point_cloud" name="CLOUD" insert_at="ROOT" scanner="SCAN" size="0.2"/>)";

/// A host in this process, and what is needed to follow it in another one.
struct Followed {
  explicit Followed(const std::string& test) : name(unique_name(test)) {
    write_text(folder.path() / "visuals.xml", kVisuals);
    serve();
  }
  void serve() {
    host.reset();
    host.emplace(Simulation::load(write_wall_scene(folder.path(), kScene)));
    host->serve({.name = name, .folders = {folder.path()}});
  }
  std::vector<std::string> follower(const std::string& out, std::vector<std::string> more = {}) const {
    std::vector<std::string> all{
        tested_build() + "/bin/simvis-run",      "--follow", name, "--quiet", "--out", (folder.path() / out).string(),
        (folder.path() / "visuals.xml").string()};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  /// Steps until `done`.
  template <typename Done>
  void step_until(const Done& done) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!done()) {
      REQUIRE(std::chrono::steady_clock::now() < end);
      host->step();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  ProcessResult step_beside(const std::vector<std::string>& arguments) {
    std::atomic<bool> done = false;
    ProcessResult result;
    std::thread runner([&] {
      result = Process(arguments).wait(std::chrono::seconds(60));
      done = true;
    });
    while (!done) {
      host->step();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    runner.join();
    return result;
  }
  std::set<std::filesystem::path> pictures(const std::string& out) const {
    std::set<std::filesystem::path> all;
    const std::filesystem::path view = folder.path() / out / "VIEW";
    if (!std::filesystem::exists(view)) return all;
    for (const auto& entry : std::filesystem::directory_iterator(view)) {
      if (entry.path().extension() == ".png" && !entry.path().stem().string().starts_with("."))
        all.insert(entry.path());
    }
    return all;
  }
  /// The picture of the scene as it should be, made in one process.
  std::string expected(const std::string& scene, const std::vector<std::string>& set) {
    write_text(folder.path() / "whole.xml", read_text(write_wall_scene(folder.path(), scene + kVisuals)));
    std::vector<std::string> command{tested_build() + "/bin/simvis-run", "--quiet", "--out",
                                     (folder.path() / "whole").string(), (folder.path() / "whole.xml").string()};
    for (const std::string& value : set) command.insert(command.end(), {"--set", value});
    const ProcessResult result = Process(command).wait();
    REQUIRE_MESSAGE(result.exit_code == 0, result.err);
    return read_text(folder.path() / "whole" / "VIEW" / "000000.png");
  }
  TemporaryFolder folder;
  std::string name;
  std::optional<Simulation> host;
};

/// Until the follower has seen that its host has ended: of one whose successor comes at once it may see nothing.
void wait_for_end(const Process& follower) {
  for (int i = 0; i < 600 && follower.err_so_far().find("has ended; waiting") == std::string::npos; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
}

}  // namespace

TEST_CASE("a follower shows the scene of the host, with beams and points that the host does not have") {
  Followed followed("follow");
  Simulation& host = *followed.host;
  host.step();
  host.execute("<part shape='box' size='1 1 1' name='BOX' insert_at='ROOT' pose_offset='2 1 0 0 0 0'/>");
  host.execute("<part shape='box' size='1 1 1' name='GONE' insert_at='CART'/>");
  host.execute("<remove name='GONE'/>");
  host.set("MOVE", "x", 0.5);
  host.set("MOVE", "yaw", 10);
  host.step();
  // It joins late, and its picture is that of one process with everything in it.
  const ProcessResult result = followed.step_beside(followed.follower("out", {"--frames", "3"}));
  CHECK_MESSAGE(result.exit_code == 0, result.err);
  const auto pictures = followed.pictures("out");
  REQUIRE(pictures.size() == 3);
  const std::string expected = followed.expected(
      kScene + std::string("<part shape='box' size='1 1 1' name='BOX' insert_at='ROOT' pose_offset='2 1 0 0 0 0'/>"),
      {"MOVE.x=0.5", "MOVE.yaw=10"});
  for (const auto& picture : pictures) CHECK(read_text(picture) == expected);
  CHECK(expected != followed.expected(kScene, {}));
  const nlohmann::json report = nlohmann::json::parse(read_text(followed.folder.path() / "out" / "run.json"));
  CHECK(report.at("followed") == followed.name);
  CHECK(report.at("sensors").at("VIEW").at("frames") == 3);
  CHECK(report.at("sensors").at("SCAN").at("enabled") == false);
}

TEST_CASE("a follower sees changes while it runs, its own things give way, and it waits for the next host") {
  Followed followed("follow-changes");
  Process follower(followed.follower("out"));
  followed.step_until([&] { return followed.pictures("out").size() > 1; });
  const auto last_is = [&](const std::string& expected) {
    const auto pictures = followed.pictures("out");
    return !pictures.empty() && read_text(*pictures.rbegin()) == expected;
  };
  const std::string box = "<part shape='box' size='1 1 1' name='BOX' insert_at='ROOT' pose_offset='2 1 0 0 0 0'/>";
  const std::string with_box = followed.expected(kScene + box, {"MOVE.x=1"});
  followed.host->execute(box);
  followed.host->set("MOVE", "x", 1);
  followed.step_until([&] { return last_is(with_box); });
  // The follower's own beams refer to the scanner that goes, and the host takes a name that the follower has.
  followed.host->execute("<remove name='SCAN'/><part name='VIEW' insert_at='ROOT'/>");
  followed.host->execute("<element type='pose' name='BEAMS' insert_at='ROOT'/>");
  followed.step_until(
      [&] { return follower.err_so_far().find("visuals.xml is left out of the changed scene") != std::string::npos; });
  const std::size_t before = followed.pictures("out").size();
  followed.host.reset();
  wait_for_end(follower);
  followed.serve();  // its successor has the scene of the beginning
  const std::string fresh = followed.expected(kScene, {});
  followed.step_until([&] { return last_is(fresh); });
  CHECK(followed.pictures("out").size() > before);
  follower.send(SIGINT);
  const ProcessResult result = follower.wait();
  CHECK(result.exit_code == 130);
  CHECK(result.err.find("has ended; waiting for the next one") != std::string::npos);
}

// The header as a host leaves it that is killed while it writes a frame.
TEST_CASE("a follower waits for the next host where the last one was killed within a frame") {
  Followed followed("follow-torn");
  Process follower(followed.follower("out"));
  followed.step_until([&] { return !followed.pictures("out").empty(); });
  {
    const int file = open_object(followed.name);
    REQUIRE(file >= 0);
    void* const memory = ::mmap(nullptr, sizeof(simvis_header), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    REQUIRE(memory != MAP_FAILED);
    simvis_header& header = *static_cast<simvis_header*>(memory);
    __atomic_store_n(&header.frame_sequence, header.frame_sequence | 1, __ATOMIC_RELEASE);
    __atomic_store_n(&header.frame, header.frame + 1, __ATOMIC_RELEASE);
    followed.host.reset();
    ::munmap(memory, sizeof(simvis_header));
    ::close(file);
  }
  const std::size_t before = followed.pictures("out").size();
  wait_for_end(follower);
  followed.serve();
  followed.step_until([&] { return followed.pictures("out").size() > before; });
  follower.send(SIGINT);
  const ProcessResult result = follower.wait();
  CHECK(result.exit_code == 130);
  CHECK(result.err.find("has ended; waiting for the next one") != std::string::npos);
}

TEST_CASE("followers that come, are killed and come again change no byte of the host's results") {
  Followed followed("follow-kill");
  Simulation alone = Simulation::load(write_wall_scene(followed.folder.path(), kScene));
  const int kills = count_of("SIMVIS_TEST_KILLS", sanitized() ? 2 : 5);
  int frame = 0;
  for (int kill = 0; kill < kills; ++kill) {
    const std::string out = "out" + std::to_string(kill);
    Process follower(followed.follower(out));
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (followed.pictures(out).empty()) {
      REQUIRE(std::chrono::steady_clock::now() < end);
      for (Simulation* const each : {&*followed.host, &alone}) {
        each->set("MOVE", "x", 0.01 * (frame % 100));
        each->step();
      }
      ++frame;
      REQUIRE(followed.host->scan("SCAN").range_m == alone.scan("SCAN").range_m);
      REQUIRE(followed.host->scan("SCAN").error_bound_m == alone.scan("SCAN").error_bound_m);
    }
    follower.send(SIGKILL);
  }
  CHECK(frame > kills);
}

TEST_CASE("--follow: mistakes") {
  Followed followed("follow-wrong");
  followed.host->step();
  write_text(followed.folder.path() / "visuals.xml", "<sensor type='camera' name='V' insert_at='NOWHERE'/>");
  const ProcessResult result = Process(followed.follower("out")).wait();
  CHECK(result.exit_code == 2);
  CHECK(result.err.find("visuals.xml:1:") != std::string::npos);
  CHECK(Process(followed.follower("out", {"--serve", "other"})).wait().exit_code == 2);
  CHECK(Process(followed.follower("out", {"--resume"})).wait().exit_code == 2);
}

TEST_SUITE_END();
