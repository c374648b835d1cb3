// A scene of things that move before a camera that moves, with its flow.
#pragma once

#include <doctest/doctest.h>

#include <chrono>
#include <cmath>
#include <cstddef>
#include <glm/glm.hpp>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/measurement.h>
#include <simvis/simulation.h>

namespace simvis {

// What the flow of a pixel may differ by from the projection of its depth.
inline constexpr double kFlow_px = 1e-4;

inline constexpr int kFlowWidth = 96, kFlowHeight = 72, kFlowPixels = kFlowWidth * kFlowHeight;
inline constexpr double kFlowHfov_rad = 70 * std::numbers::pi / 180;
inline const double kFlowFocal_px = kFlowWidth / 2.0 / std::tan(kFlowHfov_rad / 2);
inline constexpr auto kFlowStep = std::chrono::milliseconds(100);

// Closed shapes, so that no ray from outside meets a back face; a crate that goes and turns, a camera that does.
inline const std::string kMovingThings = R"(
  <part name="FLOOR" insert_at="ROOT" shape="box" size="20 20 0.2" pose_offset="0 0 -0.6 0 0 0"/>
  <part name="WALL" insert_at="ROOT" shape="box" size="0.2 9 3" pose_offset="6 0 1 0 0 10"/>
  <part name="BALL" insert_at="ROOT" shape="sphere" radius="0.5" pose_offset="3 0.4 0 0 0 0"/>
  <part name="ROD" insert_at="ROOT" shape="cylinder" radius="0.05" length="2" pose_offset="2.5 -0.6 0.3 20 0 0"/>
  <part name="FRAME" insert_at="ROOT"/>
  <element type="pose" name="MOVE" insert_at="FRAME"/>
  <part name="CRATE" insert_at="FRAME" shape="box" size="0.6 0.6 0.6" pose_offset="4 -0.8 0 0 0 30"/>
  <part name="CAR" insert_at="ROOT"/>
  <element type="pose" name="DRIVE" insert_at="CAR"/>
)";

inline std::string flow_camera(const std::string& outputs, const std::string& more = "", const char* type = "camera") {
  return "<sensor type='" + std::string(type) + "' name='CAM' insert_at='CAR' width='" + std::to_string(kFlowWidth) +
         "' height='" + std::to_string(kFlowHeight) +
         (more.find("fx=") == more.npos ? "' hfov='70' outputs='" : "' outputs='") + outputs + "' " + more + "/>";
}

inline std::vector<double> flow_numbers(const Measurement& measurement, const std::string& name) {
  const MeasuredArray* const array = measurement.find(name);
  REQUIRE_MESSAGE(array != nullptr, name);
  std::vector<double> all;
  for (std::size_t i = 0; i < array->count(); ++i) all.push_back(array->number(i));
  return all;
}

// The centre of each pixel.
inline glm::dvec2 flow_centre(int pixel) { return {pixel % kFlowWidth + 0.5, pixel / kFlowWidth + 0.5}; }

inline const glm::dvec2 kFlowMiddle(kFlowWidth / 2.0, kFlowHeight / 2.0);

inline void move_flow_scene(Simulation& simulation, int frame) {
  simulation.set("DRIVE", "x", 0.15 * frame);
  simulation.set("DRIVE", "yaw", 2.5 * frame);
  simulation.set("DRIVE", "roll", 1.0 * frame);
  simulation.set("MOVE", "y", 0.1 * frame);
  simulation.set("MOVE", "yaw", 4.0 * frame);
  simulation.step(kFlowStep);
}

}  // namespace simvis
