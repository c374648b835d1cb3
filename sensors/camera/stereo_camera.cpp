#include "sensors/camera/stereo_camera.h"

#include <algorithm>
#include <array>
#include <glm/gtc/matrix_transform.hpp>
#include <iterator>
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
     .text = "what the cameras measure: disparity of the left view, everything else of both",
     .choices = "color depth disparity instance semantic range normal object_coordinates depth_error_bound "
                "flow_backward flow_forward scene_flow occlusion layers boxes silhouettes"},
    kSupersamplingAttribute,
    kMsaaAttribute,
    kMaxErrorPxAttribute,
    kLayerAttribute,
    kMaxLayersAttribute,
    kRateAttribute,
};

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

std::unique_ptr<Sensor> create_stereo_camera(const SensorContext& context) {
  return std::make_unique<StereoCamera>(context.name, stereo_camera_desc(context));
}

const SensorRegistration kStereoCameraRegistration(
    {.name = "stereo_camera",
     .summary = "Two rectified pinhole cameras side by side, and their true disparity.",
     .notes = "The sensor frame is that of the left camera. The right camera stands baseline to its right (-y). "
              "Disparity is fx * baseline / Z of the left picture in pixels, and 0 where nothing is hit. Outputs as "
              "instance are those of a camera, of each view.",
     .capabilities = kHasImageSensor | kSeesSplats,
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
                        .truth = truth_desc(a, a.flag("outputs", "depth") || a.flag("outputs", "disparity")),
                        .sampling = color_sampling(a),
                        .max_error_px = max_error_px(a, a.flag("outputs", "color"))};
  const auto effects = [&](const char* side) {
    return camera_effects(kHasImageSensor, {a, context.seed, context.name + side,
                                            shown_outputs(desc.color, desc.depth || desc.truth.any())});
  };
  desc.left_effects = effects("/left");
  desc.right_effects = effects("/right");
  return desc;
}

StereoCamera::StereoCamera(std::string name, const StereoCameraDesc& desc)
    : name_(std::move(name)),
      desc_(desc),
      pinhole_(centred_pinhole(desc.width_px, desc.height_px, desc.hfov_rad)),
      layout_(camera_layout(desc.width_px, desc.height_px, desc.hfov_rad, desc_.left_effects)),
      views_(camera_views(layout_, 1)),
      layer_world_(desc.truth.layer),
      left_{.truth = PixelTruth(desc.truth, desc.width_px, desc.height_px)},
      right_{.truth = PixelTruth(desc.truth, desc.width_px, desc.height_px)},
      objects_(desc.truth, 2),
      scenes_(desc.truth.layer) {
  SIMVIS_ASSERT(layout_.rays.empty() && layout_.row_time_s == 0);
  left_.effects = desc_.left_effects;
  right_.effects = desc_.right_effects;
  if (desc.truth.casts()) rays_.emplace(layout_, views_, desc.near_m);
  if (draws_items()) {
    for (Eye* const eye : {&left_, &right_}) eye->open.emplace(layout_, views_, desc.near_m);
  }
  if (desc.truth.layers > 0) {
    for (Eye* const eye : {&left_, &right_}) eye->layers.emplace(desc.truth.layers, desc.width_px, desc.height_px);
  }
  if (desc.truth.flow.any()) {
    for (Eye* const eye : {&left_, &right_}) eye->flow.emplace(desc.truth.flow, layout_, views_, desc.near_m);
  }
  if (desc.truth.boxes) {
    canvas_.emplace(layout_, views_, desc.near_m);
    silhouettes_.emplace(*canvas_);
  }
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
                  .items = depth && draws_items(),
                  .views = {},
                  .supersampling = color ? desc_.sampling.supersampling : 1,
                  .msaa = color ? desc_.sampling.msaa : 1};
  const std::size_t first = plan.passes.size();
  plan.passes.push_back(pass);
  plan.passes.back().views.push_back(make_view("left", world_from_sensor, why));
  plan.passes.back().views.back().max_error_px = color ? desc_.max_error_px : 0;
  Eyes eyes{.left = {first, 0}, .right = {}};
  if (!color && !right_has_depth()) return eyes;

  View right = make_view("right", world_from_right(world_from_sensor), why);
  right.max_error_px = color ? desc_.max_error_px : 0;
  if (2 * desc_.width_px * pass.supersampling <= kMaxWidth_px) {
    right.x_px = desc_.width_px;
    plan.passes.back().width_px = 2 * desc_.width_px;
    eyes.right = {first, 1};
  } else {
    plan.passes.push_back(pass);
    plan.passes.back().depth = depth && right_has_depth();
    eyes.right = {first + 1, 0};
  }
  plan.passes.back().views.push_back(std::move(right));
  return eyes;
}

