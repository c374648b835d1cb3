// Packages of PyPI that a test uses, where they can be had.
#pragma once

#include <unistd.h>

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/run_process.h"
#include "tests/support/skip.h"

namespace simvis::test {

/// The folder of the packages for PYTHONPATH. They are installed once for the tests of all builds. If they cannot be
/// had, the test case is skipped: returns none.
inline std::optional<std::filesystem::path> pip_packages(const std::vector<std::string>& packages) {
  namespace fs = std::filesystem;
  std::string names;
  for (const std::string& package : packages) names += (names.empty() ? "" : ",") + package;
  const fs::path folder = fs::path(SIMVIS_SOURCE_DIR) / "build/test-packages" / names;
  if (fs::exists(folder)) return folder;
  // Another test may install them at the same time, and the first one that is done gives the folder its name.
  const fs::path own = folder.string() + "." + std::to_string(::getpid());
  std::vector<std::string> command = {
      "python3", "-m",        "pip", "install",  "--quiet",   "--disable-pip-version-check", "--no-input", "--retries",
      "0",       "--timeout", "10",  "--target", own.string()};
  command.insert(command.end(), packages.begin(), packages.end());
  std::string reason;
  std::error_code ignored;
  try {
    const ProcessResult result = Process(command).wait(std::chrono::seconds(100));
    if (result.exit_code == 0) {
      fs::rename(own, folder, ignored);
      if (ignored) fs::remove_all(own, ignored);
      return folder;
    }
    reason = result.timed_out ? "it takes longer than 100 s" : result.err;
  } catch (const std::runtime_error& error) {  // there is no Python
    reason = error.what();
  }
  fs::remove_all(own, ignored);
  skip("pip (Debian's python3-pip) cannot install " + names + ": " + reason);
  return std::nullopt;
}

}  // namespace simvis::test
