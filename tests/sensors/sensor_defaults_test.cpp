// A default of a camera is in the attribute table of its type, for scenes, and in the plain struct, for code. These
// tests compare both: an omitted attribute means the value in a default-constructed struct.
#include <doctest/doctest.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <simvis/sensor.h>
#include <simvis/simulation.h>
#include "effects/scanner/returns.h"
#include "sensors/camera/camera.h"
#include "sensors/camera/keypoints.h"
#include "sensors/camera/stereo_camera.h"
#include "sensors/depth_camera/rgbd_camera.h"
#include "sensors/depth_camera/tof_camera.h"
#include "sensors/event_camera/event_camera.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "sensors/thermal_camera/thermal_camera.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

// Each reads all fields of a struct by a structured binding, which does not compile when a field is added but not
// handled here. Places of attributes and effects have no default value.

bool same(const ColorSampling& a, const ColorSampling& b) {
  return a.supersampling == b.supersampling && a.msaa == b.msaa;
}

// The place of the attribute differs.
bool same(const TruthDesc& a, const TruthDesc& b) {
  const auto& [surfaces, boxes, silhouettes, flow, layers, layer] = a;
  [[maybe_unused]] const auto& [backward, forward, scene, occlusion, outputs_at] = flow;
  return surfaces == b.surfaces && boxes == b.boxes && silhouettes == b.silhouettes && backward == b.flow.backward &&
         forward == b.flow.forward && scene == b.flow.scene && occlusion == b.flow.occlusion && layers == b.layers &&
         layer == b.layer;
}

bool same(const CameraDesc& a, const CameraDesc& b) {
  const auto& [width, height, hfov, near, color, depth, truth, sampling, max_error, visualization, effects] = a;
  return width == b.width_px && height == b.height_px && hfov == b.hfov_rad && near == b.near_m && color == b.color &&
         depth == b.depth && same(truth, b.truth) && same(sampling, b.sampling) && max_error == b.max_error_px &&
         visualization == b.visualization && effects.empty();
}

bool same(const KeypointsDesc& a, const KeypointsDesc& b) {
  const auto& [points, width, height, hfov, near, radius, effects] = a;
  return points == b.points && width == b.width_px && height == b.height_px && hfov == b.hfov_rad && near == b.near_m &&
         radius == b.radius_m && effects.empty();
}

bool same(const StereoCameraDesc& a, const StereoCameraDesc& b) {
  const auto& [width, height, hfov, near, baseline, color, depth, disparity, truth, sampling, max_error, left, right] =
      a;
  return width == b.width_px && height == b.height_px && hfov == b.hfov_rad && near == b.near_m &&
         baseline == b.baseline_m && color == b.color && depth == b.depth && disparity == b.disparity &&
         same(truth, b.truth) && same(sampling, b.sampling) && max_error == b.max_error_px && left.empty() &&
         right.empty();
}

bool same(const RgbdCameraDesc& a, const RgbdCameraDesc& b) {
  const auto& [width, height, hfov, second_hfov, near, baseline, noise, step, depth_min, depth_max, color, depth, state,
               sampling, max_error, effects, seed] = a;
  return width == b.width_px && height == b.height_px && hfov == b.hfov_rad && second_hfov == b.second_hfov_rad &&
         near == b.near_m && baseline == b.baseline_m && noise == b.disparity_noise_px && step == b.disparity_step_px &&
         depth_min == b.depth_min_m && depth_max == b.depth_max_m && color == b.color && depth == b.depth &&
         state == b.state && same(sampling, b.sampling) && max_error == b.max_error_px && effects.empty() &&
         seed == b.seed;
}

template <typename Desc>
bool same(const Desc& a, const Desc& b) {
  return a == b;
}

template <typename Desc, Desc (*read)(const SensorContext&)>
bool defaults_agree(const SensorContext& context) {
  return same(read(context), Desc{});
}

const std::map<std::string_view, bool (*)(const SensorContext&)> kSensors = {
    {"camera", defaults_agree<CameraDesc, camera_desc>},
    {"keypoints", defaults_agree<KeypointsDesc, keypoints_desc>},
    {"stereo_camera", defaults_agree<StereoCameraDesc, stereo_camera_desc>},
    {"rgbd_camera", defaults_agree<RgbdCameraDesc, rgbd_camera_desc>},
    {"tof_camera", defaults_agree<TofCameraDesc, tof_camera_desc>},
    {"event_camera", defaults_agree<EventCameraDesc, event_camera_desc>},
    {"thermal_camera", defaults_agree<ThermalCameraDesc, thermal_camera_desc>},
};

std::string text_of(std::string_view type, std::string_view attribute) {
  const std::vector<AttributeSpec> table = all_attributes(*find_sensor_type(type));
  const auto row = std::ranges::find(table, attribute, &AttributeSpec::name);
  REQUIRE(row != table.end());
  return std::string(row->text);
}

// Whether the number is a word of the row's text.
void check_says(std::string_view type, std::string_view attribute, double value) {
  CAPTURE(attribute);
  CAPTURE(value);
  std::istringstream words(text_of(type, attribute));
  bool says = false;
  for (std::string word; words >> word;) {
    double number = 0;
    says = says || (parse_number(word, number) && number == value);
  }
  CHECK(says);
}

}  // namespace

TEST_CASE("the table and the struct of each camera type have the same defaults") {
  for (const auto& [type, agrees] : kSensors) {
    CAPTURE(type);
    const std::string xml = "<sensor type='" + std::string(type) + "' name='S' insert_at='ROOT'/>";
    const Command command = parse_commands(xml, "s.xml", ".").at(0);
    const AttributeValues attributes(command, all_attributes(*find_sensor_type(type)), kSensorCommonAttributes);
    CHECK(agrees({.command = command, .attributes = attributes, .name = "S", .seed = 0}));
  }
}

TEST_CASE("defaults that depend on other attributes: the table describes the behaviour of the code") {
  check_says("laser_scanner", "max_error_rel", kDefaultMaxErrorRel);
  check_says("laser_scanner", "resolution", kPlanarResolution);
  check_says("laser_scanner", "resolution", kRingsResolution);
  check_says("laser_scanner", "pulse_length", kPulseLength_m);
}

TEST_CASE("a scene without a sky has the environment of a sky element without attributes") {
  Simulation without = Simulation::from_string("");
  Simulation with = Simulation::from_string(R"(<element type="sky" name="SKY" insert_at="ROOT"/>)");
  without.step();
  with.step();
  CHECK(without.diagnostics().draw_list().environment == with.diagnostics().draw_list().environment);
}

TEST_CASE("fog without attributes scatters the same light as a default-constructed medium") {
  Simulation foggy = Simulation::from_string(R"(<element type="fog" name="FOG" insert_at="ROOT"/>)");
  foggy.step();
  CHECK(foggy.diagnostics().draw_list().medium.extinction_per_m > 0);
  CHECK(foggy.diagnostics().draw_list().medium.airlight == Medium{}.airlight);
}

}  // namespace simvis

TEST_SUITE_END();
