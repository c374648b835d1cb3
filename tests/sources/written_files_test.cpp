// One function makes all temporary files: nothing else of the product creates files.
#include <doctest/doctest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>

#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("sources");

namespace simvis {
namespace {

namespace fs = std::filesystem;

// What creates a file in C and C++.
constexpr std::string_view kCreations[] = {"O_CREAT", "O_TMPFILE", "ofstream", "std::fstream",
                                           "fopen(",  "mkstemp",   "creat("};

// Files that may create some, and why.
const std::map<std::string, std::string> kCreators = {
    {"engine/base/temporary_file.cpp", "the function"},
    {"engine/base/result_lock.cpp", "empty files of locks"},
    {"exchange/clients/simvis_ctl.c", "reads"},
    {"import/programs/inventor/checked_fopen.cpp", "reads"},
    {"import/programs/inventor/checked_fopen.h", "reads"},
    {"import/programs/system_calls.cpp", "refuses calls that create"},
};

bool is_source(const fs::path& file) {
  static const std::set<std::string> kEndings = {".h", ".cpp", ".c", ".cu"};
  return kEndings.contains(file.extension().string());
}

TEST_CASE("files of results are created by TemporaryFile alone") {
  const fs::path root = SIMVIS_SOURCE_DIR;
  int files = 0;
  for (const fs::directory_entry& folder : fs::directory_iterator(root)) {
    static const std::set<std::string> kNoProduct = {"bench", "build", "tests", "tools", "docs", "scenes"};
    const std::string name = folder.path().filename().string();
    if (!folder.is_directory() || name.starts_with('.') || kNoProduct.contains(name)) continue;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder.path())) {
      if (!entry.is_regular_file() || !is_source(entry.path())) continue;
      const std::string file = entry.path().lexically_relative(root).string();
      ++files;
      if (kCreators.contains(file)) continue;
      const std::string text = read_text(entry.path());
      CAPTURE(file);
      for (const std::string_view creation : kCreations) {
        if (text.find(creation) != std::string::npos) FAIL_CHECK("\"" << creation << "\", expected TemporaryFile");
      }
    }
  }
  CHECK(files > 500);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
