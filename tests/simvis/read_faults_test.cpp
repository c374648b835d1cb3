// A machine that fails while it reads a robot's files ends the run: it never simulates another robot.
#include <doctest/doctest.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>

#include "tests/support/parts/box_files.h"
#include "tests/support/parts/gltf_fixture.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

struct ReadFault {
  std::string program, file;
  const char* call = "";  // see tests/preload/failing_calls.cpp
  int error = 0;
};

// A robot whose links have a mesh each, and a file of Inventor that includes another. There are no sensors.
class FaultyRobot {
 public:
  FaultyRobot() {
    write_text(folder_ / "box.obj", "mtllib box.mtl\nusemtl m\n" + test::obj_box());
    write_text(folder_ / "box.mtl", "newmtl m\nKd 1 0 0\n");
    write_text(folder_ / "box.stl", test::stl_box(true));
    write_text(folder_ / "box.ply", test::ply_box(test::PlyFormat::little));
    write_text(folder_ / "box.dae", test::dae_box("<unit meter='1'/><up_axis>Z_UP</up_axis>"));
    std::string links;
    for (const char* name : {"obj", "stl", "ply", "dae"}) {
      const std::string n = name;
      links += "<link name='" + n + "'><visual><geometry><mesh filename='box." + n + "'/></geometry></visual></link>\n";
      if (n != "obj") {
        links += "<joint name='to_" + n + "' type='fixed'><parent link='obj'/><child link='" + n + "'/></joint>\n";
      }
    }
    write_text(folder_ / "r.urdf", "<?xml version='1.0'?>\n<robot name='r'>\n" + links + "</robot>\n");
    write_text(folder_ / "part.iv", "#Inventor V2.1 ascii\nSeparator { File { name \"inner.iv\" } }\n");
    write_text(folder_ / "inner.iv", "#Inventor V2.1 ascii\nSeparator { Cube { } }\nSeparator { Sphere { } }\n");
    write_text(folder_ / "scene.xml", "<scene>\n<part file='r.urdf' name='R' insert_at='ROOT'/>\n</scene>\n");
    write_text(folder_ / "coin.xml", "<scene>\n<part file='part.iv' name='P' insert_at='ROOT'/>\n</scene>\n");
  }

  fs::path operator/(const char* name) const { return folder_ / name; }

  ProcessResult list(const char* scene, const Strings& environment = {}) const {
    return run_simvis({(folder_ / scene).string(), "--list"}, environment);
  }

  // The result with the call number `at` failing; nothing if there are not so many calls.
  std::optional<ProcessResult> list_with(const char* scene, const ReadFault& fault, int at) const {
    const fs::path mark = mark_ / "failed";
    fs::remove(mark);
    ProcessResult result =
        list(scene, {"LD_PRELOAD=" + tested_build() + "/lib/libsimvis_failing_calls.so",
                     "SIMVIS_FAIL_IN=" + fault.program, "SIMVIS_FAIL_FILE=" + (folder_ / fault.file).string(),
                     std::string("SIMVIS_FAIL_CALL=") + fault.call, "SIMVIS_FAIL_AT=" + std::to_string(at),
                     "SIMVIS_FAIL_ERRNO=" + std::to_string(fault.error), "SIMVIS_FAIL_MARK=" + mark.string()});
    if (!fs::exists(mark) || fs::file_size(mark) == 0) return std::nullopt;
    return result;
  }

 private:
  TemporaryFolder folder_, mark_;
};

struct Reader {
  const char *scene, *program, *file;
};
constexpr Reader kReaders[] = {
    {"scene.xml", "simvis-run", "scene.xml"},          {"scene.xml", "simvis-run", "r.urdf"},
    {"scene.xml", "simvis-import-mesh", "box.obj"},    {"scene.xml", "simvis-import-mesh", "box.mtl"},
    {"scene.xml", "simvis-import-mesh", "box.stl"},    {"scene.xml", "simvis-import-mesh", "box.ply"},
    {"scene.xml", "simvis-import-mesh", "box.dae"},    {"coin.xml", "simvis-run", "part.iv"},
    {"coin.xml", "simvis-import-inventor", "part.iv"}, {"coin.xml", "simvis-import-inventor", "inner.iv"}};

// Fails each call once that a reader makes. Every failure must end the run, with its reason and the file's name.
void check_all_faults(const Reader& reader, const char* call, int error) {
  const FaultyRobot robot;
  CAPTURE(std::string(reader.program));
  CAPTURE(std::string(reader.file));
  const ProcessResult whole = robot.list(reader.scene);
  INFO(whole.err);
  REQUIRE(whole.exit_code == 0);
  REQUIRE(whole.err.empty());
  int faults = 0;
  for (int at = 1; at < 1000; ++at, ++faults) {
    const std::optional<ProcessResult> result =
        robot.list_with(reader.scene, {reader.program, reader.file, call, error}, at);
    if (!result) break;
    CAPTURE(at);
    INFO(result->err);
    CHECK(result->exit_code == 1);
    CHECK(result->err.find(std::strerror(error)) != std::string::npos);
    CHECK(result->err.find((robot / reader.file).string()) != std::string::npos);
    CHECK(result->err.find("crashed") == std::string::npos);
  }
  CHECK(faults > 0);
}

