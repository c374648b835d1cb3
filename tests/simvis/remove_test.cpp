// `remove`: what it takes out, what it refuses, and that nothing of the removed is left.
#include <doctest/doctest.h>

#include <map>
#include <string>

#include "scenegraph/flattener.h"
#include "simvis/live_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/object_names.h"
#include "tests/support/parts/stub_part.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

struct Removal {
  explicit Removal(const std::string& xml) {
    write_text(folder / "arm.stub", "triangle 2\npoint HAND\n<element type='joint' name='TILT' insert_at='HAND'/>");
    scene.emplace(std::vector<AttributeOverride>{}, parse(xml));
    people.emplace(scene->built.scene.root(), Audience::people);
  }
  std::vector<Command> parse(const std::string& xml) const { return parse_commands(xml, "s.xml", folder.path()); }
  void execute(const std::string& xml) { scene->execute(parse(xml)); }
  std::string refusal(const std::string& xml) {
    return error_of([&] { execute(xml); });
  }
  Parameters& parameters() { return scene->built.parameters; }
  void set(const char* element, const char* parameter, double value) {
    parameters().set(parameters().index(element, parameter), value);
    for (const std::size_t i : parameters().drain_changed_elements()) {
      const ElementDescriptor& changed = parameters().elements()[i];
      scene->built.elements[i]->update(parameters().values().subspan(changed.first_value, changed.parameters.size()));
    }
  }
  TemporaryFolder folder;
  std::optional<LiveScene> scene;
  std::optional<Flattener> people;
};

constexpr const char* kBox = "<part shape='box' size='1 1 1' name='BOX' insert_at='ROOT'/>";
constexpr const char* kBall = "<part shape='sphere' radius='1' name='BALL' insert_at='ROOT'/>";

/// The draw list, for people, of a scene made of these commands.
std::uint64_t hash_of(const std::string& xml) {
  Removal other(xml);
  return content_hash(other.people->update());
}

}  // namespace

TEST_CASE("remove: a part goes with everything that hangs on it, and its names are free") {
  const std::string rest = std::string(kBox) + "<sensor type='camera' name='CAM' insert_at='BOX'/>";
  Removal test(rest +
               "<part file='arm.stub' name='ARM' insert_at='BOX'/>"
               "<part shape='box' size='1 2 3' name='CUP' insert_at='HAND'/>"
               "<element type='pose' name='CUP_POSE' insert_at='CUP'/>"
               "<sensor type='laser_scanner' name='SCAN' insert_at='CUP'/>"
               "<element type='laser_beams' name='BEAMS' insert_at='CUP' scanner='SCAN'/>");
  const std::size_t values = test.parameters().values().size();
  std::weak_ptr<const Mesh> cup;
  for (const auto& mesh : test.people->update().meshes) {
    if (mesh->bounds_max.z == 1.5f) cup = mesh;
  }
  CHECK_FALSE(cup.expired());
  test.execute("<remove name='ARM'/>");
  CHECK(content_hash(test.people->update()) == hash_of(rest));
  CHECK(cup.expired());
  BuiltScene& built = test.scene->built;
  CHECK(built.sensors.size() == 1);
  CHECK(built.sensors[0].name == "CAM");
  for (const ElementDescriptor& element : built.parameters.elements()) CHECK(element.removed);
  for (const auto& element : built.elements) CHECK(element == nullptr);
  CHECK(built.parameters.values().size() == values);  // ids stay
  CHECK_THROWS_AS(built.parameters.set(0, 1), InputError);
  CHECK(test::part_names(built.scene) == std::vector<std::string>{"BOX"});
  CHECK_FALSE(built.scene.has_insertion_point("HAND"));
  // The only arm of the scene needs no prefix, and new elements have new ids.
  test.execute("<part file='arm.stub' name='ARM' insert_at='BOX'/>");
  CHECK(built.parameters.index("TILT", "value") == values);
}

