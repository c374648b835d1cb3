// Runs that record packets are killed at random moments, with one scanner and with another one in turn: a capture never
// stands without its metadata or beside those of another scanner, and the next run gives the bytes of a run that was
// not killed. SIMVIS_TEST_KILLS=200 kills that often.
#include <doctest/doctest.h>
#include <signal.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <filesystem>
#include <random>
#include <span>
#include <string>
#include <thread>

#include "tests/support/long_count.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr std::size_t kCaptureHead = 24, kRecordHead = 16;

std::uint32_t word_at(const std::string& bytes, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, bytes.data() + at, sizeof word);
  return word;
}

/// Bytes of its whole records; only the last one may lack its end.
std::size_t whole_bytes(const std::string& capture) {
  REQUIRE(capture.size() >= kCaptureHead);
  REQUIRE(word_at(capture, 0) == 0xa1b2c3d4);
  std::size_t at = kCaptureHead;
  while (at + kRecordHead <= capture.size()) {
    const std::size_t size = word_at(capture, at + 8);
    REQUIRE(size == word_at(capture, at + 12));
    REQUIRE(size <= 1514);  // an Ethernet frame
    if (size > capture.size() - at - kRecordHead) break;
    at += kRecordHead + size;
  }
  return at;
}

/// A run with a scanner, without its options for results.
struct CapturedRun {
  TemporaryFolder folder, whole;
  Strings command;
  std::string capture, metadata;  // of a run that was not killed

  explicit CapturedRun(const std::string& preset)
      : command{simvis_run(),
                write_wall_scene(folder.path(), R"(<sensor type="laser_scanner" name="LIDAR"
                  insert_at="ROOT" preset=")" + preset +
                                                    R"("/>)")
                    .string(),
                "--rate",
                "10",
                "--frames",
                "8",
                "--quiet"} {
    const ProcessResult result = Process(with_files(whole)).wait();
    INFO(result.err);
    REQUIRE(result.exit_code == 0);
    capture = read_text(whole / "run.pcap");
    metadata = read_text(whole / "run.pcap.json");
  }
  Strings with_files(const TemporaryFolder& results) const {
    Strings all = command;
    all.insert(all.end(), {"--record-pcap", (results / "run.pcap").string(), "--out", (results / "out").string()});
    return all;
  }
  /// Whether this is what such a run has written so far.
  bool has_written(const std::string& some_capture) const {
    return capture.starts_with(some_capture.substr(0, whole_bytes(some_capture)));
  }
};

/// Whether there is no capture, or one of a run beside the metadata of that run.
bool is_pair(std::span<const CapturedRun> runs, const std::filesystem::path& capture) {
  if (!std::filesystem::exists(capture)) return true;
  const std::filesystem::path metadata = capture.string() + ".json";
  if (!std::filesystem::exists(metadata)) return false;
  const std::string bytes = read_text(capture), text = read_text(metadata);
  return std::any_of(runs.begin(), runs.end(),
                     [&](const CapturedRun& run) { return text == run.metadata && run.has_written(bytes); });
}

// As a kill between two files: what follows the call that fails is not done.
TEST_CASE("a capture stands beside no other metadata, whichever file cannot get its name") {
  if (sanitized()) return test::skip(test::kNotSanitized);  // the preloaded library must come first
  const CapturedRun runs[] = {CapturedRun("ouster_os0_32"), CapturedRun("ouster_os1_32")};
  for (int at = 1; at <= 3; ++at) {
    CAPTURE(at);
    const TemporaryFolder tried, marks;
    REQUIRE(Process(runs[0].with_files(tried)).wait().exit_code == 0);
    const ProcessResult failed =
        Process(runs[1].with_files(tried),
                {"LD_PRELOAD=" + tested_build() + "/lib/libsimvis_failing_calls.so", "SIMVIS_FAIL_IN=simvis-run",
                 "SIMVIS_FAIL_BELOW=" + tried.path().string(), "SIMVIS_FAIL_CALL=rename",
                 "SIMVIS_FAIL_AT=" + std::to_string(at), "SIMVIS_FAIL_ERRNO=" + std::to_string(EIO),
                 "SIMVIS_FAIL_MARK=" + (marks / "mark").string()})
            .wait();
    INFO(failed.err);
    CHECK(std::filesystem::file_size(marks / "mark") == 1);
    CHECK(failed.exit_code == 1);
    CHECK(is_pair(runs, tried / "run.pcap"));
    CHECK(Process(runs[1].with_files(tried)).wait().exit_code == 0);
    CHECK(is_pair(runs, tried / "run.pcap"));
  }
}

TEST_CASE("a capture of a run that is killed at any moment is that of its metadata") {
  const CapturedRun runs[] = {CapturedRun("ouster_os0_32"), CapturedRun("ouster_os1_32")};
  const TemporaryFolder tried;
  const std::filesystem::path capture = tried / "run.pcap", metadata = tried / "run.pcap.json";
  std::mt19937 random(static_cast<unsigned>(count_of("SIMVIS_TEST_SEED", 1)));
  const auto start = std::chrono::steady_clock::now();
  REQUIRE(Process(runs[0].with_files(tried)).wait().exit_code == 0);
  const auto length = std::chrono::steady_clock::now() - start;
  int kills = 0, pairs = 0;
  for (int i = count_of("SIMVIS_TEST_KILLS", sanitized() ? 2 : 4); i > 0; --i) {
    const CapturedRun& run = runs[i % 2];
    Process process(run.with_files(tried));
    std::this_thread::sleep_for(length * static_cast<double>(random() % 1000) / 1000);
    process.send(SIGKILL);
    kills += process.wait().signal == SIGKILL ? 1 : 0;
    if (!std::filesystem::exists(capture)) continue;
    INFO(i);
    CHECK(is_pair(runs, capture));  // the capture of the run before, if this one was killed before its first frame
    ++pairs;
  }
  MESSAGE(kills, " runs were killed, ", pairs, " left a capture");
  CHECK(pairs > 0);
  const ProcessResult next = Process(runs[1].with_files(tried)).wait();
  INFO(next.err);
  CHECK(next.exit_code == 0);
  const bool same = read_text(capture) == runs[1].capture && read_text(metadata) == runs[1].metadata;
  CHECK(same);
  CHECK(files_below(tried.path()) == files_below(runs[1].whole.path()));  // no leftovers
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
