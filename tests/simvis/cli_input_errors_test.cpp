// What simvis-run says about wrong options and wrong scenes.
#include <doctest/doctest.h>

#include <filesystem>

#include "tests/support/simvis_run.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

namespace fs = std::filesystem;

TEST_CASE("a wrong command line") {
  const std::string scene(kWallSensors);
  check_refused({"--frames", "0"}, scene, {"simvis-run: --frames: ", "1 or more"});
  check_refused({"--frames", "-3"}, scene, {"simvis-run: ", "--frames"});
  check_refused({"--frames", "1.5"}, scene, {"--frames"});
  for (const char* rate : {"0", "-1", "nan", "inf", "1e-300"})
    check_refused({"--rate", rate}, scene, {"simvis-run: --rate: "});
  check_refused({"--rate", "fast"}, scene, {"--rate"});
  check_refused({"--seed", "x"}, scene, {"--seed"});
  check_refused({"--seed", "18446744073709551616"}, scene, {"--seed"});
  check_refused({"--sensor", "CAN"}, scene, {"--sensor", "CAN", "did you mean \"CAM\"?"});
  check_refused({"--set", "MOVE.yaw"}, scene, {"--set MOVE.yaw", "expected ELEMENT.PARAM=VALUE"});
  check_refused({"--set", "MOVE=1"}, scene, {"expected ELEMENT.PARAM=VALUE"});
  check_refused({"--set", "MOVE.yaw=nan"}, scene, {"\"nan\"", "finite"});
  check_refused({"--set", "MOVE.yaw=1 2"}, scene, {"\"1 2\""});
  check_refused({"--set", "MOVE.yow=1"}, scene, {"yow", "did you mean \"yaw\"?"});
  check_refused({"--set", "MOV.yaw=1"}, scene, {"MOV", "did you mean \"MOVE\"?"});
  check_refused({"--trajectory", "/nonexistent.csv"}, scene, {"/nonexistent.csv"});
  check_refused({"--trajectory", "/dev/zero"}, scene, {"/dev/zero:1:1: error: byte 0x00 is not allowed"});
  check_refused({"--plugin", "/nonexistent.so"}, scene, {"/nonexistent.so: error: ", "cannot open shared object file"});
  check_refused({"--device", "no such device"}, scene, {"no such device"});
  check_refused({"--colour"}, scene, {"--colour", "--help"});
  check_refused({"second.xml"}, scene, {"second.xml"});

  const ProcessResult nothing = run_simvis({});
  CHECK(nothing.exit_code == 2);
  CHECK(nothing.err.find("SCENE.xml is missing") != std::string::npos);
}

TEST_CASE("a wrong scene") {
  const std::string camera = R"(<sensor type="camera" name="C" insert_at="ROOT" )";
  // The commands begin on line 3.
  check_refused({}, "<part file=", {"scene.xml:", ": error: "});
  check_refused({}, R"(<prt file="wall.gltf" name="W" insert_at="ROOT"/>)", {"scene.xml:3:2: error: ", "part"});
  check_refused({}, R"(<sensor type="camra" name="C" insert_at="ROOT"/>)", {"scene.xml:3:", "camra", "\"camera\"?"});
  check_refused({}, R"(<element type="poes" name="P" insert_at="ROOT"/>)", {"scene.xml:3:", "poes", "\"pose\"?"});
  check_refused({}, camera + R"(widht="5"/>)", {"scene.xml:3:49: error: ", "widht", "\"width\"?"});
  check_refused({}, R"(<sensor type="camera" name="C" insert_at="WAL"/>)", {"scene.xml:3:", "WAL", "\"WALL\"?"});
  check_refused({}, camera + "/>\n" + camera + "/>", {"scene.xml:4:", "\"C\""});
  check_refused({}, camera + R"(near="nan"/>)", {"scene.xml:3:", "near", "nan"});
  check_refused({}, camera + R"(pose_offset="0 0 0 0 inf 0"/>)", {"scene.xml:3:", "pose_offset"});
  check_refused({}, camera + R"(width="0"/>)", {"scene.xml:3:", "width", "0"});
  check_refused({}, camera + R"(height="-1"/>)", {"scene.xml:3:", "height"});
  check_refused({}, camera + R"(hfov="0"/>)", {"scene.xml:3:", "hfov"});
  check_refused({}, camera + R"(hfov="360"/>)", {"scene.xml:3:", "hfov"});
  check_refused({}, R"(<part file="gone.glb" name="G" insert_at="ROOT"/>)", {"gone.glb"});
  check_refused({}, R"(<sensor type="camera" name="a/b" insert_at="ROOT"/>)", {"a/b"});
}

TEST_CASE("a scene or part that cannot be read") {
  const TemporaryFolder folder;
  const std::string out = (folder / "out").string();
  const ProcessResult missing = run_simvis({(folder / "missing.xml").string(), "--out", out});
  CHECK(missing.exit_code == 2);
  CHECK(missing.err.starts_with((folder / "missing.xml").string()));
  const ProcessResult is_folder = run_simvis({folder.path().string(), "--out", out});
  CHECK(is_folder.exit_code == 2);

  // A GLB file whose header gives a larger size than the file has.
  write_text(folder / "cut.glb", std::string("glTF\x02\0\0\0\xff\0\0\0\x20\0\0\0JSON{\"asset\"", 28));
  write_text(folder / "cut.xml", R"(<part file="cut.glb" name="P" insert_at="ROOT"/>)");
  const ProcessResult cut = run_simvis({(folder / "cut.xml").string(), "--out", out});
  CHECK(cut.exit_code == 2);
  CHECK(cut.err.find("cut.glb") != std::string::npos);
  CHECK(cut.err.find("error: ") != std::string::npos);
  CHECK(files_below(folder.path()) == Strings{"cut.glb", "cut.xml"});
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
