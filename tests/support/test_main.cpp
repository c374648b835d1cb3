// doctest's main, with an exit code that tells ctest of skipped test cases.
#define DOCTEST_CONFIG_IMPLEMENT
#include "tests/support/skip.h"

#include <doctest/doctest.h>
#include <stdio.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string_view>

namespace simvis::test {
namespace {

bool any_skipped = false;
bool any_validation_message = false;

/// A cookie function of fopencookie(): writes to the standard error stream and looks for validation messages. It keeps
/// no memory of its own, so that it works while static objects are destroyed. The caller holds the lock of the stream.
ssize_t write_and_look(void*, const char* text, size_t size) {
  constexpr std::string_view kMessage = "Vulkan validation ";  // its first letter occurs in it once
  static std::size_t matched = 0;
  for (const char letter : std::string_view(text, size)) {
    if (letter != kMessage[matched]) matched = 0;
    if (letter == kMessage[matched]) ++matched;
    if (matched < kMessage.size()) continue;
    any_validation_message = true;
    matched = 0;
  }
  return ::write(STDERR_FILENO, text, size);
}

/// The library prints validation messages with stdio. In the GNU C library `stderr` is a variable.
void watch_standard_error() {
  FILE* const watched = ::fopencookie(nullptr, "w", {.read = {}, .write = write_and_look, .seek = {}, .close = {}});
  if (watched == nullptr) std::abort();
  ::setvbuf(watched, nullptr, _IONBF, 0);
  stderr = watched;
}

/// ctest looks at kSkippedExitCode before it searches the output for validation messages, so a program with a message
/// must not end with it. Devices in static objects may print messages after main().
void fail_if_skip_hides_message() {
  if (!any_skipped || !any_validation_message) return;
  std::fflush(nullptr);
  std::_Exit(EXIT_FAILURE);
}

}  // namespace

void skip(const std::string& reason) {
  any_skipped = true;
  std::cout << "skipped: " << reason << '\n';
}

std::optional<std::filesystem::path> test_data(const std::string& name) {
  const std::filesystem::path path = std::filesystem::path(SIMVIS_TEST_DATA) / name;
  if (std::filesystem::exists(path)) return path;
  skip(path.string() + " is missing; the CMake variable SIMVIS_TEST_DATA names the folder of test data");
  return std::nullopt;
}

}  // namespace simvis::test

int main(int argc, char** argv) {
  using namespace simvis::test;
  watch_standard_error();
  std::atexit(fail_if_skip_hides_message);  // runs after the destructors of static objects of the tests
  const int failed = doctest::Context(argc, argv).run();
  return failed == 0 && any_skipped ? kSkippedExitCode : failed;
}