bool has_reader(const Reader& reader) {
  return fs::exists(tested_build() + "/lib/simvis/" + reader.program) || std::string(reader.program) == "simvis-run";
}

TEST_CASE("a read that fails with EIO ends the run, whichever it is") {
  if (sanitized()) return test::skip(test::kNotSanitized);  // its runtime must be the first library
  for (const Reader& reader : kReaders) {
    if (has_reader(reader)) check_all_faults(reader, "read", EIO);
  }
}

TEST_CASE("too many open files end the run, at whichever file") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  for (const Reader& reader : kReaders) {
    if (has_reader(reader)) check_all_faults(reader, "open", EMFILE);
  }
}

TEST_CASE("an allocation that fails in a library ends the run, even if the library goes on") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const FaultyRobot robot;
  for (const Reader& reader : kReaders) {
    if (std::string(reader.program) == "simvis-run" || !has_reader(reader)) continue;
    CAPTURE(std::string(reader.file));
    const std::optional<ProcessResult> result =
        robot.list_with(reader.scene, {reader.program, reader.file, "memory", ENOMEM}, 1);
    REQUIRE(result);
    INFO(result->err);
    CHECK(result->exit_code == 1);
    CHECK(result->err.find("reading takes more than 4096 MiB of memory") != std::string::npos);
  }
}

// What a material's colour replaces is another picture of the robot.
TEST_CASE("a picture that cannot be read for a fault of the machine ends the run") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const TemporaryFolder folder;
  write_text(folder / "box.obj", "mtllib box.mtl\nusemtl m\n" + test::obj_box());
  write_text(folder / "box.mtl", "newmtl m\nmap_Kd p.tga\n");
  // One pixel of TGA: a header of 18 bytes, blue, green, red.
  write_text(folder / "p.tga", std::string("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x18\0\1\2\3", 21));
  write_text(folder / "scene.xml",
             "<scene>\n<part file='box.obj' name='P' insert_at='ROOT'/>\n<sensor type='camera' name='C' "
             "insert_at='ROOT' width='8' height='8'/>\n</scene>\n");
  const auto run = [&](const std::string& program) {
    return run_simvis({(folder / "scene.xml").string(), "--out", (folder / "out").string()},
                      {"LD_PRELOAD=" + tested_build() + "/lib/libsimvis_failing_calls.so", "SIMVIS_FAIL_IN=" + program,
                       "SIMVIS_FAIL_FILE=" + (folder / "p.tga").string(), "SIMVIS_FAIL_CALL=read", "SIMVIS_FAIL_AT=1",
                       "SIMVIS_FAIL_ERRNO=" + std::to_string(EIO), "SIMVIS_FAIL_MARK=" + (folder / "mark").string()});
  };
  const ProcessResult whole = run("none");
  INFO(whole.err);
  CHECK(whole.exit_code == 0);
  const ProcessResult failed = run("simvis-run");
  INFO(failed.err);
  CHECK(failed.exit_code == 1);
  CHECK(failed.err.find((folder / "p.tga").string() + ": error: cannot be read: Input/output error") !=
        std::string::npos);
}

TEST_CASE("a mesh that may not be read is left out as one that is not there") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const FaultyRobot robot;
  const std::optional<ProcessResult> result =
      robot.list_with("scene.xml", {"simvis-import-mesh", "box.ply", "open", EACCES}, 1);
  REQUIRE(result);
  INFO(result->out);
  CHECK(result->exit_code == 0);
  CHECK(result->out.find("a visual is left out") != std::string::npos);
  CHECK(result->out.find("Permission denied") != std::string::npos);
}

// The same text or status 1, and no advice to install what is installed.
TEST_CASE("little memory gives the whole scene or an error, never a part of it") {
  if (sanitized()) return test::skip(test::kNotSanitized);
  const FaultyRobot robot;
  constexpr int kStep_kib = 8 << 10, kMost_kib = 4 << 20;
  for (const char* scene : {"scene.xml", "coin.xml"}) {
    const std::string whole = robot.list(scene).out;
    int failed = 0;
    int kib = kStep_kib;
    for (bool is_whole = false; !is_whole && kib < kMost_kib; kib += std::max(kStep_kib, kib / 16)) {
      const ProcessResult result = Process({"/bin/sh", "-c", "ulimit -v $0; exec \"$@\"", std::to_string(kib),
                                            simvis_run(), (robot / scene).string(), "--list"})
                                       .wait();
      CAPTURE(kib);
      INFO(result.err);
      CHECK(result.exit_code != 2);
      is_whole = result.exit_code == 0;
      failed += is_whole ? 0 : 1;
      if (is_whole) CHECK(result.out == whole);
      if (is_whole) CHECK(result.err.empty());
    }
    CHECK(failed > 0);
    CHECK(kib < kMost_kib);
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
