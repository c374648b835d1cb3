// A running scene executes commands completely or not at all; own parts; names within parts; references.
#include "simvis/live_scene.h"

#include <doctest/doctest.h>

#include "scenegraph/clone_graph.h"
#include "scenegraph/flattener.h"
#include "scenegraph/same_graph.h"
#include "tests/support/error_of.h"
#include "tests/support/parts/stub_part.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

constexpr AttributeSpec kPainterAttributes[] = {
    {.name = "part", .kind = AttributeKind::part, .text = "which part it paints"},
    {.name = "after", .kind = AttributeKind::element, .text = "an element before it"},
    {.name = "watch", .kind = AttributeKind::sensor, .text = "a scanner"},
    {.name = "red", .default_value = "0.5", .text = "how red", .min = 0, .max = 1, .live = true},
};

// Paints the shapes of one part, and adds one parameter to its table.
class Painter : public Element {
 public:
  explicit Painter(const ElementContext& context) {
    const OwnPart part = context.scene.own_part(context.attributes.text("part"), context.attributes.where("part"));
    for (const NodePtr& node : nodes_of(part.root)) {
      if (node->kind() == NodeKind::material) materials_.push_back(std::static_pointer_cast<MaterialNode>(node));
    }
    if (context.attributes.is_set("after")) before = context.find_element(context.attributes.text("after"));
  }
  void adapt_parameters(std::vector<AttributeSpec>& rows) const override {
    rows.push_back({.name = "green", .default_value = "0.25", .text = "how green", .min = 0, .max = 1, .live = true});
  }
  void update(ParameterView values) override {
    for (const auto& node : materials_) {
      Material material = *node->material();
      material.base_color = glm::vec4(values[0], values[1], 0, 1);
      node->set_material(std::make_shared<const Material>(material));
    }
  }
  Element* before = nullptr;

 private:
  std::vector<std::shared_ptr<MaterialNode>> materials_;
};

const ElementRegistration kPainter({.name = "painter",
                                    .summary = "for tests",
                                    .attributes = kPainterAttributes,
                                    .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
                                      return std::make_unique<Painter>(context);
                                    }});

struct LiveStage {
  LiveStage() {
    write_text(folder / "table.stub", "triangle 1");
    write_text(folder / "copy.stub", "triangle 1");
    write_text(folder / "arm.stub", "triangle 2\npoint HAND\n<element type='joint' name='TILT' insert_at='HAND'/>");
  }
  std::vector<Command> parse(std::string_view xml) const { return parse_commands(xml, "s.xml", folder.path()); }
  LiveScene scene(std::string_view xml) const { return LiveScene({}, parse(xml)); }
  TemporaryFolder folder;
};

constexpr const char* kTwoTables =
    "<part file='table.stub' name='A' insert_at='ROOT'/><part file='table.stub' name='B' insert_at='ROOT'/>";

double red_of(const DrawList& list, std::size_t item) {
  return list.materials[list.items[item].material]->base_color.r;
}

}  // namespace

TEST_CASE("an element changes the named part and no other one of the same file") {
  const LiveStage stage;
  LiveScene scene({}, stage.parse(std::string(kTwoTables) +
                                  "<element type='painter' name='P' insert_at='ROOT' part='A' red='1'/>"));
  Flattener flattener(scene.built.scene.root());
  const DrawList& list = flattener.update();
  REQUIRE(list.items.size() == 2);
  CHECK(red_of(list, 0) == 1);
  CHECK(red_of(list, 1) == 0.5);  // the file's grey
  CHECK(list.items[0].mesh == list.items[1].mesh);
}

TEST_CASE("rows that an element adds are parameters that start with their default") {
  const LiveStage stage;
  LiveScene scene(
      {}, stage.parse(std::string(kTwoTables) + "<element type='painter' name='P' insert_at='ROOT' part='A'/>"));
  Parameters& parameters = scene.built.parameters;
  REQUIRE(parameters.elements()[0].parameters.size() == 2);
  const std::size_t green = parameters.index("P", "green");
  CHECK(parameters.values()[green] == 0.25);
  CHECK(contains(error_of([&] { parameters.set(green, 2); }), "P.green: 2 is not allowed"));
}

