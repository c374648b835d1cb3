// Names of included files: prefixes on what they define, and what their references mean.
#include <doctest/doctest.h>

#include <string>

#include "scenegraph/flattener.h"
#include "simvis/live_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/object_names.h"
#include "tests/support/parts/stub_part.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

constexpr std::string_view kRobot = R"(
  <part name="BODY" file="body.stub" insert_at="ROOT" pose_offset="0 0 1 0 0 0"/>
  <element type="pose" name="MOVE" insert_at="BODY" x="2"/>
  <part name="HAND" shape="sphere" radius="0.1" insert_at="WRIST"/>
  <element type="laser_beams" name="BEAMS" insert_at="BODY" scanner="SCANNER"/>
  <sensor type="laser_scanner" name="SCANNER" insert_at="HAND" samples="3"/>
  <element type="material" name="PAINT" insert_at="BODY" part="BODY" red="0.5"/>
)";

struct IncludeStage {
  IncludeStage() {
    write_text(folder / "body.stub",
               "triangle 1\npoint WRIST\n<element type=\"pose\" name=\"JOINT\" insert_at=\"WRIST\"/>");
    write_text(folder / "robot.xml", kRobot);
  }
  BuiltScene build(std::string_view xml) const { return build_scene(parse_commands(xml, "s.xml", folder.path())); }
  std::string error(std::string_view xml) const {
    return error_of([&] { build(xml); });
  }
  TemporaryFolder folder;
};

std::string element_names(const BuiltScene& built) {
  std::string names;
  for (const ElementDescriptor& element : built.parameters.elements()) {
    names += element.name + " at " + element.insertion_point + ", ";
  }
  for (const BuiltSensor& sensor : built.sensors) names += sensor.name + ", ";
  return names;
}

TEST_CASE("an included file without a prefix equals its text") {
  const IncludeStage stage;
  const BuiltScene included = stage.build("<include file='robot.xml'/>"), inlined = stage.build(kRobot);
  CHECK(included.parameters.changes() == inlined.parameters.changes());
  CHECK(included.parameters.changes().size() == 7);
  CHECK(Flattener(included.scene.root()).update().world_from_node ==
        Flattener(inlined.scene.root()).update().world_from_node);
}

TEST_CASE("a prefix stands before every name that the file and its parts define") {
  const IncludeStage stage;
  const BuiltScene built =
      stage.build("<include file='robot.xml' prefix='A/'/><include file='robot.xml' prefix='B/'/>");
  CHECK(element_names(built) ==
        "A/JOINT at A/WRIST, A/MOVE at A/BODY, A/BEAMS at A/BODY, A/PAINT at A/BODY, "
        "B/JOINT at B/WRIST, B/MOVE at B/BODY, B/BEAMS at B/BODY, B/PAINT at B/BODY, A/SCANNER, B/SCANNER, ");
  CHECK(test::part_names(built.scene) == std::vector<std::string>{"A/BODY", "A/HAND", "B/BODY", "B/HAND"});
  const DrawList list = Flattener(built.scene.root()).update();
  CHECK(list.items.size() == 4);
}

TEST_CASE("prefixes of nested files stand in a row, and names of outer files can be referred to") {
  const IncludeStage stage;
  write_text(stage.folder / "pair.xml",
             "<part name='BASE' insert_at='ROOT'/><include file='robot.xml' prefix='L/' insert_at='BASE'/>"
             "<include file='hat.xml' prefix='HAT/'/>");
  write_text(stage.folder / "hat.xml", "<part name='HAT' insert_at='BASE'/><part name='TOP' insert_at='L/HAND'/>");
  const BuiltScene built = stage.build("<include file='pair.xml' prefix='P/'/>");
  CHECK(test::part_names(built.scene) ==
        std::vector<std::string>{"P/BASE", "P/HAT/HAT", "P/HAT/TOP", "P/L/BODY", "P/L/HAND"});
}

TEST_CASE("insert_at says where ROOT of the file stands") {
  const IncludeStage stage;
  write_text(stage.folder / "lamp.xml", "<part name='LAMP' insert_at='ROOT' shape='sphere' radius='1'/>");
  const BuiltScene built = stage.build(R"(<part name="LAMP" insert_at="ROOT" pose_offset="5 0 0 0 0 0"/>
    <include file="lamp.xml" prefix="A/" insert_at="LAMP"/><include file="lamp.xml" prefix="B/"/>)");
  CHECK(built.scene.world_from_point("A/LAMP").value()[3] == glm::dvec4(5, 0, 0, 1));
  CHECK(built.scene.world_from_point("B/LAMP").value()[3] == glm::dvec4(0, 0, 0, 1));
  CHECK(contains(stage.error("<include file='lamp.xml' insert_at='LAPM'/>"),
                 "s.xml:1:26: error: there is no insertion point \"LAPM\""));
}

TEST_CASE("names of an included file do not mean those of another one") {
  const IncludeStage stage;
  write_text(stage.folder / "hand.xml", "<part name='X' insert_at='WRIST'/>");
  const std::string error =
      stage.error("<include file='robot.xml' prefix='A/'/><include file='hand.xml' prefix='B/'/>");
  CHECK(contains(error, "hand.xml:1:16: error: there is no insertion point \"WRIST\""));
  CHECK(contains(error, "(included from s.xml:1:41)"));
  CHECK(
      contains(stage.error("<include file='robot.xml'/><include file='robot.xml'/>"), "is already taken by the part"));
  write_text(stage.folder / "late.xml", "<part name='X' insert_at='Y'/><part name='Y' insert_at='ROOT'/>");
  CHECK(contains(stage.error("<include file='late.xml' prefix='A/'/>"), "yet: its part comes later"));
}

}  // namespace
}  // namespace simvis
