// A disk that fails, is full or is slow to answer, at whichever call: the run ends with status 1, one message with the
// reason and no half-written file, or its results are those of every other run. Caches never change a result. In the
// suite a few calls of each kind fail; by hand SIMVIS_TEST_FILE_FAULTS=0 lets each of them fail, once in each run.
#include <doctest/doctest.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "program/output/new_folders.h"
#include "tests/support/error_of.h"
#include "tests/support/long_count.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"
#include "tests/support/whole_files.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

using FileBytes = std::map<std::string, std::string>;

/// All files below the folder but reports, which have times by the clock.
FileBytes results_below(const fs::path& folder) {
  FileBytes results;
  for (const std::string& name : files_below(folder)) {
    if (!name.ends_with(".json")) results[name] = read_text(folder / name);
  }
  return results;
}

/// A run that writes a file of each kind, with caches of its own.
class WatchedRun {
 public:
  explicit WatchedRun(bool makes_views) : scene_(write_wall_scene(scene_folder_.path(), kWallSensors)) {
    options_ = {scene_.string(), "--frames", "2", "--quiet", "--out", "@/out"};
    if (!makes_views) return;
    for (const char* option :
         {"--page", "@/p.html", "--export", "@/e.glb", "--record", "@/r.mcap", "--profile", "@/p.json"}) {
      options_.emplace_back(option);
    }
  }

  struct Outcome {
    ProcessResult result;
    FileBytes results;
    std::string fault;
    std::size_t calls = 0, failed = 0;
    bool has_folder = false;  // that of --out
  };

  /// With the call number `at` failing in files below `below`; 0: none fails.
  Outcome with_fault(const char* call, int error, std::size_t at, bool in_cache = false) const {
    const TemporaryFolder results, cache, marks;
    const fs::path mark = marks / "mark", count = marks / "count";
    Outcome outcome;
    outcome.result = run_simvis(
        options_for(results.path()),
        {"XDG_CACHE_HOME=" + cache.path().string(), "LD_PRELOAD=" + tested_build() + "/lib/libsimvis_failing_calls.so",
         "SIMVIS_FAIL_IN=simvis-run", "SIMVIS_FAIL_BELOW=" + (in_cache ? cache : results).path().string(),
         std::string("SIMVIS_FAIL_CALL=") + call, "SIMVIS_FAIL_AT=" + std::to_string(at),
         "SIMVIS_FAIL_ERRNO=" + std::to_string(error), "SIMVIS_FAIL_MARK=" + mark.string(),
         "SIMVIS_FAIL_COUNT=" + count.string()});
    outcome.fault = first_fault_below(results.path());
    outcome.results = results_below(results.path());
    outcome.has_folder = fs::exists(results / "out");
    outcome.calls = fs::file_size(count);
    outcome.failed = fs::file_size(mark);
    return outcome;
  }

  Strings options_for(const fs::path& results) const {
    Strings options = options_;
    for (std::string& option : options) {
      if (option.starts_with('@')) option.replace(0, 1, results.string());
    }
    return options;
  }

 private:
  TemporaryFolder scene_folder_;
  fs::path scene_;
  Strings options_;
};

/// Numbers from 1 to `all`: each, or some that are spread over all and always include the last.
std::vector<std::size_t> some_of(std::size_t all) {
  const auto most = static_cast<std::size_t>(count_of("SIMVIS_TEST_FILE_FAULTS", 1));
  std::vector<std::size_t> numbers;
  const std::size_t step = most == 0 ? 1 : std::max<std::size_t>(1, all / most);
  for (std::size_t at = all; at >= 1 && at <= all; at -= std::min(at, step)) numbers.push_back(at);
  return numbers;
}

struct FileFault {
  const char* call;
  int error;  // 0: a short call
};

constexpr FileFault kFatal[] = {{"open", EMFILE},  {"open", EACCES}, {"write", ENOSPC},  {"write", EIO},
                                {"write", EDQUOT}, {"rename", EIO},  {"rename", ENOSPC}, {"ftruncate", EIO},
                                {"close", EIO},    {"close", ENOSPC}};
constexpr FileFault kHarmless[] = {{"write", EINTR}, {"write", 0}};

TEST_CASE("whichever call for a result fails, the run ends with its reason and whole files") {
  if (sanitized()) return test::skip(test::kNotSanitized);  // its runtime must be the first library
  const WatchedRun run(true);
  std::size_t failed = 0;
  for (const FileFault& fault : kFatal) {
    CAPTURE(fault.call);
    CAPTURE(std::string(std::strerror(fault.error)));
    const std::size_t calls = run.with_fault(fault.call, fault.error, 0).calls;
    CHECK(calls > 0);
    for (const std::size_t at : some_of(calls)) {
      const WatchedRun::Outcome outcome = run.with_fault(fault.call, fault.error, at);
      if (outcome.failed == 0) continue;  // with how the threads ran, there was one call less
      CAPTURE(at);
      INFO(outcome.result.err);
      ++failed;
      CHECK(outcome.fault == "");
      // The first file that is closed is a probe, which is removed.
      if (std::string_view(fault.call) == "close" && at == 1) continue;
      CHECK(outcome.result.exit_code == 1);
      CHECK(outcome.result.err.find(std::strerror(fault.error)) != std::string::npos);
      CHECK(std::count(outcome.result.err.begin(), outcome.result.err.end(), '\n') == 1);
    }
  }
  MESSAGE(failed, " calls failed, one in each run");
}

