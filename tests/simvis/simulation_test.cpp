// The interface for programs: the effect of a step, skipped work, and errors.
#include <simvis/simulation.h>

#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <optional>

#include <simvis/element.h>
#include "simvis/default_light.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

/// A simulation of the wall at x = 4 m with `commands`.
class WallSimulation {
 public:
  explicit WallSimulation(const std::string& commands, const SimulationDesc& desc = {}) {
    write_text(folder_ / "wall.gltf", wall_gltf());
    simulation_.emplace(Simulation::from_string(std::string(kWallPart) + commands, desc, folder_.path()));
  }
  Simulation& operator*() { return *simulation_; }
  Simulation* operator->() { return &*simulation_; }

 private:
  TemporaryFolder folder_;
  std::optional<Simulation> simulation_;
};

const std::string kScanner =
    R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="3" min_angle="-45" max_angle="45"/>)";
const std::string kMove = R"(<element type="pose" name="MOVE" insert_at="ROOT"/>)";

/// An element of this program that scales the parts after it.
class Scale : public Element {
 public:
  explicit Scale(const ElementContext& context) : node_(std::make_shared<Transform>()) {
    context.scene.insert(context.command, node_);
  }
  void update(ParameterView values) override {
    glm::dmat4 matrix(1);
    for (int axis = 0; axis < 3; ++axis) matrix[axis][axis] = values[static_cast<std::size_t>(axis)];
    node_->set_matrix(matrix);
  }

 private:
  std::shared_ptr<Transform> node_;
};

constexpr AttributeSpec factor(std::string_view axis) {
  return {.name = axis, .default_value = "1", .unit = "", .text = "a factor", .choices = {}, .live = true};
}
constexpr AttributeSpec kScaleAttributes[] = {factor("x"), factor("y"), factor("z")};
const ElementRegistration kScale({.name = "test_scale",
                                  .summary = "Scales what follows.",
                                  .attributes = kScaleAttributes,
                                  .create = [](const ElementContext& context) -> std::unique_ptr<Element> {
                                    return std::make_unique<Scale>(context);
                                  }});

