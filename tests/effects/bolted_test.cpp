// Whatever is fixed to the body of a sensor stands still for it, however the body turns and drives within a frame.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/sensor_bytes.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("effects");

namespace simvis {
namespace {

constexpr double kRate_hz = 16, kU = 0x1p-53;

/// A body on a chain: it turns about two axes and drives. MAST, an unlit wall whose edges a wide camera sees, is fixed
/// to it. There are `dense` frames for each measurement of the sensor, whose `rate` is 16.
Simulation body_with(const std::string& sensor, int dense) {
  const TemporaryFolder folder;
  write_text(folder / "wall.gltf", wall_gltf());
  SimulationDesc desc;
  desc.rate_hz = kRate_hz * dense;
  return Simulation::from_string(
      R"(<part name="O" insert_at="ROOT"/>
         <element type="joint" name="YAW" insert_at="O" axis="0 0 1" lower="-1e4" upper="1e4"/>
         <part name="ARM" insert_at="O" pose_offset="2 -0.3 0.1 0 0 0"/>
         <element type="joint" name="ROLL" insert_at="ARM" axis="1 0 0" lower="-1e4" upper="1e4"/>
         <part name="BODY" insert_at="ARM" pose_offset="0.1 0.2 0 10 20 30"/>
         <element type="pose" name="DRIVE" insert_at="BODY"/>
         <part name="MAST" insert_at="BODY" file="wall.gltf" scale="0.1"/>
         <part name="POINT" insert_at="BODY" pose_offset="0.4 0.1 0.05 0 0 0"/>)" +
          sensor,
      desc, folder.path());
}

/// The frames up to a measurement. Up to 85 degrees and 0.4 m from one measurement to the next.
void move(Simulation& simulation, int measurement, int dense) {
  for (int part = measurement == 0 ? dense : 1; part <= dense; ++part) {
    const double at = measurement - 1 + static_cast<double>(part) / dense;
    simulation.set("YAW", "value", 23.0 * at);
    simulation.set("ROLL", "value", -17.0 * at * at);
    simulation.set("DRIVE", "x", 0.3 * at);
    simulation.set("DRIVE", "z", -0.2 * at);
    simulation.step();
  }
}

constexpr int kDense[] = {1, 4};

TEST_CASE("a sweeping scanner measures the plate that is fixed to it at its place, within the stated bound") {
  for (const auto& [given, frames] :
       std::vector<std::pair<std::string, int>>{{"", 1},
                                                {"sweep='0.05'", 1},
                                                {"sweep='0.05'", 4},
                                                {"sweep='0.09'", 1},
                                                {"sweep='0.09'", 4},
                                                {"sweep='0.05' sweep_direction='cw' vertical_samples='3' "
                                                 "vertical_min_angle='-10' vertical_max_angle='10'",
                                                 3}}) {
    const std::string attributes = given;
    const int dense = frames;
    CAPTURE(attributes);
    CAPTURE(dense);
    Simulation simulation =
        body_with(std::string("<part name='PLATE' insert_at='BODY' shape='plane' size='100 100' "
                              "pose_offset='0 0.5 0 90 0 0'/>"
                              "<sensor type='laser_scanner' name='SCAN' insert_at='BODY' samples='31' "
                              "min_angle='60' max_angle='120' rate='16' ") +
                      attributes + "/>",
                  dense);
    // Twenty roundings of chained poses a few metres from the origin, of which the plate's distance is the difference.
    constexpr double kPoses_m = 20 * kU * 4;
    for (int frame = 0; frame < 4; ++frame) {
      move(simulation, frame, dense);
      const Scan& scan = simulation.scan("SCAN");
      for (std::size_t i = 0; i < scan.range_m.size(); ++i) {
        const double elevation =
            glm::radians(scan.range_m.size() == 31 ? 0.0 : 10.0 * static_cast<double>(i / 31) - 10);
        const double azimuth = glm::radians(60 + 2.0 * static_cast<double>(i % 31));
        const double across = std::cos(elevation) * std::sin(azimuth), expected_m = 0.5 / across;
        const double range_rounding_m = expected_m * 0x1p-24;  // ranges are float32
        REQUIRE(std::abs(static_cast<double>(scan.range_m[i]) - expected_m) <=
                scan.error_bound_m[i] + range_rounding_m + kPoses_m / across);
      }
    }
  }
}

// All numbers are those of the first frame, in which nothing has moved: poses relative to the sensor differ by
// roundings in double, which change no vertex, since these are rounded to float32.
TEST_CASE("cameras see what is fixed to them as if nothing moved") {
  const std::string pixels = "width='40' height='30' hfov='150' pose_offset='0 0 0 0 5 0' ";
  for (const auto& [of_type, given] : std::vector<std::pair<std::string, std::string>>{
           {"camera", pixels + "outputs='depth' row_time='0.001' rows_per_pose='1'"},
           {"camera", pixels + "outputs='color' row_time='0.001' rows_per_pose='4' exposure_time='0.01'"},
           {"camera", pixels + "outputs='color' exposure_time='0.05' motion_samples='8'"},
           {"stereo_camera", pixels + "outputs='depth' baseline='0.05' row_time='0.001' rows_per_pose='1'"},
           {"keypoints", pixels + "points='POINT' row_time='0.001' rows_per_pose='1'"}}) {
    const std::string type = of_type, attributes = given;
    for (const int dense : kDense) {
      CAPTURE(type);
      CAPTURE(attributes);
      CAPTURE(dense);
      Simulation simulation =
          body_with("<sensor type='" + type + "' name='CAM' insert_at='BODY' rate='16' " + attributes + "/>", dense);
      std::vector<double> first;
      for (int frame = 0; frame < 4; ++frame) {
        move(simulation, frame, dense);
        std::vector<double> values;
        for (const MeasuredArray& each : simulation.measurement("CAM").arrays) {
          const std::optional<Image> image = to_image(each);
          if (image) values.insert(values.end(), image->pixels.begin(), image->pixels.end());
        }
        if (values.empty()) values = measured_table(simulation.measurement("CAM")).values;
        if (frame == 0) first = values;
        REQUIRE(values.size() == first.size());
        REQUIRE_FALSE(values.empty());
        std::size_t others = 0;
        for (std::size_t i = 0; i < values.size(); ++i) {
          // Float32 of a depth, or a place in the picture from poses of a few metres with 30 roundings and a focal
          // length of 6 pixels.
          const double tolerance = type == "keypoints" ? 30 * kU * 4 * 6 / 0.4 : std::abs(first[i]) * 0x1p-23;
          others += !(values[i] == first[i] || std::abs(values[i] - first[i]) <= tolerance);
        }
        CHECK(others == 0);
      }
    }
  }
}

TEST_CASE("an event camera has no event from what is fixed to it") {
  for (const int dense : kDense) {
    for (const char* const rate : {"", "rate='16'"}) {
      CAPTURE(dense);
      CAPTURE(rate);
      Simulation simulation = body_with(
          std::string("<sensor type='event_camera' name='EVENTS' insert_at='BODY' width='40' height='30' hfov='150' ") +
              rate + "/>",
          dense);
      for (int frame = 0; frame < 4; ++frame) {
        move(simulation, frame, dense);
        CHECK(measured_table(simulation.measurement("EVENTS")).values.empty());
      }
    }
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
