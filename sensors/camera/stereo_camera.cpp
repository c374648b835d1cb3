#include "sensors/camera/stereo_camera.h"

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <utility>

#include <simvis/pose.h>
#include "engine/base/assert.h"
#include "sensors/camera/camera_outputs.h"

namespace simvis {

namespace {

// Both views share a pass if they fit side by side into a target that every Vulkan device supports.
constexpr std::uint32_t kMaxWidth_px = 4096;

constexpr AttributeSpec kStereoCameraAttributes[] = {
    kWidthAttribute,
    kHeightAttribute,
    kHfovAttribute,
    kNearAttribute,
    {.name = "baseline",
     .default_value = "0.12",
     .unit = "m",
     .text = "distance from the left to the right camera",
     .min = 0,
     .open_min = true},
    {.name = "outputs",
     .kind = AttributeKind::flags,
     .default_value = "color disparity",
     .text = "what the cameras measure: colour and depth of both views, disparity of the left view",
     .choices = "color depth disparity"},
    kSupersamplingAttribute,
    kMsaaAttribute,
    kMaxErrorPxAttribute,
    kRateAttribute,
};

std::vector<OutputSpec> stereo_camera_outputs(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  return {color_output("left", a),        depth_output("left_depth", a), color_output("right", a),
          depth_output("right_depth", a), disparity_output(a),           depth_bound_output(a)};
}

std::unique_ptr<Sensor> create_stereo_camera(const SensorContext& context) {
  return std::make_unique<StereoCamera>(context.name, stereo_camera_desc(context));
}

const SensorRegistration kStereoCameraRegistration(
    {.name = "stereo_camera",
     .summary = "Two rectified pinhole cameras side by side, and their true disparity.",
     .notes = "The sensor frame is that of the left camera. The right camera stands baseline to its right (-y). "
              "Disparity is fx * baseline / Z of the left picture in pixels, and 0 where nothing is hit.",
     .capabilities = kHasImageSensor,
     .attributes = kStereoCameraAttributes,
     .create = create_stereo_camera,
     .outputs = stereo_camera_outputs});

}  // namespace

StereoCameraDesc stereo_camera_desc(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  StereoCameraDesc desc{.width_px = static_cast<std::uint32_t>(a.integer("width")),
                        .height_px = static_cast<std::uint32_t>(a.integer("height")),
                        .hfov_rad = glm::radians(a.number("hfov")),
                        .near_m = a.number("near"),
                        .baseline_m = a.number("baseline"),
                        .color = a.flag("outputs", "color"),
                        .depth = a.flag("outputs", "depth"),
                        .disparity = a.flag("outputs", "disparity"),
                        .sampling = color_sampling(a),
                        .max_error_px = max_error_px(a, a.flag("outputs", "color"))};
  const auto effects = [&](const char* side) {
    return camera_effects(kHasImageSensor,
                          {a, context.seed, context.name + side, shown_outputs(desc.color, desc.depth)});
  };
  desc.left_effects = effects("/left");
  desc.right_effects = effects("/right");
  return desc;
}

StereoCamera::StereoCamera(std::string name, const StereoCameraDesc& desc)
    : name_(std::move(name)),
      desc_(desc),
      pinhole_(centred_pinhole(desc.width_px, desc.height_px, desc.hfov_rad)),
      layout_(camera_layout(desc.width_px, desc.height_px, desc.hfov_rad, desc_.left_effects)) {
  SIMVIS_ASSERT(layout_.rays.empty() && layout_.row_time_s == 0);
  left_.effects = desc_.left_effects;
  right_.effects = desc_.right_effects;
  Calibration left{.view = "left",
                   .camera = {.width_px = desc.width_px, .height_px = desc.height_px, .pinhole = pinhole_}};
  Calibration right = left;
  right.view = "right";
  right.camera.baseline_m = desc.baseline_m;
  calibrations_ = std::make_shared<const std::vector<Calibration>>(std::vector{std::move(left), std::move(right)});
}

void StereoCamera::check(const TargetLimits& limits) const {
  if (desc_.color) check_sampling(desc_.sampling, desc_.width_px, desc_.height_px, limits);
}

View StereoCamera::make_view(const char* side, const glm::dmat4& world_from_camera, const char* why) const {
  View view;
  view.name = name_ + "_" + side;
  view.reason = std::string(side) + " view of stereo camera " + name_ + why;
  view.pinhole = pinhole_;
  view.near_m = desc_.near_m;
  view.view_from_world = rigid_inverse(world_from_camera * sensor_from_view());
  view.width_px = desc_.width_px;
  view.height_px = desc_.height_px;
  return view;
}

// Adds one pass with both views side by side, or one pass each if that is too wide; disparity alone needs only the left
// view.
StereoCamera::Eyes StereoCamera::plan_eyes(const glm::dmat4& world_from_sensor, bool color, bool depth, const char* why,
                                           FramePlan& plan) const {
  const Pass pass{.name = name_,
                  .width_px = desc_.width_px,
                  .height_px = desc_.height_px,
                  .color = color,
                  .depth = depth,
                  .views = {},
                  .supersampling = color ? desc_.sampling.supersampling : 1,
                  .msaa = color ? desc_.sampling.msaa : 1};
  const std::size_t first = plan.passes.size();
  plan.passes.push_back(pass);
  plan.passes.back().views.push_back(make_view("left", world_from_sensor, why));
  plan.passes.back().views.back().max_error_px = color ? desc_.max_error_px : 0;
  Eyes eyes{.left = {first, 0}, .right = {}};
  if (!color && !desc_.depth) return eyes;

  View right = make_view("right", glm::translate(world_from_sensor, {0, -desc_.baseline_m, 0}), why);
  right.max_error_px = color ? desc_.max_error_px : 0;
  if (2 * desc_.width_px * pass.supersampling <= kMaxWidth_px) {
    right.x_px = desc_.width_px;
    plan.passes.back().width_px = 2 * desc_.width_px;
    eyes.right = {first, 1};
  } else {
    plan.passes.push_back(pass);
    plan.passes.back().depth = depth && desc_.depth;
    eyes.right = {first + 1, 0};
  }
  plan.passes.back().views.push_back(std::move(right));
  return eyes;
}

void StereoCamera::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  planned_from_ = world_from_sensor;
  const bool depth = desc_.depth || desc_.disparity;
  const char* const why = why_depth_apart(desc_.sampling, desc_.max_error_px);
  const bool apart = desc_.color && depth && why != nullptr;
  const Eyes first = plan_eyes(world_from_sensor, desc_.color, depth && !apart, "", plan);
  const Eyes second = apart ? plan_eyes(world_from_sensor, false, true, why, plan) : first;
  left_.color_at = first.left;
  left_.depth_at = second.left;
  right_.color_at = first.right;
  right_.depth_at = second.right;
  plan_effects(name_, desc_.left_effects, plan);
  if (!desc_.depth) return;
  for (Eye* const eye : {&left_, &right_}) {
    eye->depth_view = depth_view(plan.passes[eye->depth_at.pass].views[eye->depth_at.view], list);
  }
}

