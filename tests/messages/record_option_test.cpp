// simvis-run --record: files of whole runs, of killed runs, and on full disks.
#include <doctest/doctest.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "exchange/messages/mcap_writer.h"
#include "exchange/messages/types/sensor_types.h"
#include "exchange/messages/types/system_types.h"
#include "tests/messages/mcap_file.h"
#include "tests/support/error_of.h"
#include "tests/support/long_count.h"
#include "tests/support/run_process.h"
#include "tests/support/simvis_run.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("messages");

namespace simvis {
namespace {

namespace fs = std::filesystem;
using ros::test::McapFile;
using ros::test::McapReader;

struct WallRun {
  TemporaryFolder folder;
  std::string scene = write_wall_scene(folder.path(), kWallSensors).string();
  fs::path out = folder / "out", file = folder / "run.mcap";

  Strings arguments(const Strings& more) const {
    Strings all = {scene, "--out", out.string(), "--record", file.string(), "--quiet"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  ProcessResult run(const Strings& more) const { return run_simvis(arguments(more)); }
  McapFile read() const { return McapReader::read(read_text(file)); }
};

TEST_CASE("--record writes the frames of a run and says so in run.json") {
  const WallRun wall;
  const ProcessResult result = wall.run({"--frames", "3"});
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  const McapFile file = wall.read();
  CHECK(file.has_end);
  CHECK(file.counts().at("/clock") == 3);
  CHECK(file.counts().at("/CAM/image_raw") == 3);
  CHECK(file.counts().at("/SLOW/image_raw") == 1);
  const auto report = nlohmann::json::parse(read_text(wall.out / "run.json"));
  CHECK(report.at("recording") == nlohmann::json{{"file", wall.file.string()},
                                                 {"messages", file.messages.size()},
                                                 {"dropped", 0},
                                                 {"bytes", fs::file_size(wall.file)}});
}

TEST_CASE("only the topics that are asked for, and a warning for a pattern without one") {
  const WallRun wall;
  const ProcessResult result =
      wall.run({"--frames", "2", "--record-topics", "/SCAN/*,/cl?ck", "--record-topics", "/X"});
  CHECK(result.exit_code == 0);
  CHECK(contains(result.err, R"(warning: recording: no topic has matched "/X")"));
  CHECK(wall.read().counts() == std::map<std::string, std::size_t>{{"/clock", 2},
                                                                   {"/SCAN/pose", 2},
                                                                   {"/SCAN/twist", 1},
                                                                   {"/SCAN/scan", 2},
                                                                   {"/SCAN/points", 2},
                                                                   {"/SCAN/azimuth_rad", 1},
                                                                   {"/SCAN/elevation_rad", 1},
                                                                   {"/SCAN/azimuth_deg", 1},
                                                                   {"/SCAN/elevation_deg", 1}});
}

TEST_CASE("an earlier recording is replaced, another file is not") {
  const WallRun wall;
  REQUIRE(wall.run({"--frames", "3"}).exit_code == 0);
  REQUIRE(wall.run({"--frames", "2"}).exit_code == 0);
  CHECK(wall.read().counts().at("/clock") == 2);
  fs::remove_all(wall.out);
  const ProcessResult kept = wall.run({"--frames", "1", "--no-replace"});
  CHECK(kept.exit_code == 2);
  CHECK(contains(kept.err, "--no-replace is given"));
  CHECK(wall.read().counts().at("/clock") == 2);
  write_text(wall.file, "a letter");
  const ProcessResult refused = wall.run({"--frames", "1"});
  CHECK(refused.exit_code == 2);
  CHECK(contains(refused.err, "run.mcap: error: exists and is no MCAP file"));
  CHECK(read_text(wall.file) == "a letter");
}

TEST_CASE("--resume and --again record only with --record") {
  const WallRun wall;
  REQUIRE(wall.run({"--frames", "2"}).exit_code == 0);
  fs::remove(wall.file);
  REQUIRE(run_simvis({"--out", wall.out.string(), "--resume", "--frames", "3", "--quiet"}).exit_code == 0);
  CHECK_FALSE(fs::exists(wall.file));
  const ProcessResult more =
      run_simvis({"--out", wall.out.string(), "--resume", "--frames", "5", "--quiet", "--record", wall.file.string()});
  INFO(more.err);
  REQUIRE(more.exit_code == 0);
  CHECK(wall.read().counts().at("/clock") == 2);  // the frames 3 and 4
  REQUIRE(run_simvis({"--again", (wall.out / "run.json").string(), "--out", (wall.folder / "again").string(),
                      "--record", wall.file.string(), "--quiet"})
              .exit_code == 0);
  CHECK(wall.read().counts().at("/clock") == 5);
}

TEST_CASE("a disk without room ends the run with an error, and what was written opens") {
  const WallRun wall;
  Strings command = {"/bin/sh", "-c", "ulimit -f 128; exec \"$@\"", "sh", simvis_run()};  // blocks of 512 bytes: 64 KiB
  // The recording grows faster than the tables.
  for (const std::string& each : wall.arguments({"--frames", "10000", "--sensor", "CAM", "--set", "MOVE.x=0.1"})) {
    command.push_back(each);
  }
  const ProcessResult result = Process(command).wait();
  CHECK(result.exit_code == 1);
  CHECK(contains(result.err, "run.mcap: error: cannot be written: File too large"));
  const McapFile file = wall.read();
  CHECK(file.has_end);
  CHECK_FALSE(file.messages.empty());
  CHECK(nlohmann::json::parse(read_text(wall.out / "run.json")).at("status") == "failed");
}

TEST_CASE("a killed run leaves a whole file without a summary") {
  std::mt19937 random(7);
  for (int i = 0; i < 5; ++i) {
    const WallRun wall;
    Strings command = wall.arguments({"--frames", "1000000"});
    command.insert(command.begin(), simvis_run());
    Process process(command);
    while (!fs::exists(wall.file)) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 200));
    process.send(SIGKILL);
    REQUIRE(process.wait().signal == SIGKILL);
    const McapFile file = wall.read();
    CHECK_FALSE(file.has_end);
    const std::vector<ros::Clock> clocks = file.all<ros::Clock>("/clock");
    CHECK(clocks.empty() == (file.chunks == 0));
    constexpr std::int64_t kSecond = 1'000'000'000;
    for (std::size_t frame = 0; frame < clocks.size(); ++frame) {  // at 15 Hz
      const ros::Time& time = clocks[frame].clock;
      CHECK(std::llround(static_cast<double>(frame) * kSecond / 15) == time.sec * kSecond + time.nanosec);
    }
  }
}

/// Writes messages of one chunk each, and counts those that are written, until it is killed.
[[noreturn]] void write_forever(const fs::path& file, std::atomic<std::uint32_t>& written) {
  ros::McapWriter writer(file);
  const auto channel = writer.add_channel("/image", ros::describe<ros::Image>(), ros::Durability::transient);
  std::mt19937 random(8);
  ros::Image image;
  image.data.resize(ros::McapWriter::kChunkBytes);
  for (std::uint8_t& each : image.data) each = static_cast<std::uint8_t>(random());
  for (;;) {
    image.height = written;
    writer.write(channel, 0, ros::encode(image));
    ++written;
  }
}

TEST_CASE("kills at any moment: every file opens and holds all but the last chunk") {
  std::mt19937 random(9);
  void* const shared =
      ::mmap(nullptr, sizeof(std::uint32_t), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  REQUIRE(shared != MAP_FAILED);
  auto* const written = new (shared) std::atomic<std::uint32_t>(0);
  for (int i = count_of("SIMVIS_TEST_KILLS", sanitized() ? 5 : 30); i > 0; --i) {
    const TemporaryFolder folder;
    written->store(0);
    const pid_t child = ::fork();
    if (child == 0) write_forever(folder / "file.mcap", *written);
    while (written->load() == 0) std::this_thread::sleep_for(std::chrono::microseconds(100));
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 20'000));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const McapFile file = McapReader::read(read_text(folder / "file.mcap"));
    CHECK(file.messages.size() >= written->load());
    CHECK(file.messages.size() <= written->load() + 1);
    std::uint32_t number = 0;
    for (const ros::Image& image : file.all<ros::Image>("/image")) CHECK(image.height == number++);
  }
  ::munmap(shared, sizeof(std::uint32_t));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
