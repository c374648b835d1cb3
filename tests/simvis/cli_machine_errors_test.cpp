// simvis-run ends with exit code 1 and leaves no half-written file when the machine fails or a signal stops it.
#include <doctest/doctest.h>
#include <sys/mount.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/support/error_of.h"
#include "tests/support/picture_files.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

TEST_CASE("no Vulkan driver") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  const Strings none = {"VK_DRIVER_FILES=/nonexistent.json", "VK_ICD_FILENAMES=/nonexistent.json",
                        "VK_ADD_DRIVER_FILES="};
  const ProcessResult result = run_simvis({scene.string(), "--out", (folder / "out").string()}, none);
  CHECK(result.exit_code == 1);
  CHECK(result.err.starts_with("simvis-run: error: "));
  CHECK(result.err.find("Vulkan") != std::string::npos);
  CHECK_FALSE(fs::exists(folder / "out"));
  CHECK(run_simvis({"--list-devices"}, none).exit_code == 1);
}

// A driver that is there is not looked for: the machine has no memory to load it, or no number for its file.
TEST_CASE("little memory and few open files are no missing Vulkan driver") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  if (run_simvis({"--list-devices"}).exit_code != 0) return test::skip("there is no Vulkan driver");
  constexpr int kStep_kib = 32 << 10, kMost_kib = 2 << 20;
  Strings limits;
  for (int kib = 3 * kStep_kib; kib <= kMost_kib; kib += std::max(kStep_kib, kib / 8)) {
    limits.push_back("-v " + std::to_string(kib));
  }
  for (int files = 4; files < 24; ++files) limits.push_back("-n " + std::to_string(files));
  int failed = 0;
  for (const std::string& limit : limits) {
    const ProcessResult result =
        Process({"/bin/sh", "-c", "ulimit " + limit + "; exec \"$0\" --list-devices", simvis_run()}).wait();
    CAPTURE(limit);
    INFO(result.err);
    CHECK(result.err.find("Install") == std::string::npos);
    CHECK(result.exit_code != 2);
    failed += result.exit_code == 1 && result.err.find("Vulkan") != std::string::npos;
  }
  CHECK(failed > 0);
}

TEST_CASE("a limit of the shell ends a run with a message, or not at all") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  const auto run = [&](const std::string& limit) {
    return Process({"/bin/sh", "-c", "ulimit " + limit + "; exec \"$0\" \"$@\"", simvis_run(), scene.string(), "--out",
                    (folder / "out").string()})
        .wait();
  };
  for (const std::string limit : {"-s 64", "-s 128", "-s 256", "-s 384", "-s 512", "-s 1024", "-f 8", "-n 6", "-n 12",
                                  "-v 200000", "-v 400000", "-d 20000"}) {
    const ProcessResult result = run(limit);
    CAPTURE(limit);
    CAPTURE(result.exit_code);
    INFO(result.err);
    CHECK((result.exit_code == 0 || result.exit_code == 1));
    CHECK((result.exit_code == 0) == (result.err.find("error: ") == std::string::npos));
  }
  CHECK(contains(run("-s 128").err, " KiB, expected at least 384 KiB; ulimit -s 8192 sets the usual limit"));
  CHECK(run("-s 512").exit_code == 0);
}

TEST_CASE("an output folder that cannot be written") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  // Permissions do not restrict root, so the paths are below a file and on a file system that accepts no files.
  for (const std::string& out :
       {scene.string(), scene.string() + "/out", std::string("/proc"), std::string("/proc/out")}) {
    const ProcessResult result = run_simvis({scene.string(), "--out", out});
    INFO(result.err);
    CHECK(result.exit_code == 1);
    CHECK(result.err.starts_with(out));
    CHECK(result.err.find(": error: ") != std::string::npos);
  }
  const ProcessResult profile =
      run_simvis({scene.string(), "--out", (folder / "out").string(), "--profile", scene.string() + "/p.json"});
  CHECK(profile.exit_code == 1);
  CHECK(profile.err.starts_with(scene.string() + "/p.json: error: "));
  CHECK(files_below(folder.path()) == Strings{"scene.xml", "wall.gltf"});
}

