// Code that runs in a helper program can read the files of its part, but no others, and cannot write, connect, or start
// anything.
#include <doctest/doctest.h>
#include <linux/landlock.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "tests/support/parts/box_files.h"
#include "tests/support/simvis_run.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

bool has_landlock() { return ::syscall(__NR_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) > 0; }

TEST_CASE("a library that a part file has taken over cannot read other files, write, connect, or start a program") {
  if (sanitized()) return;  // its runtime must be the first library, and system calls are not restricted
  const TemporaryFolder folder, other;
  write_text(other / "secret", "not of the part");
  write_text(folder / "box.stl", test::stl_box(true));
  write_text(folder / "scene.xml", "<scene><part file='box.stl' name='P' insert_at='ROOT'/></scene>");
  const ProcessResult result = run_simvis(
      {(folder / "scene.xml").string(), "--list"},
      {"LD_PRELOAD=" + tested_build() + "/lib/libsimvis_hostile_library.so",
       "SIMVIS_HOSTILE_LOG=" + (folder / "log").string(), "SIMVIS_HOSTILE_FILE=" + (folder / "made").string(),
       "SIMVIS_HOSTILE_SECRET=" + (other / "secret").string()});
  INFO(result.err);
  // No attempt before "tried" was allowed, except reading where the kernel cannot prevent it.
  if (!has_landlock()) MESSAGE("not tested whether other files can be read: this kernel has no Landlock");
  CHECK(read_text(folder / "log") == (has_landlock() ? "tried" : "read read-system list tried"));
  // The last attempt would have ended the program without an answer.
  CHECK(result.exit_code == 0);
  CHECK_FALSE(std::filesystem::exists(folder / "made"));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