TEST_CASE("remove: the log has a command for each thing that went, the last one first") {
  Removal test("<part file='arm.stub' name='ARM' insert_at='ROOT'/>");
  test.execute("<part file='arm.stub' name='B' insert_at='ROOT'/><remove name='ARM'/>");
  const std::vector<std::string>& log = test.parameters().changes();
  REQUIRE(log.size() == 6);
  const std::string file = (test.folder / "arm.stub").string();
  CHECK(log[0] == "<part file=\"" + file + "\" name=\"ARM\" insert_at=\"ROOT\" logged_prefix=\"\"/>");
  CHECK(log[2] == "<part file=\"" + file + "\" name=\"B\" insert_at=\"ROOT\" logged_prefix=\"B/\"/>");
  CHECK(log[3] == R"(<element type="joint" name="B/TILT" insert_at="B/HAND"/>)");
  CHECK(log[4] == R"(<remove name="TILT" kind="element"/>)");
  CHECK(log[5] == R"(<remove name="ARM" kind="part"/>)");
}

TEST_CASE("remove: an element leaves what it changed as it was before") {
  const std::string base = std::string(kBox) + kBall +
                           "<part file='arm.stub' name='ARM' insert_at='ROOT'/>"
                           "<element type='light' name='LIGHT' insert_at='ROOT' kind='point'/>"
                           "<element type='joint' name='LEADER' insert_at='BOX' value='20'/>";
  const std::uint64_t before = hash_of(base);
  const char* const elements[] = {
      "<element type='material' name='E' insert_at='ROOT' part='ARM' red='0.5'/>",
      "<element type='material' name='E' insert_at='ROOT' part='BALL' red='0.25' fixed_opacity='0.5'/>",
      "<element type='color_temperature' name='E' insert_at='ROOT' light='LIGHT' kelvin='3000'/>",
      "<element type='mimic_joint' name='E' insert_at='BALL' leader='LEADER'/>",
      "<element type='trail' name='E' insert_at='ROOT' part='BALL'/>",
      "<element type='pose' name='E' insert_at='BALL' x='3'/>",
      "<element type='fog' name='E' insert_at='ROOT' visibility='100'/>",
      "<element type='light' name='E' insert_at='ROOT' kind='point'/>",
  };
  for (const char* const element : elements) {
    CAPTURE(element);
    const std::uint64_t with = hash_of(base + element);
    Removal test(base + element);
    test.execute("<remove name='E'/>");
    CHECK(content_hash(test.people->update()) == before);
    test.set("LEADER", "value", 30);  // calls no element that is gone
    test.set("LEADER", "value", 20);
    // A request that fails later puts it back as it was, and it goes on working.
    test.execute(element);
    CHECK(content_hash(test.people->update()) == with);
    CHECK_FALSE(test.refusal("<remove name='E'/><remove name='BOX'/><remove name='NONE'/>").empty());
    CHECK(content_hash(test.people->update()) == with);
    test.execute("<remove name='E'/>");
    CHECK(content_hash(test.people->update()) == before);
  }
}

TEST_CASE("remove: two changes of one part are independent") {
  const std::string red = "<element type='material' name='RED' insert_at='ROOT' part='BOX' red='0.5'/>";
  const std::string blue = "<element type='material' name='BLUE' insert_at='ROOT' part='BOX' blue='0.5'/>";
  Removal test(kBox + red + blue);
  test.execute("<remove name='RED'/>");
  CHECK(content_hash(test.people->update()) == hash_of(kBox + blue));
  test.set("BLUE", "blue", 0.25);
  CHECK(test.people->update().materials.at(0)->base_color.b == 0.25f);
  test.execute(red);
  test.execute("<remove name='BLUE'/>");
  CHECK(content_hash(test.people->update()) == hash_of(kBox + red));
}

