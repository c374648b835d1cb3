// How test programs end: after skipped test cases, after validation messages, after both. ctest counts an entry with
// kSkippedExitCode as skipped and ignores what it printed. The test cases "made up ..." run in a process of their own.
#include <doctest/doctest.h>

#include <cstdio>
#include <filesystem>
#include <string>

#include <simvis/device.h>
#include "engine/vulkan/buffer.h"
#include "engine/vulkan/device_impl.h"
#include "tests/support/run_process.h"
#include "tests/support/skip.h"
#include "tests/support/validation.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

struct PrintsWhenDestroyed {
  ~PrintsWhenDestroyed() { std::fprintf(stderr, "Vulkan validation error: made up\n"); }
};

void make_buffer_without_use() {
  Device device({.select = "", .validation = true, .cache_dir = ""});
  const Buffer without_use(device.impl(), {.name = "bad", .size = 4, .usage = 0, .memory = MemoryKind::staging});
}

ProcessResult run_case(const std::string& name) {
  const std::string program = std::filesystem::read_symlink("/proc/self/exe").string();
  return Process({program, "--no-skip", "--test-case=" + name}).wait();
}

}  // namespace

TEST_CASE("made up without a message" * doctest::skip()) { test::skip("made up"); }

TEST_CASE("made up with a message of the validation layer" * doctest::skip()) {
  make_buffer_without_use();
  test::skip("made up");
}

TEST_CASE("made up passed with a message of the validation layer" * doctest::skip()) { make_buffer_without_use(); }

TEST_CASE("made up with an expected message of the validation layer" * doctest::skip()) {
  test::expect_validation_message();
  make_buffer_without_use();
}

TEST_CASE("made up with a message after main" * doctest::skip()) {
  static const PrintsWhenDestroyed prints_when_destroyed;
  test::skip("made up");
}

TEST_CASE("a program that skips a test case ends as skipped") {
  CHECK(run_case("made up without a message").exit_code == test::kSkippedExitCode);
}

TEST_CASE("a program that skips a test case fails after a validation message") {
  for (const std::string name : {"with a message of the validation layer", "with a message after main"}) {
    CAPTURE(name);
    const ProcessResult result = run_case("made up " + name);
    CHECK(result.exit_code == 1);
    CHECK(result.out.find("skipped: made up") != std::string::npos);
    CHECK(result.err.find("Vulkan validation error: ") != std::string::npos);
  }
}

TEST_CASE("a test case that passes fails its program by a validation message, which names it") {
  const std::string name = "made up passed with a message of the validation layer";
  const ProcessResult result = run_case(name);
  CHECK(result.exit_code == 1);
  CHECK(result.out.find("ERROR: test case \"" + name + "\": the Vulkan validation layers") != std::string::npos);
}

TEST_CASE("a message that a test case expects does not fail it") {
  CHECK(run_case("made up with an expected message of the validation layer").exit_code == 0);
}

TEST_SUITE_END();