// The first call opens the folder for its lock, those that follow look for a link, open the file of the lock on the
// report, and try whether a file can be written there.
TEST_CASE("a run that cannot begin leaves no folder") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const WatchedRun run(false);
  for (const std::size_t at : {1, 2, 3, 4, 5}) {
    CAPTURE(at);
    const WatchedRun::Outcome outcome = run.with_fault("open", EMFILE, at);
    CHECK(outcome.failed == 1);
    CHECK(outcome.result.exit_code == 1);
    CHECK_FALSE(outcome.has_folder);
  }
}

TEST_CASE("new folders go if they are empty, with the parents that were made for them") {
  const TemporaryFolder folder;
  { const NewFolders made(folder / "a/b/c"); }
  CHECK(fs::is_empty(folder.path()));
  {
    const NewFolders made(folder / "a/b/c");
    write_text(folder / "a/b/file", "x");
  }
  CHECK_FALSE(fs::exists(folder / "a/b/c"));
  CHECK(fs::exists(folder / "a/b/file"));
  { const NewFolders was_there(folder / "a/b"); }
  fs::remove(folder / "a/b/file");
  { const NewFolders was_there(folder / "a/b"); }
  CHECK(fs::exists(folder / "a/b"));
  write_text(folder / "text", "x");
  CHECK(contains(machine_error_of([&] { NewFolders(folder / "text/x/y"); }), "the folder cannot be created"));
  for (const char* const link : {"itself", "nothing"}) {
    fs::create_symlink(link == std::string("itself") ? "itself" : "missing", folder / link);
    CHECK(contains(machine_error_of([&] { NewFolders(folder / link / "x"); }), "the folder cannot be created"));
    CHECK(fs::is_symlink(folder / link));
  }
}

// The file that a recording would replace is looked at first; if that fails it is kept.
TEST_CASE("a file that cannot be looked at is not replaced by a recording") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const TemporaryFolder folder;
  const fs::path scene = write_wall_scene(folder.path(), kWallSensors), mine = folder / "mine.txt";
  write_text(mine, "not a recording");
  for (const FileFault& fault : {FileFault{"open", EMFILE}, FileFault{"read", EIO}}) {
    const ProcessResult result = run_simvis(
        {scene.string(), "--record", mine.string(), "--frames", "1", "--out", (folder / "out").string()},
        {"LD_PRELOAD=" + tested_build() + "/lib/libsimvis_failing_calls.so", "SIMVIS_FAIL_IN=simvis-run",
         "SIMVIS_FAIL_FILE=" + mine.string(), std::string("SIMVIS_FAIL_CALL=") + fault.call, "SIMVIS_FAIL_AT=1",
         "SIMVIS_FAIL_ERRNO=" + std::to_string(fault.error), "SIMVIS_FAIL_MARK=" + (folder / "mark").string()});
    INFO(result.err);
    CHECK(result.exit_code == 1);
    CHECK(read_text(mine) == "not a recording");
  }
}

TEST_CASE("calls that are interrupted or short change nothing") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const WatchedRun run(true);
  const FileBytes whole = run.with_fault("write", 0, 0).results;
  REQUIRE(whole.size() > 8);
  std::size_t failed = 0;
  for (const FileFault& fault : kHarmless) {
    CAPTURE(fault.error);
    for (const std::size_t at : some_of(run.with_fault(fault.call, fault.error, 0).calls)) {
      const WatchedRun::Outcome outcome = run.with_fault(fault.call, fault.error, at);
      CAPTURE(at);
      INFO(outcome.result.err);
      failed += outcome.failed;
      CHECK(outcome.result.exit_code == 0);
      CHECK(outcome.results == whole);
    }
  }
  MESSAGE(failed, " calls were interrupted or short, one in each run");
}

TEST_CASE("a cache that cannot be read, written or mapped changes no result") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const WatchedRun run(false);
  const FileBytes whole = run.with_fault("read", 0, 0).results;
  std::size_t failed = 0;
  for (const FileFault& fault :
       {FileFault{"open", EMFILE}, FileFault{"open", EIO}, FileFault{"write", ENOSPC}, FileFault{"write", EIO},
        FileFault{"write", 0}, FileFault{"rename", EIO}, FileFault{"close", EIO}}) {
    CAPTURE(fault.call);
    CAPTURE(fault.error);
    for (const std::size_t at : some_of(run.with_fault(fault.call, fault.error, 0, true).calls)) {
      const WatchedRun::Outcome outcome = run.with_fault(fault.call, fault.error, at, true);
      CAPTURE(at);
      INFO(outcome.result.err);
      failed += outcome.failed;
      CHECK(outcome.result.exit_code == 0);
      CHECK(outcome.results == whole);
    }
  }
  MESSAGE(failed, " calls failed, one in each run");
  CHECK(failed > 0);
}