TEST_CASE("unknown names of parts, elements and sensors are errors at their place") {
  const LiveStage stage;
  const std::string start = kTwoTables;
  const auto error = [&](const std::string& painter) {
    return error_of(
        [&] { LiveScene scene({}, stage.parse(start + "\n<element type='painter' insert_at='ROOT' " + painter)); });
  };
  CHECK(contains(error("name='P' part='C'/>"), "s.xml:2:51: error: there is no part \"C\""));
  CHECK(contains(error("name='P' part=' '/>"), "expected the name of a part"));
  CHECK(contains(error("name='P' part='A' after='Q'/>"), "there is no element \"Q\""));
  CHECK(contains(error("name='P' part='A' watch='LASER'/>"), "there is no sensor \"LASER\" that gives scans"));
  CHECK(contains(error("name='P' part='A' watch='CAM'/><sensor type='camera' name='CAM' insert_at='ROOT'/>"),
                 "there is no sensor \"CAM\" that gives scans"));
  // A scanner may be declared later.
  CHECK(error("name='P' part='A' watch='LASER'/><sensor type='laser_scanner' name='LASER' insert_at='ROOT'/>") ==
        "nothing was thrown");
  // An element finds the scanner that it names.
  LiveScene scene({}, stage.parse(start + "<element type='pose' name='Q' insert_at='A'/>"
                                          "<element type='painter' name='P' insert_at='ROOT' part='A' after='Q'/>"));
  CHECK(dynamic_cast<const Painter&>(*scene.built.elements[1]).before == scene.built.elements[0].get());
}

TEST_CASE("insertion points within a part take commands; of two copies, their names have the part's name in front") {
  const LiveStage stage;
  LiveScene scene({}, stage.parse("<part file='arm.stub' name='L' insert_at='ROOT'/>"
                                  "<part file='arm.stub' name='R' insert_at='ROOT' pose_offset='0 5 0 0 0 0'/>"
                                  "<part file='table.stub' name='IN_LEFT' insert_at='L/HAND'/>"
                                  "<part file='table.stub' name='IN_RIGHT' insert_at='R/HAND'/>"));
  Parameters& parameters = scene.built.parameters;
  REQUIRE(parameters.elements().size() == 2);
  CHECK(parameters.elements()[0].name == "L/TILT");
  CHECK(parameters.elements()[1].name == "R/TILT");
  CHECK(parameters.elements()[1].insertion_point == "R/HAND");
  parameters.set(parameters.index("R/TILT", "value"), 90);
  for (const std::size_t i : parameters.drain_changed_elements()) {
    scene.built.elements[i]->update(parameters.values().subspan(parameters.elements()[i].first_value, 1));
  }
  Flattener flattener(scene.built.scene.root());
  const DrawList& list = flattener.update();
  REQUIRE(list.items.size() == 4);  // arm, what its hand holds, and the same again
  const glm::dmat4 left = list.world_from_node[list.items[1].transform];
  const glm::dmat4 right = list.world_from_node[list.items[3].transform];
  CHECK(left[3] == glm::dvec4(1, 0, 0, 1));
  CHECK(left[0] == glm::dvec4(1, 0, 0, 0));
  CHECK(right[3] == glm::dvec4(1, 5, 0, 1));
  CHECK(right[0] == glm::dvec4(0, 1, 0, 0));  // turned by its own joint
}

TEST_CASE("a name in a part that is already used gets the part's name as prefix") {
  const LiveStage stage;
  write_text(stage.folder / "head.stub", "<element type='joint' name='TILT'/>");
  LiveScene scene({}, stage.parse("<part file='arm.stub' name='ARM' insert_at='ROOT'/>"
                                  "<part file='head.stub' name='HEAD' insert_at='ARM'/>"));
  REQUIRE(scene.built.parameters.elements().size() == 2);
  CHECK(scene.built.parameters.elements()[0].name == "TILT");
  CHECK(scene.built.parameters.elements()[1].name == "HEAD/TILT");
}

