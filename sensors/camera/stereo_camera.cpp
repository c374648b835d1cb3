#include "sensors/camera/stereo_camera.h"

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <iterator>
#include <utility>

#include "sensors/camera/camera_outputs.h"
#include "sensors/cloud_attributes.h"

namespace simvis {

namespace {

constexpr std::uint8_t kStereoCameraCapabilities =
    kHasImageSensor | kHasLens | kHasPixelRays | kSeesSplats | kShowsSurfaces;

std::vector<OutputSpec> stereo_camera_outputs(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  std::vector<OutputSpec> outputs;
  for (const char* const side : {"left", "right"}) {
    outputs.push_back(color_output(side, a));
    outputs.push_back(depth_output(std::string(side) + "_depth", a));
    for (OutputSpec& truth : truth_outputs(std::string(side) + "_", a)) outputs.push_back(std::move(truth));
    for (OutputSpec& flow : flow_outputs(std::string(side) + "_", a)) outputs.push_back(std::move(flow));
    for (OutputSpec& layer : layer_outputs(std::string(side) + "_", a)) outputs.push_back(std::move(layer));
  }
  outputs.push_back(disparity_output(a));
  std::ranges::move(object_outputs(a, true), std::back_inserter(outputs));
  for (const char* const side : {"left_", "right_"}) outputs.push_back(silhouettes_output(side, a));
  outputs.push_back(depth_bound_output(a));
  return outputs;
}

const SensorRegistration kStereoCameraRegistration(
    {.name = "stereo_camera",
     .summary = "Two cameras side by side, with equal lenses, and their true disparity.",
     .notes = "The sensor frame is that of the left camera. The right camera stands baseline to its right (-y). "
              "Disparity is fx * baseline / Z of the left picture in pixels, and 0 where nothing is hit. With a lens "
              "the images are not rectified: the disparity of a pixel is that of its point in the rectified pair, "
              "with the pinhole of the calibration. Outputs as instance are those of a camera, of each view.",
     .capabilities = kStereoCameraCapabilities,
     .attributes = rows_of<StereoCameraDesc>().table(),
     .create = create_sensor<StereoCamera, StereoCameraDesc>,
     .outputs = stereo_camera_outputs});

EyeDesc eye_of(const std::string& name, const std::string& side, const StereoCameraDesc& desc) {
  const bool is_left = side == "left";
  return {.name = name + "_" + side,
          .sensor = name,
          .title = "the " + side + " view of stereo camera " + name,
          .view = side,
          .color_name = side,
          .prefix = side + "_",
          .pinhole = desc.pinhole,
          .color = desc.color,
          .depth = desc.depth,
          .baseline_m = desc.disparity && is_left ? desc.baseline_m : 0,
          .truth = desc.truth,
          .sampling = desc.sampling,
          .effects = is_left ? desc.left_effects : desc.right_effects};
}

}  // namespace

AttributeRows<StereoCameraDesc> StereoCameraDesc::rows() {
  using Desc = StereoCameraDesc;
  return {
      nested(&Desc::pinhole, PinholeDesc::rows()),
      row(&Desc::baseline_m, "baseline", "m", kAboveZero, "distance from the left to the right camera"),
      flags_row<Desc>("outputs", {{"color", &Desc::color}, {"depth", &Desc::depth}, {"disparity", &Desc::disparity}},
                      "what the cameras measure: disparity of the left view, everything else of both", kTruthWords),
      nested(&Desc::sampling, ColorSampling::rows()),
      kLayerAttribute,
      kMaxLayersAttribute,
      kDenseAttribute,
      kRateAttribute};
}

void StereoCameraDesc::complete(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  truth = truth_desc(a, depth || disparity);
  check_max_error_px(sampling, color, a);
  const auto effects_of = [&](const char* side) {
    return camera_effects(kStereoCameraCapabilities, {a, context.seed, context.name + side,
                                                      shown_outputs(color, depth || disparity || truth.any())});
  };
  left_effects = effects_of("/left");
  right_effects = effects_of("/right");
}

StereoCamera::StereoCamera(const std::string& name, const StereoCameraDesc& desc)
    : left_desc_(eye_of(name, "left", desc)),
      right_desc_(eye_of(name, "right", desc)),
      baseline_m_(desc.baseline_m),
      optics_(left_desc_),
      world_(desc.truth),
      left_(left_desc_, optics_, world_),
      right_(right_desc_, optics_, world_),
      objects_(desc.truth, 2) {
  Calibration left{.view = "left", .camera = calibration_of(optics_.layout)}, right = left;
  right.view = "right";
  right.camera.baseline_m = desc.baseline_m;
  calibrations_ = calibrations({std::move(left), std::move(right)});
}

glm::dmat4 StereoCamera::world_from_right(const glm::dmat4& world_from_sensor) const {
  return glm::translate(world_from_sensor, {0, -baseline_m_, 0});
}

void StereoCamera::begin(const FrameTime& time) {
  left_.begin(time);
  right_.begin(time);
}

void StereoCamera::skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) {
  left_.skip_frame(time, world_from_sensor);
  right_.skip_frame(time, world_from_right(world_from_sensor));
}

// Disparity alone needs only the left view.
void StereoCamera::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  world_.begin(list);
  left_.begin_plan(world_from_sensor);
  right_.begin_plan(world_from_right(world_from_sensor));
  const std::vector<CameraEye::Drawing>&left = left_.drawings(), &right = right_.drawings();
  for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i) {
    if (i < left.size()) left_.draw(i, plan);
    if (i < right.size()) right_.draw(i, plan, i < left.size() && left[i].color == right[i].color ? &left[i] : nullptr);
  }
  left_.finish_plan(plan);
  right_.finish_plan(plan);
  plan_effects(left_desc_.sensor, left_desc_.effects, plan);
}

void StereoCamera::collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) {
  left_.collect(time, plan, results);
  right_.collect(time, plan, results);
}

void StereoCamera::cast(RayCaster& of_list) {
  RayCaster& caster = world_.layers.caster(of_list);
  left_.cast(caster);
  right_.cast(caster);
  if (!left_desc_.truth.boxes) return;
  objects_.begin();
  left_.add_objects(objects_, 0, of_list.threads());
  right_.add_objects(objects_, 1, of_list.threads());
}

Measurement StereoCamera::measurement() const {
  Measurement measurement{
      .time_ns = left_.measured_ns(), .world_from_sensor = left_.measured_from(), .calibrations = calibrations_};
  left_.add_to(measurement);
  right_.add_to(measurement);
  objects_.add_to(measurement, std::array{"left", "right"});
  if (left_desc_.disparity()) {
    measurement.arrays.push_back(
        image_array("disparity", left_.disparity(), ImageContent::disparity, "px", left_desc_.view));
  }
  return measurement;
}

std::vector<NumberOnRequest> StereoCamera::on_request() const {
  if (!left_desc_.depth) return {};
  return {{std::string(kDepthErrorBound), "m",
           [left = left_.depth_bound(), right = right_.depth_bound()] { return std::max(left(), right()); }}};
}

}  // namespace simvis
