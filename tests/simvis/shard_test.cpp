// `--shard K/N`: the joined results of several processes equal those of one, to the byte.
#include "program/report/shard.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "tests/support/simvis_run.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;
// Everything that a frame can take from other frames: earlier poses of a camera with a rolling shutter and of a scanner
// with a sweep (one of them with its own rate), motion and drift of an imu, the ways of wheels, noise, and a sensor
// that is never due in some shards.
constexpr std::string_view kShardedSensors = R"(
<element type="pose" name="MOVE" insert_at="ROOT"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="32" height="24" outputs="color depth" row_time="0.002"
        read_noise_e="5"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="31" min_angle="-60" max_angle="60" sweep="0.05"
        range_noise="0.01" rate="7"/>
<sensor type="laser_scanner" name="PLANAR" insert_at="ROOT" method="planar" samples="11" min_angle="-60" max_angle="60"/>
<sensor type="imu" name="IMU" insert_at="ROOT" gyroscope_noise_density="0.01" gyroscope_random_walk="0.1"/>
<sensor type="odometry" name="ODOM" insert_at="ROOT" kind="wheel" slip_stddev="0.01" rate="7"/>
<sensor type="camera" name="SLOW" insert_at="ROOT" width="8" height="8" rate="1"/>)";

// Joins them as in docs/command-line.md.
constexpr const char* kJoin =
    "cd \"$1\" && for first in *-0-of-\"$2\".csv; do table=${first%-0-of-*}; "
    "(head -n 1 \"$first\"; tail -qn +2 \"$table\"-*-of-\"$2\".csv | sort -snt, -k1,1) > \"$table.csv\"; done";

ProcessResult run_checked(Strings arguments) {
  arguments.insert(arguments.begin(), simvis_run());
  return Process(arguments).wait();
}

void write_drive(const fs::path& file) {
  write_text(file, "time_s,MOVE.x,MOVE.y,MOVE.yaw\n0,0,0,-10\n0.4,1,-0.5,20\n0.8,1.5,0.2,-5\n");
}

bool is_run_file(const std::string& name) { return name.starts_with("run") && name.ends_with(".json"); }

TEST_CASE("the files of all shards equal those of one run, to the byte") {
  const TemporaryFolder folder;
  const std::string scene = write_wall_scene(folder.path(), kShardedSensors).string();
  write_drive(folder / "drive.csv");
  const Strings options = {scene, "--frames", "10", "--trajectory", (folder / "drive.csv").string(), "--seed", "3"};
  const auto make = [&](const std::string& out, const Strings& more) {
    Strings arguments = options;
    arguments.insert(arguments.end(), {"--out", (folder / out).string()});
    arguments.insert(arguments.end(), more.begin(), more.end());
    const ProcessResult result = run_checked(arguments);
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    return result.out;
  };
  make("one", {});
  CHECK(make("three", {"--shard", "2/3"}).find("three/run-2-of-3.json") != std::string::npos);
  CHECK(files_below(folder / "three") ==
        Strings{"CAM.yaml",          "CAM/000002.exr",          "CAM/000002.png",
                "CAM/000005.exr",    "CAM/000005.png",          "CAM/000008.exr",
                "CAM/000008.png",    "CAM_poses-2-of-3.csv",    "CAM_poses-2-of-3.tum",
                "IMU-2-of-3.csv",    "IMU_poses-2-of-3.csv",    "IMU_poses-2-of-3.tum",
                "ODOM-2-of-3.csv",   "ODOM_poses-2-of-3.csv",   "ODOM_poses-2-of-3.tum",
                "PLANAR-2-of-3.csv", "PLANAR_poses-2-of-3.csv", "PLANAR_poses-2-of-3.tum",
                "SCAN-2-of-3.csv",   "SCAN_poses-2-of-3.csv",   "SCAN_poses-2-of-3.tum",
                "run-2-of-3.json"});
  make("three", {"--shard", "0/3"});
  make("three", {"--shard", "1/3"});
  for (const int k : {0, 1, 2}) {
    const auto json = nlohmann::json::parse(read_text(folder / ("three/run-" + std::to_string(k) + "-of-3.json")));
    CHECK(json["shard"]["index"] == k);
    CHECK(json["shard"]["count"] == 3);
    CHECK(json["frames"] == (k == 0 ? 4 : 3));
  }
  CHECK_FALSE(nlohmann::json::parse(read_text(folder / "one/run.json")).contains("shard"));

  REQUIRE(Process({"/bin/sh", "-c", kJoin, "sh", (folder / "three").string(), "3"}).wait().exit_code == 0);
  std::size_t compared = 0;
  for (const std::string& name : files_below(folder / "one")) {
    if (is_run_file(name) || name.ends_with(".tum")) continue;
    INFO(name);
    REQUIRE(fs::exists(folder / ("three/" + name)));
    CHECK(read_text(folder / ("three/" + name)) == read_text(folder / ("one/" + name)));
    ++compared;
  }
  // Pictures of both cameras, their intrinsics, the tables, and the poses of all six.
  CHECK(compared == 10 * 2 + 1 + 2 + 4 + 6);
  for (const std::string& name : files_below(folder / "three")) {
    const bool own = is_run_file(name) || name.find("-of-3.") != std::string::npos;
    CHECK_MESSAGE((own || fs::exists(folder / ("one/" + name))), name);
  }
}