TEST_CASE("a cache that is damaged changes no result") {
  const WatchedRun run(false);
  const TemporaryFolder cache;
  const Strings environment{"XDG_CACHE_HOME=" + cache.path().string()};
  const auto results = [&] {
    const TemporaryFolder folder;
    const ProcessResult result = run_simvis(run.options_for(folder.path()), environment);
    INFO(result.err);
    CHECK(result.exit_code == 0);
    return results_below(folder.path());
  };
  const FileBytes whole = results();
  const std::vector<std::string> names = files_below(cache.path());
  REQUIRE_FALSE(names.empty());
  std::mt19937 random(20261125);
  const auto below = [&](std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
  };
  for (int i = 0; i < count_of("SIMVIS_TEST_DAMAGED_CACHES", 4); ++i) {
    const std::string& name = names[below(names.size())];
    CAPTURE(name);
    CAPTURE(i);
    std::string bytes = fs::exists(cache / name) ? read_text(cache / name) : "";
    if (i % 3 == 0) bytes.resize(bytes.empty() ? 0 : below(bytes.size()));
    if (!bytes.empty()) bytes[below(bytes.size())] ^= static_cast<char>(1 + below(255));
    write_text(cache / name, bytes);
    CHECK(results() == whole);
  }
}

TEST_CASE("twenty processes that begin with one empty cache give the same results") {
  if (sanitized()) return test::skip(test::kNotSanitized);  // takes minutes
  const WatchedRun run(false);
  const TemporaryFolder cache;
  constexpr int kProcesses = 20;
  std::vector<std::unique_ptr<TemporaryFolder>> folders;
  std::vector<std::unique_ptr<Process>> processes;
  for (int i = 0; i < kProcesses; ++i) {
    folders.push_back(std::make_unique<TemporaryFolder>());
    Strings arguments = run.options_for(folders.back()->path());
    arguments.insert(arguments.begin(), simvis_run());
    processes.push_back(std::make_unique<Process>(arguments, Strings{"XDG_CACHE_HOME=" + cache.path().string()}));
  }
  FileBytes first;
  for (int i = 0; i < kProcesses; ++i) {
    const ProcessResult result = processes[static_cast<std::size_t>(i)]->wait(std::chrono::minutes(10));
    INFO(result.err);
    CHECK(result.exit_code == 0);
    const FileBytes results = results_below(folders[static_cast<std::size_t>(i)]->path());
    if (i == 0) first = results;
    CHECK_FALSE(results.empty());
    CHECK(results == first);
  }
  for (const std::string& name : files_below(cache.path())) CHECK_FALSE(name.ends_with(".tmp"));
}

/// The command on a disk of this size, in a mount namespace of its own. What is there at the end is copied to `copy`.
/// Exit code 77: such a disk cannot be made here.
ProcessResult run_on_disk(int kib, const fs::path& disk, const fs::path& copy, const Strings& command) {
  const std::string mount = ::geteuid() == 0 ? "-m" : "-rm";
  Strings arguments{
      "/usr/bin/unshare",
      mount,
      "/bin/sh",
      "-c",
      "mount -t tmpfs -o size=$0k tmpfs \"$1\" 2>/dev/null || exit 77; disk=$1; copy=$2; shift 2; \"$@\"; "
      "status=$?; cp -a \"$disk/.\" \"$copy\"; exit $status",
      std::to_string(kib),
      disk.string(),
      copy.string()};
  arguments.insert(arguments.end(), command.begin(), command.end());
  return Process(arguments).wait();
}

TEST_CASE("a disk of any size that fills up is an error with whole files") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const WatchedRun run(true);
  const TemporaryFolder disk;
  int failed = 0, kib = 16;
  for (bool fits = false; !fits && kib < 64 << 10; kib = kib * 5 / 3) {
    const TemporaryFolder copy;
    Strings command = run.options_for(disk.path());
    command.insert(command.begin(), simvis_run());
    const ProcessResult result = run_on_disk(kib, disk.path(), copy.path(), command);
    // Within a root that is no mount of its own, as that of chroot, there are no mount namespaces.
    const bool has_disk = result.exit_code != 77 && !result.err.starts_with("unshare: ");
    if (!has_disk) return test::skip("a small disk cannot be mounted here");
    CAPTURE(kib);
    INFO(result.err);
    fits = result.exit_code == 0;
    CHECK(first_fault_below(copy.path()) == "");
    if (fits) continue;
    ++failed;
    CHECK(result.exit_code == 1);
    CHECK(result.err.find("No space left on device") != std::string::npos);
    CHECK(std::count(result.err.begin(), result.err.end(), '\n') == 1);
  }
  CHECK(failed > 2);
  CHECK(kib < 64 << 10);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
