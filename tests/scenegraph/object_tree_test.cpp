// The tree of a scene's objects: names, paths, patterns, and what attributes of commands make of them.
#include <simvis/object_tree.h>

#include <doctest/doctest.h>

#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "simvis/built_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/temporary_folder.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis::test {
namespace {

using Names = std::vector<std::string>;

Names names_of_objects(const ObjectTree& tree, const std::vector<std::uint32_t>& objects) {
  Names names;
  for (const std::uint32_t object : objects) names.push_back(tree[object].name);
  return names;
}

// Two robots of one file, whose names have prefixes; a tool at the hand of the second one; a chair with a named place.
ObjectTree robots() {
  ObjectTree tree;
  for (const std::string robot : {"R1", "R2"}) {
    const std::uint32_t part = tree.add(robot, ObjectKind::part, 0);
    const std::uint32_t model = tree.add(robot + "/arm", ObjectKind::model, part);
    const std::uint32_t hand = tree.add(robot + "/arm/hand", ObjectKind::link, model);
    tree.add(robot + "/grip", ObjectKind::frame, hand);
    tree.add(robot + "/base", ObjectKind::link, part);
  }
  const std::uint32_t tool = tree.add("TOOL", ObjectKind::part, *tree.find("R2/arm/hand"));
  tree.add("blade", ObjectKind::link, tool);
  const std::uint32_t chair = tree.add("CHAIR", ObjectKind::part, 0);
  tree.add("CHAIR/seat", ObjectKind::part, chair);
  return tree;
}

TEST_CASE("objects have paths from the part at ROOT down, and are found by name or path") {
  const ObjectTree tree = robots();
  CHECK(tree[0].name == "ROOT");
  CHECK(tree[0].kind == ObjectKind::world);
  CHECK(tree[0].parent == kNoObject);
  for (const auto& [object, path] :
       std::vector<std::pair<std::string, std::string>>{{"R1", "R1"},
                                                        {"R1/arm/hand", "R1/arm/hand"},
                                                        {"R1/grip", "R1/arm/hand/grip"},
                                                        {"R2/base", "R2/base"},
                                                        {"TOOL", "R2/arm/hand/TOOL"},
                                                        {"blade", "R2/arm/hand/TOOL/blade"},
                                                        {"CHAIR/seat", "CHAIR/seat"}}) {
    const std::string name = object;
    CAPTURE(name);
    REQUIRE(tree.find(name));
    CHECK(tree[*tree.find(name)].path == path);
    CHECK(tree.find(path) == tree.find(name));
  }
  CHECK_FALSE(tree.find("hand"));
  CHECK(tree[tree[*tree.find("blade")].part].name == "TOOL");
  CHECK(tree[tree[*tree.find("R1/grip")].part].name == "R1");
  for (std::uint32_t i = 1; i < tree.size(); ++i) CHECK(tree[i].parent < i);
}

TEST_CASE("a pattern names objects by their names, or by their paths if no name matches, and ROOT never") {
  const ObjectTree tree = robots();
  CHECK(names_of_objects(tree, tree.matching("R?")) == Names{"R1", "R2"});
  CHECK(names_of_objects(tree, tree.matching("*hand")) == Names{"R1/arm/hand", "R2/arm/hand"});
  CHECK(names_of_objects(tree, tree.matching("R2/arm/hand/*")) == Names{"R2/grip", "TOOL", "blade"});  // by paths
  CHECK(names_of_objects(tree, tree.matching("R[2]")) == Names{"R2"});
  CHECK(tree.matching("*").size() == tree.size() - 1);
  CHECK(tree.matching("ROOT").empty());
  Names unknown;
  CHECK(names_of_objects(tree, tree.named("TOOL R?/base SOFA CHAIR", unknown)) ==
        Names{"CHAIR", "R1/base", "R2/base", "TOOL"});
  CHECK(unknown == Names{"SOFA"});
  ObjectTree spaced;
  spaced.add("my chair", ObjectKind::part, 0);
  spaced.add("chair", ObjectKind::part, 0);
  unknown.clear();
  CHECK(names_of_objects(spaced, spaced.named("my chair", unknown)) == Names{"my chair"});
  CHECK(unknown.empty());
}

TEST_CASE("a part and a model have the content of their file, and links and places stand for themselves") {
  const ObjectTree tree = robots();
  const auto content = [&](const char* name) { return names_of_objects(tree, tree.content_of(*tree.find(name))); };
  CHECK(content("R2") == Names{"R2", "R2/arm", "R2/arm/hand", "R2/grip", "R2/base"});
  CHECK(content("R2/arm") == Names{"R2/arm", "R2/arm/hand", "R2/grip"});
  CHECK(content("R2/arm/hand") == Names{"R2/arm/hand"});
  CHECK(content("CHAIR") == Names{"CHAIR"});  // what stands on it is no content
}

TEST_CASE("the message about an unknown name has the nearest name or path") {
  const ObjectTree tree = robots();
  CHECK(tree.unknown("part or link", "CHIAR") == "there is no part or link \"CHIAR\", did you mean \"CHAIR\"?");
  CHECK(tree.unknown("part", "R2/arm/hand/TOL") ==
        "there is no part \"R2/arm/hand/TOL\", did you mean "
        "\"R2/arm/hand/TOOL\"?");
  CHECK(tree.unknown("part", "xxxxxxxxxxxx") == "there is no part \"xxxxxxxxxxxx\"");
}

std::string object_box(const std::string& name, const std::string& at = "ROOT") {
  return "<part name='" + name + "' insert_at='" + at + "' shape='box' size='1 1 1'/>";
}

const std::string kArm = R"(<robot name="r"><link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual>
  </link><link name="hand"/><joint name="j" type="fixed"><parent link="base"/><child link="hand"/></joint></robot>)";

