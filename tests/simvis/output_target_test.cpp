// What simvis-run does with targets that are no regular files: a device node, a FIFO, a folder, a symbolic link.
#include <doctest/doctest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <chrono>
#include <filesystem>

#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

/// Each option of simvis-run that names one file.
const char* const kFileOptions[] = {"--record", "--page", "--export", "--profile"};

struct NamedTargets {
  NamedTargets() : scene(write_wall_scene(folder.path(), kWallSensors)) {}
  /// Ended by force after 60 s, since a program that waits for the other end of a FIFO takes no other signal.
  ProcessResult run(const std::string& option, const fs::path& target, const Strings& more = {}) const {
    Strings command{simvis_run(), scene.string(), "--out",        (folder / "out").string(),
                    "--quiet",    option,         target.string()};
    command.insert(command.end(), more.begin(), more.end());
    return Process(command).wait(std::chrono::seconds(60));
  }
  TemporaryFolder folder;
  fs::path scene;
};

TEST_CASE("a FIFO, a socket's place and a folder are refused at once, and stay what they are") {
  const NamedTargets targets;
  const fs::path fifo = targets.folder / "fifo", directory = targets.folder / "directory";
  REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
  fs::create_directory(directory);
  for (const char* const option : kFileOptions) {
    CAPTURE(option);
    const ProcessResult waiting = targets.run(option, fifo);
    CHECK_FALSE(waiting.timed_out);
    CHECK(waiting.exit_code == 2);
    CHECK(waiting.err.find("fifo is a FIFO or a pipe, expected a regular file") != std::string::npos);
    CHECK(fs::is_fifo(fifo));
    const ProcessResult folder = targets.run(option, directory);
    CHECK(folder.exit_code == 2);
    CHECK(folder.err.find("directory is a folder, expected a regular file") != std::string::npos);
    CHECK(fs::is_directory(directory));
  }
}

TEST_CASE("of a run that is refused, --page and --export leave no folder") {
  const NamedTargets targets;
  for (const char* const option : {"--page", "--export"}) {
    CAPTURE(option);
    const Strings refused{"--profile", (targets.folder / "missing/p.json").string()};
    CHECK(targets.run(option, targets.folder / "views/deep/file", refused).exit_code != 0);
    CHECK_FALSE(fs::exists(targets.folder / "views"));
    CHECK(targets.run(option, targets.folder / "kept/file", {"--frames", "1"}).exit_code == 0);
    CHECK(fs::exists(targets.folder / "kept/file"));
    fs::remove_all(targets.folder / "kept");
  }
}

TEST_CASE("a device node is written to, or refused for a recording, and never replaced") {
  const NamedTargets targets;
  const fs::path node = targets.folder / "null";
  if (::mknod(node.c_str(), S_IFCHR | 0600, ::makedev(1, 3)) != 0)
    return test::skip("this process may not make device nodes");
  for (const char* const option : kFileOptions) {
    CAPTURE(option);
    const ProcessResult result = targets.run(option, node);
    CHECK(result.exit_code == (std::string(option) == "--record" ? 2 : 0));
    CHECK(fs::is_character_file(node));
  }
}

TEST_CASE("a symbolic link stays, and the file behind it is replaced, or made") {
  const NamedTargets targets;
  const fs::path behind = targets.folder / "behind";
  for (const char* const option : kFileOptions) {
    CAPTURE(option);
    fs::create_directory(behind);
    const fs::path link = targets.folder / "link", file = behind / "file";
    fs::create_symlink("behind/file", link);
    for (int run = 0; run < 2; ++run) {  // the file is not there at first
      CHECK(targets.run(option, link).exit_code == 0);
      CHECK(fs::is_symlink(link));
      CHECK(fs::is_regular_file(file));
      CHECK(fs::file_size(file) > 0);
    }
    CHECK(std::distance(fs::directory_iterator(behind), fs::directory_iterator()) == 1);  // no temporary file
    fs::remove(link);
    fs::remove_all(behind);
  }
}

TEST_CASE("what a killed run left of a named file is removed by the next one") {
  const NamedTargets targets;
  const fs::path page = targets.folder / "run.html";
  Process killed({simvis_run(), targets.scene.string(), "--out", (targets.folder / "out").string(), "--quiet",
                  "--frames", "1000000", "--page", page.string()});
  const auto leftovers = [&] {
    int count = 0;
    for (const fs::directory_entry& entry : fs::directory_iterator(targets.folder.path())) {
      count += entry.path().filename().string().starts_with(".run.html.") ? 1 : 0;
    }
    return count;
  };
  for (int i = 0; i < 60'000 && leftovers() < 2; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  killed.send(SIGKILL);
  killed.wait();
  REQUIRE(leftovers() == 2);  // the temporary file and the lock
  CHECK(targets.run("--page", page).exit_code == 0);
  CHECK(leftovers() == 0);
  CHECK(fs::is_regular_file(page));
}

TEST_CASE("--resume refuses what it cannot continue, before it touches anything") {
  const NamedTargets targets;
  const fs::path recording = targets.folder / "run.mcap", page = targets.folder / "run.html";
  REQUIRE(targets.run("--record", recording, {"--page", page.string(), "--frames", "2"}).exit_code == 0);
  const std::string recorded = read_text(recording), shown = read_text(page);
  const ProcessResult record = targets.run("--record", recording, {"--resume", "--frames", "4"});
  CHECK(record.exit_code == 2);
  CHECK(record.err.find("cannot continue a recording") != std::string::npos);
  const ProcessResult paged = targets.run("--page", page, {"--resume", "--frames", "4"});
  CHECK(paged.exit_code == 2);
  CHECK(paged.err.find("cannot continue a page") != std::string::npos);
  CHECK(read_text(recording) == recorded);
  CHECK(read_text(page) == shown);
  CHECK(read_text(targets.folder / "out/run.json").find("\"frames\": 2") != std::string::npos);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