/// Checks that every file is complete: pictures can be read, tables end with a line break, no temporary file is left.
void check_all_whole(const fs::path& folder, const std::string& status) {
  for (const std::string& name : files_below(folder)) {
    INFO(name);
    CHECK_FALSE(name.ends_with(".tmp"));
    if (name.ends_with(".csv")) CHECK(read_text(folder / name).ends_with('\n'));
    if (name == "run.json") CHECK(nlohmann::json::parse(read_text(folder / name))["status"] == status);
    if (name.ends_with(".png")) CHECK(read_png(folder / name).width > 0);
    if (name.ends_with(".exr")) CHECK(read_exr(folder / name).width > 0);
  }
}

/// A file system of 256 KiB, mounted during its lifetime.
class SmallDisk {
 public:
  explicit SmallDisk(const fs::path& folder)
      : folder_(folder), mounted_(::mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=256k") == 0) {}
  ~SmallDisk() {
    if (mounted_) ::umount2(folder_.c_str(), MNT_DETACH);
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  explicit operator bool() const { return mounted_; }

 private:
  fs::path folder_;
  bool mounted_;
};

TEST_CASE("a full disk") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  const fs::path disk = folder / "disk";
  fs::create_directory(disk);
  const SmallDisk mounted(disk);
  if (!mounted) {
    MESSAGE("not tested with a full file system: mounting a small tmpfs is not permitted here");
    return;
  }
  const ProcessResult result = run_simvis({scene.string(), "--out", (disk / "out").string(), "--frames", "100000"});
  CHECK(result.exit_code == 1);
  CHECK(result.err.starts_with(disk.string()));
  CHECK(result.err.find("No space left on device") != std::string::npos);
  CHECK_FALSE(files_below(disk).empty());
  check_all_whole(disk / "out", "running");  // no room is left to say more
}

TEST_CASE("a limit on the size of files") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  // One block of 512 bytes: the first picture does not fit.
  const ProcessResult result = Process({"/bin/sh", "-c", "ulimit -f 1; exec \"$@\"", "sh", simvis_run(), scene.string(),
                                        "--out", (folder / "out").string()})
                                   .wait();
  CHECK(result.exit_code == 1);
  CHECK(result.err.find("File too large") != std::string::npos);
  check_all_whole(folder / "out", "running");
}

// A run that ended between two files of a frame once left a picture that no table names, and the folder was refused.
TEST_CASE("whatever a run with few open files leaves, the next run takes the folder") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  int failed = 0;
  for (int files = 4; files < 20; ++files) {
    const Strings run{simvis_run(), scene.string(), "--out", (folder / "out").string(), "--frames", "2"};
    Strings limited{"/bin/sh", "-c", "ulimit -n $0; exec \"$@\"", std::to_string(files)};
    limited.insert(limited.end(), run.begin(), run.end());
    CAPTURE(files);
    failed += Process(limited).wait().exit_code == 1;
    const ProcessResult next = Process(run).wait();
    INFO(next.err);
    CHECK(next.exit_code == 0);
  }
  CHECK(failed > 3);
}

TEST_CASE("standard output that cannot be written") {
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
  const ProcessResult result = Process({"/bin/sh", "-c", "exec \"$@\" > /dev/full", "sh", simvis_run(), scene.string(),
                                        "--out", (folder / "out").string()})
                                   .wait();
  CHECK(result.exit_code == 1);
  CHECK(result.err.find("standard output") != std::string::npos);
}

TEST_CASE("a signal ends the run and leaves no incomplete file") {
  for (const int signal : {SIGINT, SIGTERM}) {
    const TemporaryFolder folder;
    const fs::path scene = write_wall_scene(folder.path(), kWallSensors);
    Process process({simvis_run(), scene.string(), "--out", (folder / "out").string(), "--frames", "100000000"});
    for (int i = 0; i < 60'000 && !fs::exists(folder / "out/CAM/000002.png"); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    process.send(signal);
    const ProcessResult result = process.wait();
    INFO(result.err);
    CHECK(result.exit_code == 130);
    CHECK(result.err.find("signal") != std::string::npos);
    CHECK(fs::exists(folder / "out/CAM/000002.png"));
    check_all_whole(folder / "out", "stopped");
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
