// Files and links that another user has put where results are written: none is opened, and none of yours is written to.
#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "engine/base/cache_file.h"
#include "engine/base/temporary_file.h"
#include "exchange/messages/mcap_records.h"
#include "exchange/messages/record_file.h"
#include "exchange/packets/capture_file.h"
#include "program/output/atomic_file.h"
#include "program/output/growing_file.h"
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

/// The start of a recording.
std::string recording_start() {
  return std::string(ros::kMcapMagic) + ros::McapRecord(ros::McapOpcode::header).text("").text("").bytes();
}

std::string recording_end() {
  return ros::McapRecord(ros::McapOpcode::data_end).number(std::uint32_t{0}).bytes() + std::string(ros::kMcapMagic);
}

/// Each class that writes files.
const std::map<std::string, std::function<void(const fs::path&)>> kFileWriters = {
    {"whole", [](const fs::path& file) { write_file(file, "result"); }},
    {"cache", [](const fs::path& file) { write_cache_file(file, "result"); }},
    {"capture", [](const fs::path& file) { CaptureFile(file, "result").close(); }},
    {"recording", [](const fs::path& file) { ros::RecordFile(file, recording_start()).finish(recording_end()); }},
    {"growing",
     [](const fs::path& file) {
       GrowingFile growing(file, "result");
       growing.append(std::string(10'000, 'x'));
       growing.finish();
     }},
    {"continued", [](const fs::path& file) {
       write_file(file, "result and more");
       GrowingFile growing(file, std::uintmax_t{6});
       growing.append(std::string(10'000, 'x'));
       growing.finish();
     }}};

TEST_CASE("a link under a name that a temporary file may get does not lead to your file") {
  char machine[256] = "";
  ::gethostname(machine, sizeof machine - 1);
  const std::string middle = "." + std::string(machine) + "." + std::to_string(::getpid()) + ".";
  for (const auto& [name, write] : kFileWriters) {
    CAPTURE(name);
    const TemporaryFolder folder;
    write_text(folder / "mine", "mine");
    // The numbers that a counter gives.
    for (int i = 0; i < 3000; ++i) {
      fs::create_symlink("mine", folder / (".result" + middle + std::to_string(i) + ".tmp"));
      fs::create_symlink("mine", folder / ("result" + middle + std::to_string(i)));
    }
    write(folder / "result");
    CHECK(read_text(folder / "mine") == "mine");
    CHECK(fs::symlink_status(folder / "mine").type() == fs::file_type::regular);
    CHECK(fs::symlink_status(folder / "result").type() == fs::file_type::regular);
    CHECK(read_text(folder / "result").size() >= 6);
  }
}

TEST_CASE("temporary files have names that no other call gets, long ones too, and go") {
  const TemporaryFolder folder;
  const fs::path target = folder / std::string(250, 'n');
  std::set<fs::path> names;
  for (int i = 0; i < 100; ++i) {
    const TemporaryFile file(target, target);
    CHECK(names.insert(file.hidden_name()).second);
    CHECK(fs::exists(file.hidden_name()));
  }
  CHECK(files_below(folder.path()).empty());
  for (const auto& [name, write] : kFileWriters) {
    CAPTURE(name);
    write(target);
    CHECK(files_below(folder.path()) == Strings{target.filename().string()});
  }
}

TEST_CASE("a file that is replaced keeps its permissions, whichever class replaces it") {
  for (const auto& [name, write] : kFileWriters) {
    CAPTURE(name);
    const TemporaryFolder folder;
    write_text(folder / "result", "before");
    fs::permissions(folder / "result", fs::perms::owner_read | fs::perms::owner_write);
    write(folder / "result");
    CHECK(fs::status(folder / "result").permissions() == (fs::perms::owner_read | fs::perms::owner_write));
  }
}

/// A folder such as /tmp, where all users may write, with a link of another user in it.
struct SharedFolder {
  TemporaryFolder folder;
  fs::path link = folder / "result";
  bool is_made = false;
  SharedFolder() {
    ::chmod(folder.path().c_str(), S_ISVTX | 0777);
    write_text(folder / "mine", "mine");
    fs::create_symlink("mine", link);
    constexpr uid_t kOtherUser = 12'345;
    is_made = ::lchown(link.c_str(), kOtherUser, kOtherUser) == 0;
  }
};

TEST_CASE("a link of another user in a folder of all users is refused by each option, and your file stays") {
  const TemporaryFolder results;
  const std::string scene = write_wall_scene(results.path(), R"(
<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" preset="velodyne_vlp16"/>)");
  for (const char* const option : {"--record", "--record-pcap", "--page", "--export", "--profile"}) {
    for (const bool is_dangling : {false, true}) {
      CAPTURE(option);
      CAPTURE(is_dangling);
      const SharedFolder shared;
      if (!shared.is_made) return test::skip("this process may not make links of other users");
      if (is_dangling) fs::remove(shared.folder / "mine");
      const ProcessResult result =
          run_simvis({scene, "--quiet", "--out", (results / "out").string(), option, shared.link.string()});
      CHECK(result.exit_code == 2);
      CHECK_MESSAGE(result.err.find("is a symbolic link of another user") != std::string::npos, result.err);
      CHECK(fs::is_symlink(shared.link));
      CHECK(fs::exists(shared.folder / "mine") != is_dangling);
      if (!is_dangling) CHECK(read_text(shared.folder / "mine") == "mine");
    }
  }
}

TEST_CASE("a file that grows is an error when its name leads to another file, or to none") {
  const auto check = [](const std::string& name, const auto& make, const auto& grow) {
    CAPTURE(name);
    const TemporaryFolder folder;
    const fs::path file = folder / "result", moved = folder / "moved";
    auto growing = make(file);
    grow(*growing);
    fs::rename(file, moved);
    const std::string before = read_text(moved);
    CHECK(contains(machine_error_of([&] { grow(*growing); }), "result: error: was removed, renamed or replaced"));
    write_text(file, "of another run");
    CHECK(contains(machine_error_of([&] { grow(*growing); }), "result: error: was removed, renamed or replaced"));
    CHECK(read_text(moved) == before);
    growing.reset();
    CHECK(read_text(file) == "of another run");
  };
  check(
      "capture", [](const fs::path& file) { return std::make_unique<CaptureFile>(file, "start"); },
      [](CaptureFile& file) { file.append("more"); });
  check(
      "recording", [](const fs::path& file) { return std::make_unique<ros::RecordFile>(file, recording_start()); },
      [](ros::RecordFile& file) { file.append(ros::McapRecord(ros::McapOpcode::header).text("").text("").bytes()); });
  for (const std::size_t bytes : {4, 5000}) {  // in one page; by an exchange of names
    check(
        "growing", [](const fs::path& file) { return std::make_unique<GrowingFile>(file, "start"); },
        [bytes](GrowingFile& file) { file.append(std::string(bytes, 'x')); });
  }
}

TEST_CASE("a table that goes on is none behind a link") {
  const TemporaryFolder folder;
  write_text(folder / "mine", "mine and more");
  fs::create_symlink("mine", folder / "table.csv");
  CHECK(contains(error_of([&] { GrowingFile(folder / "table.csv", std::uintmax_t{4}); }), "is a symbolic link"));
  CHECK(read_text(folder / "mine") == "mine and more");
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