TEST_CASE("a command that fails leaves the scene as it was") {
  const LiveStage stage;
  const std::string start = std::string(kTwoTables) + "<element type='painter' name='P' insert_at='ROOT' part='A'/>";
  LiveScene scene({}, stage.parse(start));
  Flattener flattener(scene.built.scene.root());
  const std::uint64_t before = content_hash(flattener.update());
  const NodePtr graph_before = [&] {
    NodeMap ignored;
    return clone_graph(scene.built.scene.root(), ignored);
  }();
  const std::size_t changes = scene.built.parameters.changes().size();
  const char* const wrong[] = {
      "<part file='table.stub' name='C' insert_at='ROOT'/><part file='table.stub' name='A' insert_at='ROOT'/>",
      "<part file='arm.stub' name='C' insert_at='A'/><element type='pose' name='Q' insert_at='HAND' x='a'/>",
      ("<part file='arm.stub' name='C' insert_at='A'/><sensor type='camera' name='S' insert_at='HAND'/>"
       "<element type='painter' name='Q' insert_at='ROOT' part='C' watch='S'/>"),
      "<element type='joint' name='J' insert_at='A' upper='5' value='6'/>",
  };
  for (const char* const commands : wrong) {
    CAPTURE(commands);
    CHECK_FALSE(error_of([&] { scene.execute(stage.parse(commands)); }).empty());
    // Cloned materials are equal only by value, so the draw list is compared.
    CHECK(content_hash(flattener.update()) == before);
    CHECK(nodes_of(scene.built.scene.root()).size() == nodes_of(graph_before).size());
    CHECK(scene.built.parameters.changes().size() == changes);
    CHECK(scene.built.parameters.elements().size() == 1);
    CHECK(scene.built.parameters.values().size() == 2);
    CHECK(scene.built.elements.size() == 1);
    CHECK(scene.built.sensors.empty());
    CHECK_FALSE(scene.built.scene.has_insertion_point("C"));
    CHECK_FALSE(scene.built.scene.has_insertion_point("HAND"));
  }
  // The names are free again, and HAND needs no prefix.
  scene.execute(
      stage.parse("<part file='arm.stub' name='C' insert_at='A'/>"
                  "<sensor type='camera' name='S' insert_at='HAND'/>"));
  CHECK(scene.built.parameters.elements().back().name == "TILT");
  CHECK(flattener.update().items.size() == 3);
}

TEST_CASE("files that embed each other, or too deep, are refused with the chain of files") {
  const LiveStage stage;
  write_text(stage.folder / "x.stub", "<part file='y.stub' name='Y'/>");
  write_text(stage.folder / "y.stub", "<part file='x.stub' name='X2'/>");
  CHECK(contains(error_of([&] { stage.scene("<part file='x.stub' name='X' insert_at='ROOT'/>"); }),
                 "inserts itself: x.stub > y.stub > x.stub"));
  constexpr int kTooMany = 70;  // more than the 64 that are allowed
  for (int i = 0; i < kTooMany; ++i) {
    const std::string next = std::to_string(i + 1);
    write_text(stage.folder / ("n" + std::to_string(i) + ".stub"),
               "<part file='n" + next + ".stub' name='N" + next + "'/>");
  }
  write_text(stage.folder / ("n" + std::to_string(kTooMany) + ".stub"), "");
  const std::string error = error_of([&] { stage.scene("<part file='n0.stub' name='N' insert_at='ROOT'/>"); });
  CHECK(contains(error, "is nested deeper than 64 files"));
  CHECK(contains(error, "n0.stub > n1.stub > n2.stub"));
}

TEST_CASE("the default light shines until a light is declared") {
  const LiveStage stage;
  LiveScene scene({}, stage.parse(kTwoTables));
  Flattener flattener(scene.built.scene.root());
  CHECK(flattener.update().lights.size() == 1);
  const auto lamp = std::make_shared<LightNode>(Light{.intensity = 2});
  scene.built.scene.root()->add(lamp);
  scene.execute({});
  REQUIRE(flattener.update().lights.size() == 1);
  CHECK(flattener.update().lights[0].light.intensity == 2);
}

TEST_CASE("files of identical content share one graph") {
  const LiveStage stage;
  LiveScene scene({}, stage.parse("<part file='table.stub' name='A' insert_at='ROOT'/>"
                                  "<part file='copy.stub' name='B' insert_at='ROOT'/>"
                                  "<part file='arm.stub' name='C' insert_at='ROOT'/>"));
  const auto content = [&](const char* part) {
    return std::dynamic_pointer_cast<Group>(scene.built.scene.find_node(part))->children().back();
  };
  CHECK(content("A") == content("B"));
  CHECK_FALSE(same_graph(content("A"), content("C")));
  NodeMap ignored;
  const NodePtr clone = clone_graph(content("C"), ignored);
  CHECK(same_graph(clone, content("C")));
  nodes_of(clone).back()->name = "other";
  CHECK_FALSE(same_graph(clone, content("C")));
}

}  // namespace simvis

TEST_SUITE_END();
