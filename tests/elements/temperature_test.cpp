// The element `temperature`: which shapes it means. tests/sensors/thermal_camera_test.cpp has what cameras see of it.
#include "elements/temperature.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/support/element_scene.h"

TEST_SUITE_BEGIN("elements");

namespace simvis::test {
namespace {

/// The whole kelvins that the pixels of a camera of 3 x 1 see, from left to right.
std::vector<double> kelvins(Simulation& simulation) {
  simulation.step();
  const Measurement measurement = simulation.measurement("T");
  std::vector<double> shown;
  for (std::size_t i = 0; i < 3; ++i) shown.push_back(std::round(measurement.find("temperature")->number(i)));
  return shown;
}

std::string temperature(const std::string& name, const std::string& attributes) {
  return "<element type='temperature' name='" + name + "' insert_at='ROOT' " + attributes + "/>";
}

const std::string kThermal =
    "<sensor type='thermal_camera' name='T' insert_at='ROOT' width='3' height='1' hfov='73.7398'/>";

TEST_CASE("temperatures by part, by material and by pattern; a material takes precedence, and they come and go") {
  const TemporaryFolder folder;
  GltfBuilder file;
  file.append("materials", painted("Wood", {1, 0, 0, 1}));
  file.append("materials", painted("Steel_1", {0, 1, 0, 1}));
  file.append("materials", painted("Steel_2", {0, 0, 1, 1}));
  add_plate(file, {.x = 4, .left = 3, .right = 1}, 0);
  add_plate(file, {.x = 4, .left = 1, .right = -1}, 1);
  add_plate(file, {.x = 4, .left = -1, .right = -3}, 2);
  write_text(folder / "table.gltf", file.text());
  const auto simulation_of = [&](const std::string& commands) {
    return Simulation::from_string(
        "<simvis><part name='TABLE' insert_at='ROOT' file='table.gltf' up='z'/>" + commands + kThermal + "</simvis>",
        {}, folder.path());
  };
  Simulation simulation = simulation_of(temperature("A", "part='TABLE' temperature='310'") +
                                        temperature("B", "part='TABLE' material='Steel_1' temperature='320'"));
  CHECK(kelvins(simulation) == std::vector<double>{310, 320, 310});
  simulation.set("B", "temperature", 330);
  CHECK(kelvins(simulation) == std::vector<double>{310, 330, 310});
  simulation.execute("<remove kind='element' name='A'/>" +
                     temperature("C", "parts='T?BLE' material='*_2' temperature='340'"));
  CHECK(kelvins(simulation) == std::vector<double>{293, 330, 340});
  simulation.execute("<remove kind='element' name='B'/><remove kind='element' name='C'/>" +
                     temperature("D", "parts='T*' material='Steel_*' temperature='350'"));
  CHECK(kelvins(simulation) == std::vector<double>{293, 350, 350});
  CHECK(contains(error_of([&] { simulation_of(temperature("A", "part='TABLE' material='Wod'")); }),
                 "there is no material \"Wod\" in what the temperature names, did you mean \"Wood\"?"));
  CHECK(contains(error_of([&] {
                   simulation_of(temperature("A", "part='TABLE' material='Steel_1'") +
                                 temperature("B", "part='TABLE' material='Steel_*'"));
                 }),
                 "\"TABLE\" already has a temperature from element \"A\" for the material \"Steel_1\""));
}

TEST_CASE("an element at an insertion point means what stands there, and not what was inserted at it") {
  const std::string boxes =
      "<simvis><part name='A' insert_at='ROOT' shape='box' size='0.2 2 4' pose_offset='4.1 2 0 0 0 0'/>"
      "<part name='B' insert_at='A' shape='box' size='0.2 2 4' pose_offset='0 -2 0 0 0 0'/>";
  Simulation simulation = Simulation::from_string(
      boxes + "<element type='temperature' name='HOT' insert_at='A' temperature='400'/>" + kThermal + "</simvis>");
  CHECK(kelvins(simulation) == std::vector<double>{400, 293, 293});
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