TEST_CASE("the tree follows insertions, removals and failures") {
  Simulation simulation = Simulation::from_string("<simvis>" + object_box("A") + object_box("B", "A") + "</simvis>");
  const auto paths = [&] {
    Names all;
    for (const Object& object : built_scene(simulation).scene.objects().all()) all.push_back(object.path);
    return all;
  };
  CHECK(paths() == Names{"ROOT", "A", "A/B"});
  simulation.execute(object_box("C", "A/B"));  // a path
  CHECK(paths() == Names{"ROOT", "A", "A/B", "A/B/C"});
  CHECK_THROWS_AS(simulation.execute(object_box("D") + object_box("E", "NOWHERE")), InputError);
  CHECK(paths() == Names{"ROOT", "A", "A/B", "A/B/C"});
  simulation.execute("<remove name='B'/>");
  CHECK(paths() == Names{"ROOT", "A"});
}

// Attributes that name objects, by their kind in the tables.
TEST_CASE("attributes take names and paths alike, and have one message for what they do not find") {
  const TemporaryFolder folder;
  write_text(folder / "r.urdf", kArm);
  const std::string parts = "<part name='ROBOT' insert_at='ROOT' file='r.urdf'/>" + object_box("CUP", "hand");
  const auto error = [&](const std::string& command) {
    return error_of([&] { Simulation::from_string("<simvis>" + parts + command + "</simvis>", {}, folder.path()); });
  };
  const std::vector<std::string> commands = {
      "<element type='label' name='L' insert_at='ROOT' part='@' class='c' class_id='1'/>",
      "<element type='label' name='L' insert_at='ROOT' parts='@' class='c' class_id='1'/>",
      "<element type='temperature' name='T' insert_at='ROOT' part='@'/>",
      "<element type='temperature' name='T' insert_at='ROOT' parts='@'/>",
      "<element type='trail' name='T' insert_at='ROOT' part='@'/>",
      "<element type='pose' name='T' insert_at='@'/>",
      "<part name='P' insert_at='@'/>",
      "<sensor type='camera' name='C' insert_at='ROOT' pose_offset='9 9 9' look_at='@'/>",
      "<sensor type='bumper' name='B' insert_at='ROOT' part='@'/>",
      "<sensor type='bumper' name='B' insert_at='CUP' ignore='@'/>",
      "<sensor type='joint_state' name='J' insert_at='ROOT' part='@'/>",
      "<sensor type='contact' name='K' insert_at='ROOT' part='@' without_physics='nothing'/>"};
  for (const std::string& command : commands) {
    const auto naming = [&](const std::string& name) {
      std::string text = command;
      return text.replace(text.find('@'), 1, name);
    };
    CAPTURE(command);
    for (const char* const name : {"CUP", "ROBOT/hand/CUP", "base", "ROBOT/base"})
      CHECK(error(naming(name)) == "nothing was thrown");
    CHECK(contains(error(naming("COP")), "there is no "));
    CHECK(contains(error(naming("COP")), "\"COP\", did you mean \"CUP\"?"));
  }
}

TEST_CASE("patterns of sensors that match nothing are warnings, and errors of a strict scene") {
  const std::string point = object_box("POST");
  const std::vector<std::string> commands = {
      "<sensor type='beacon' name='S' insert_at='ROOT' beacons='@'/>",
      "<sensor type='keypoints' name='S' insert_at='ROOT' points='@'/>",
      "<sensor type='radar' name='S' insert_at='ROOT' cross_sections='@:1'/>",
      "<sensor type='laser_scanner' name='S' insert_at='ROOT' sweep='0.1' crosstalk='@'/>"};
  for (const std::string& command : commands) {
    CAPTURE(command);
    const auto scene = [&](const std::string& name) {
      std::string text = command;
      return "<simvis>" + point + text.replace(text.find('@'), 1, name) + "</simvis>";
    };
    CHECK(Simulation::from_string(scene("POST")).warnings().empty());
    const Simulation unknown = Simulation::from_string(scene("PST"));
    REQUIRE(unknown.warnings().size() == 1);
    CHECK(contains(unknown.warnings()[0], "sensor \"S\": there is no part or link \"PST\", did you mean \"POST\"?"));
    SimulationDesc strict;
    strict.strict = true;
    CHECK(
        contains(error_of([&] { Simulation::from_string(scene("PST"), strict); }), "there is no part or link \"PST\""));
  }
}

TEST_CASE("patterns in an included file mean its own objects where any match") {
  const TemporaryFolder folder;
  write_text(folder / "room.xml",
             "<simvis>" + object_box("CHAIR_1") + object_box("CHAIR_2") +
                 "<element type='label' name='L' insert_at='ROOT' parts='CHAIR_*' class='chair' class_id='62'/>"
                 "</simvis>");
  const Simulation simulation = Simulation::from_string(
      "<simvis>" + object_box("CHAIR_1") + "<include file='room.xml' prefix='ROOM/'/></simvis>", {}, folder.path());
  Names labelled;
  for (const SceneObject& object : simulation.objects()) {
    if (object.semantic == 62) labelled.push_back(object.path);
  }
  CHECK(labelled == Names{"ROOM/CHAIR_1", "ROOM/CHAIR_2"});
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
