// Execution of commands: the places in the graph, and errors.
#include <simvis/scene.h>

#include <doctest/doctest.h>

#include <simvis/pose.h>
#include "simvis/scene_builder.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/stub_part.h"

TEST_SUITE_BEGIN("scenegraph");

namespace simvis {
namespace {

constexpr AttributeSpec kProbeAttributes[] = {
    kRateAttribute,
    {.name = "gain", .kind = AttributeKind::number, .default_value = "1", .text = "a number", .min = 0, .max = 10},
};

// A sensor that measures nothing and stores one number.
class Probe : public Sensor {
 public:
  explicit Probe(const SensorContext& context) : gain(context.attributes.number("gain")) {}
  void plan(const glm::dmat4&, const DrawList&, FramePlan&) override {}
  void collect(const FrameTime&, const FramePlan&, std::span<const PassResult>) override {}
  Measurement measurement() const override { return {}; }
  std::string method() const override { return "none"; }
  double gain;
};

const SensorRegistration kProbe({.name = "probe",
                                 .summary = "for tests",
                                 .attributes = kProbeAttributes,
                                 .create = [](const SensorContext& context) -> std::unique_ptr<Sensor> {
                                   return std::make_unique<Probe>(context);
                                 }});

struct Stage {
  Stage() {
    write_text(folder / "a.stub", "triangle 1");
    write_text(folder / "b.STUB", "warn\ntriangle 2");
  }
  BuiltScene build(std::string_view xml, std::span<const AttributeOverride> overrides = {}) const {
    return build_scene(parse_commands(xml, "s.xml", folder.path()), overrides);
  }
  // The message, with the folder's name left out.
  std::string error(std::string_view xml, std::span<const AttributeOverride> overrides = {}) const {
    std::string message = error_of([&] { build(xml, overrides); });
    const std::string prefix = folder.path().string() + "/";
    for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
    return message;
  }
  TemporaryFolder folder;
};

// "Kind NAME" of the children, in order.
std::string children(const Node& node) {
  static constexpr const char* kKinds[] = {"group",    "separator",  "visual", "switch", "transform",
                                           "material", "visibility", "shape",  "light",  "environment",
                                           "sky",      "point",      "mount"};
  std::string text;
  for (const NodePtr& child : dynamic_cast<const Group&>(node).children()) {
    text += (text.empty() ? "" : ", ") + std::string(kKinds[static_cast<int>(child->kind())]);
    if (!child->name.empty()) text += " " + child->name;
  }
  return text;
}

const Node& child(const Node& node, std::size_t i) { return *dynamic_cast<const Group&>(node).children().at(i); }

TEST_CASE("an empty scene has ROOT and its insertion point") {
  const BuiltScene built = build_scene({});
  CHECK(children(*built.scene.root()) == "point ROOT");
  CHECK(built.scene.has_insertion_point("ROOT"));
  CHECK(built.scene.objects().size() == 1);
}

TEST_CASE("parts are placed directly before their insertion point, in order, with their offset") {
  const Stage stage;
  const BuiltScene built = stage.build(R"(
    <part file="a.stub" name="A" insert_at="ROOT" pose_offset="1 2 3 0 0 90"/>
    <part file="b.STUB" name="B" insert_at="ROOT"/>
    <part file="a.stub" name="C" insert_at="A"/>)");
  const Node& root = *built.scene.root();
  CHECK(children(root) == "separator A, separator B, point ROOT");
  CHECK(children(child(root, 0)) == "transform, separator C, point A, separator");
  CHECK(children(child(root, 1)) == "point B, separator");
  CHECK(dynamic_cast<const Transform&>(child(child(root, 0), 0)).matrix() == matrix_from_degrees({1, 2, 3}, 0, 0, 90));
  // One file is one content object.
  CHECK(&child(child(root, 0), 3) == &child(child(child(root, 0), 1), 1));
  CHECK(built.scene.warnings().size() == 1);
}

TEST_CASE("an element at a part's name precedes the part's content and moves it, with parts that are inserted later") {
  const Stage stage;
  const BuiltScene built = stage.build(R"(
    <part file="a.stub" name="A" insert_at="ROOT"/>
    <element type="pose" name="P" insert_at="A" x="5"/>
    <part file="b.STUB" name="B" insert_at="A"/>
    <sensor type="probe" name="S" insert_at="A" pose_offset="0 0 1 0 0 0" rate="10"/>
    <sensor type="probe" name="T" insert_at="B"/>)");
  const Node& a = child(*built.scene.root(), 0);
  CHECK(children(a) == "transform P, separator B, separator S, point A, separator");
  CHECK(children(child(a, 1)) == "separator T, point B, separator");
  CHECK(children(child(a, 2)) == "transform, mount S");
  CHECK(dynamic_cast<const Transform&>(child(a, 0)).matrix()[3] == glm::dvec4(5, 0, 0, 1));
  REQUIRE(built.sensors.size() == 2);
  CHECK(built.sensors[0].name == "S");
  CHECK(built.sensors[0].type == "probe");
  CHECK(built.sensors[0].sensor->rate_hz == 10);
  CHECK(built.sensors[1].sensor->rate_hz == 0);
  CHECK(built.sensors[0].mount.get() == &child(child(a, 2), 1));
  REQUIRE(built.parameters.elements().size() == 1);
  CHECK(built.parameters.elements()[0].insertion_point == "A");
  CHECK(built.parameters.changes().size() == 5);
  CHECK(built.parameters.changes()[1] == R"(<element type="pose" name="P" insert_at="A" x="5"/>)");
}

TEST_CASE("a file is read once per up axis") {
  const Stage stage;
  stub_imports = 0;
  stage.build("<part file='a.stub' name='A' insert_at='ROOT'/><part file='./a.stub' name='B' insert_at='ROOT'/>");
  CHECK(stub_imports == 1);
  CHECK_FALSE(last_stub_import.up_given);
  stage.build("<part file='a.stub' name='A' insert_at='ROOT'/><part file='a.stub' name='B' insert_at='A' up='y'/>");
  CHECK(stub_imports == 3);
  CHECK(last_stub_import.up_given);
  CHECK(last_stub_import.up == UpAxis::y);
}

TEST_CASE("errors in parts") {
  const Stage stage;
  write_text(stage.folder / "broken.stub", "broken");
  write_text(stage.folder / "x.txt", "");
  CHECK(stage.error("<part file='no.stub' name='A' insert_at='ROOT'/>") ==
        "s.xml:1:7: error: there is no part file \"no.stub\"");
  CHECK(contains(stage.error("<part file='' name='A' insert_at='ROOT'/>"), "is not a file, expected a part file"));
  CHECK(contains(stage.error("<part file='x.txt' name='A' insert_at='ROOT'/>"),
                 "s.xml:1:7: error: part file \"x.txt\" is of an unknown kind, expected one of: "));
  CHECK(contains(stage.error("<part file='x.txt' name='A' insert_at='ROOT'/>"), ".stub"));
  CHECK(stage.error("\n<part file='broken.stub' name='W' insert_at='ROOT'/>") ==
        "s.xml:2:2: error: part W: broken.stub: it is broken");
  CHECK(contains(stage.error("<part file='a.stub' insert_at='ROOT'/>"), "part without attribute \"name\""));
  CHECK(contains(stage.error("<part file='a.stub' name='A'/>"), "part without attribute \"insert_at\""));
  CHECK(contains(stage.error("<part file='a.stub' name='A' insert_at='ROOT' up='x'/>"),
                 "s.xml:1:47: error: attribute \"up\": \"x\" is not allowed, expected one of: y, z"));
  CHECK(contains(stage.error("<part file='a.stub' name='A' insert_at='ROOT' pose_ofset='0'/>"),
                 "s.xml:1:47: error: unknown attribute \"pose_ofset\", did you mean \"pose_offset\"?"));
  CHECK(contains(stage.error("<part file='a.stub' name='A' insert_at='ROOT' pose_offset='0 0'/>"),
                 "expected six finite numbers"));
}

TEST_CASE("names are unique per kind") {
  const Stage stage;
  CHECK(
      stage.error("<part file='a.stub' name='A' insert_at='ROOT'/>\n<part file='a.stub' name='A' insert_at='ROOT'/>") ==
      "s.xml:2:21: error: the name \"A\" is already taken by the part at s.xml:1:21, expected a name that no other "
      "part has");
  CHECK(contains(stage.error("<part file='a.stub' name='ROOT' insert_at='ROOT'/>"), "\"ROOT\" is already taken"));
  CHECK(contains(stage.error("<element type='pose' name='E' insert_at='ROOT'/>\n<element type='pose' name='E' "
                             "insert_at='ROOT'/>"),
                 "s.xml:2:22: error: the name \"E\" is already taken by the element at s.xml:1:22"));
  CHECK(contains(stage.error("<sensor type='probe' name='E' insert_at='ROOT'/>\n<sensor type='probe' name='E' "
                             "insert_at='ROOT'/>"),
                 "s.xml:2:22: error: the name \"E\" is already taken by the sensor at s.xml:1:22"));
  CHECK(stage
            .build("<part file='a.stub' name='A' insert_at='ROOT'/><element type='pose' name='A' insert_at='A'/>"
                   "<sensor type='probe' name='A' insert_at='A'/>")
            .sensors.size() == 1);
}

TEST_CASE("insertion points must exist when the command is executed") {
  const Stage stage;
  CHECK(stage.error("<part file='a.stub' name='ROBOT' insert_at='ROOT'/>\n<sensor type='probe' name='S' "
                    "insert_at='ROBOTT'/>") ==
        "s.xml:2:31: error: there is no insertion point \"ROBOTT\", did you mean \"ROBOT\"? (expected ROOT or the name "
        "of a part inserted before)");
  CHECK(
      stage.error("<element type='pose' name='P' insert_at='A'/>\n<part file='a.stub' name='A' insert_at='ROOT'/>") ==
      "s.xml:1:31: error: there is no insertion point \"A\" yet: its part comes later, at s.xml:2:2, and commands are "
      "executed in order");
  CHECK(contains(stage.error("<part file='a.stub' name='A' insert_at='A'/>"), "there is no insertion point \"A\""));
}

TEST_CASE("errors in elements and sensors") {
  const Stage stage;
  CHECK(contains(stage.error("<element type='pos' name='P' insert_at='ROOT'/>"),
                 "s.xml:1:10: error: unknown element type \"pos\", did you mean \"pose\"? (expected one of: "));
  CHECK(contains(stage.error("<sensor type='prob' name='P' insert_at='ROOT'/>"),
                 "s.xml:1:9: error: unknown sensor type \"prob\", did you mean \"probe\"?"));
  CHECK(contains(stage.error("<element name='P' insert_at='ROOT'/>"), "element without attribute \"type\""));
  CHECK(contains(stage.error("<sensor type='probe' insert_at='ROOT'/>"), "sensor without attribute \"name\""));
  CHECK(contains(stage.error("<sensor type='probe' name='P'/>"), "sensor without attribute \"insert_at\""));
  CHECK(contains(stage.error("<sensor type='probe' name='P' insert_at='ROOT' gian='1'/>"), "did you mean \"gain\"?"));
  CHECK(contains(stage.error("<sensor type='probe' name='P' insert_at='ROOT' rate='-1'/>"),
                 "attribute \"rate\": -1 is not allowed, expected a number greater than 0 (Hz)"));
  CHECK(contains(stage.error("<element type='pose' name='P' insert_at='ROOT' x='nan'/>"),
                 "s.xml:1:48: error: attribute \"x\": \"nan\" is not allowed, expected a number from"));
}

TEST_CASE("commands in a part are executed after it, with their own names for each of several copies") {
  const Stage stage;
  write_text(stage.folder / "robot.stub",
             "<part file='a.stub' name='ARM'/><element type='pose' name='LIFT' insert_at='ARM'/>\n"
             "<sensor type='probe' name='CAM' insert_at='ARM'/>\n<sensor type='probe' name='EYE'/>");
  const BuiltScene built = stage.build(R"(
    <part file="robot.stub" name="R1" insert_at="ROOT"/>
    <part file="robot.stub" name="R2" insert_at="ROOT"/>
    <sensor type="probe" name="TOP" insert_at="R2/ARM"/>)");
  const Node& root = *built.scene.root();
  CHECK(children(child(root, 0)) == "separator R1/ARM, separator R1/EYE, point R1, separator");
  CHECK(children(child(child(root, 0), 0)) == "transform R1/LIFT, separator R1/CAM, point R1/ARM, separator");
  CHECK(children(child(root, 1)) == "separator R2/ARM, separator R2/EYE, point R2, separator");
  CHECK(children(child(child(root, 1), 0)) ==
        "transform R2/LIFT, separator R2/CAM, separator TOP, point R2/ARM, separator");
  CHECK(built.parameters.index("R2/LIFT", "x") == 6);
  CHECK(built.parameters.changes().size() == 11);
}

TEST_CASE("errors in commands of a part name both places") {
  const Stage stage;
  write_text(stage.folder / "self.stub", "<part file='self.stub' name='B'/>");
  CHECK(contains(stage.error("<part file='self.stub' name='A' insert_at='ROOT'/>"),
                 "inserts itself: self.stub > self.stub"));
  write_text(stage.folder / "bad.stub", "<sensor type='probe' name='S'/>\n<sensor type='probe' name='T' gian='1'/>");
  CHECK(stage.error("\n<part file='bad.stub' name='A' insert_at='ROOT'/>") ==
        "s.xml:2:2: error: part A: bad.stub(command 2):1:31: unknown attribute \"gian\", did you mean \"gain\"?");
  write_text(stage.folder / "ok.stub", "<sensor type='probe' name='S'/>");
  for (const std::string name : {"/abs", "..", "a.b"}) {
    CHECK(contains(stage.error("<part file='ok.stub' name='A' insert_at='ROOT'/><part file='ok.stub' name='" + name +
                               "' insert_at='ROOT'/>"),
                   "is not allowed for a part whose file defines names"));
  }
}

TEST_CASE("overrides replace attributes of all sensors of a type, also of those in parts") {
  const Stage stage;
  write_text(stage.folder / "eye.stub", "<sensor type='probe' name='EYE' gain='3'/>");
  const std::string xml =
      "<part file='eye.stub' name='A' insert_at='ROOT'/><sensor type='probe' name='S' "
      "insert_at='ROOT'/>";
  const AttributeOverride gain[] = {{"probe", "gain", "7", "--gain"}};
  const BuiltScene built = stage.build(xml, gain);
  for (const BuiltSensor& sensor : built.sensors) CHECK(dynamic_cast<const Probe&>(*sensor.sensor).gain == 7);
  const AttributeOverride wrong[] = {{"probe", "gain", "70", "--gain"}};
  CHECK(contains(stage.error(xml, wrong),
                 "--gain: attribute \"gain\": 70 is not allowed, expected a number from 0 to 10"));
  const AttributeOverride no_such[] = {{"prob", "gain", "7", ""}};
  CHECK(contains(stage.error(xml, no_such), "prob.gain: error: unknown sensor type \"prob\""));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
