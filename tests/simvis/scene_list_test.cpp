// simvis-run --list and --list-types, and what sensors give in them, in --describe and in files.
#include "program/report/scene_list.h"

#include <doctest/doctest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include <simvis/reading_sensor.h>
#include <simvis/simulation.h>
#include "program/output/output_writer.h"
#include "program/report/type_reference.h"
#include "simvis/live_scene.h"
#include "tests/support/error_of.h"
#include "tests/support/run_process.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

// Positions are float32 below 8 m.
constexpr double kPosition_m = 5e-7;

SceneList list_of(const LiveScene& scene) { return list_scene(scene.built); }

TEST_CASE("the list has each part with its own box, below the part that it is inserted in") {
  const LiveScene scene({}, parse_commands(R"(
    <part name="TABLE" insert_at="ROOT" shape="box" size="2 1 0.5" pose_offset="1 0 0.25 0 0 0"/>
    <element type="pose" name="MOVE" insert_at="TABLE" x="3"/>
    <part name="BALL" insert_at="TABLE" shape="sphere" radius="0.5" color="1 0 0" pose_offset="0 0 1 0 0 0"/>
    <part name="FRAME" insert_at="BALL"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="FRAME" samples="5" pose_offset="0 0 0 0 0 90"/>)",
                                           "s.xml", ""));
  const SceneList list = list_of(scene);
  REQUIRE(list.parts.size() == 4);
  const char* names[] = {"ROOT", "TABLE", "BALL", "FRAME"};
  for (std::size_t i = 0; i < 4; ++i) {
    CHECK(list.parts[i].name == names[i]);
    CHECK(list.parts[i].depth == i);
    CHECK(list.parts[i].insert_at == (i == 0 ? "" : names[i - 1]));
  }
  const ListedShapes &table = list.parts[1].shapes, &ball = list.parts[2].shapes;
  CHECK(list.parts[1].source == "box");
  CHECK(list.parts[3].source == "frame");
  CHECK(table.triangles == 12);
  CHECK(glm::length(table.box_min_m - glm::dvec3(3, -0.5, 0)) < kPosition_m);  // moved by 3 m
  CHECK(glm::length(table.box_max_m - glm::dvec3(5, 0.5, 0.5)) < kPosition_m);
  CHECK(glm::length(ball.box_min_m - glm::dvec3(3.5, -0.5, 0.75)) < kPosition_m);
  CHECK(glm::length(ball.box_max_m - glm::dvec3(4.5, 0.5, 1.75)) < kPosition_m);
  REQUIRE(ball.materials.size() == 1);
  CHECK(ball.materials[0]->base_color == glm::vec4(1, 0, 0, 1));
  CHECK_FALSE(list.parts[0].shapes.any);
  CHECK_FALSE(list.parts[3].shapes.any);
  CHECK(list.parts[1].elements == std::vector<std::size_t>{0});
  CHECK(list.parts[3].sensors == std::vector<std::size_t>{0});
  REQUIRE(list.elements.size() == 1);
  CHECK(list.elements[0].parameters[0].value == 3);
  REQUIRE(list.sensors.size() == 1);
  const ListedSensor& sensor = list.sensors[0];
  CHECK(sensor.attributes == std::vector<std::pair<std::string, std::string>>{{"samples", "5"}});
  REQUIRE(sensor.world_from_sensor);
  CHECK((*sensor.world_from_sensor)[3] == glm::dvec4(4, 0, 1.25, 1));
  CHECK((*sensor.world_from_sensor)[0] == glm::dvec4(0, 1, 0, 0));

  const std::string text = to_text(list);
  CHECK(contains(text,
                 "ROOT\n"
                 "  TABLE (box) at ROOT, 12 triangles, 2 x 1 x 0.5 m, from (3 -0.5 0) to (5 0.5 0.5); materials: box\n"
                 "    element MOVE (pose) at TABLE: x = 3 m"));
  CHECK(contains(text,
                 "\n    BALL (sphere) at TABLE, 3480 triangles, 1 x 1 x 1 m, from (3.5 -0.5 0.75) to (4.5 0.5 1.75); "
                 "materials: sphere\n"
                 "      FRAME (frame) at BALL\n"
                 "        sensor SCAN (laser_scanner, raycast) at FRAME, stands at (4 0 1.25), looks along (0 1 0): "
                 "samples=\"5\"\n"));
}

TEST_CASE("the list as JSON") {
  const LiveScene scene({}, parse_commands(R"(
    <part name="BALL" insert_at="ROOT" shape="sphere" radius="0.5"/>
    <element type="joint" name="ELBOW" insert_at="BALL" axis="0 0 1"/>
    <element type="pose" name="MOVE" insert_at="BALL"/>
    <sensor type="camera" name="CAM" insert_at="BALL" width="8" height="8"/>)",
                                           "s.xml", ""));
  const auto json = nlohmann::json::parse(to_json(list_of(scene)));
  CHECK(json["parts"].size() == 2);
  CHECK(json["parts"][0]["box_m"].is_null());
  CHECK(json["parts"][1]["insert_at"] == "ROOT");
  CHECK(json["parts"][1]["triangles"] == 3480);
  CHECK(json["parts"][1]["box_m"]["max"][2] == 0.5);
  CHECK(json["joints"] == nlohmann::json::array({"ELBOW"}));
  CHECK(json["elements"][1]["parameters"][0]["name"] == "x");
  CHECK(json["elements"][1]["parameters"][0]["unit"] == "m");
  CHECK(json["sensors"][0]["attributes"]["width"] == "8");
  CHECK(json["sensors"][0]["up"] == nlohmann::json::array({0, 0, 1}));
  CHECK(json["warnings"].empty());
}

