// A scene of things with classes, and a camera that gives their truth.
#pragma once

#include <doctest/doctest.h>

#include <cstddef>
#include <string>
#include <vector>

#include <simvis/measurement.h>
#include <simvis/simulation.h>

namespace simvis {

inline constexpr int kTruthWidth = 96, kTruthHeight = 72;

// Closed shapes, so that no ray from outside meets a back face: a floor, a wall, things before it, one that moves.
inline const std::string kTruthThings = R"(
  <part name="FLOOR" insert_at="ROOT" shape="box" size="20 20 0.2" pose_offset="0 0 -0.6 0 0 0"/>
  <part name="WALL" insert_at="ROOT" shape="box" size="0.2 9 3" pose_offset="6 0 1 0 0 10"/>
  <part name="BALL" insert_at="ROOT" shape="sphere" radius="0.5" pose_offset="3 0.4 0 0 0 0"/>
  <part name="ROD" insert_at="ROOT" shape="cylinder" radius="0.02" length="2" pose_offset="2.5 -0.6 0.3 20 0 0"/>
  <part name="FRAME" insert_at="ROOT"/>
  <element type="pose" name="MOVE" insert_at="FRAME"/>
  <part name="CRATE" insert_at="FRAME" shape="box" size="0.6 0.6 0.6" pose_offset="4 -0.8 0 0 0 30"/>
  <part name="CAR" insert_at="ROOT"/>
  <element type="pose" name="DRIVE" insert_at="CAR"/>
  <element type="label" name="L1" insert_at="ROOT" part="BALL" class="ball" class_id="3"/>
  <element type="label" name="L2" insert_at="ROOT" parts="*R*A*" class="box" class_id="5"/>
  <element type="label" name="L3" insert_at="ROOT" part="FLOOR" class="ground" class_id="1"/>
)";
inline const std::string kDrawnTruth = "instance semantic range object_coordinates depth depth_error_bound",
                         kCastTruth = "normal " + kDrawnTruth;

inline std::string truth_camera(const std::string& outputs, const std::string& more = "", const char* type = "camera") {
  return "<sensor type='" + std::string(type) + "' name='CAM' insert_at='CAR' width='" + std::to_string(kTruthWidth) +
         "' height='" + std::to_string(kTruthHeight) +
         (more.find("fx=") == more.npos ? "' hfov='70' outputs='" : "' outputs='") + outputs + "' " + more + "/>";
}

inline Simulation truth_simulation(const std::string& commands) {
  return Simulation::from_string("<simvis>" + kTruthThings + commands + "</simvis>");
}

/// The numbers of an output, which it must have.
inline std::vector<double> truth_numbers(const Measurement& measurement, const std::string& name) {
  const MeasuredArray* const array = measurement.find(name);
  REQUIRE_MESSAGE(array != nullptr, name);
  std::vector<double> all;
  for (std::size_t i = 0; i < array->count(); ++i) all.push_back(array->number(i));
  return all;
}

}  // namespace simvis
