#include "sensors/camera.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "scenegraph/pose.h"

namespace simvis {

namespace {

constexpr AttributeSpec kAttributes[] = {
    {.name = "width",
     .kind = AttributeKind::integer,
     .default_value = "640",
     .unit = "px",
     .text = "columns of the image",
     .min = 1,
     .max = 16384},
    {.name = "height",
     .kind = AttributeKind::integer,
     .default_value = "480",
     .unit = "px",
     .text = "rows of the image",
     .min = 1,
     .max = 16384},
    {.name = "hfov",
     .default_value = "60",
     .unit = "deg",
     .text = "horizontal field of view, from the left edge of the image to the right",
     .min = 0,
     .max = 180,
     .open_min = true,
     .open_max = true},
    {.name = "near",
     .default_value = "0.05",
     .unit = "m",
     .text = "what is nearer along the optical axis is not seen",
     .min = 0,
     .open_min = true},
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
  const double focal_px = desc_.width_px / (2 * std::tan(desc_.hfov_rad / 2));
  View view;
  view.name = name_;
  view.reason = (desc_.color && desc_.depth ? "colour and depth"
                 : desc_.color              ? "colour"
                                            : "depth") +
                std::string(" of camera ") + name_;
  view.pinhole = {focal_px, focal_px, desc_.width_px / 2.0, desc_.height_px / 2.0};
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

void Camera::collect(const FrameTime&, const FramePlan&, std::span<const PassResult> results) {
  if (desc_.color) {
    const std::span<const glm::vec4> seen = results[pass_].color;
    color_ = {desc_.width_px, desc_.height_px, 4, std::move(color_.pixels)};
    color_.pixels.resize(seen.size() * 4);
    std::memcpy(color_.pixels.data(), seen.data(), seen.size_bytes());
  }
  if (desc_.depth) {
    const std::span<const float> seen = results[pass_].depth;
    depth_ = {desc_.width_px, desc_.height_px, 1, std::move(depth_.pixels)};
    depth_.pixels.resize(seen.size());
    std::ranges::transform(seen, depth_.pixels.begin(), [near_m = desc_.near_m](float d) {
      return d > 0 ? static_cast<float>(near_m / d) : std::numeric_limits<float>::infinity();
    });
  }
}

void Camera::write(OutputSink& sink) const { sink.picture("", color(), depth()); }

}  // namespace simvis