void StereoCamera::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  planned_from_ = world_from_sensor;
  drawn_list_ = &list;
  list_ = &layer_world_.begin(list);
  plan_splats(list, plan);
  const bool depth = draws_depth();
  const char* const why = why_depth_apart(desc_.sampling, desc_.max_error_px);
  const bool apart = desc_.color && depth && why != nullptr;
  Eyes first, second;
  if (desc_.color || depth) first = plan_eyes(world_from_sensor, desc_.color, depth && !apart, "", plan);
  second = apart ? plan_eyes(world_from_sensor, false, true, why, plan) : first;
  left_.color_at = first.left;
  left_.depth_at = second.left;
  right_.color_at = first.right;
  right_.depth_at = second.right;
  if (rays_) {
    plan.casts.push_back(
        {.name = name_,
         .reason = "the centre of each pixel of stereo camera " + name_ + ", as what is measured needs",
         .max_rays = 2 * std::uint64_t{desc_.width_px} * desc_.height_px});
  }
  begin_truth(plan);
  if (desc_.truth.boxes) {
    plan.casts.push_back(
        silhouette_cast("stereo camera " + name_, name_, 2 * std::uint64_t{desc_.width_px} * desc_.height_px));
  }
  plan_effects(name_, desc_.left_effects, plan);
  if (!depth || !desc_.depth) return;
  for (Eye* const eye : {&left_, &right_}) {
    eye->depth_view = depth_view(plan.passes[eye->depth_at.pass].views[eye->depth_at.view], list);
  }
}

void StereoCamera::plan_splats(const DrawList& list, FramePlan& plan) {
  const bool any = has_splats(list), both = desc_.color || desc_.depth || desc_.truth.of_surfaces();
  left_.shows_splats = any && (both || desc_.disparity);
  right_.shows_splats = any && both;
  for (Eye* const eye : {&left_, &right_}) {
    if (!eye->shows_splats) continue;
    if (!eye->splats) eye->splats.emplace(layout_, views_, desc_.near_m);
    eye->splats->plan(list, "stereo camera", name_, plan);
  }
}

glm::dmat4 StereoCamera::world_from_right(const glm::dmat4& world_from_sensor) const {
  return glm::translate(world_from_sensor, {0, -desc_.baseline_m, 0});
}

void StereoCamera::begin_truth(FramePlan& plan) {
  for (Eye* const eye : {&left_, &right_}) {
    if (eye->open) eye->open->begin(*list_, name_, plan);
    if (!eye->flow) continue;
    eye->flow->begin(moment(*eye));
    eye->flow->plan(name_, !rays_, plan);
  }
}

CameraMoment StereoCamera::moment(const Eye& eye) const {
  const glm::dmat4 world_from_camera = &eye == &left_ ? planned_from_ : world_from_right(planned_from_);
  return {.time_ns = time_ns_,
          .scene = kept_scene_,
          .rows = {{.count = desc_.height_px, .world_from_view = world_from_camera * sensor_from_view()}}};
}

void StereoCamera::sense(const SensedWorld& world) {
  if (desc_.truth.needs_ids()) ids_ = world.item_ids();
  if (desc_.truth.flow.any()) kept_scene_ = scenes_.keep(world.scene(), {});
}

void StereoCamera::skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) {
  time_ns_ = time.time_ns;
  planned_from_ = world_from_sensor;
  for (Eye* const eye : {&left_, &right_}) {
    if (eye->flow) eye->flow->skip(moment(*eye));
  }
}

HistoryDependence StereoCamera::history_dependence() const {
  if (remembers(left_.effects)) return HistoryDependence::measurements;
  if (desc_.truth.flow.forward && !rays_) return HistoryDependence::last_measurement;
  return desc_.truth.flow.any() ? HistoryDependence::poses : Sensor::history_dependence();
}

