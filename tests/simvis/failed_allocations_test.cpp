// Whichever allocation of SimVis fails, the program ends with status 1, one message and no half-written file, and a
// program that uses the library gets an exception and can go on. In the suite a few allocations fail; by hand
// SIMVIS_TEST_ALLOCATIONS=500 lets so many fail of each kind of run, spread over all, and 0 each of them.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <random>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/long_count.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"
#include "tests/support/whole_files.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr const char* kFewSensors = R"(<scene>
  <part shape="box" size="0.1 4 4" name="WALL" insert_at="ROOT" pose_offset="5 0 0 0 0 0"/>
  <element type="pose" name="MOVE" insert_at="WALL" x="0.5"/>
  <sensor type="camera" name="CAM" insert_at="ROOT" width="32" height="24" hfov="60" outputs="color depth"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="5" min_angle="-60" max_angle="60" range_max="7"/>
  <sensor type="imu" name="IMU" insert_at="WALL"/>
</scene>
)";

std::string allocations_library() { return tested_build() + "/lib/libsimvis_failing_allocations.so"; }

struct AllocationRun {
  ProcessResult result;
  long calls = 0, failed = 0;
  std::string fault;  // of a file
};

/// Runs simvis-run with these options, in which @ is a folder for results, and lets allocation number `at` fail.
AllocationRun run_with_failure(const Strings& options, long at) {
  const TemporaryFolder folder, results, mark;
  write_text(folder / "scene.xml", kFewSensors);
  Strings arguments{(folder / "scene.xml").string()};
  for (std::string option : options) {
    if (option.starts_with('@')) option.replace(0, 1, results.path().string());
    arguments.push_back(option);
  }
  const std::string counted = (mark / "counted").string();
  AllocationRun run;
  run.result = run_simvis(arguments, {"LD_PRELOAD=" + allocations_library(), "SIMVIS_FAIL_IN=simvis-run",
                                      "SIMVIS_FAIL_AT=" + std::to_string(at), "SIMVIS_FAIL_MARK=" + counted});
  std::istringstream(read_text(counted)) >> run.calls >> run.failed;
  run.fault = first_fault_below(results.path());
  return run;
}

/// Numbers from 1 to `all`, at most `most` of them (0: no limit), spread evenly and shifted at random, in order.
std::vector<long> spread_over(long all, long most) {
  std::mt19937 random(20261125);
  if (most == 0 || most > all) most = all;
  std::set<long> numbers;
  for (long i = 0; i < most; ++i) {
    const long first = all * i / most, end = std::max(first + 1, all * (i + 1) / most);
    numbers.insert(1 + std::uniform_int_distribution<long>(first, end - 1)(random));
  }
  return {numbers.begin(), numbers.end()};
}

void check_failures(const Strings& options) {
  INFO(options[0], " ", options[1]);
  const AllocationRun whole = run_with_failure(options, 0);
  INFO(whole.result.err);
  REQUIRE(whole.result.exit_code == 0);
  REQUIRE(whole.calls > 1000);
  CHECK(whole.fault == "");
  long ended = 0, gone_on = 0, all = 0;
  for (const long at : spread_over(whole.calls, count_of("SIMVIS_TEST_ALLOCATIONS", 4))) {
    const AllocationRun run = run_with_failure(options, at);
    if (run.failed == 0) continue;  // names of temporary folders make runs a little longer or shorter
    CAPTURE(at);
    INFO(run.result.err);
    ++all;
    CHECK(run.fault == "");
    CHECK_FALSE(run.result.timed_out);
    // A few can be done without, such as room for a faster sort, or are no longer needed when they fail.
    CHECK((run.result.exit_code == 1 || run.result.exit_code == 0));
    const std::string& text = run.result.err;
    if (run.result.exit_code == 1) CHECK(std::count(text.begin(), text.end(), '\n') == 1);
    ended += run.result.exit_code == 1;
    gone_on += run.result.exit_code == 0;
  }
  MESSAGE(options[0], ": of ", whole.calls, " allocations ", all, " failed, one in each run; ", ended,
          " runs ended with a message, ", gone_on, " went on");
  CHECK(ended > 0);
}

TEST_CASE("an allocation that fails ends a run with one message and whole files, whichever it is") {
  if (sanitized()) return test::skip(test::kNotSanitized);  // its runtime must be the first library
  check_failures({"--out", "@/out", "--frames", "2", "--quiet"});
  check_failures({"--page", "@/p.html", "--export", "@/e.glb", "--profile", "@/p.json", "--frames", "2", "--quiet",
                  "--out", "@/out"});
  check_failures({"--record", "@/r.mcap", "--frames", "2", "--quiet", "--out", "@/out"});
  check_failures({"--serve", "failed_allocations_test", "--frames", "2", "--quiet", "--out", "@/out"});
  check_failures({"--live", "0", "--frames", "2", "--quiet", "--out", "@/out"});
}

// The first of them register the types of the library, before main().
TEST_CASE("an allocation that fails before main() ends the run with one message") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  for (const long at : {1, 2, 30, 300}) {
    CAPTURE(at);
    const AllocationRun run = run_with_failure({"--out", "@/out", "--frames", "2", "--quiet"}, at);
    CHECK(run.failed == 1);
    CHECK(run.result.exit_code == 1);
    CHECK(run.result.err == "simvis-run: error: there is not enough memory\n");
    CHECK(run.fault == "");
  }
}

TEST_CASE("an allocation that fails in the library is an exception, and the next simulation is as good as ever") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const int most = count_of("SIMVIS_TEST_ALLOCATIONS", 30);
  const ProcessResult result =
      Process({tested_build() + "/bin/each_allocation", std::to_string(most)}).wait(std::chrono::hours(4));
  INFO(result.err);
  MESSAGE(result.out);
  CHECK(result.exit_code == 0);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