TEST_CASE("remove: what something else refers to stays, and so do ROOT and what is in a file") {
  Removal test(std::string(kBox) +
               "<part file='arm.stub' name='ARM' insert_at='ROOT'/>"
               "<element type='material' name='PAINT' insert_at='ROOT' part='BOX'/>"
               "<element type='joint' name='LEADER' insert_at='ARM'/>"
               "<element type='mimic_joint' name='FOLLOWER' insert_at='ROOT' leader='LEADER'/>"
               "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT'/>"
               "<element type='point_cloud' name='CLOUD' insert_at='ROOT' scanner='SCAN'/>"
               "<part name='SCAN' insert_at='ROOT'/>");
  const std::uint64_t before = content_hash(test.people->update());
  const std::pair<const char*, const char*> refused[] = {
      {"<remove name='BOX'/>", "s.xml:1:9: error: element \"PAINT\" refers to part \"BOX\" as its \"part\""},
      {"<remove name='ARM'/>", "element \"FOLLOWER\" refers to element \"LEADER\" as its \"leader\""},
      {"<remove name='SCAN'/>", "\"SCAN\" is the name of sensor and of part"},
      {"<remove name='SCAN' kind='sensor'/>", "element \"CLOUD\" refers to sensor \"SCAN\" as its \"scanner\""},
      {"<remove name='ROOT'/>", "\"ROOT\" is always there"},
      {"<remove name='HAND'/>", "\"HAND\" stands in the file of a part"},
      {"<remove name='BOXX'/>", "there is nothing of the name \"BOXX\", did you mean \"BOX\"?"},
      {"<remove name='BOX' kind='sensor'/>", "there is nothing of the name \"BOX\""},
      {"<remove name='BOX' type='part'/>", "unknown attribute \"type\""},
      {"<remove/>", "remove without attribute \"name\""},
  };
  for (const auto& [xml, why] : refused) {
    CAPTURE(xml);
    const std::string error = test.refusal(xml);
    CHECK_MESSAGE(contains(error, why), error);
    CHECK(content_hash(test.people->update()) == before);
  }
  test.execute(
      "<remove name='FOLLOWER'/><remove name='ARM'/><remove name='CLOUD'/><remove name='SCAN' kind='sensor'/>");
  CHECK(test.scene->built.sensors.empty());
  write_text(test.folder / "eraser.stub", "<remove name='BOX'/>");
  CHECK(contains(test.refusal("<part file='eraser.stub' name='X' insert_at='ROOT'/>"), "cannot remove anything"));
}

TEST_CASE("remove: a part stays while something refers to what is in its file, by name or by path") {
  for (const auto& [name, object] : std::map<std::string, std::string>{
           {"ARM", "part \"ARM\""}, {"HAND", "frame \"HAND\""}, {"ARM/HAND", "frame \"HAND\""}}) {
    INFO(name);
    Removal test("<part file='arm.stub' name='ARM' insert_at='ROOT'/>");
    test.execute("<element type='trail' name='TRAIL' insert_at='ROOT' part='" + name + "'/>");
    const std::string error = test.refusal("<remove name='ARM'/>");
    CHECK_MESSAGE(contains(error, "element \"TRAIL\" refers to " + object + " as its \"part\""), error);
    test.execute("<remove name='TRAIL'/><remove name='ARM'/>");
    CHECK(simvis::test::part_names(test.scene->built.scene).empty());
  }
}

TEST_CASE(
    "remove: what a part's file has inserted elsewhere goes with the part; included files remove by their names") {
  Removal test("");
  write_text(test.folder / "lamp.stub", "<element type='pose' name='FAR' insert_at='ROOT'/>");
  test.execute("<part file='lamp.stub' name='LAMP' insert_at='ROOT'/><remove name='LAMP'/>");
  CHECK(test.parameters().elements()[0].removed);
  write_text(test.folder / "inner.xml", std::string(kBox) + "<remove name='BOX'/>");
  test.execute(std::string(kBox) + "<include file='inner.xml' prefix='A/'/>");
  CHECK(simvis::test::part_names(test.scene->built.scene) == std::vector<std::string>{"BOX"});
}

}  // namespace simvis

TEST_SUITE_END();