void StereoCamera::collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) {
  for (Eye* const eye : {&left_, &right_}) {
    if (desc_.color) {
      const Pass& color = plan.passes[eye->color_at.pass];
      read_color(color, color.views[eye->color_at.view], results[eye->color_at.pass], eye->color);
      if (!eye->shows_splats) post_process(eye->effects, time, layout_, eye->color);
    }
    if (draws_depth()) collect_depth(plan.passes[eye->depth_at.pass], results[eye->depth_at.pass], *eye);
  }
  if (desc_.disparity && draws_depth()) collect_disparity(plan, results);
  measured_ns_ = time.time_ns;
  measured_from_ = planned_from_;
}

void StereoCamera::collect_depth(const Pass& pass, const PassResult& result, Eye& eye) {
  const View& view = pass.views[eye.depth_at.view];
  if (reads_depth(eye)) simvis::read_depth(pass, view, result, eye.depth);
  eye.depth_view.reach.depth_snap_px = result.depth_snap_px;
  if (desc_.truth.any()) {
    eye.truth.begin();
    if (desc_.truth.of_surfaces()) eye.truth.read(pass, view, result, {*list_, ids_}, 0);
    if (eye.flow) eye.flow->read(pass, view, result, 0);
    if (eye.open) eye.open->read(pass, view, result, 0);
    if (desc_.truth.bound) eye.truth.read_bounds(eye.depth, eye.depth_view, 0, desc_.height_px);
  }
  if (desc_.depth) eye.depth_view.rounding.complete();  // the list changes before someone asks for the bound
  std::swap(eye.measured_view, eye.depth_view);
}

void StereoCamera::add_objects() {
  objects_.begin();
  for (const Eye* const eye : {&left_, &right_}) {
    const bool is_right = eye == &right_;
    const glm::dmat4 world_from_view =
        glm::translate(planned_from_, {0, is_right ? -desc_.baseline_m : 0, 0}) * sensor_from_view();
    const PixelRows rows{.count = desc_.height_px, .world_from_view = world_from_view};
    objects_.add({.world = {*list_, ids_},
                  .pixels = eye->truth.items(),
                  .rows = {&rows, 1},
                  .world_from_camera = world_from_view},
                 is_right ? 1 : 0, *silhouettes_);
  }
}

void StereoCamera::cast(RayCaster& of_list) {
  RayCaster& caster = layer_world_.caster(of_list);
  cast_open_pixels(caster);
  if (rays_) {
    rays_->begin(*list_);
    cast(caster, planned_from_, left_);
    cast(caster, world_from_right(planned_from_), right_);
  } else {
    for (Eye* const eye : {&left_, &right_}) {
      if (eye->flow) eye->flow->complete_drawn();
      const glm::dmat4 world_from_camera = eye == &left_ ? planned_from_ : world_from_right(planned_from_);
      const PixelRows rows{.count = desc_.height_px, .world_from_view = world_from_camera * sensor_from_view()};
      add_splats(rows, caster.threads(), *eye);
    }
  }
  if (desc_.truth.boxes) add_objects();
}

void StereoCamera::cast(RayCaster& caster, const glm::dmat4& world_from_camera, Eye& eye) {
  const PixelRows rows{.count = desc_.height_px, .world_from_view = world_from_camera * sensor_from_view()};
  seen_.assign(rays_->directions().size(), {});
  rays_->cast(caster, rows, seen_);
  eye.truth.begin();
  eye.truth.read(rows, rays_->directions(), seen_, {*list_, ids_});
  if (eye.layers) {
    eye.layers->begin(*drawn_list_, ids_.instance);
    eye.layers->cast(rows, *rays_);
  }
  if (reads_depth(eye)) read_depth(rows, eye);
  if (desc_.disparity && &eye == &left_) cast_disparity();
  if (eye.flow) eye.flow->cast(caster, *list_, *rays_, seen_);
  add_splats(rows, caster.threads(), eye);
}

