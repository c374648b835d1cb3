// doctest's main. A program fails if the Vulkan validation layers print anything in any test case or after all; its
// exit code tells ctest of skipped test cases.
#define DOCTEST_CONFIG_IMPLEMENT
#include "tests/support/skip.h"
#include "tests/support/validation.h"

#include <doctest/doctest.h>
#include <stdio.h>
#include <unistd.h>

#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <string_view>

namespace simvis::test {
namespace {

bool any_skipped = false;
std::atomic<bool> any_validation_message = false;
std::atomic<bool> expects_validation_message = false;

/// A cookie function of fopencookie(): writes to the standard error stream and looks for validation messages. It keeps
/// no memory of its own, so that it works while static objects are destroyed. The caller holds the lock of the stream.
ssize_t write_and_look(void*, const char* text, size_t size) {
  constexpr std::string_view kMessage = "Vulkan validation ";  // its first letter occurs in it once
  static std::size_t matched = 0;
  for (const char letter : std::string_view(text, size)) {
    if (letter != kMessage[matched]) matched = 0;
    if (letter == kMessage[matched]) ++matched;
    if (matched < kMessage.size()) continue;
    if (!expects_validation_message) any_validation_message = true;
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

/// Names each test case in which a validation message was printed.
class ValidationListener : public doctest::IReporter {
 public:
  explicit ValidationListener(const doctest::ContextOptions& /*options*/) {}

  void test_case_start(const doctest::TestCaseData& test) override {
    name_ = test.m_name;
    had_message_ = any_validation_message;
  }
  void test_case_end(const doctest::CurrentTestCaseStats& /*counts*/) override {
    expects_validation_message = false;
    if (any_validation_message && !had_message_) {
      std::cout << "ERROR: test case \"" << name_ << "\": the Vulkan validation layers printed a message\n";
    }
  }
  void report_query(const doctest::QueryData& /*query*/) override {}
  void test_run_start() override {}
  void test_run_end(const doctest::TestRunStats& /*counts*/) override {}
  void test_case_reenter(const doctest::TestCaseData& /*test*/) override {}
  void test_case_exception(const doctest::TestCaseException& /*exception*/) override {}
  void subcase_start(const doctest::SubcaseSignature& /*subcase*/) override {}
  void subcase_end() override {}
  void log_assert(const doctest::AssertData& /*check*/) override {}
  void log_message(const doctest::MessageData& /*message*/) override {}
  void test_case_skipped(const doctest::TestCaseData& /*test*/) override {}

 private:
  const char* name_ = "";
  bool had_message_ = false;
};

/// Devices in static objects may print messages after main().
void fail_after_validation_message() {
  if (!any_validation_message) return;
  std::fflush(nullptr);
  std::_Exit(EXIT_FAILURE);
}

}  // namespace

void skip(const std::string& reason) {
  any_skipped = true;
  std::cout << "skipped: " << reason << '\n';
}

void expect_validation_message() { expects_validation_message = true; }

std::optional<std::filesystem::path> test_data(const std::string& name) {
  const std::filesystem::path path = std::filesystem::path(SIMVIS_TEST_DATA) / name;
  if (std::filesystem::exists(path)) return path;
  skip(path.string() + " is missing; the CMake variable SIMVIS_TEST_DATA names the folder of test data");
  return std::nullopt;
}

}  // namespace simvis::test

REGISTER_LISTENER("validation", 1, simvis::test::ValidationListener);

int main(int argc, char** argv) {
  using namespace simvis::test;
  watch_standard_error();
  std::atexit(fail_after_validation_message);  // runs after the destructors of static objects of the tests
  const int failed = doctest::Context(argc, argv).run();
  return failed == 0 && any_skipped ? kSkippedExitCode : failed;
}
