// States of sensors: every type, with each set of attributes, with and without delayed measurements.
#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <simvis/simulation.h>
#include "tests/state/saved_state.h"
#include "tests/support/every_sensor.h"

TEST_SUITE_BEGIN("state");

namespace simvis::test {
namespace {

const std::string kLate = " delay='0.1' delay_jitter='0.1' drop='0.2' freeze='0.3'";

// Attributes that make measurements depend on earlier ones, beside those of every_sensor.h.
const std::multimap<std::string_view, std::string> kLookingBack = {
    {"camera", "outputs='color' width='32' height='20' auto_exposure='0.18' auto_exposure_time='0.2'"},
    {"camera", "outputs='color depth' width='32' height='20' row_time='0.001'"},
    {"camera", "outputs='color' width='32' height='20' exposure_time='0.02'"},
    {"laser_scanner", "samples='21' sweep='0.05'"},
    {"laser_scanner", "samples='21' truth='velocity'"},
    {"thermal_camera", "width='16' height='10' time_constant='0.1'"},
    {"odometry", "kind='ideal'"},
};

void move(Simulation& simulation, std::uint64_t frame) {
  const std::vector<ElementDescriptor>& elements = simulation.parameters().elements();
  if (std::ranges::count(elements, "MOVE", &ElementDescriptor::name) == 0) return;
  const auto k = static_cast<double>(frame);
  simulation.set("MOVE", "x", 0.05 * k);
  simulation.set("MOVE", "yaw", 2 * k * k);
  simulation.set("NECK", "value", 0.1 * k);
}

// Compares the frames after a restored state, in this simulation and in a new one.
void check_goes_on(std::string_view type, const std::string& attributes) {
  constexpr int kBefore = 5, kAfter = 5;
  Simulation simulation = scene_of(type, attributes);
  make_frames(simulation, move, kBefore);
  const std::string state = simulation.save_state();
  const std::vector<MadeFrame> expected = make_frames(simulation, move, kAfter);
  Simulation unsaved = scene_of(type, attributes);
  make_frames(unsaved, move, kBefore);
  CHECK(make_frames(unsaved, move, kAfter) == expected);  // saving changes nothing
  simulation.restore_state(state);
  CHECK(simulation.save_state() == state);
  CHECK(make_frames(simulation, move, kAfter) == expected);
  if (type == "force_torque") return;  // its file lies in another folder then; restored_physics_test.cpp has it
  Simulation fresh = scene_of(type, attributes);
  fresh.restore_state(state);
  CHECK(make_frames(fresh, move, kAfter) == expected);
}

TEST_CASE("every type of sensor goes on to the bit from a restored state") {
  int saved = 0;
  for (const SensorType* const type : sensor_types()) {
    std::vector<std::string> all = attributes_of(type->name);
    const auto [first, end] = kLookingBack.equal_range(type->name);
    for (auto each = first; each != end; ++each) all.push_back(each->second);
    for (const std::string& attributes : all) {
      for (const std::string& late : {std::string(), kLate}) {
        CAPTURE(type->name);
        CAPTURE(attributes);
        CAPTURE(late);
        check_goes_on(type->name, attributes + late);
        ++saved;
      }
    }
  }
  CHECK(saved > 90);
}

TEST_CASE("a sensor that was off forgets what came after the state") {
  const std::string flow = "outputs='color flow_backward flow_forward' width='32' height='20'";
  const std::pair<std::string_view, std::string> all[] = {{"camera", flow},
                                                          {"camera", flow + " row_time='0.001'"},
                                                          {"stereo_camera", flow},
                                                          {"event_camera", "width='16' height='10' leak='200'"},
                                                          {"laser_scanner", "samples='21' method='auto'"}};
  for (const auto& [type, attributes] : all) {
    for (const std::string& late : {std::string(), kLate}) {
      Simulation simulation = scene_of(type, attributes + late);
      simulation.enable("S", false);
      make_frames(simulation, move, 2);
      const std::string state = simulation.save_state();
      simulation.enable("S", true);
      make_frames(simulation, move, 10);
      simulation.restore_state(state);
      simulation.enable("S", true);
      const std::vector<MadeFrame> after = make_frames(simulation, move, 4);
      Simulation fresh = scene_of(type, attributes + late);
      fresh.restore_state(state);
      fresh.enable("S", true);
      const std::vector<MadeFrame> expected = make_frames(fresh, move, 4);
      const std::string what = std::string(type) + " " + attributes + late;
      CAPTURE(what);
      CHECK(after == expected);
    }
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
