#include "sensors/stereo_camera.h"

#include <glm/gtc/matrix_transform.hpp>

#include "scenegraph/pose.h"
#include "sensors/camera_info.h"
#include "sensors/pinhole_view.h"

namespace simvis {

namespace {

// Both views share a pass where they fit side by side into what every Vulkan device can render to.
constexpr std::uint32_t kMaxWidth_px = 4096;

constexpr AttributeSpec kAttributes[] = {
    kWidthAttribute,
    kHeightAttribute,
    kHfovAttribute,
    kNearAttribute,
    {.name = "baseline",
     .default_value = "0.12",
     .unit = "m",
     .text = "how far the right camera stands to the right of the left one",
     .min = 0,
     .open_min = true},
    {.name = "outputs",
     .kind = AttributeKind::flags,
     .default_value = "color disparity",
     .text = "what it delivers: colour and depth of both views, disparity of the left",
     .choices = "color depth disparity"},
    kRateAttribute,
};

std::unique_ptr<Sensor> create(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  return std::make_unique<StereoCamera>(context.name,
                                        StereoCameraDesc{.width_px = static_cast<std::uint32_t>(a.integer("width")),
                                                         .height_px = static_cast<std::uint32_t>(a.integer("height")),
                                                         .hfov_rad = glm::radians(a.number("hfov")),
                                                         .near_m = a.number("near"),
                                                         .baseline_m = a.number("baseline"),
                                                         .color = a.flag("outputs", "color"),
                                                         .depth = a.flag("outputs", "depth"),
                                                         .disparity = a.flag("outputs", "disparity")});
}

const SensorRegistration kRegistration({"stereo_camera",
                                        "Two rectified pinhole cameras side by side, and their true disparity.",
                                        kAttributes, create});

}  // namespace

StereoCamera::StereoCamera(std::string name, const StereoCameraDesc& desc)
    : name_(std::move(name)), desc_(desc), pinhole_(centred_pinhole(desc.width_px, desc.height_px, desc.hfov_rad)) {}

View StereoCamera::make_view(const char* side, const glm::dmat4& world_from_camera) const {
  View view;
  view.name = name_ + "_" + side;
  view.reason = std::string(side) + " view of stereo camera " + name_;
  view.pinhole = pinhole_;
  view.near_m = desc_.near_m;
  view.view_from_world = rigid_inverse(world_from_camera * sensor_from_view());
  view.width_px = desc_.width_px;
  view.height_px = desc_.height_px;
  return view;
}

void StereoCamera::plan(const glm::dmat4& world_from_sensor, const DrawList&, FramePlan& plan) {
  const Pass pass{.name = name_,
                  .width_px = desc_.width_px,
                  .height_px = desc_.height_px,
                  .color = desc_.color,
                  .depth = desc_.depth || desc_.disparity,
                  .views = {}};
  left_.pass = plan.passes.size();
  left_.view = 0;
  plan.passes.push_back(pass);
  plan.passes.back().views.push_back(make_view("left", world_from_sensor));
  if (!needs_right()) return;

  View right = make_view("right", glm::translate(world_from_sensor, {0, -desc_.baseline_m, 0}));
  right_.view = 0;
  if (2 * desc_.width_px <= kMaxWidth_px) {
    right.x_px = desc_.width_px;
    plan.passes.back().width_px = 2 * desc_.width_px;
    right_.view = 1;
  } else {
    plan.passes.push_back(pass);
    plan.passes.back().depth = desc_.depth;
  }
  right_.pass = plan.passes.size() - 1;
  plan.passes.back().views.push_back(std::move(right));
}

void StereoCamera::collect(const FrameTime&, const FramePlan& plan, std::span<const PassResult> results) {
  collect_eye(plan, results, left_);
  if (needs_right()) collect_eye(plan, results, right_);
  if (desc_.disparity) collect_disparity(plan, results);
}

void StereoCamera::collect_eye(const FramePlan& plan, std::span<const PassResult> results, Eye& eye) const {
  const Pass& pass = plan.passes[eye.pass];
  if (desc_.color) take_color(pass, pass.views[eye.view], results[eye.pass], eye.color);
  if (desc_.depth) take_depth(pass, pass.views[eye.view], results[eye.pass], eye.depth);
}

// Reversed depth is d = near / Z, so the disparity is d times a constant.
void StereoCamera::collect_disparity(const FramePlan& plan, std::span<const PassResult> results) {
  const std::uint32_t stride_px = plan.passes[left_.pass].width_px;
  const double disparity_per_d = pinhole_.fx_px * desc_.baseline_m / desc_.near_m;
  disparity_ = {desc_.width_px, desc_.height_px, 1, std::move(disparity_.pixels)};
  disparity_.pixels.clear();
  for (std::uint32_t row = 0; row < desc_.height_px; ++row) {
    for (const float d : results[left_.pass].depth.subspan(std::size_t{row} * stride_px, desc_.width_px)) {
      disparity_.pixels.push_back(static_cast<float>(disparity_per_d * static_cast<double>(d)));
    }
  }
}

const Image* StereoCamera::picture(std::string_view name) const {
  if (name == "left") return color();
  if (name == "right") return desc_.color ? &right_.color : nullptr;
  if (name == "left_depth") return depth();
  if (name == "right_depth") return desc_.depth ? &right_.depth : nullptr;
  if (name == "disparity") return desc_.disparity ? &disparity_ : nullptr;
  return nullptr;
}

void StereoCamera::write(OutputSink& sink) const {
  sink.picture("left", color(), depth());
  sink.picture("right", picture("right"), picture("right_depth"));
  if (desc_.disparity) sink.plane("disparity", "disparity", disparity_);
  CameraInfo info{
      .name = name_ + "_left", .width_px = desc_.width_px, .height_px = desc_.height_px, .pinhole = pinhole_};
  sink.text("left", "yaml", camera_info_yaml(info));
  info.name = name_ + "_right";
  info.baseline_m = desc_.baseline_m;
  sink.text("right", "yaml", camera_info_yaml(info));
}

}  // namespace simvis
