// doctest's main, with an exit code that tells ctest of test cases that were skipped.
#define DOCTEST_CONFIG_IMPLEMENT
#include "tests/support/skip.h"

#include <doctest/doctest.h>

#include <iostream>

namespace simvis::test {
namespace {

bool any_skipped = false;

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
  const int failed = doctest::Context(argc, argv).run();
  return failed == 0 && simvis::test::any_skipped ? simvis::test::kSkippedExitCode : failed;
}