void check_refused(const Strings& options, std::string_view commands, const Strings& expected) {
  const TemporaryFolder folder;
  Strings arguments = {write_wall_scene(folder.path(), commands).string(), "--frames", "6", "--out",
                       (folder / "out").string()};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const ProcessResult result = run_checked(arguments);
  INFO(result.err);
  CHECK(result.exit_code == 2);
  CHECK(result.err.starts_with("simvis-run: "));
  for (const std::string& text : expected) CHECK_MESSAGE(result.err.find(text) != std::string::npos, text);
  CHECK_FALSE(fs::exists(folder / "out"));
}

TEST_CASE("an invalid share, and scenes whose frames cannot be made separately") {
  for (const char* wrong : {"3/3", "1", "1/", "/2", "-1/2", "0/0", "1/2/3", "a/b", "1 /2", "1/99999999999999999999"}) {
    check_refused({"--shard", wrong}, kShardedSensors, {"--shard: ", wrong, "expected K/N with K from 0 to N - 1"});
  }
  check_refused({"--shard", ""}, kShardedSensors, {"--shard"});
  check_refused({"--shard", "6/7"}, kShardedSensors, {"--shard: 6/7 has no frame of 6"});
  check_refused({"--shard", "0/2", "--price"}, kShardedSensors, {"--shard", "--price"});
  const std::string chooses = R"(<sensor type="laser_scanner" name="AUTO" insert_at="ROOT" method="auto"/>)";
  check_refused({"--shard", "0/2"}, chooses, {"--shard: sensor \"AUTO\"", "(auto)", "expected another method"});
  const std::string view = R"(<sensor type="camera" name="VIEW" insert_at="ROOT" view="visualization"/>)";
  check_refused({"--shard", "0/2"}, view, {"--shard: sensor \"VIEW\"", "expected it to be off"});
  const std::string events = R"(<sensor type="event_camera" name="EVENTS" insert_at="ROOT" width="8" height="8"/>)";
  check_refused({"--shard", "0/2"}, events, {"--shard: sensor \"EVENTS\"", "expected it to be off"});

  // Share 1/1 is a whole run, and a sensor that is off makes nothing dependent.
  const TemporaryFolder folder;
  const std::string scene = write_wall_scene(folder.path(), std::string(kShardedSensors) + view + chooses).string(),
                    out = (folder / "out").string();
  CHECK(run_checked({scene, "--out", out, "--shard", "0/1"}).exit_code == 0);
  CHECK(run_checked({scene, "--out", out, "--frames", "2", "--shard", "1/2", "--sensor", "PLANAR"}).exit_code == 0);
  CHECK(fs::exists(folder / "out/run-0-of-1.json"));
  CHECK(fs::exists(folder / "out/PLANAR-1-of-2.csv"));
  CHECK(run_checked({"--help"}).out.find("--shard K/N") != std::string::npos);
}

