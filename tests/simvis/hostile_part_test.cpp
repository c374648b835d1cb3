// Code that runs in a helper program can read, but not write, connect, or start anything.
#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "tests/support/parts/box_files.h"
#include "tests/support/simvis_run.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

TEST_CASE("a library that a part file has taken over cannot write, connect, or start a program") {
  if (sanitized()) return;  // its runtime must be the first library, and system calls are not restricted
  const TemporaryFolder folder;
  write_text(folder / "box.stl", test::stl_box(true));
  write_text(folder / "scene.xml", "<scene><part file='box.stl' name='P' insert_at='ROOT'/></scene>");
  const ProcessResult result = run_simvis(
      {(folder / "scene.xml").string(), "--list"},
      {"LD_PRELOAD=" + tested_build() + "/lib/libsimvis_hostile_library.so",
       "SIMVIS_HOSTILE_LOG=" + (folder / "log").string(), "SIMVIS_HOSTILE_FILE=" + (folder / "made").string()});
  INFO(result.err);
  CHECK(read_text(folder / "log") == "tried");  // no attempt before it was allowed
  // The last attempt would have ended the program without an answer.
  CHECK(result.exit_code == 0);
  CHECK_FALSE(std::filesystem::exists(folder / "made"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
