// simvis-run --export of maps: files, options, and what is refused.
#include <doctest/doctest.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>

#include <filesystem>
#include <string>

#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("maps");

namespace simvis {
namespace {

namespace fs = std::filesystem;

// A crate on a floor, and a robot that drives in x: its body has a gripper that is a part of its own.
const std::string kScene =
    "<simvis>"
    "<part name='FLOOR' insert_at='ROOT' shape='plane' size='4 4'/>"
    "<part name='CRATE' insert_at='ROOT' shape='box' size='1 1 1' pose_offset='-1.5 1.5 0.5 0 0 0'/>"
    "<part name='ROBOT' insert_at='ROOT' shape='box' size='1 1 1' pose_offset='0 -0.5 0.5 0 0 0'/>"
    "<element type='pose' name='DRIVE' insert_at='ROBOT'/>"
    "<part name='GRIPPER' insert_at='ROBOT' shape='box' size='1 1 1' pose_offset='1 0 0 0 0 0'/>"
    "<sensor type='imu' name='IMU' insert_at='ROOT'/>"
    "</simvis>";

struct Exports {
  Exports() { write_text(folder / "scene.xml", kScene); }

  ProcessResult run(const std::string& name, const Strings& more = {}) const {
    Strings arguments{(folder / "scene.xml").string(), "--quiet", "--out",      (folder / "out").string(), "--export",
                      (folder / name).string(),        "--set",   "DRIVE.x=0.5"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_simvis(arguments);
  }

  std::string picture(const Strings& more = {}) const {
    const ProcessResult result = run("map.yaml", more);
    CHECK(result.exit_code == 0);
    std::string text;
    const std::string bytes = read_text(folder / "map.pgm");
    for (const char c : bytes.substr(bytes.find("255\n") + 4)) text += c == 0 ? '#' : c == '\xfe' ? '.' : '?';
    return text;
  }

  void refuse(const std::string& name, const Strings& more, const std::string& expected) const {
    const ProcessResult result = run(name, more);
    CHECK(result.exit_code == 2);
    CHECK(contains(result.err, expected));
    CHECK(files_below(folder.path()) == Strings{"scene.xml"});
  }

  TemporaryFolder folder;
};

TEST_CASE("a map has the moving parts where they stand in the last frame, and no floor") {
  const Exports exports;
  CHECK(exports.picture({"--export-resolution", "1"}) ==
        "#..."
        "...."
        "..##"
        "....");
  CHECK(read_text(exports.folder / "map.yaml") ==
        "image: 'map.pgm'\nmode: trinary\nresolution: 1\norigin: [-2, -2, 0]\nnegate: 0\noccupied_thresh: 0.65\n"
        "free_thresh: 0.196\n");
}

TEST_CASE("parts are left out of a map by name, path and pattern, without what is inserted in them") {
  const Exports exports;
  const auto map = [&](const std::string& ignored) {
    return exports.picture({"--export-resolution", "1", "--export-ignore", ignored});
  };
  CHECK(map("ROBOT") == "#..........#....");
  CHECK(map("ROBOT,GRIPPER") == "#...............");
  CHECK(map("R*,G*,CRATE") == "................");
  fs::remove(exports.folder / "map.yaml");
  fs::remove(exports.folder / "map.pgm");
  fs::remove_all(exports.folder / "out");
  exports.refuse("map.yaml", {"--export-ignore", "ROBOTT"},
                 "--export-ignore: there is no part or link \"ROBOTT\", did you mean \"ROBOT\"?");
}

TEST_CASE("the area, the heights and a start of a map are those of the options") {
  const Exports exports;
  const auto map = [&](Strings more) {
    more.insert(more.end(), {"--export-resolution", "1"});
    return exports.picture(more);
  };
  CHECK(map({"--export-area", "-2,-1,1,2"}) ==
        "#......."
        "#");
  CHECK(map({"--export-heights", "1,2"}) == "................");
  CHECK(map({"--export-heights", "-1,0"}) == "################");
  // The robot and its gripper are a barrier across this area.
  CHECK(map({"--export-area", "0,-2,2,2"}) == "....##..");
  CHECK(map({"--export-area", "0,-2,2,2", "--export-start", "0.5,0.5"}) ==
        "....##"
        "??");
}

TEST_CASE("options of maps that are wrong are refused before anything is written") {
  const Exports exports;
  exports.refuse("a.yaml", {"--export-heights", "1,0.1"},
                 "--export-heights: \"1,0.1\" is not allowed, expected LOW,HIGH in metres");
  exports.refuse("a.yaml", {"--export-heights", "1"}, "--export-heights: \"1\" is not allowed");
  exports.refuse("a.bt", {"--export-area", "0,0,1"},
                 "--export-area: \"0,0,1\" is not allowed, expected X0,Y0,X1,Y1 in metres");
  exports.refuse("a.npz", {"--export-area", "0,0,0,1"}, "--export-area: \"0,0,0,1\" is not allowed");
  exports.refuse("a.yaml", {"--export-start", "0,0,0"},
                 "--export-start: \"0,0,0\" is not allowed, expected X,Y in metres");
  exports.refuse("a.npz", {"--export-start", "0,0"},
                 "--export-start: \"0,0\" is not allowed, expected X,Y,Z in metres");
  exports.refuse("a.npz", {"--export-resolution", "1e-5"},
                 "--export-resolution: 1e-05 is not allowed, expected from 1e-04 to 1000000 m");
  for (const std::string size : {"1000001", "1e300"}) {
    exports.refuse("a.npz", {"--export-resolution", size}, " is not allowed, expected from 1e-04 to 1000000 m");
  }
  exports.refuse("a.npz", {"--export-resolution", "0"}, "--export-resolution");
  exports.refuse(
      "a.glb", {"--export-heights", "0,1"},
      "is no map, which the other options of --export describe, expected a name that ends with .yaml, .npz or .bt");
  exports.refuse("a.glb", {"--export-resolution", "0.05"}, "is no map");  // the default, but given
  const ProcessResult alone = run_simvis({(exports.folder / "scene.xml").string(), "--export-start", "0,0"});
  CHECK(alone.exit_code == 2);
  CHECK(contains(alone.err, "--export-start requires --export"));
}

TEST_CASE("a map that cannot be made leaves no file") {
  const Exports exports;
  const auto check = [&](const std::string& name, const Strings& more, const std::string& expected) {
    const ProcessResult result = exports.run(name, more);
    CHECK(result.exit_code == 2);
    CHECK(contains(result.err, expected));
    CHECK_FALSE(fs::exists(exports.folder / "deep"));
  };
  check("deep/a.yaml", {"--export-resolution", "0.0001"},
        "--export: the map would have 40000 x 40000 cells of 1e-04 m");
  check("deep/a.yaml", {"--export-start", "-1.5,1.5"}, "--export: the start -1.5, 1.5 lies");
  check("deep/a.bt", {"--export-area", "4e4,0,4e4.5,1"}, "--export-area");
  check("deep/a.bt", {"--export-area", "40000,0,40001,1", "--export-resolution", "1"},
        "--export: the map reaches farther than 32768 cells");
}

TEST_CASE("a map that lacks what people see, or has no occupied cell, comes with a warning") {
  const Exports exports;
  write_text(exports.folder / "points.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
             "end_header\n0 0 0.5\n");
  std::string scene = kScene;
  scene.insert(8, "<part name='CLOUD' insert_at='ROOT' file='points.ply'/>");
  write_text(exports.folder / "scene.xml", scene);
  const ProcessResult lacking = exports.run("map.bt");
  CHECK(lacking.exit_code == 0);
  CHECK(contains(lacking.err, "map.bt: the map lacks part \"CLOUD\": points without a radius and Gaussian splats"));
  CHECK(exports.run("map.bt", {"--export-ignore", "CLOUD"}).err.empty());
  const ProcessResult strict = exports.run("strict.bt", {"--strict"});
  CHECK(strict.exit_code == 2);
  CHECK_FALSE(fs::exists(exports.folder / "strict.bt"));
  const ProcessResult empty = exports.run("map.yaml", {"--export-ignore", "CLOUD", "--export-heights", "5,6"});
  CHECK(empty.exit_code == 0);
  CHECK(contains(empty.err, "map.yaml: the map has no occupied cell, expected surfaces between its heights"));
}

TEST_CASE("a map does not take the name of a calibration") {
  const Exports exports;
  std::string scene = kScene;
  scene.insert(8, "<sensor type='camera' name='CAM' insert_at='ROOT' width='8' height='8'/>");
  write_text(exports.folder / "scene.xml", scene);
  exports.refuse("out/CAM.yaml", {},
                 "CAM.yaml is reserved for the calibration of sensor \"CAM\", expected another name");
  exports.refuse("out/../out/CAM_left.yaml", {}, "is reserved for the calibration of sensor \"CAM\"");
  CHECK(exports.run("CAM.yaml").exit_code == 0);
  CHECK(exports.run("out/CAM_map.yaml").exit_code == 0);
}

TEST_CASE("a map below a link that leads to itself or to nothing is refused, and the link stays") {
  const Exports exports;
  fs::create_symlink("loop", exports.folder / "loop");
  fs::create_symlink("nowhere", exports.folder / "gone");
  for (const std::string link : {"loop", "gone"}) {
    CAPTURE(link);
    for (const Strings& more : {Strings{}, {"--no-replace"}}) {
      const ProcessResult result = exports.run(link + "/deep/map.yaml", more);
      CHECK(result.exit_code == 1);
      CHECK(contains(result.err, link + "/deep: error: the folder cannot be created"));
      CHECK(fs::is_symlink(exports.folder / link));
    }
  }
}

TEST_CASE("files of an earlier map stay with --no-replace, the picture too") {
  const Exports exports;
  for (const std::string name : {"map.pgm", "map.yaml"}) {
    write_text(exports.folder / name, "mine");
    const ProcessResult result = exports.run("map.yaml", {"--no-replace"});
    CHECK(result.exit_code == 2);
    CHECK(contains(result.err, "--export: " + (exports.folder / name).string() + " exists, and --no-replace is given"));
    CHECK(files_below(exports.folder.path()) == Strings{name, "scene.xml"});
    fs::remove(exports.folder / name);
  }
}

TEST_CASE("maps go to devices behind links, and pictures are no folders") {
  const Exports exports;
  fs::create_directory(exports.folder / "map.pgm");
  const ProcessResult folder = exports.run("map.yaml");
  CHECK(folder.exit_code == 2);
  CHECK(contains(folder.err, "map.pgm is a folder, expected a regular file"));
  fs::create_symlink("/dev/null", exports.folder / "null.bt");
  CHECK(exports.run("null.bt").exit_code == 0);
  CHECK(fs::is_symlink(exports.folder / "null.bt"));
}

}  // namespace
}  // namespace simvis