TEST_CASE("a signal after the last frame of a share finds it whole, also if other shares have later frames") {
  constexpr const char* kInterruptAtFile =
      "import os, signal, subprocess, sys, time\n"
      "run = subprocess.Popen(sys.argv[2:])\n"
      "while run.poll() is None and not os.path.exists(sys.argv[1]): time.sleep(1e-4)\n"
      "run.send_signal(signal.SIGTERM)\n"
      "sys.exit(run.wait())\n";
  const TemporaryFolder folder;
  const std::string scene = write_wall_scene(folder.path(), kShardedSensors).string(), out = (folder / "out").string();
  const ProcessResult result = Process({"python3", "-c", kInterruptAtFile, out + "/CAM/000002.png", simvis_run(), scene,
                                        "--out", out, "--frames", "4", "--quiet", "--shard", "0/2"})
                                   .wait();
  INFO(result.err);
  CHECK(result.exit_code == 0);
  CHECK(nlohmann::json::parse(read_text(folder / "out/run-0-of-2.json")).at("status") == "complete");
}

TEST_CASE("a signal that comes when all frames are made changes nothing, also in a share without the last frame") {
  // The explanation follows the last frame. Its pipe holds little of it, so the run waits for the reader in finish().
  constexpr const char* kInterruptAtTheEnd =
      "import fcntl, os, signal, subprocess, sys\n"
      "end, start = os.pipe()\n"
      "assert fcntl.fcntl(start, 1031, 4096) == 4096\n"  // F_SETPIPE_SZ
      "run = subprocess.Popen(sys.argv[1:], stdout=start)\n"
      "os.close(start)\n"
      "size = len(os.read(end, 1))\n"
      "run.send_signal(signal.SIGTERM)\n"
      "while more := os.read(end, 65536): size += len(more)\n"
      "assert size > 3 * 4096, size\n"
      "sys.exit(run.wait())\n";
  std::string sensors(kShardedSensors);
  for (int i = 0; i < 100; ++i) {
    sensors += "<sensor type=\"psd\" name=\"P" + std::to_string(i) + "\" insert_at=\"ROOT\"/>";
  }
  for (const std::string shard : {"0/1", "0/2", "1/2"}) {
    CAPTURE(shard);
    const TemporaryFolder folder;
    const std::string scene = write_wall_scene(folder.path(), sensors).string(), out = (folder / "out").string();
    const ProcessResult result = Process({"python3", "-c", kInterruptAtTheEnd, simvis_run(), scene, "--out", out,
                                          "--frames", "4", "--explain", "--quiet", "--shard", shard})
                                     .wait();
    INFO(result.err);
    CHECK(result.exit_code == 0);
    const auto report = nlohmann::json::parse(
        read_text(folder / ("out/run-" + shard.substr(0, 1) + "-of-" + shard.substr(2) + ".json")));
    CHECK(report.at("status") == "complete");
    CHECK(report.at("next_frame") == 4);
  }
}

TEST_CASE("the shares of a run cover its frames once") {
  for (const std::uint64_t frames : {1u, 2u, 7u, 24u}) {
    for (const std::uint64_t count : {1u, 2u, 5u, 30u}) {
      std::uint64_t all = 0;
      for (std::uint64_t index = 0; index < count; ++index) {
        const Shard shard = parse_shard(std::to_string(index) + "/" + std::to_string(count));
        std::uint64_t own = 0;
        for (std::uint64_t frame = 0; frame < frames; ++frame) own += shard.has(frame);
        CHECK(own == shard.share_of(frames));
        all += own;
      }
      CHECK(all == frames);
    }
  }
  CHECK(Shard{3, 8}.suffix() == "-3-of-8");
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