TEST_CASE("--list and --list-types need no device") {
  const TemporaryFolder folder;
  write_text(folder / "s.xml", "<part name='BALL' insert_at='ROOT' shape='sphere' radius='0.5'/>");
  write_text(folder / "wrong.xml", "<part name='BALL' insert_at='ROTO'/>");
  const auto run = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), tested_build() + "/bin/simvis-run");
    return Process(arguments, {"VK_ICD_FILENAMES=/nowhere.json", "VK_DRIVER_FILES=/nowhere.json"}).wait();
  };
  const std::string scene = (folder / "s.xml").string();
  const ProcessResult text = run({"--list", scene}), json = run({"--list", "--json", scene});
  CHECK(text.exit_code == 0);
  CHECK(contains(text.out, "  BALL (sphere) at ROOT, 3480 triangles, 1 x 1 x 1 m"));
  CHECK(json.exit_code == 0);
  CHECK(nlohmann::json::parse(json.out)["parts"][1]["name"] == "BALL");
  write_text(folder / "camera.xml", "<sensor type='camera' name='CAM' insert_at='ROOT' width='8' height='6'/>");
  CHECK(run({"--list", (folder / "camera.xml").string()}).exit_code == 0);
  // There is none indeed.
  CHECK(run({(folder / "camera.xml").string(), "--out", (folder / "out").string()}).exit_code == 1);
  const ProcessResult wrong = run({"--list", (folder / "wrong.xml").string()});
  CHECK(wrong.exit_code == 2);
  CHECK(contains(wrong.err, "wrong.xml:1:19: error: there is no insertion point \"ROTO\""));
  CHECK(run({"--list"}).exit_code == 2);
  CHECK(run({"--json", scene}).exit_code == 2);
  CHECK(run({"--list", "--frames", "2", "--set", "A.x=1", scene}).exit_code == 2);

  const ProcessResult types = run({"--list-types"});
  CHECK(types.exit_code == 0);
  CHECK(contains(types.out, "element  pose                 Moves and turns what follows its insertion point.\n"));
  CHECK(contains(types.out, "sensor   laser_scanner        "));
  CHECK(contains(types.out, "effect   range_noise          "));
}

/// The one place for the outputs of the type. A row that is added here needs no change anywhere else.
std::vector<TableColumn> gauge_columns() {
  return {{.name = "level_m", .format = "%.9g", .unit = "m", .meaning = "height of the water", .frame = "world"},
          {.name = "made_up_k", .format = "%.9g", .unit = "K", .meaning = "temperature of the water"}};
}

class Gauge : public ReadingSensor {
 public:
  Gauge() : ReadingSensor(gauge_columns()) {}
  void collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) override {
    std::vector<double> values;
    for (std::size_t i = 0; i < gauge_columns().size(); ++i) values.push_back(2 + static_cast<double>(i));
    set_reading(time, std::move(values));
  }
  std::string method() const override { return "made up"; }
};

const SensorRegistration kGauge(
    {.name = "test_gauge",
     .summary = "A gauge of this test.",
     .attributes = {},
     .create = [](const SensorContext&) -> std::unique_ptr<Sensor> { return std::make_unique<Gauge>(); },
     .outputs = [](const SensorContext& context) { return reading_outputs(context, gauge_columns()); }});

constexpr const char* kGaugeScene = "<sensor type='test_gauge' name='GAUGE' insert_at='ROOT'/>";

TEST_CASE("a made-up output is described, listed and written with no other change") {
  const std::string text = type_reference("test_gauge", ReferenceFormat::text),
                    markdown = type_reference("test_gauge", ReferenceFormat::markdown);
  const LiveScene scene({}, parse_commands(kGaugeScene, "s.xml", ""));
  const SceneList list = list_scene(scene.built);
  const std::string tree = to_text(list), json = to_json(list);
  const TemporaryFolder folder;
  Simulation simulation = Simulation::from_string(kGaugeScene);
  simulation.step();
  {
    OutputDesc desc;
    desc.folder = folder / "out";
    desc.sensors = {"GAUGE"};
    OutputWriter writer(desc);
    writer.write("GAUGE", {}, glm::dmat4(1), simulation.measurement("GAUGE"));
    writer.finish();
  }
  const std::string file = read_text(folder / "out/GAUGE.csv");
  REQUIRE(list.sensors.size() == 1);
  REQUIRE(list.sensors[0].outputs.size() == gauge_columns().size());
  double value = 2;
  for (const TableColumn& column : gauge_columns()) {
    CAPTURE(column.name);
    CHECK(contains(text, column.name));
    CHECK(contains(text, column.meaning));
    CHECK(contains(markdown, "| `" + column.name + "` | scalar | f64 | 1 | " + column.unit + " |"));
    CHECK(contains(tree, "gives " + column.name + ": scalar, f64, 1, " + column.unit + "\n"));
    CHECK(contains(json, "\"name\": \"" + column.name + "\""));
    CHECK(contains(file, "," + column.name));
    CHECK(simulation.value("GAUGE", column.name) == value++);
  }
}

TEST_CASE("--describe prints what a camera gives, also what only some commands make it give") {
  const std::string text = type_reference("camera", ReferenceFormat::text);
  CHECK(contains(text, "\ngives:\ncolor "));
  CHECK(contains(text, "480 x 640 x 4"));
  CHECK(contains(text, "depth_error_bound_m"));
  const LiveScene scene(
      {}, parse_commands("<sensor type='camera' name='CAM' insert_at='ROOT' width='8' height='6'/>", "s.xml", ""));
  const std::string tree = to_text(list_scene(scene.built));
  CHECK(contains(tree, "gives color: image, f32, 6 x 8 x 4\n"));
  CHECK_FALSE(contains(tree, "gives depth"));
}

}  // namespace
}  // namespace simvis
