// Code that runs in a helper program can read the files of its part, but no others, and cannot write, connect, start or
// signal anything. It makes the system calls of an allow list alone.
#include <doctest/doctest.h>
#include <linux/landlock.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <utility>

#include "import/programs/system_calls.h"
#include "import/sandbox/import_program.h"
#include "import/sandbox/sandboxed_decode.h"
#include "tests/support/parts/box_files.h"
#include "tests/support/python_package.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

bool has_landlock() { return ::syscall(__NR_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION) > 0; }

const std::string& hostile_library() {
  static const std::string library = tested_build() + "/lib/libsimvis_hostile_library.so";
  return library;
}

// The variables by which a helper program loads the library, which tries to make a file in the folder.
Strings variables_of_attempts(const TemporaryFolder& folder, const TemporaryFolder& other) {
  write_text(other / "secret", "not of the part");
  return {"LD_PRELOAD=" + hostile_library(), "SIMVIS_HOSTILE_LOG=" + (folder / "log").string(),
          "SIMVIS_HOSTILE_FILE=" + (folder / "made").string(), "SIMVIS_HOSTILE_SECRET=" + (other / "secret").string()};
}

void check_refused_attempts(const TemporaryFolder& folder) {
  // No attempt before "tried" was allowed, except reading where the kernel cannot prevent it.
  if (!has_landlock()) MESSAGE("not tested whether other files can be read: this kernel has no Landlock");
  CHECK(read_text(folder / "log") == (has_landlock() ? "tried" : "read read-system list tried"));
  CHECK_FALSE(std::filesystem::exists(folder / "made"));
}

void check_part(const TemporaryFolder& folder, const std::string& file) {
  const TemporaryFolder other;
  write_text(folder / "scene.xml", "<scene><part file='" + file + "' name='P' insert_at='ROOT'/></scene>");
  const ProcessResult result =
      run_simvis({(folder / "scene.xml").string(), "--list"}, variables_of_attempts(folder, other));
  INFO(result.err);
  check_refused_attempts(folder);
  // The last attempt would have ended the program without an answer.
  CHECK(result.exit_code == 0);
}

TEST_CASE("a library that a mesh has taken over reads no other files and makes no other system calls") {
  if (sanitized())
    return test::skip(
        test::kNotSanitized);  // its runtime must be the first library, and system calls are not restricted
  const TemporaryFolder folder;
  write_text(folder / "box.stl", test::stl_box(true));
  check_part(folder, "box.stl");
}

TEST_CASE("a library that an Inventor file has taken over reads no other files and makes no other system calls") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  if (!std::filesystem::exists(import_program("simvis-import-inventor"))) {
    test::skip("there is no simvis-import-inventor: Coin is not installed");
    return;
  }
  const TemporaryFolder folder;
  write_text(folder / "box.iv", "#Inventor V2.1 ascii\n\nCube { }\n");
  check_part(folder, "box.iv");
}

TEST_CASE("a decoder that a picture has taken over reads no files and makes no other system calls") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const TemporaryFolder folder;
  const TemporaryFolder other;
  // TGA: one pixel of 24 bits.
  constexpr std::uint8_t kPixel[] = {0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0, 10, 20, 30};
  const Strings variables = variables_of_attempts(folder, other);
  for (const std::string& each : variables) {
    const std::size_t sign = each.find('=');
    ::setenv(each.substr(0, sign).c_str(), each.substr(sign + 1).c_str(), 1);
  }
  CHECK(decode_picture_in_sandbox(kPixel, "t.tga").width == 1);
  for (const std::string& each : variables) ::unsetenv(each.substr(0, each.find('=')).c_str());
  check_refused_attempts(folder);
}

TEST_CASE("code in the programs in Python makes no other system calls") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  if (!test::has_python_module("ctypes")) return;
  const std::string script = R"(
import ctypes, os, sys
hostile, limits = ctypes.CDLL(sys.argv[1]), ctypes.CDLL(sys.argv[2])
reason = ctypes.create_string_buffer(1000)
folders = (ctypes.c_char_p * 1)(b"/")
memory, size = ctypes.c_size_t(1 << 30), ctypes.c_size_t(1000)
if limits.simvis_limit_process(os.fsencode(sys.argv[3]), memory, folders, 1, reason, size) != 0:
    sys.exit(reason.value)
hostile.try_system_calls(int(sys.argv[4]), 1)
)";
  for (const auto& [name, program] : {std::pair("usd", HelperProgram::usd), std::pair("xacro", HelperProgram::xacro)}) {
    CAPTURE(name);
    const ProcessResult tried =
        Process({test::kToolsPython, "-c", script, hostile_library(),
                 import_program("simvis-python-limits.so").string(), name, std::to_string(static_cast<int>(program))})
            .wait();
    INFO(tried.err);
    CHECK(tried.out == "tried");
  }
}

TEST_CASE("the reader of USD has one thread when it sets its limits") {
  if (!test::has_python_module("pxr.Usd") || !test::has_python_module("numpy")) return;
  const std::string script = R"(
import os, runpy, sys
sys.path.insert(0, sys.argv[1])
try:
    runpy.run_path(sys.argv[1] + "/usd_main.py")
except SystemExit:
    pass
import usd_stage
print(len(os.listdir("/proc/self/task")))
)";
  const ProcessResult run = Process({test::kToolsPython, "-c", script, import_program("python").string()}).wait();
  INFO(run.err);
  CHECK(run.out == "1\n");
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
