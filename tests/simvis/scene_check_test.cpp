// simvis-run --check: what is probably a mistake in a scene.
#include "program/report/scene_check.h"

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "simvis/live_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

std::vector<std::string> problems_of(const std::string& commands) {
  const LiveScene scene({}, parse_commands(commands, "s.xml", "."));
  return check_scene(scene.built);
}

std::string solid_with(const std::string& pose, const std::string& sensor = "type='laser_scanner'",
                       const std::string& shape = "shape='box' size='2 2 2'") {
  return "<part name='SOLID' insert_at='ROOT' " + shape + "/>\n<sensor name='S' insert_at='ROOT' pose_offset='" + pose +
         "' " + sensor + "/>";
}

TEST_CASE("a part of a kilometre or more is one in another unit") {
  const auto part = [](const std::string& size) {
    return "<part name='P' insert_at='ROOT' shape='box' size='" + size + "'/>";
  };
  CHECK(problems_of(part("999 1 1")).empty());
  CHECK(problems_of(part("1 1200.5 1")) ==
        std::vector<std::string>{"s.xml:1:2: part \"P\" is 1 x 1200.5 x 1 m large; expected less than 1000 m, or its "
                                 "lengths are in another unit (attributes unit and scale)"});
  const TemporaryFolder folder;
  write_text(folder / "land.obj", "v 0 0 0\nv 1200 0 0\nv 0 1 0\nf 1 2 3\n");
  const std::string file = "file='" + (folder / "land.obj").string() + "'";
  CHECK(problems_of("<part name='P' insert_at='ROOT' " + file + "/>").size() == 1);
  CHECK(problems_of("<part name='P' insert_at='ROOT' unit='m' " + file + "/>").empty());
}

TEST_CASE("a sensor within a solid is reported, one beside it is not") {
  CHECK(problems_of(solid_with("0.9 0 0 0 0 0")) ==
        std::vector<std::string>{
            "s.xml:2:2: sensor \"S\" is inside a solid of part \"SOLID\", mesh \"box\", whose back faces it sees"});
  CHECK(problems_of(solid_with("1.1 0 0 0 0 0")).empty());
  CHECK(problems_of(solid_with("0 0 0.4 0 0 0", "type='camera'", "shape='sphere' radius='0.5'")).size() == 1);
  CHECK(problems_of(solid_with("0.4 0.4 0.4 0 0 0", "type='camera'", "shape='sphere' radius='0.5'")).empty());
  CHECK(problems_of(solid_with("0 0 0.01 0 0 0", "type='camera'", "shape='plane' size='9 9'")).empty());
}

TEST_CASE("a camera whose near distance leaves out its housing sees through it") {
  const std::string housing = "shape='box' size='0.04 0.04 0.04'";
  CHECK(problems_of(solid_with("0 0 0 0 0 0", "type='camera'", housing)).empty());
  CHECK(problems_of(solid_with("0 0 0 0 0 0", "type='camera' near='0.01'", housing)).size() == 1);
  CHECK(problems_of(solid_with("0 0 0 0 0 0", "type='laser_scanner'", housing)).size() == 1);
}

TEST_CASE("a part that no laser sees for its opacity is reported to a scene with a laser") {
  const auto part = [](const std::string& opacity) {
    return "<part name='P' insert_at='ROOT' shape='box' size='1 1 1' opacity='" + opacity + "'/>\n";
  };
  const std::string laser = "<sensor name='S' type='laser_scanner' insert_at='ROOT' pose_offset='5 0 0 0 0 0'/>",
                    camera = "<sensor name='C' type='camera' insert_at='ROOT' pose_offset='5 0 0 0 0 0'/>";
  CHECK(problems_of(part("0.4") + laser) ==
        std::vector<std::string>{"s.xml:1:2: part \"P\" has an opacity below 0.5 everywhere, so that lasers do not see "
                                 "it; its attribute opacity sets another"});
  CHECK(problems_of(part("0.6") + laser).empty());
  CHECK(problems_of(part("0.4") + camera).empty());
}

TEST_CASE("transparent solids and rooms within walls hold no sensor") {
  CHECK(problems_of(solid_with("0 0 0 0 0 0", "type='camera'", "shape='box' size='1 1 1' opacity='0.3'")).empty());
  const std::string room = "shape='wall' points='-2 -2, 2 -2, 2 2, -2 2, -2 -2' height='2' thickness='0.2'";
  CHECK(problems_of(solid_with("0 0 1 0 0 0", "type='laser_scanner'", room)).empty());
  CHECK(problems_of(solid_with("2.05 0 1 0 0 0", "type='laser_scanner'", room)).size() == 1);
}

// A house of two closed surfaces: the outside, and the walls of its room with their faces inwards.
TEST_CASE("a house whose walls hide its outside holds no sensor, one without walls does") {
  const TemporaryFolder folder;
  const auto box = [](int first, double half, bool inwards) {
    std::string text;
    for (int corner = 0; corner < 8; ++corner) {
      const auto side = [&](int bit) { return " " + std::to_string((corner & bit) != 0 ? half : -half); };
      text += "v" + side(1) + side(2) + side(4) + "\n";
    }
    constexpr int kFaces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& face : kFaces) {
      text += "f";
      for (int i = 0; i < 4; ++i) text += " " + std::to_string(first + face[inwards ? 3 - i : i]);
      text += "\n";
    }
    return text;
  };
  write_text(folder / "outside.obj", "o outside\n" + box(1, 3, false));
  write_text(folder / "house.obj", "o outside\n" + box(1, 3, false) + "o walls\n" + box(9, 2.8, true));
  const auto problems = [&](const std::string& file) {
    return problems_of("<part name='HOUSE' insert_at='ROOT' file='" + (folder / file).string() +
                       "'/><sensor name='S' type='laser_scanner' insert_at='ROOT'/>");
  };
  CHECK(problems("outside.obj").size() == 1);
  CHECK(problems("house.obj").empty());
}

TEST_CASE("the program says what it finds by its exit status") {
  const TemporaryFolder folder;
  write_text(folder / "good.xml", "<simvis>" + solid_with("2 0 0 0 0 0") + "</simvis>");
  write_text(folder / "bad.xml", "<simvis>" + solid_with("0 0 0 0 0 0") + "</simvis>");
  const ProcessResult good = run_simvis({"--check", folder / "good.xml"}),
                      bad = run_simvis({"--check", folder / "bad.xml"});
  CHECK(good.exit_code == 0);
  CHECK(good.out == "no problems found\n");
  CHECK(bad.exit_code == 1);
  CHECK(contains(bad.out, "bad.xml:2:2: sensor \"S\" is inside a solid"));
  CHECK(contains(bad.out, "1 problem found\n"));
  CHECK(run_simvis({"--check", folder / "none.xml"}).exit_code == 2);
}

TEST_CASE("our own scenes have no problems") {
  for (const char* scene : {"arm/arm.xml", "first/first.xml", "marvin/marvin.xml", "ravon/ravon.xml",
                            "showcase/showcase.xml", "showcase/surfaces.xml"}) {
    CAPTURE(scene);
    CHECK(run_simvis({"--check", std::string(SIMVIS_SOURCE_DIR "/scenes/") + scene}).out == "no problems found\n");
  }
}

}  // namespace
}  // namespace simvis