void StereoCamera::collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) {
  for (Eye* const eye : {&left_, &right_}) {
    const Pass &color = plan.passes[eye->color_at.pass], &depth = plan.passes[eye->depth_at.pass];
    if (desc_.color) {
      read_color(color, color.views[eye->color_at.view], results[eye->color_at.pass], eye->color);
      post_process(eye->effects, time, layout_, eye->color);
    }
    if (desc_.depth) read_depth(depth, depth.views[eye->depth_at.view], results[eye->depth_at.pass], eye->depth);
    eye->depth_view.reach.depth_snap_px = results[eye->depth_at.pass].depth_snap_px;
    std::swap(eye->measured_view, eye->depth_view);
  }
  if (desc_.disparity) collect_disparity(plan, results);
  measured_ns_ = time.time_ns;
  measured_from_ = planned_from_;
}

// Reversed depth is d = near / Z, so the disparity is d times a constant.
void StereoCamera::collect_disparity(const FramePlan& plan, std::span<const PassResult> results) {
  const std::uint32_t stride_px = plan.passes[left_.depth_at.pass].width_px;
  const double disparity_per_d = pinhole_.fx_px * desc_.baseline_m / desc_.near_m;
  disparity_.width = desc_.width_px;
  disparity_.height = desc_.height_px;
  disparity_.channels = 1;
  std::vector<float>& pixels = disparity_.pixels.overwrite();
  pixels.clear();
  for (std::uint32_t row = 0; row < desc_.height_px; ++row) {
    for (const float d : results[left_.depth_at.pass].depth.subspan(std::size_t{row} * stride_px, desc_.width_px)) {
      pixels.push_back(static_cast<float>(disparity_per_d * static_cast<double>(d)));
    }
  }
}

Measurement StereoCamera::measurement() const {
  Measurement measurement{.time_ns = measured_ns_, .world_from_sensor = measured_from_, .calibrations = calibrations_};
  measurement.arrays.reserve(5);
  const auto add = [&](const char* name, const Image& image, ImageContent content, const char* unit, const char* view) {
    measurement.arrays.push_back(image_array(name, image, content, unit, view));
  };
  if (desc_.color) add("left", left_.color, ImageContent::color, "", "left");
  if (desc_.depth) add("left_depth", left_.depth, ImageContent::depth, "m", "left");
  if (desc_.color) add("right", right_.color, ImageContent::color, "", "right");
  if (desc_.depth) add("right_depth", right_.depth, ImageContent::depth, "m", "right");
  if (desc_.disparity) add("disparity", disparity_, ImageContent::disparity, "px", "left");
  if (!desc_.depth) return measurement;
  measurement.on_request.push_back(
      {std::string(kDepthErrorBound), "m",
       [left = left_.depth, right = right_.depth, left_view = left_.measured_view, right_view = right_.measured_view] {
         if (left.pixels.empty()) return std::numeric_limits<double>::quiet_NaN();
         return std::max(depth_error_bound(left, left_view), depth_error_bound(right, right_view));
       }});
  return measurement;
}

}  // namespace simvis
