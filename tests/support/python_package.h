// Python packages of tools/python_tools, which tests use where they are.
#pragma once

#include <filesystem>
#include <string>

#include "tests/support/run_process.h"
#include "tests/support/skip.h"

namespace simvis::test {

inline const char* const kToolsPython = SIMVIS_SOURCE_DIR "/build/python-tools/bin/python";

/// Whether the module is there; skip() if it is not.
inline bool has_python_module(const std::string& name) {
  if (std::filesystem::exists(kToolsPython) && Process({kToolsPython, "-c", "import " + name}).wait().exit_code == 0) {
    return true;
  }
  skip("there is no Python module " + name + ": tools/python_tools installs it where pip can");
  return false;
}

}  // namespace simvis::test
