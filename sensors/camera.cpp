#include "sensors/camera.h"

#include "scenegraph/pose.h"
#include "sensors/pinhole_view.h"

namespace simvis {

namespace {

constexpr AttributeSpec kAttributes[] = {
    kWidthAttribute,
    kHeightAttribute,
    kHfovAttribute,
    kNearAttribute,
    {.name = "outputs",
     .kind = AttributeKind::flags,
     .default_value = "color",
     .text = "what the camera delivers",
     .choices = "color depth"},
    {.name = "view",
     .kind = AttributeKind::choice,
     .default_value = "simulation",
     .text = "what it sees: the simulated world, or also what elements draw for people (beams, paths, graphs)",
     .choices = "simulation visualization"},
    kRateAttribute,
};

std::unique_ptr<Sensor> create(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  return std::make_unique<Camera>(context.name, CameraDesc{.width_px = static_cast<std::uint32_t>(a.integer("width")),
                                                           .height_px = static_cast<std::uint32_t>(a.integer("height")),
                                                           .hfov_rad = glm::radians(a.number("hfov")),
                                                           .near_m = a.number("near"),
                                                           .color = a.flag("outputs", "color"),
                                                           .depth = a.flag("outputs", "depth"),
                                                           .visualization = a.choice("view") == "visualization"});
}

const SensorRegistration kRegistration({"camera", "A pinhole camera: colour, depth or both.", kAttributes, create});

}  // namespace

Camera::Camera(std::string name, const CameraDesc& desc) : name_(std::move(name)), desc_(desc) {}

void Camera::plan(const glm::dmat4& world_from_sensor, const DrawList&, FramePlan& plan) {
  View view;
  view.name = name_;
  view.reason = (desc_.color && desc_.depth ? "colour and depth"
                 : desc_.color              ? "colour"
                                            : "depth") +
                std::string(" of camera ") + name_;
  view.pinhole = centred_pinhole(desc_.width_px, desc_.height_px, desc_.hfov_rad);
  view.near_m = desc_.near_m;
  view.view_from_world = rigid_inverse(world_from_sensor * sensor_from_view());
  view.width_px = desc_.width_px;
  view.height_px = desc_.height_px;
  pass_ = plan.passes.size();
  plan.passes.push_back({.name = name_,
                         .width_px = desc_.width_px,
                         .height_px = desc_.height_px,
                         .color = desc_.color,
                         .depth = desc_.depth,
                         .views = {}});
  plan.passes.back().views.push_back(std::move(view));
}

void Camera::collect(const FrameTime&, const FramePlan& plan, std::span<const PassResult> results) {
  const Pass& pass = plan.passes[pass_];
  if (desc_.color) take_color(pass, pass.views[0], results[pass_], color_);
  if (desc_.depth) take_depth(pass, pass.views[0], results[pass_], depth_);
}

void Camera::write(OutputSink& sink) const { sink.picture("", color(), depth()); }

}  // namespace simvis