std::string refusal(const auto& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

bool has(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

TEST_CASE("parameters move a sensor from the next step on") {
  WallSimulation simulation(kMove + kScanner);
  CHECK(simulation->scan("SCAN").range_m.empty());  // not due yet
  simulation->step();
  const Scan& scan = simulation->scan("SCAN");
  REQUIRE(scan.range_m.size() == 3);
  CHECK(std::abs(scan.range_m[1] - 4) <= scan.error_bound_m[1]);
  simulation->set("MOVE", "x", 1.5);
  CHECK(simulation->get("MOVE", "x") == 1.5);
  CHECK(std::abs(scan.range_m[1] - 4) <= scan.error_bound_m[1]);
  simulation->step();
  CHECK(std::abs(scan.range_m[1] - 2.5) <= scan.error_bound_m[1]);
  CHECK(std::abs(scan.range_m[0] - 2.5 * std::sqrt(2)) <= scan.error_bound_m[0]);

  glm::dmat4 pose;
  REQUIRE(simulation->sensor_pose("SCAN", pose));
  CHECK(pose[3] == glm::dvec4(1.5, 0, 0, 1));
}

TEST_CASE("an invalid call keeps the old value and gives the reason") {
  WallSimulation simulation(kMove + kScanner +
                            R"(<sensor type="camera" name="CAM" insert_at="ROOT" width="4" height="4"/>)");
  simulation->set("MOVE", "x", 1);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  CHECK(has(refusal([&] { simulation->set("MOVE", "x", nan); }), "MOVE.x"));
  CHECK(simulation->get("MOVE", "x") == 1);
  CHECK(has(refusal([&] { simulation->set("MOVE", "rol", 0); }), "did you mean"));
  CHECK(has(refusal([&] { simulation->get("MUVE", "x"); }), "\"MOVE\"?"));
  CHECK(has(refusal([&] { simulation->enable("SCAM", false); }), "did you mean"));
  CHECK(has(refusal([&] { simulation->scan("CAM"); }), "camera"));
  CHECK(has(refusal([&] { simulation->depth("CAM"); }), "depth"));
  CHECK(has(refusal([&] { simulation->color("SCAN"); }), "SCAN"));
  glm::dmat4 pose;
  CHECK(has(refusal([&] { simulation->sensor_pose("SCAN1", pose); }), "\"SCAN\"?"));
  CHECK(has(refusal([&] { Simulation::from_string("<scene><prt/></scene>", {}, ".", "mine.xml"); }),
            "mine.xml:1:9: error: "));
  SimulationDesc desc;
  desc.rate_hz = 0;
  CHECK(has(refusal([&] { Simulation::from_string("", desc); }), "rate"));
}

TEST_CASE("overrides replace the values of the scene, and are checked without a scene") {
  SimulationDesc desc;
  desc.overrides = {{"laser_scanner", "samples", "7", ""}};
  WallSimulation simulation(kScanner, desc);
  simulation->step();
  CHECK(simulation->scan("SCAN").range_m.size() == 7);
  desc.overrides = {{"laser_scanner", "samples", "-7", "--samples"}};
  CHECK(refusal([&] { Simulation::from_string("", desc); }).starts_with("--samples: error: "));
  for (const auto& [attribute, value] : {std::pair("outputs", "color range"), std::pair("vignetting", "natural")}) {
    desc.overrides = {{"camera", attribute, value, ""}};  // of a registered output, and of an effect
    CHECK_NOTHROW(Simulation::from_string("", desc));
  }
  desc.overrides = {{"laser_scaner", "samples", "7", ""}};
  CHECK(has(refusal([&] { Simulation::from_string("", desc); }), "\"laser_scanner\"?"));
}

TEST_CASE("only enabled sensors that are due are rendered") {
  WallSimulation simulation(kScanner +
                            R"(<sensor type="camera" name="SLOW" insert_at="ROOT" width="4" height="4" rate="5"/>)");
  std::vector<std::string> fired;
  for (int frame = 0; frame < 7; ++frame) {
    simulation->step();
    fired.emplace_back();
    for (const std::string& name : simulation->measured()) fired.back() += name + " ";
  }
  // 15 Hz frames, 5 Hz sensor: frames 0, 3, 6.
  CHECK(fired ==
        std::vector<std::string>{"SCAN SLOW ", "SCAN ", "SCAN ", "SCAN SLOW ", "SCAN ", "SCAN ", "SCAN SLOW "});
  CHECK(simulation->next_frame().index == 7);
  CHECK(simulation->next_frame().time_ns == 466'666'667);

  simulation->enable("SCAN", false);
  simulation->step();
  CHECK(simulation->measured().empty());
  CHECK(simulation->diagnostics().frame_plan().passes.empty());
  CHECK(simulation->diagnostics().counters().draws == 0);
  CHECK(simulation->diagnostics().counters().bytes_read_back == 0);
  const std::vector<SensorInfo> sensors = simulation->sensors();
  REQUIRE(sensors.size() == 2);
  CHECK(sensors[0].name == "SCAN");
  CHECK(sensors[0].frames == 7);
  CHECK_FALSE(sensors[0].enabled);
  CHECK(sensors[1].frames == 3);
  CHECK(sensors[1].enabled);
}

TEST_CASE("a scaled or mirrored sensor still works, a flattened one is refused") {
  WallSimulation simulation(R"(<element type="test_scale" name="SCALE" insert_at="ROOT"/>)" +
                            std::string(R"(<sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="2"
                                            min_angle="0" max_angle="60" pose_offset="0.5 0 0 0 0 0"/>)"));
  // The wall precedes the element and is not scaled. The scanner is moved to x = 0.5 m times the factor.
  simulation->set("SCALE", "x", 2);
  simulation->set("SCALE", "y", -3);
  simulation->step();
  const Scan& scan = simulation->scan("SCAN");
  CHECK(std::abs(scan.range_m[0] - 3) <= scan.error_bound_m[0]);
  CHECK(std::abs(scan.range_m[1] - 6) <= scan.error_bound_m[1]);
  glm::dmat4 pose;
  REQUIRE(simulation->sensor_pose("SCAN", pose));
  CHECK(pose ==
        glm::dmat4(glm::dvec4(1, 0, 0, 0), glm::dvec4(0, 1, 0, 0), glm::dvec4(0, 0, 1, 0), glm::dvec4(1, 0, 0, 1)));

  simulation->set("SCALE", "x", 0);
  CHECK(has(refusal([&] { simulation->step(); }), "\"SCAN\" has no direction"));
  simulation->set("SCALE", "x", 1);
  simulation->step();
  CHECK(std::abs(scan.range_m[0] - 3.5) <= scan.error_bound_m[0]);
}

TEST_CASE("the stages of a step are in sequence") {
  WallSimulation simulation(kScanner);
  CHECK(simulation->diagnostics().stages().empty());
  simulation->step();
  simulation->step();
  std::string names;
  std::int64_t last_ns = 0;
  for (const StageTime& stage : simulation->diagnostics().stages()) {
    names += std::string(stage.name) + " ";
    CHECK(stage.start_ns >= last_ns);
    CHECK(stage.end_ns >= stage.start_ns);
    last_ns = stage.end_ns;
  }
  CHECK(names == "elements flatten plan render collect ");
}

TEST_CASE("a scene without a light gets one, and a scene with a light does not") {
  WallSimulation dark("");
  REQUIRE(dark->diagnostics().draw_list().lights.size() == 1);
  CHECK(dark->diagnostics().draw_list().lights[0].light == kDefaultLight);
  CHECK(dark->diagnostics().draw_list().lights[0].transform == 0);

  const TemporaryFolder folder;
  write_text(folder / "lamp.gltf",
             R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
                 "extensionsUsed": ["KHR_lights_punctual"],
                 "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 5}]}},
                 "nodes": [{"extensions": {"KHR_lights_punctual": {"light": 0}}}]})");
  const Simulation lit =
      Simulation::from_string(R"(<part file="lamp.gltf" name="LAMP" insert_at="ROOT"/>)", {}, folder.path());
  REQUIRE(lit.diagnostics().draw_list().lights.size() == 1);
  CHECK(lit.diagnostics().draw_list().lights[0].light.kind == LightKind::point);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
