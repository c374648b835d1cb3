// tools/build in a tree of its own, with programs in place of cmake, ninja and dpkg-query: when it configures.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "tests/support/run_process.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

class Tree {
 public:
  Tree() {
    for (const char* folder : {"tools", "programs"}) fs::create_directories(folder_ / folder);
    fs::copy_file(fs::path(SIMVIS_SOURCE_DIR) / "tools/build", folder_ / "tools/build");
    write_text(folder_ / "tools/packages", "# packages\nrun   cmake  for builds\nbench libembree-dev  the peer\n");
    write_text(folder_ / "CMakePresets.json", "{}");
    program("cmake", "touch build/release/build.ninja; echo configured >>log");
    program("ninja", "echo built >>log");
    installed("cmake");
  }

  // What `dpkg-query --show` prints.
  void installed(const std::string& packages) { program("dpkg-query", "echo '" + packages + "'"); }

  // What one call of tools/build does.
  std::string build() const {
    write_text(folder_ / "log", "");
    const std::string path = (folder_ / "programs").string() + ":/usr/bin:/bin";
    const ProcessResult result =
        Process({"/usr/bin/env", "PATH=" + path, (folder_ / "tools/build").string(), "release"}).wait();
    INFO(result.err);
    CHECK(result.exit_code == 0);
    return read_text(folder_ / "log");
  }

 private:
  void program(const std::string& name, const std::string& commands) const {
    const fs::path file = folder_ / "programs" / name;
    write_text(file, "#!/bin/sh\n" + commands + "\n");
    fs::permissions(file, fs::perms::owner_all);
  }

  TemporaryFolder folder_;
};

}  // namespace

TEST_CASE("a package that is installed after the first build configures the next one again") {
  Tree tree;
  CHECK(tree.build() == "configured\nbuilt\n");
  CHECK(tree.build() == "built\n");
  tree.installed("cmake libembree-dev");  // as bench/run does after ./run
  CHECK(tree.build() == "configured\nbuilt\n");
  CHECK(tree.build() == "built\n");
}

}  // namespace simvis

TEST_SUITE_END();