// In front of what the view has just seen.
void StereoCamera::add_splats(const PixelRows& rows, unsigned threads, Eye& eye) {
  if (!eye.shows_splats) return;
  eye.splats->look(*list_, {&rows, 1}, eye.depth, threads);
  if (desc_.color) {
    eye.splats->add_to_color(eye.color);
    post_process(eye.effects, time_, layout_, eye.color);
  }
  if (desc_.depth) eye.splats->add_to_depth(eye.depth);
  if (desc_.disparity && &eye == &left_) {
    eye.splats->add_to_disparity(disparity_, pinhole_.fx_px * desc_.baseline_m);
  }
  if (desc_.truth.of_surfaces()) eye.splats->add_to_truth(eye.truth, {*list_, ids_});
}

void StereoCamera::cast_open_pixels(RayCaster& caster) {
  for (Eye* const eye : {&left_, &right_}) {
    if (!eye->open) continue;
    const glm::dmat4 world_from_camera = eye == &left_ ? planned_from_ : world_from_right(planned_from_);
    const PixelRows rows{.count = desc_.height_px, .world_from_view = world_from_camera * sensor_from_view()};
    TruthImages images{.truth = eye->truth, .flow = eye->flow ? &*eye->flow : nullptr};
    images.set_depth = [this, eye](std::uint32_t pixel, double depth_m) { set_depth(*eye, pixel, depth_m); };
    eye->open->cast(caster, {&rows, 1}, {*list_, ids_}, images);
  }
}

void StereoCamera::set_depth(Eye& eye, std::uint32_t pixel, double depth_m) {
  if (reads_depth(eye)) eye.depth.pixels.edit()[pixel] = static_cast<float>(depth_m);
  if (!desc_.disparity || &eye != &left_) return;
  disparity_.pixels.edit()[pixel] = static_cast<float>(pinhole_.fx_px * desc_.baseline_m / depth_m);
}

// From the surfaces that the view has just seen.
void StereoCamera::read_depth(const PixelRows& rows, Eye& eye) {
  eye.depth.width = desc_.width_px;
  eye.depth.height = desc_.height_px;
  eye.depth.channels = 1;
  std::vector<float>& depth = eye.depth.pixels.overwrite();
  depth.resize(seen_.size());
  eye.cast_bound_m = cast_depth(rows, rays_->directions(), seen_, desc_.width_px, depth);
}

// From the surfaces that the left view has just seen.
void StereoCamera::cast_disparity() {
  disparity_.width = desc_.width_px;
  disparity_.height = desc_.height_px;
  disparity_.channels = 1;
  std::vector<float>& pixels = disparity_.pixels.overwrite();
  pixels.clear();
  for (std::size_t i = 0; i < seen_.size(); ++i) {
    const double z = seen_[i].range_m * rays_->directions()[i].z;
    pixels.push_back(static_cast<float>(pinhole_.fx_px * desc_.baseline_m / z));
  }
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
  left_.truth.add_to(measurement, "left_", "left");
  if (left_.flow) left_.flow->add_to(measurement, "left_", "left");
  if (left_.layers) left_.layers->add_to(measurement, "left_", "left");
  if (desc_.color) add("right", right_.color, ImageContent::color, "", "right");
  if (desc_.depth) add("right_depth", right_.depth, ImageContent::depth, "m", "right");
  right_.truth.add_to(measurement, "right_", "right");
  if (right_.flow) right_.flow->add_to(measurement, "right_", "right");
  if (right_.layers) right_.layers->add_to(measurement, "right_", "right");
  objects_.add_to(measurement, std::array{"left", "right"});
  if (desc_.disparity) add("disparity", disparity_, ImageContent::disparity, "px", "left");
  return measurement;
}

std::vector<NumberOnRequest> StereoCamera::on_request() const {
  if (!desc_.depth) return {};
  const std::string name(kDepthErrorBound);
  if (has_splat_depth(left_) || has_splat_depth(right_))
    return {{name, "m", [] { return std::numeric_limits<double>::infinity(); }}};
  if (rays_) return {{name, "m", [bound_m = std::max(left_.cast_bound_m, right_.cast_bound_m)] { return bound_m; }}};
  return {
      {name, "m",
       [left = left_.depth, right = right_.depth, left_view = left_.measured_view, right_view = right_.measured_view] {
         if (left.pixels.empty()) return std::numeric_limits<double>::quiet_NaN();
         return std::max(depth_error_bound(left, left_view), depth_error_bound(right, right_view));
       }}};
}

}  // namespace simvis
