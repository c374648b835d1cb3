// Every sensor with a reading: it changes no byte of other sensors, costs nothing while it is off, and gives the
// columns and the rows that it says.
#include <doctest/doctest.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "sensors/measured_table.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// A moving robot in front of a wall, with a camera and a scanner, and one more sensor.
std::string scene_with(const std::string& sensor) {
  return R"(
    <part name="WALL" shape="box" size="0.25 4 4" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>
    <part name="ROBOT" insert_at="ROOT"/>
    <element type="pose" name="MOVE" insert_at="ROBOT"/>
    <part name="BODY" shape="box" size="0.5 0.5 0.5" insert_at="ROBOT" pose_offset="-1 0 0 0 0 0"/>
    <element type="joint" name="NECK" insert_at="ROBOT" axis="0 0 1" lower="-9" upper="9"/>
    <sensor type="camera" name="CAM" insert_at="ROBOT" width="16" height="12" outputs="color depth"/>
    <sensor type="laser_scanner" name="SCAN" insert_at="ROBOT" samples="21" min_angle="-60" max_angle="60"/>)" +
         sensor;
}

struct Watched {
  std::vector<float> color, depth, ranges;
  bool operator==(const Watched&) const = default;
};

struct CostlyRun {
  std::vector<Watched> frames;
  std::vector<FrameCounters> counters;
  std::uint64_t rays = 0, motions = 0;
};

CostlyRun run(Simulation& simulation) {
  CostlyRun result;
  for (int i = 0; i < 3; ++i) {
    simulation.set("MOVE", "x", 0.1 * i);
    simulation.step();
    result.frames.push_back(
        {simulation.color("CAM").pixels, simulation.depth("CAM").pixels, simulation.scan("SCAN").range_m});
    result.counters.push_back(simulation.diagnostics().counters());
  }
  result.rays = simulation.diagnostics().ray_counters().rays;
  result.motions = simulation.diagnostics().motions_followed();
  return result;
}

std::vector<const SensorType*> reading_types() {
  std::vector<const SensorType*> types;
  for (const SensorType* type : sensor_types()) {
    if ((type->capabilities & ~(kHasLens | kSeesSplats | kRaysHitSplats)) != 0 || type->name == "psd") continue;
    if (type->name == "tof_camera" || type->name == "thermal_camera") continue;
    // tests/dynamics/force_sensors_test.cpp has those that need physics.
    if (type->name == "contact" || type->name == "force_torque") continue;
    types.push_back(type);
  }
  return types;
}

std::string one_of(const SensorType& type) {
  const std::string size = type.name == "event_camera" ? " width='16' height='12'" : "";
  return "<sensor type='" + std::string(type.name) + "' name='MORE' insert_at='ROBOT'" + size + "/>";
}

TEST_CASE("a sensor with a reading costs nothing while it is off, and never changes what others measure") {
  Simulation plain = Simulation::from_string(scene_with(""));
  const CostlyRun without = run(plain);
  CHECK(without.motions == 0);
  CHECK(reading_types().size() >= 14);
  for (const SensorType* type : reading_types()) {
    CAPTURE(type->name);
    Simulation off = Simulation::from_string(scene_with(one_of(*type)));
    off.enable("MORE", false);
    const CostlyRun idle = run(off);
    CHECK(idle.frames == without.frames);
    CHECK(idle.counters == without.counters);
    CHECK(idle.rays == without.rays);
    CHECK(idle.motions == 0);
    CHECK(off.reading("MORE").rows() == 0);
    Simulation on = Simulation::from_string(scene_with(one_of(*type)));
    CHECK(run(on).frames == without.frames);
  }
}

TEST_CASE("files, values and the reading are the same numbers, and none is missing") {
  for (const SensorType* type : reading_types()) {
    CAPTURE(type->name);
    Simulation simulation = Simulation::from_string(scene_with(one_of(*type)));
    run(simulation);
    const Reading& reading = simulation.reading("MORE");
    const MeasuredTable table = measured_table(simulation.measurement("MORE"));
    CHECK(table.values.size() == reading.values().size());
    REQUIRE(table.columns.size() == reading.arrays.size());
    REQUIRE_FALSE(reading.arrays.empty());
    CHECK(reading.values().size() % reading.arrays.size() == 0);
    for (std::size_t c = 0; c < reading.arrays.size(); ++c) {
      CAPTURE(reading.arrays[c].name);
      CHECK(table.columns[c].name == reading.arrays[c].name);
      const std::optional<double> value = simulation.find_value("MORE", reading.arrays[c].name);
      if (!value) continue;  // a table of several rows
      CHECK((*value == table.values.at(c) || (std::isnan(*value) && std::isnan(table.values[c]))));
      // A column has its unit in its name, and the other way round.
      std::string unit = "_" + reading.arrays[c].unit;
      std::ranges::replace(unit, '/', '_');
      std::ranges::transform(unit, unit.begin(), [](unsigned char letter) { return std::tolower(letter); });
      CHECK((unit == "_" || reading.arrays[c].name.ends_with(unit)));
    }
    CHECK(simulation.sensors().back().method != "");
    const std::vector<SensorNote> notes = simulation.sensors().back().report.notes;
    REQUIRE_FALSE(notes.empty());
    CHECK(notes.back().name == "columns");
    const std::string first = reading.arrays[0].name + (reading.arrays[0].unit.empty() ? "" : " ");
    CHECK(std::get<std::string>(notes.back().value).starts_with(first + reading.arrays[0].unit));
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
