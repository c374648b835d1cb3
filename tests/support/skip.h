// Test cases that cannot run here end as skipped: ctest shows their entry so, unless another test case of it failed.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace simvis::test {

/// Exit code of a test program that skipped a test case and found no mistake in the others; tests/CMakeLists.txt tells
/// ctest the same number.
inline constexpr int kSkippedExitCode = 77;

/// The reason of a test case that works in builds without sanitizers alone.
inline constexpr const char* kNotSanitized = "it has no sense with sanitizers";

/// Prints why the test case is skipped. The test case returns after the call.
void skip(const std::string& reason);

/// A file or folder of the test data (CMake: SIMVIS_TEST_DATA), or nothing and skip() when it is missing. Test cases
/// that call it have a name that begins with "test data: ", and so an entry of their own in ctest.
std::optional<std::filesystem::path> test_data(const std::string& name);

}  // namespace simvis::test
