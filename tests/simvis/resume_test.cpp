// What a run leaves when it is interrupted, and that --resume gives the bytes of a run that was not.
#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <thread>

#include "tests/support/error_of.h"
#include "tests/support/long_count.h"
#include "tests/support/loopback_dds.h"
#include "tests/support/picture_files.h"
#include "tests/support/simvis_run.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;
// A scanner whose frames are several pages of a file, one whose frames depend on the pose before, a camera with depth,
// noise, a sensor at a rate of its own, one with drift, and a table that is empty in many frames.
constexpr std::string_view kInterruptedSensors = R"(
<element type="pose" name="MOVE" insert_at="ROOT"/>
<sensor type="laser_scanner" name="BIG" insert_at="ROOT" samples="301" min_angle="-60" max_angle="60"
        vertical_samples="3" vertical_min_angle="-5" vertical_max_angle="5" range_noise="0.01"/>
<sensor type="laser_scanner" name="SWEEP" insert_at="ROOT" samples="11" min_angle="-60" max_angle="60" sweep="0.05"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="16" height="12" outputs="color depth" read_noise_e="5"/>
<sensor type="imu" name="IMU" insert_at="ROOT" accelerometer_dynamic_bias_stddev="1"
        accelerometer_dynamic_bias_correlation_time="3"/>
<sensor type="radar" name="RADAR" insert_at="ROOT" range_max="3.3" angle_step="5"/>
<sensor type="psd" name="SLOW" insert_at="ROOT" rate="4"/>)";

struct InterruptedScene {
  TemporaryFolder folder;
  std::string file = write_wall_scene(folder.path(), kInterruptedSensors).string(),
              drive = (folder / "drive.csv").string();
  InterruptedScene() { write_text(drive, "time_s,MOVE.x,MOVE.yaw\n0,0,-10\n2,1.5,20\n"); }

