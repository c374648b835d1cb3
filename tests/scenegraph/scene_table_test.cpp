// items.csv: which part and mesh the items are that scans name.
#include "program/output/scene_table.h"

#include <doctest/doctest.h>

#include <map>
#include <set>
#include <string>

#include <simvis/simulation.h>
#include "tests/support/error_of.h"
#include "tests/support/simvis_run.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

const std::string kItemScene = R"(<simvis>
  <part name="WALL" insert_at="ROOT" shape="box" size="0.1 8 2" pose_offset="5 0 0 0 0 0"/>
  <part name="BALL" insert_at="WALL" shape="sphere" radius="0.5" pose_offset="-3 0 0 0 0 0"/>
  <element type="visibility" name="SHOW" insert_at="BALL"/>
  <part name="ON_BALL" insert_at="BALL" shape="box" size="0.1 0.1 0.1" pose_offset="0 0 2 0 0 0"/>
  <sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="31" truth="hit"/>
</simvis>)";

TEST_CASE("the items have the names of their parts, and the file has them once, also where one is hidden later") {
  const TemporaryFolder folder;
  write_text(folder / "s.xml", kItemScene);
  write_text(folder / "t.csv", "time_s,SHOW.visible\n0,1\n0.1,1\n0.101,0\n0.2,0\n");
  const ProcessResult run = run_simvis({folder / "s.xml", "--out", folder / "out", "--trajectory", folder / "t.csv",
                                        "--frames", "4", "--rate", "20", "--quiet"});
  REQUIRE(run.exit_code == 0);
  const Table items = read_csv(folder / "out/items.csv");
  CHECK(items.columns == Strings{"frame", "item", "part", "mesh", "triangles"});
  std::set<std::string> frames;
  std::map<std::string, Strings> of_first;
  for (const Strings& row : items.rows) {
    frames.insert(row[0]);
    if (row[0] == "0") of_first[row[1]] = row;
  }
  CHECK(frames == std::set<std::string>{"0"});
  REQUIRE(of_first.size() == 3);
  std::map<std::string, std::set<std::string>> hit;  // by frame
  for (const Strings& row : read_csv(folder / "out/SCAN.csv").rows) {
    if (row[11].empty()) continue;
    const Strings& item = of_first.at(row[11]);
    hit[row[0]].insert(item[2] + " " + item[3]);
    CHECK(std::stoul(row[12]) < std::stoul(item[4]));
  }
  CHECK(hit["0"] == std::set<std::string>{"WALL box", "BALL sphere"});
  CHECK(hit["3"] == std::set<std::string>{"WALL box"});
  CHECK(contains(read_text(folder / "out/run.json"), "\"items.csv\""));
}

TEST_CASE("a run whose scans name no items writes no list of them") {
  const TemporaryFolder folder;
  write_text(folder / "s.xml",
             "<simvis><part name='A' insert_at='ROOT' shape='sphere' radius='2'/>"
             "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='3'/></simvis>");
  REQUIRE(run_simvis({folder / "s.xml", "--out", folder / "out", "--quiet"}).exit_code == 0);
  CHECK_FALSE(std::filesystem::exists(folder / "out/items.csv"));
}

TEST_CASE("the API gives the same items") {
  auto simulation = Simulation::from_string(kItemScene);
  const std::vector<SceneItem> items = simulation.items();
  simulation.step();
  CHECK(simulation.items() == items);
  REQUIRE(items.size() == 3);
  std::set<std::string> parts;
  for (const SceneItem& item : items) parts.insert(item.part);
  CHECK(parts == std::set<std::string>{"WALL", "BALL", "ON_BALL"});
  const double item = simulation.scan("SCAN").channel("true_item")->values[15];
  CHECK(items.at(static_cast<std::size_t>(item)).part == "BALL");
}

TEST_CASE("a resumed file goes on as if it had not been interrupted, and names are quoted") {
  const TemporaryFolder folder;
  const std::vector<SceneItem> items = {{"A,1", "say \"x\"", 3}, {"B", "", 0}};
  const std::vector<std::string> first = item_lines(items), second = item_lines(std::span(items).subspan(1));
  {
    SceneTableFile whole(kItemTable, folder / "whole.csv"), broken(kItemTable, folder / "broken.csv");
    for (std::uint64_t frame = 0; frame < 6; ++frame) {
      whole.append(frame, frame < 4 ? first : second);
      broken.append(frame, frame < 4 ? first : second);
    }
  }
  for (const std::uint64_t frame : {std::uint64_t{2}, std::uint64_t{5}}) {
    SceneTableFile resumed(kItemTable, folder / "broken.csv", frame);
    for (std::uint64_t next = frame; next < 6; ++next) resumed.append(next, next < 4 ? first : second);
  }
  const std::string text = read_text(folder / "whole.csv");
  CHECK(text == "frame,item,part,mesh,triangles\n0,0,\"A,1\",\"say \"\"x\"\"\",3\n0,1,B,,0\n4,0,B,,0\n");
  CHECK(read_text(folder / "broken.csv") == text);
}

TEST_CASE("the tables of objects and shapes have the ids, the classes and the parents") {
  const TemporaryFolder folder;
  const std::vector<SceneItem> items = {
      {.part = "A", .mesh = "m", .triangles = 3, .instance = 4000000000, .semantic = 7, .label = "a, b", .shape = 8},
      {.part = "B", .mesh = "", .instance = 5, .shape = 5}};
  std::vector<SceneObject> objects(3);
  objects[0] = {.instance = 4000000000, .name = "A", .path = "A", .semantic = 7, .label = "a, b"};
  objects[1] = {.instance = 5, .parent = 4000000000, .name = "B", .path = "A/B", .kind = ObjectKind::link};
  objects[2] = {.instance = 6, .parent = 5, .name = "C", .path = "A/B/C", .kind = ObjectKind::frame};  // no surface
  {
    SceneTableFile object_file(kObjectTable, folder / "objects.csv"), shape_file(kShapeTable, folder / "shapes.csv");
    for (const std::uint64_t frame : {0, 1}) {
      object_file.append(frame, object_lines(objects));
      shape_file.append(frame, shape_lines(items));
    }
  }
  CHECK(read_text(folder / "objects.csv") ==
        "frame,instance,object,parent,kind,semantic,class\n0,4000000000,A,0,part,7,\"a, b\"\n"
        "0,5,A/B,4000000000,link,0,\n");
  CHECK(read_text(folder / "shapes.csv") ==
        "frame,shape,instance,part,mesh,semantic,class\n0,8,4000000000,A,m,7,\"a, b\"\n0,5,5,B,,0,\n");
}

}  // namespace
}  // namespace simvis
