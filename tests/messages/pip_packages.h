// Packages of PyPI that a test uses, where they can be had.
#pragma once

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/run_process.h"
#include "tests/support/skip.h"

namespace simvis::test {

/// Installs the packages into a folder. If they cannot be had, the test case is skipped: returns false.
inline bool pip_install(const std::vector<std::string>& packages, const std::filesystem::path& folder) {
  std::vector<std::string> command = {
      "python3",      "-m",        "pip", "install",   "--quiet", "--disable-pip-version-check",
      "--no-input",   "--retries", "0",   "--timeout", "10",      "--target",
      folder.string()};
  command.insert(command.end(), packages.begin(), packages.end());
  std::string reason;
  try {
    const ProcessResult result = Process(command).wait(std::chrono::seconds(100));
    if (result.exit_code == 0) return true;
    reason = result.timed_out ? "it takes longer than 100 s" : result.err;
  } catch (const std::runtime_error& error) {  // there is no Python
    reason = error.what();
  }
  std::string names;
  for (const std::string& package : packages) names += (names.empty() ? "" : ", ") + package;
  skip("pip (Debian's python3-pip) cannot install " + names + ": " + reason);
  return false;
}

}  // namespace simvis::test