  Strings command(const std::string& out, const Strings& more = {}) const {
    Strings arguments = {simvis_run(), file,  "--frames", "30", "--trajectory", drive, "--out", (folder / out).string(),
                         "--poses",    "WALL"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  ProcessResult run(const std::string& out, const Strings& more = {}) const {
    return Process(command(out, more)).wait();
  }
};

bool ends_in_line(const std::string& text) { return text.ends_with('\n'); }

/// Every table ends with a whole frame, every picture and the report can be read.
/// `killed`: a killed run may have left temporary files.
void check_whole(const fs::path& out, bool killed) {
  for (const std::string& name : files_below(out)) {
    INFO(name);
    if (name.ends_with(".tmp") || name.ends_with(".simvis-lock")) {
      CHECK(killed);
    } else if (name.ends_with(".csv") || name.ends_with(".tum")) {
      const std::string text = read_text(out / name);
      CHECK(ends_in_line(text));
      if (name == "BIG.csv") CHECK(std::ranges::count(text, '\n') % (3 * 301) == 1);
      if (name == "SWEEP.csv") CHECK(std::ranges::count(text, '\n') % 11 == 1);
    } else if (name.ends_with(".png")) {
      CHECK(read_png(out / name).width == 16);
    } else if (name.ends_with(".exr")) {
      CHECK(read_exr(out / name).channels.size() == 4);
    } else if (name == "run.json") {
      CHECK(nlohmann::json::parse(read_text(out / name)).contains("files"));
    } else {
      CHECK(name == "CAM.yaml");
    }
  }
}

void check_same_files(const fs::path& one, const fs::path& other) {
  const Strings names = files_below(one);
  REQUIRE(names == files_below(other));
  for (const std::string& name : names) {
    if (name == "run.json") continue;
    CHECK_MESSAGE(read_text(one / name) == read_text(other / name), name);
  }
}

// A run takes five times as long with the sanitizers. SIMVIS_SIGNALS=200 sends as many, however long that takes.
const int kSignals = count_of("SIMVIS_SIGNALS", sanitized() ? 10 : 30);

TEST_CASE("signals at random times: every file is whole, and resumed runs give the same bytes") {
  const InterruptedScene scene;
  const auto start = std::chrono::steady_clock::now();
  REQUIRE(scene.run("whole").exit_code == 0);
  const auto length = std::chrono::steady_clock::now() - start;
  const fs::path out = scene.folder / "out";
  std::mt19937_64 random(11);
  int kills = 0, stops = 0, done = 0;
  bool leftovers = false;
  // Some seconds each on a loaded machine; no new signal after this time, so that the test ends.
  const auto end = start + (std::getenv("SIMVIS_SIGNALS") != nullptr ? std::chrono::hours(1) : std::chrono::minutes(3));
  for (int i = 0; i < kSignals && std::chrono::steady_clock::now() < end; ++i) {
    const int signal = std::vector{SIGINT, SIGTERM, SIGKILL}[random() % 3];
    Process process(scene.command("out", {"--resume"}));
    std::this_thread::sleep_for(length * static_cast<double>(random() % 1000) / 1000);
    process.send(signal);
    const ProcessResult result = process.wait();
    INFO(i, " ", signal, " ", result.err);
    if (result.signal == SIGKILL) {
      ++kills;
      leftovers = true;
    } else if (result.exit_code == 0) {
      ++done;
    } else {
      ++stops;
      // A signal before main() has the system's own effect.
      CHECK((result.exit_code == 130 || result.signal == signal));
    }
    check_whole(out, leftovers);
    if (result.exit_code != 0) continue;
    leftovers = false;
    check_same_files(scene.folder / "whole", out);
    fs::remove_all(out);
  }
  MESSAGE(kills, " kills, ", stops, " stops, ", done, " runs to the end");
  CHECK(kills > 0);
  CHECK(stops > 0);
  REQUIRE(scene.run("out", {"--resume"}).exit_code == 0);
  check_same_files(scene.folder / "whole", out);
  const auto json = nlohmann::json::parse(read_text(out / "run.json"));
  CHECK(json["status"] == "complete");
  CHECK(json["frames"] == 30);
  CHECK(json["sensors"]["BIG"]["frames"] == 30);
  CHECK(json["sensors"]["SLOW"]["frames"] == 8);  // 4 Hz in the two seconds of 30 frames
}

TEST_CASE("--resume goes on only with the same run, and a finished run is left alone") {
  const InterruptedScene scene;
  REQUIRE(scene.run("out", {"--resume"}).exit_code == 0);  // nothing there: from the beginning
  const std::string report = read_text(scene.folder / "out/run.json");
  const ProcessResult again = Process({simvis_run(), "--resume", "--out", (scene.folder / "out").string()}).wait();
  CHECK(again.exit_code == 0);
  CHECK(again.out.find("has all of its 30 frames") != std::string::npos);
  CHECK(read_text(scene.folder / "out/run.json") == report);
  const ProcessResult other = scene.run("out", {"--resume", "--seed", "1"});
  CHECK(other.exit_code == 2);
  CHECK(other.err.find("another \"seed\": 0, and this one has 1") != std::string::npos);
  CHECK(read_text(scene.folder / "out/run.json") == report);
  const ProcessResult longer =
      Process({simvis_run(), "--resume", "--frames", "33", "--out", (scene.folder / "out").string()}).wait();
  INFO(longer.err);
  REQUIRE(longer.exit_code == 0);
  REQUIRE(scene.run("whole", {}).exit_code == 0);
  CHECK(fs::exists(scene.folder / "out/CAM/000032.png"));
  CHECK(read_text(scene.folder / "out/BIG.csv").starts_with(read_text(scene.folder / "whole/BIG.csv")));
}

TEST_CASE("--resume is refused with options of other processes, and for runs in which these took part") {
  const std::pair<Strings, bool> shared[] = {{{"--serve", "resumed-run-" + std::to_string(::getpid())}, true},
                                             {{"--live", "0"}, true},
                                             {{"--dds", std::to_string(own_domain())}, has_dds()},
                                             {{"--follow", "none"}, false}};
  for (const auto& [options, can_run] : shared) {
    const std::string option = options.front();
    CAPTURE(option);
    const InterruptedScene scene;
    Strings resumed = options;
    resumed.emplace_back("--resume");
    const auto refused = [&](const Strings& arguments, const std::string& expected) {
      const ProcessResult result = run_simvis(arguments);
      CHECK(result.exit_code == 2);
      CHECK(contains(result.err, expected));
    };
    const std::string out = (scene.folder / "out").string();
    for (const bool names_out : {false, true}) {
      Strings arguments = resumed;
      if (names_out) arguments.insert(arguments.end(), {"--out", out});
      arguments.push_back(scene.file);
      refused(arguments, "--resume excludes " + option);
    }
    CHECK_FALSE(fs::exists(out));
    if (!can_run) continue;
    Strings slow = scene.command("out", options);
    slow.insert(slow.end(), {"--real-time", "0.1"});
    Process running(slow);
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (!fs::exists(scene.folder / "out/CAM/000001.png") && std::chrono::steady_clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    running.send(SIGINT);
    const ProcessResult stopped = running.wait();
    CHECK(stopped.exit_code == 130);
    CHECK(stopped.err.ends_with(" of 30\n"));
    const std::string report = read_text(scene.folder / "out/run.json");
    CHECK(contains(report, "\"stopped\""));
    Strings named = scene.command("out", {"--resume"});
    named.erase(named.begin());
    refused(named, "other processes took part in the run");
    refused({"--resume", "--out", out}, "other processes took part in the run");
    CHECK(read_text(scene.folder / "out/run.json") == report);
  }
}

TEST_CASE("a run replaces the files of the earlier run in its folder, and nothing else") {
  const InterruptedScene scene;
  REQUIRE(scene.run("out").exit_code == 0);
  const fs::path out = scene.folder / "out";
  write_text(out / "notes.txt", "mine");
  write_text(out / "CAM/000100.png", "mine, too");
  const ProcessResult refused = scene.run("out", {"--no-replace"});
  CHECK(refused.exit_code == 2);
  CHECK(refused.err.find("--no-replace: ") != std::string::npos);
  CHECK(fs::exists(out / "CAM/000029.png"));

  // Nothing is written when a file of another option stands there.
  const fs::path mine = scene.folder / "mine";
  for (const std::string option : {"--export", "--page", "--save-state", "--profile", "--record", "--record-pcap"}) {
    CAPTURE(option);
    const std::string file = mine.string() + (option == "--export" ? ".glb" : option == "--page" ? ".html" : ".mcap");
    write_text(file, "mine");
    const ProcessResult kept = scene.run("new", {option, file, "--no-replace"});
    CHECK(kept.exit_code == 2);
    CHECK(contains(kept.err, option + ": " + file + " exists, and --no-replace is given, expected another file"));
    CHECK(read_text(file) == "mine");
    CHECK(!fs::exists(scene.folder / "new"));
  }

  Strings shorter = {simvis_run(), scene.file, "--frames", "2", "--sensor", "CAM", "--out", out.string()};
  const ProcessResult result = Process(shorter).wait();
  INFO(result.err);
  REQUIRE(result.exit_code == 0);
  CHECK(result.out.find("replaced the results of an earlier run in " + out.string()) != std::string::npos);
  CHECK(files_below(out) == Strings{"CAM.yaml", "CAM/000000.exr", "CAM/000000.png", "CAM/000001.exr", "CAM/000001.png",
                                    "CAM/000100.png", "CAM_poses.csv", "CAM_poses.tum", "notes.txt", "run.json"});
  CHECK(read_text(out / "CAM/000100.png") == "mine, too");

  // A file that the run would write, but which no run has written.
  write_text(out / "BIG.csv", "mine");
  const ProcessResult taken = scene.run("out");
  CHECK(taken.exit_code == 2);
  CHECK(taken.err.find("BIG.csv: error: the file exists") != std::string::npos);
  CHECK(read_text(out / "BIG.csv") == "mine");
}

TEST_CASE("a scene that fails in its first frame leaves the earlier results alone") {
  const InterruptedScene scene;
  REQUIRE(scene.run("out").exit_code == 0);
  const Strings before = files_below(scene.folder / "out");
  const ProcessResult failed = scene.run("out", {"--max-error", "1e-12"});
  CHECK(failed.exit_code == 2);
  CHECK(files_below(scene.folder / "out") == before);
}

TEST_CASE("two runs never write to one folder at once; leftovers of dead runs go") {
  const InterruptedScene scene;
  const fs::path out = scene.folder / "out";
  fs::create_directories(out / "CAM");
  const int descriptor = ::open(out.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  REQUIRE(descriptor >= 0);
  REQUIRE(::flock(descriptor, LOCK_EX) == 0);
  const ProcessResult refused = scene.run("out");
  CHECK(refused.exit_code == 1);
  CHECK(refused.err.find("is writing to this folder") != std::string::npos);
  ::close(descriptor);

  write_text(out / ".BIG.csv.machine.1234.5.tmp", "half");
  write_text(out / ".mine.tmp", "mine");
  CHECK(scene.run("out").exit_code == 0);
  CHECK_FALSE(fs::exists(out / ".BIG.csv.machine.1234.5.tmp"));
  CHECK(fs::exists(out / ".mine.tmp"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
