#include "sensors/camera.h"

#include "scenegraph/pose.h"

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
    kSupersamplingAttribute,
    kMsaaAttribute,
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
                                                           .sampling = color_sampling(a),
                                                           .visualization = a.choice("view") == "visualization"});
}

const SensorRegistration kRegistration({"camera", "A pinhole camera: colour, depth or both.", kAttributes, create});

}  // namespace

Camera::Camera(std::string name, const CameraDesc& desc) : name_(std::move(name)), desc_(desc) {}

void Camera::check(const TargetLimits& limits) const {
  if (desc_.color) check_sampling(desc_.sampling, desc_.width_px, desc_.height_px, limits);
}

void Camera::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  View view;
  view.name = name_;
  view.pinhole = centred_pinhole(desc_.width_px, desc_.height_px, desc_.hfov_rad);
  view.near_m = desc_.near_m;
  view.view_from_world = rigid_inverse(world_from_sensor * sensor_from_view());
  view.width_px = desc_.width_px;
  view.height_px = desc_.height_px;
  const auto add_pass = [&](bool color, bool depth, const char* what, const char* why) {
    view.reason = what + std::string(" of camera ") + name_ + why;
    plan.passes.push_back({.name = name_,
                           .width_px = desc_.width_px,
                           .height_px = desc_.height_px,
                           .color = color,
                           .depth = depth,
                           .views = {view},
                           .grid = color ? desc_.sampling.grid : 1,
                           .msaa = color ? desc_.sampling.msaa : 1});
  };
  color_pass_ = depth_pass_ = plan.passes.size();
  if (desc_.color && desc_.depth && desc_.sampling.several()) {
    add_pass(true, false, "colour", "");
    depth_pass_ = plan.passes.size();
    add_pass(false, true, "depth", kDepthApart);
  } else {
    add_pass(desc_.color, desc_.depth,
             desc_.color && desc_.depth ? "colour and depth"
             : desc_.color              ? "colour"
                                        : "depth",
             "");
  }
  if (desc_.color) plan_color_effects(name_, list, plan);
  if (desc_.depth) depth_view_ = depth_view(plan.passes[depth_pass_].views[0], list);
}

void Camera::collect(const FrameTime&, const FramePlan& plan, std::span<const PassResult> results) {
  const Pass &color = plan.passes[color_pass_], &depth = plan.passes[depth_pass_];
  if (desc_.color) take_color(color, color.views[0], results[color_pass_], color_);
  if (desc_.depth) {
    take_depth(depth, depth.views[0], results[depth_pass_], depth_);
    depth_view_.reach.depth_snap_px = results[depth_pass_].depth_snap_px;
  }
  bound_due_ = desc_.depth;
}

std::span<const NamedValue> Camera::values() const {
  if (!desc_.depth) return {};
  if (bound_due_) bound_.value = depth_error_bound(depth_, depth_view_);
  bound_due_ = false;
  return {&bound_, 1};
}

void Camera::write(OutputSink& sink) const { sink.picture("", color(), depth()); }

}  // namespace simvis
