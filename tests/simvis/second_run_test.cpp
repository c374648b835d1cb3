// Two runs that would write the same result: the second ends with an error before it touches anything, and the first is
// whole. The first may be killed: it leaves no lock that a later run waits for.
#include <doctest/doctest.h>
#include <signal.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include "tests/support/simvis_run.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kLockedSensors = R"(
<element type="pose" name="MOVE" insert_at="ROOT"/>
<sensor type="camera" name="CAM" insert_at="ROOT" width="16" height="12" outputs="color depth instance boxes silhouettes"/>
<element type="label" name="LABEL" insert_at="ROOT" part="WALL" class="wall" class_id="1"/>
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" preset="velodyne_vlp16"/>)";

/// A result that one run writes at a time: its options, with @ for the shared folder and % for one of each run; its
/// file; and the hidden file of its lock.
struct SharedResult {
  std::string name;
  Strings options;
  std::string file, lock;
  bool is_folder_locked = false;  ///< the message names the folder
};

std::vector<SharedResult> shared_results() {
  return {{"out", {"--out", "@/out"}, "out/run.json", "out/.run.json.simvis-lock", true},
          {"resume", {"--out", "@/out", "--resume"}, "out/run.json", "out/.run.json.simvis-lock", true},
          {"shard", {"--out", "@/out", "--shard", "0/2"}, "out/run-0-of-2.json", "out/.run-0-of-2.json.simvis-lock"},
          {"record", {"--out", "%/out", "--record", "@/r.mcap"}, "r.mcap", ".r.mcap.simvis-lock"},
          {"record-pcap", {"--out", "%/out", "--record-pcap", "@/r.pcap"}, "r.pcap", ".r.pcap.simvis-lock"},
          {"page", {"--out", "%/out", "--page", "@/r.html"}, "r.html", ".r.html.simvis-lock"},
          {"export", {"--out", "%/out", "--export", "@/r.glb"}, "r.glb", ".r.glb.simvis-lock"},
          {"map", {"--out", "%/out", "--export", "@/r.yaml"}, "r.yaml", ".r.yaml.simvis-lock"},
          {"profile", {"--out", "%/out", "--profile", "@/r.json"}, "r.json", ".r.json.simvis-lock"},
          {"dataset",
           {"--out", "@/set", "--dataset", "coco", "--sensor", "CAM", "--resume"},
           "set",
           "set/.simvis/.dataset.json.simvis-lock",
           true},
          {"dataset shard",
           {"--out", "@/set", "--dataset", "coco", "--sensor", "CAM", "--shard", "1/2"},
           "set",
           "set/.simvis/.dataset-1-of-2.json.simvis-lock"}};
}

struct LockedRuns {
  TemporaryFolder shared, first_own, second_own, scene_folder;
  std::string scene = write_wall_scene(scene_folder.path(), kLockedSensors).string();

  bool have_frames() const;
  Strings command(Strings options, const TemporaryFolder& own, const Strings& more) const {
    for (std::string& option : options) {
      if (option.starts_with('@')) option.replace(0, 1, shared.path().string());
      if (option.starts_with('%')) option.replace(0, 1, own.path().string());
    }
    options.insert(options.begin(), {simvis_run(), scene, "--quiet"});
    options.insert(options.end(), more.begin(), more.end());
    return options;
  }
};

const Strings kLongRun = {"--real-time", "1", "--frames", "9000"}, kShortRun = {"--frames", "4"};

