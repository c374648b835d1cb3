// Runs that write results in each way are killed at random moments: what they leave under the names that they were
// given is whole, and the next run with the same names gives the bytes of a run that was not killed. The suite kills a
// few times in each mode; SIMVIS_TEST_KILLS=200 kills that often in each.
#include <doctest/doctest.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <functional>
#include <random>
#include <string>
#include <thread>

#include "tests/messages/mcap_file.h"
#include "tests/support/long_count.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr std::string_view kKilledSensors = R"(
<element type="pose" name="MOVE" insert_at="ROOT"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="181" min_angle="-60" max_angle="60"
        range_noise="0.01"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="32" height="24" outputs="color depth" read_noise_e="5"/>)";

struct KilledScene {
  TemporaryFolder folder;
  std::string file = write_wall_scene(folder.path(), kKilledSensors).string(), drive = (folder / "drive.csv").string();
  KilledScene() { write_text(drive, "time_s,MOVE.x\n0,0\n2,1.5\n"); }

  Strings command(const Strings& more) const {
    Strings arguments = {simvis_run(), file, "--frames", "30", "--trajectory", drive, "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
};

/// One way to write results: its options, with % for a folder, and what must hold for a file that exists.
struct KilledMode {
  std::string name;
  Strings options;
  std::string target;  ///< below the folder
  std::function<bool(const std::string& bytes)> is_whole;
};

bool is_whole_page(const std::string& bytes) { return bytes.find("</html>", bytes.size() - 16) != std::string::npos; }

bool is_whole_glb(const std::string& bytes) {
  std::uint32_t length = 0;
  if (bytes.size() < 12) return false;
  std::memcpy(&length, bytes.data() + 8, sizeof length);
  return bytes.starts_with("glTF") && length == bytes.size();
}

bool is_whole_map(const std::string& bytes) { return bytes.ends_with("free_thresh: 0.196\n"); }

// A killed recording has no summary; the reader checks all that is there.
bool is_readable_recording(const std::string& bytes) {
  ros::test::McapReader::read(bytes);
  return true;
}

bool ends_with_line(const std::string& bytes) { return bytes.empty() || bytes.ends_with('\n'); }

std::vector<KilledMode> killed_modes() {
  std::vector<KilledMode> modes = {
      {"results", {"--out", "%/out"}, "out/SCAN.csv", ends_with_line},
      {"page", {"--page", "%/run.html", "--out", "%/out"}, "run.html", is_whole_page},
      {"export", {"--export", "%/scene.glb", "--out", "%/out"}, "scene.glb", is_whole_glb},
      {"map", {"--export", "%/map.yaml", "--out", "%/out"}, "map.yaml", is_whole_map},
      {"record", {"--record", "%/run.mcap", "--out", "%/out"}, "run.mcap", is_readable_recording},
      {"shard", {"--shard", "1/2", "--out", "%/out"}, "out/SCAN-1-of-2.csv", ends_with_line},
      {"profile", {"--profile", "%/profile.json", "--out", "%/out"}, "out/SCAN.csv", ends_with_line},
      {"resume", {"--resume", "--out", "%/out"}, "out/SCAN.csv", ends_with_line},
      {"live", {"--live", "0", "--out", "%/out"}, "out/SCAN.csv", ends_with_line}};
  if (has_dds()) {
    modes.push_back({"dds", {"--dds", std::to_string(own_domain()), "--out", "%/out"}, "out/SCAN.csv", ends_with_line});
  }
  return modes;
}

Strings in_folder(Strings options, const std::filesystem::path& folder) {
  for (std::string& option : options) {
    if (option.starts_with('%')) option = folder.string() + option.substr(1);
  }
  return options;
}

/// Whether the file holds times of the wall clock, which no two runs share: reports and profiles.
bool holds_times(const std::string& name) { return name.ends_with(".json"); }

void check_same_results(const std::filesystem::path& whole, const std::filesystem::path& next) {
  CHECK(files_below(whole) == files_below(next));  // no leftovers
  std::size_t compared = 0;
  for (const std::string& name : files_below(whole)) {
    if (holds_times(name)) continue;
    INFO(name);
    const bool same = read_text(whole / name) == read_text(next / name);  // the texts are long
    CHECK(same);
    ++compared;
  }
  CHECK(compared >= 3);
}

TEST_CASE("runs that are killed at any moment leave whole files, and the next run gives the same bytes") {
  const KilledScene scene;
  std::mt19937 random(static_cast<unsigned>(count_of("SIMVIS_TEST_SEED", 1)));
  int kills = 0, ends = 0;
  for (const KilledMode& mode : killed_modes()) {
    CAPTURE(mode.name);
    const TemporaryFolder whole, tried;
    const auto start = std::chrono::steady_clock::now();
    const ProcessResult reference = Process(scene.command(in_folder(mode.options, whole.path()))).wait();
    INFO(reference.err);
    REQUIRE(reference.exit_code == 0);
    const auto length = std::chrono::steady_clock::now() - start;
    for (int i = count_of("SIMVIS_TEST_KILLS", sanitized() ? 1 : 3); i > 0; --i) {
      Process process(scene.command(in_folder(mode.options, tried.path())));
      std::this_thread::sleep_for(length * static_cast<double>(random() % 1000) / 1000);
      process.send(SIGKILL);
      (process.wait().signal == SIGKILL ? kills : ends) += 1;
      if (std::filesystem::exists(tried / mode.target)) {
        INFO(i);
        CHECK(mode.is_whole(read_text(tried / mode.target)));
      }
    }
    const ProcessResult next = Process(scene.command(in_folder(mode.options, tried.path()))).wait();
    INFO(next.err);
    CHECK(next.exit_code == 0);
    check_same_results(whole.path(), tried.path());
  }
  MESSAGE(kills, " runs were killed, ", ends, " had ended");
  CHECK(kills > 0);
}

// As a kill between the two files of a map: what follows the call that fails is not done.
TEST_CASE("a map of ROS never names the picture of another map, whichever file cannot get its name") {
  if (sanitized()) return test::skip(test::kNotSanitized);  // the preloaded library must come first
  const KilledScene scene;
  const auto command = [&](const TemporaryFolder& results, const TemporaryFolder& map, const char* resolution_m) {
    return scene.command({"--out", (results / "out").string(), "--export", (map / "map.yaml").string(),
                          "--export-resolution", resolution_m});
  };
  for (int at = 1; at <= 2; ++at) {
    CAPTURE(at);
    const TemporaryFolder results, map, marks;
    REQUIRE(Process(command(results, map, "0.1")).wait().exit_code == 0);
    const ProcessResult failed =
        Process(command(results, map, "0.2"),
                {"LD_PRELOAD=" + tested_build() + "/lib/libsimvis_failing_calls.so", "SIMVIS_FAIL_IN=simvis-run",
                 "SIMVIS_FAIL_BELOW=" + map.path().string(), "SIMVIS_FAIL_CALL=rename",
                 "SIMVIS_FAIL_AT=" + std::to_string(at), "SIMVIS_FAIL_ERRNO=" + std::to_string(EIO),
                 "SIMVIS_FAIL_MARK=" + (marks / "mark").string()})
            .wait();
    INFO(failed.err);
    CHECK(failed.exit_code == 1);
    CHECK(std::filesystem::file_size(marks / "mark") == 1);
    CHECK(std::filesystem::exists(map / "map.pgm"));
    CHECK_FALSE(std::filesystem::exists(map / "map.yaml"));
  }
}

TEST_CASE("a resumed run with recordings that is killed again and again") {
  const KilledScene scene;
  const TemporaryFolder whole, tried;
  const auto options = [](const TemporaryFolder& folder, int number) {
    return Strings{"--resume", "--out", (folder / "out").string(), "--record",
                   (folder / ("run" + std::to_string(number) + ".mcap")).string()};
  };
  const auto start = std::chrono::steady_clock::now();
  REQUIRE(Process(scene.command(options(whole, 0))).wait().exit_code == 0);
  const auto length = std::chrono::steady_clock::now() - start;
  std::mt19937 random(static_cast<unsigned>(count_of("SIMVIS_TEST_SEED", 1)));
  int number = 0;
  for (int i = count_of("SIMVIS_TEST_KILLS", sanitized() ? 2 : 4); i > 0; --i, ++number) {
    Process process(scene.command(options(tried, number)));
    std::this_thread::sleep_for(length * static_cast<double>(random() % 1000) / 1000);
    process.send(SIGKILL);
    process.wait();
    const std::filesystem::path recording = tried / ("run" + std::to_string(number) + ".mcap");
    if (std::filesystem::exists(recording)) CHECK(is_readable_recording(read_text(recording)));
  }
  const ProcessResult next = Process(scene.command(options(tried, number))).wait();
  INFO(next.err);
  CHECK(next.exit_code == 0);
  for (const char* file : {"out/SCAN.csv", "out/CAM/000000.png", "out/CAM/000029.exr"}) {
    const bool same = read_text(whole / file) == read_text(tried / file);
    CAPTURE(file);
    CHECK(same);
  }
}

TEST_CASE("a served run that is killed leaves its name to the next one") {
  const KilledScene scene;
  const std::string name = "test-killed-mode-" + std::to_string(::getpid());
  const TemporaryFolder folder;
  const Strings options = {"--serve", name, "--out", (folder / "out").string()};
  std::mt19937 random(static_cast<unsigned>(count_of("SIMVIS_TEST_SEED", 1)));
  for (int i = count_of("SIMVIS_TEST_KILLS", sanitized() ? 1 : 3); i > 0; --i) {
    Process process(scene.command(options));
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 500));
    process.send(SIGKILL);
    process.wait();
  }
  const ProcessResult next = Process(scene.command(options)).wait();
  INFO(next.err);
  CHECK(next.exit_code == 0);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