/// Waits until the first run has written its first frame, for a minute at most.
bool LockedRuns::have_frames() const {
  const auto has_frame = [](const std::string& file) {
    return file.find("SCAN.csv") != file.npos || file.find("SCAN-") != file.npos ||
           file.find("frames/00000") != file.npos;
  };
  for (int i = 0; i < 6000; ++i) {
    for (const TemporaryFolder* folder : {&shared, &first_own}) {
      if (std::ranges::any_of(files_below(folder->path()), has_frame)) return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

/// Waits until the file is there, for a minute at most.
bool appears(const fs::path& file) {
  for (int i = 0; i < 12'000 && !fs::exists(file); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return fs::exists(file);
}

Strings locks_below(const fs::path& folder) {
  Strings locks = files_below(folder);
  std::erase_if(locks, [](const std::string& file) { return !file.ends_with(".simvis-lock"); });
  return locks;
}

TEST_CASE("a second run of the same result is an error before it touches anything, and the first one is whole") {
  for (const SharedResult& result : shared_results()) {
    CAPTURE(result.name);
    const LockedRuns runs;
    Process first(runs.command(result.options, runs.first_own, kLongRun));
    REQUIRE(appears(runs.shared / result.lock));
    REQUIRE(runs.have_frames());
    const ProcessResult second =
        Process(runs.command(result.options, runs.second_own, kLongRun)).wait(std::chrono::seconds(60));
    CHECK(second.exit_code == 1);
    CHECK_MESSAGE(second.err.find("error: another run") != std::string::npos, second.err);
    CHECK(second.err.find(result.is_folder_locked ? "is writing to this folder" : "is writing to this file") !=
          std::string::npos);
    CHECK(std::ranges::count(second.err, '\n') == 1);
    CHECK(files_below(runs.second_own.path()).empty());
    first.send(SIGINT);
    const ProcessResult ended = first.wait();
    INFO(ended.err);
    CHECK(ended.exit_code == 130);
    CHECK(fs::exists(runs.shared / result.file));
    CHECK(locks_below(runs.shared.path()).empty());
    CHECK(locks_below(runs.first_own.path()).empty());
  }
}

TEST_CASE("the message names the process that writes") {
  const LockedRuns runs;
  const Strings options = {"--out", "%/out", "--page", "@/r.html"};
  // The shell prints the number that the program then has.
  Process first([&] {
    Strings shell{"/bin/sh", "-c", "echo $$ > \"$0\"; exec \"$@\"", (runs.first_own / "pid").string()};
    const Strings command = runs.command(options, runs.first_own, kLongRun);
    shell.insert(shell.end(), command.begin(), command.end());
    return shell;
  }());
  REQUIRE(appears(runs.shared / ".r.html.simvis-lock"));
  const ProcessResult second = Process(runs.command(options, runs.second_own, kShortRun)).wait();
  std::string process = read_text(runs.first_own / "pid");
  process.pop_back();
  CHECK(second.exit_code == 1);
  const bool is_named = second.err.find("another run (process " + process + ") is writing") != std::string::npos;
  // Of some file systems, as overlays, the kernel's list of locks has other numbers.
  if (!is_named) MESSAGE("the process is not known here: ", second.err);
  CHECK(second.err.find("is writing to this file") != std::string::npos);
  first.send(SIGINT);
  CHECK(first.wait().exit_code == 130);
}

TEST_CASE("a killed run leaves no lock that holds, and the next run removes what is left") {
  for (const SharedResult& result : shared_results()) {
    CAPTURE(result.name);
    const LockedRuns runs;
    Process killed(runs.command(result.options, runs.first_own, {"--real-time", "0.1", "--frames", "40"}));
    REQUIRE(appears(runs.shared / result.lock));
    killed.send(SIGKILL);
    CHECK(killed.wait().signal == SIGKILL);
    CHECK(fs::exists(runs.shared / result.lock));
    const ProcessResult next = Process(runs.command(result.options, runs.second_own, {"--frames", "40"})).wait();
    INFO(next.err);
    CHECK(next.exit_code == 0);
    CHECK(locks_below(runs.shared.path()).empty());
  }
}

TEST_CASE("one run that names a file twice is an error") {
  const LockedRuns runs;
  const ProcessResult result =
      Process(runs.command({"--out", "%/out", "--export", "@/same", "--page", "@/same"}, runs.first_own, kShortRun))
          .wait();
  CHECK(result.exit_code == 1);
  CHECK(result.err.find("same: error: this process is writing to this file") != std::string::npos);
  CHECK_FALSE(fs::exists(runs.shared / "same"));
}

TEST_CASE("different shards write to one folder at once, and no whole run beside them") {
  const LockedRuns runs;
  const Strings out = {"--out", "@/out"};
  const auto shard = [&](const std::string& share) { return Strings{"--out", "@/out", "--shard", share}; };
  Process first(runs.command(shard("0/2"), runs.first_own, kLongRun));
  REQUIRE(appears(runs.shared / "out/run-0-of-2.json"));
  const ProcessResult other = Process(runs.command(shard("1/2"), runs.second_own, kShortRun)).wait();
  INFO(other.err);
  CHECK(other.exit_code == 0);
  const ProcessResult whole = Process(runs.command(out, runs.second_own, kShortRun)).wait();
  CHECK(whole.exit_code == 1);
  CHECK(whole.err.find("out: error: another run") != std::string::npos);
  first.send(SIGINT);
  CHECK(first.wait().exit_code == 130);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
