#include "sensors/camera/camera.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <iterator>
#include <limits>
#include <span>
#include <utility>

#include <simvis/pose.h>
#include "effects/camera/rolling_shutter.h"
#include "engine/base/assert.h"
#include "scenegraph/motion.h"
#include "sensors/camera/camera_outputs.h"
#include "sensors/camera/resampled_image.h"

namespace simvis {

namespace {

// The views of a pinhole divide its image into rows: their pass is the image.
View whole_image(const Pass& pass) {
  View view = pass.views[0];
  view.y_px = 0;
  view.height_px = pass.height_px;
  return view;
}

// Pixels of all pictures whose mean one image is; each takes up to 40 bytes.
constexpr std::uint64_t kMaxSampledPixels = std::uint64_t{1} << 25;

}  // namespace

Camera::Camera(std::string name, const CameraDesc& desc)
    : name_(std::move(name)),
      desc_(desc),
      layout_(camera_layout(desc.width_px, desc.height_px, desc.hfov_rad, desc.effects)),
      views_(camera_views(layout_, desc.color ? desc.sampling.supersampling : 1)),
      samples_(color_samples(layout_.exposure)),
      still_samples_(still_samples(layout_.exposure)),
      calibrations_(std::make_shared<const std::vector<Calibration>>(
          std::vector{Calibration{.view = "", .camera = calibration_of(layout_)}})),
      layer_world_(desc.truth.layer),
      truth_(desc.truth, desc.width_px, desc.height_px),
      scenes_(desc.truth.layer),
      objects_(desc.truth, 1) {
  if (desc.truth.casts() || (desc.truth.any() && resamples())) rays_.emplace(layout_, views_, desc.near_m);
  if (draws_items()) open_.emplace(layout_, views_, desc.near_m);
  if (desc.truth.layers > 0) layers_.emplace(desc.truth.layers, desc.width_px, desc.height_px);
  if (desc.truth.flow.any()) flow_.emplace(desc.truth.flow, layout_, views_, desc.near_m);
  if (!desc.truth.boxes) return;
  canvas_.emplace(layout_, views_, desc.near_m);
  silhouettes_.emplace(*canvas_);
}

void Camera::check(const TargetLimits& limits) const {
  if (desc_.color) check_sampling(desc_.sampling, desc_.width_px, desc_.height_px, limits);
  check_one_axis();
  check_samples();
  if (!resamples() || (rays_ && !desc_.color)) return;
  const std::uint32_t supersampling = desc_.color ? desc_.sampling.supersampling : 1;
  for (const glm::uvec2& size : views_.pass_size_px) {
    if (size.x * supersampling <= limits.width_px && size.y * supersampling <= limits.height_px) continue;
    fail_at(layout_.oversampling_at, "attribute \"lens_oversampling\": with " + format_number(layout_.oversampling) +
                                         " this lens needs a view of " + std::to_string(size.x * supersampling) +
                                         " x " + std::to_string(size.y * supersampling) +
                                         " samples, expected at most " + std::to_string(limits.width_px) + " x " +
                                         std::to_string(limits.height_px) + " on this device");
  }
}

// The plane of focus is perpendicular to the axis of the camera, and colours are magnified about it, so that only views
// along this axis can be sheared and magnified.
void Camera::check_one_axis() const {
  const bool turned =
      std::ranges::any_of(views_.views, [](const CameraView& view) { return view.face_from_view != glm::dmat3(1); });
  if (!turned) return;
  const auto refuse = [](const Location& at, const std::string& attribute) {
    fail_at(at, "attribute \"" + attribute +
                    "\": this lens is so wide that it takes several views, expected a lens of one view, or no " +
                    attribute);
  };
  if (layout_.exposure.aperture_m != 0) refuse(layout_.exposure.aperture_at, "aperture");
  if (layout_.exposure.magnification != glm::dvec3(1)) refuse(layout_.exposure.magnification_at, "color_magnification");
}

// Each sample is a picture of its own on the device and in memory until their mean is taken.
void Camera::check_samples() const {
  const std::uint64_t pixels = std::uint64_t{desc_.width_px} * desc_.height_px, most = kMaxSampledPixels / pixels;
  if (samples_.size() <= 1 || samples_.size() <= most) return;
  const ColorExposure& exposure = layout_.exposure;
  fail_at(exposure.samples > 1 ? exposure.samples_at : exposure.magnification_at,
          std::to_string(samples_.size()) + " samples of " + std::to_string(desc_.width_px) + " x " +
              std::to_string(desc_.height_px) + " pixels are too many, expected at most " + std::to_string(most) +
              " for this image");
}

SensorNeeds Camera::needs() const {
  return {.item_moves = is_late(), .item_ids = desc_.truth.needs_ids(), .scene = desc_.truth.flow.any()};
}

HistoryDependence Camera::history_dependence() const {
  if (remembers(desc_.effects)) return HistoryDependence::measurements;
  if (desc_.truth.flow.forward && !rays_) return HistoryDependence::last_measurement;
  return is_late() || flow_ ? HistoryDependence::poses : Sensor::history_dependence();
}

bool Camera::is_late() const {
  return !desc_.visualization &&
         (std::ranges::any_of(views_.views, [](const CameraView& view) { return view.time_s != 0; }) ||
          std::ranges::any_of(samples_, [](const ColorSample& sample) { return sample.time_s != 0; }));
}

void Camera::sense(const SensedWorld& world) {
  if (is_late()) moves_ = world.item_moves();
  if (desc_.truth.needs_ids()) ids_ = world.item_ids();
  if (flow_) kept_scene_ = scenes_.keep(world.scene(), moves_);
}

void Camera::skip_frame(const FrameTime& time, const glm::dmat4& world_from_sensor) {
  begin(time);
  world_from_sensor_ = world_from_sensor;
  if (flow_) flow_->skip(moment());
  last_ = Past{time.time_ns, world_from_sensor};
}

// A frame that was not finished is repeated; its own measurement then does not count as the previous one.
void Camera::begin(const FrameTime& time) {
  time_ = time;
  if (last_ && last_->time_ns < time.time_ns) before_ = last_;
}

// What time_s is of the time between the last two measurements.
double Camera::share_before(double time_s) const {
  const double between_s = static_cast<double>(time_.time_ns - before_->time_ns) / 1e9;
  SIMVIS_ASSERT(between_s > 0);
  return time_s / between_s;
}

glm::dmat4 Camera::world_from_camera(double time_s) const {
  if (!before_ || time_s == 0) return world_from_sensor_;
  return pose_between(before_->world_from_sensor, world_from_sensor_, 1 + share_before(time_s));
}

// Where things were that have moved since.
std::vector<ItemPlace> Camera::places(double time_s, const DrawList& list) const {
  std::vector<ItemPlace> places;
  if (!before_ || time_s == 0) return places;
  const double share = share_before(time_s);
  for (const ItemMove& move : moves_) {
    places.push_back({move.item, place_at(move, share, list.world_from_node[list.items[move.item].transform])});
  }
  return places;
}

// Views of the same rows share their pose.
CameraMoment Camera::moment() const {
  CameraMoment moment{.time_ns = time_.time_ns, .scene = kept_scene_, .rows = {}};
  std::uint32_t next_row = 0;
  for (const CameraView& view : views_.views) {
    if (view.first_row < next_row) continue;
    next_row = view.first_row + view.rows;
    moment.rows.push_back({.first = view.first_row,
                           .count = view.rows,
                           .world_from_view = world_from_camera(view.time_s) * sensor_from_view(),
                           .share = before_ && view.time_s != 0 ? share_before(view.time_s) : 0});
  }
  return moment;
}

void Camera::add_passes(bool color, bool depth, const std::string& what, const char* why, const DrawList& list,
                        FramePlan& plan, const ColorSample& sample) const {
  const std::size_t first = plan.passes.size();
  for (const glm::uvec2& size : views_.pass_size_px) {
    plan.passes.push_back({.name = name_,
                           .width_px = size.x,
                           .height_px = size.y,
                           .color = color,
                           .depth = depth,
                           .items = depth && draws_items(),
                           .views = {},
                           .supersampling = color ? desc_.sampling.supersampling : 1,
                           .msaa = color ? desc_.sampling.msaa : 1});
  }
  const bool several = views_.views.size() > 1;
  for (std::size_t i = 0; i < views_.views.size(); ++i) {
    const CameraView& seen = views_.views[i];
    View view;
    view.name = several ? name_ + "/view " + std::to_string(i) : name_;
    view.reason = what + " of camera " + name_ + why;
    if (seen.rows < desc_.height_px) {
      const double before_s = std::round(-seen.time_s * 1e9) / 1e9;
      view.reason += ": rows " + std::to_string(seen.first_row) + " to " +
                     std::to_string(seen.first_row + seen.rows - 1) + ", " + format_number(before_s) + " s before";
    }
    view.pinhole = pinhole_of(sample, seen.pinhole, layout_.exposure.focus_m);
    view.max_error_px = color ? desc_.max_error_px : 0;
    view.near_m = desc_.near_m;
    const double time_s = seen.time_s + sample.time_s;
    view.view_from_world = rigid_inverse(world_from_camera(time_s) * sensor_from_view() *
                                         glm::translate(glm::dmat4(1), glm::dvec3(sample.lens_m, 0)) *
                                         glm::dmat4(glm::transpose(seen.face_from_view)));
    view.places = places(time_s, list);
    view.x_px = seen.x_px;
    view.y_px = seen.y_px;
    view.width_px = seen.width_px;
    view.height_px = seen.height_px;
    plan.passes[first + seen.pass].views.push_back(std::move(view));
  }
}

// Whether the camera or anything else has moved since the last measurement.
bool Camera::moves() const { return before_ && (before_->world_from_sensor != world_from_sensor_ || !moves_.empty()); }

// Nothing moves in a picture through a pinhole: one time shows it.
void Camera::add_color_samples(const DrawList& list, FramePlan& plan) {
  if (layout_.exposure.aperture_m != 0 || moves()) taken_samples_ = samples_;
  if (taken_samples_.size() == 1) return add_passes(true, false, "colour", "", list, plan, taken_samples_[0]);
  for (std::size_t i = 0; i < taken_samples_.size(); ++i) {
    const std::string which = "sample " + std::to_string(i + 1) + " of " + std::to_string(taken_samples_.size());
    add_passes(true, false, which + " of the colour", "", list, plan, taken_samples_[i]);
  }
}

void Camera::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  world_from_sensor_ = world_from_sensor;
  drawn_list_ = &list;
  list_ = &layer_world_.begin(list);
  shows_splats_ = may_show_splats() && has_splats(list);
  color_pass_ = depth_pass_ = plan.passes.size();
  const bool depth = draws_depth();
  const char* const apart = why_depth_apart(desc_.sampling, desc_.max_error_px);
  taken_samples_ = still_samples_;
  if (desc_.color && !layout_.exposure.one_picture()) {
    add_color_samples(list, plan);
    depth_pass_ = plan.passes.size();
    if (depth) add_passes(false, true, "depth", ", apart: at one time, from the centre of the lens", list, plan);
  } else if (desc_.color && depth && apart != nullptr) {
    add_passes(true, false, "colour", "", list, plan);
    depth_pass_ = plan.passes.size();
    add_passes(false, true, "depth", apart, list, plan);
  } else if (desc_.color || depth) {
    add_passes(desc_.color, depth,
               desc_.color && depth ? "colour and depth"
               : desc_.color        ? "colour"
                                    : "depth",
               "", list, plan);
  }
  if (rays_ || desc_.truth.boxes) plan_rays(plan);
  if (shows_splats_) {
    if (!splats_) splats_.emplace(layout_, views_, desc_.near_m);
    splats_->plan(list, "camera", name_, plan);
  }
  if (open_) open_->begin(list, name_, plan);
  if (flow_) {
    flow_->begin(moment());
    flow_->plan(name_, !rays_, plan);
  }
  plan_effects(name_, desc_.effects, plan);
  depth_views_.clear();
  if (!depth || !reads_depth()) return;
  for (const Pass& pass : std::span(plan.passes).subspan(depth_pass_, views_.pass_size_px.size())) {
    for (const View& view : pass.views) depth_views_.push_back(depth_view(view, list));
  }
}

void Camera::plan_rays(FramePlan& plan) const {
  const std::uint64_t pixels = std::uint64_t{layout_.width_px} * layout_.height_px;
  if (rays_) {
    plan.casts.push_back({.name = name_,
                          .reason = "the centre of each pixel of camera " + name_ +
                                    (resamples() ? ", which is no pixel of a view" : ", as what is measured needs"),
                          .max_rays = pixels});
  }
  if (desc_.truth.boxes) plan.casts.push_back(silhouette_cast("camera " + name_, name_, pixels));
}

void Camera::collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) {
  const auto own = [&](const auto& all, std::size_t first) {
    return std::span(all).subspan(first, views_.pass_size_px.size());
  };
  if (desc_.color) {
    mean_.begin();
    for (std::size_t i = 0; i < taken_samples_.size(); ++i) {
      const std::size_t first = color_pass_ + i * views_.pass_size_px.size();
      read_color_of(own(plan.passes, first), own(results, first));
      if (taken_samples_.size() > 1) mean_.add(color_, taken_samples_[i].colors);
    }
    if (taken_samples_.size() > 1) mean_.finish(color_);
    if (!shows_splats_) post_process(desc_.effects, time, layout_, color_);
  }
  if (draws_depth()) collect_depth(own(plan.passes, depth_pass_), own(results, depth_pass_));
  measured_ = {time.time_ns, world_from_sensor_};
  last_ = measured_;
}

void Camera::read_color_of(std::span<const Pass> passes, std::span<const PassResult> results) {
  if (resamples()) {
    resample_color(layout_, views_, passes, results, color_);
  } else {
    read_color(passes[0], whole_image(passes[0]), results[0], color_);
  }
}

void Camera::collect_depth(std::span<const Pass> passes, std::span<const PassResult> results) {
  for (DepthView& view : depth_views_) view.reach.depth_snap_px = results[0].depth_snap_px;
  if (resamples()) {
    whole_bound_m_ = resample_depth(layout_, views_, passes, results, depth_views_, depth_);
  } else if (reads_depth()) {
    read_depth(passes[0], whole_image(passes[0]), results[0], depth_);
  }
  if (desc_.truth.any()) read_truth(passes[0], results[0]);
  if (!resamples()) {
    for (DepthView& view : depth_views_) view.rounding.complete();  // the list changes before someone asks
  }
  std::swap(measured_views_, depth_views_);
}

void Camera::read_truth(const Pass& pass, const PassResult& result) {
  truth_.begin();
  for (std::size_t i = 0; i < views_.views.size(); ++i) {
    const CameraView& view = views_.views[i];
    if (desc_.truth.of_surfaces()) truth_.read(pass, pass.views[i], result, {*list_, ids_}, view.first_row);
    if (flow_) flow_->read(pass, pass.views[i], result, i);
    if (open_) open_->read(pass, pass.views[i], result, view.first_row);
    if (desc_.truth.bound) truth_.read_bounds(depth_, depth_views_[i], view.first_row, view.rows);
  }
}

// Rows that share a pose, as the views of the camera do. Their items are in `moved`.
std::vector<PixelRows> Camera::all_rows(std::vector<std::vector<ItemPlace>>& moved) const {
  std::vector<PixelRows> rows;
  moved.reserve(views_.views.size());
  for (const CameraView& view : views_.views) {
    if (!rows.empty() && view.first_row < rows.back().first + rows.back().count) continue;
    moved.push_back(places(view.time_s, *list_));
    rows.push_back({.first = view.first_row,
                    .count = view.rows,
                    .world_from_view = world_from_camera(view.time_s) * sensor_from_view(),
                    .places = moved.back()});
  }
  return rows;
}

void Camera::add_splats(unsigned threads) {
  std::vector<std::vector<ItemPlace>> moved;
  const std::vector<PixelRows> rows = all_rows(moved);
  splats_->look(*list_, rows, depth_, threads);
  if (desc_.color) {
    splats_->add_to_color(color_);
    post_process(desc_.effects, time_, layout_, color_);
  }
  if (desc_.depth) splats_->add_to_depth(depth_);
  if (desc_.truth.of_surfaces()) splats_->add_to_truth(truth_, {*list_, ids_});
}

void Camera::add_objects() {
  std::vector<std::vector<ItemPlace>> moved;
  const std::vector<PixelRows> rows = all_rows(moved);
  objects_.begin();
  objects_.add({.world = {*list_, ids_},
                .pixels = truth_.items(),
                .rows = rows,
                .world_from_camera = world_from_sensor_ * sensor_from_view()},
               0, *silhouettes_);
}

void Camera::cast(RayCaster& of_list) {
  RayCaster& caster = layer_world_.caster(of_list);
  if (open_) cast_open_pixels(caster);
  if (rays_) {
    cast_pixels(caster);
    if (flow_) flow_->cast(caster, *list_, *rays_, seen_);
  } else if (flow_) {
    flow_->complete_drawn();
  }
  if (shows_splats_) add_splats(caster.threads());
  if (desc_.truth.boxes) add_objects();
}

void Camera::cast_open_pixels(RayCaster& caster) {
  std::vector<std::vector<ItemPlace>> moved;
  std::vector<PixelRows> rows;
  for (const CameraView& view : views_.views) moved.push_back(places(view.time_s, *list_));
  for (std::size_t i = 0; i < views_.views.size(); ++i) {
    const CameraView& view = views_.views[i];
    rows.push_back({.first = view.first_row,
                    .count = view.rows,
                    .world_from_view = world_from_camera(view.time_s) * sensor_from_view(),
                    .places = moved[i]});
  }
  TruthImages images{.truth = truth_, .flow = flow_ ? &*flow_ : nullptr};
  if (reads_depth()) {
    images.set_depth = [this](std::uint32_t pixel, double depth_m) {
      depth_.pixels.edit()[pixel] = static_cast<float>(depth_m);
    };
  }
  open_->cast(caster, rows, {*list_, ids_}, images);
}

// Views of the same rows share their pose, and their rays are cast together.
void Camera::cast_pixels(RayCaster& caster) {
  const std::size_t pixels = std::size_t{layout_.width_px} * layout_.height_px;
  seen_.assign(pixels, {});
  truth_.begin();
  depth_.width = layout_.width_px;
  depth_.height = layout_.height_px;
  depth_.channels = 1;
  std::vector<float>& depth = depth_.pixels.overwrite();
  if (reads_depth()) depth.assign(pixels, std::numeric_limits<float>::infinity());
  rays_->begin(*list_);
  if (layers_) layers_->begin(*drawn_list_, ids_.instance);
  double bound_m = 0;
  std::uint32_t next_row = 0;
  for (const CameraView& view : views_.views) {
    if (view.first_row < next_row) continue;
    next_row = view.first_row + view.rows;
    const std::vector<ItemPlace> moved = places(view.time_s, *list_);
    const PixelRows rows{.first = view.first_row,
                         .count = view.rows,
                         .world_from_view = world_from_camera(view.time_s) * sensor_from_view(),
                         .places = moved};
    rays_->cast(caster, rows, seen_);
    truth_.read(rows, rays_->directions(), seen_, {*list_, ids_});
    if (layers_) layers_->cast(rows, *rays_);
    if (reads_depth()) {
      bound_m = std::max(bound_m, cast_depth(rows, rays_->directions(), seen_, layout_.width_px, depth));
    }
  }
  whole_bound_m_ = bound_m;
}

// It works with the depth and the views of the last measurement, whenever it is called.
std::function<double()> Camera::depth_bound() const {
  if (shows_splats_ && splats_->in_depth()) return [] { return std::numeric_limits<double>::infinity(); };
  if (resamples() || rays_) {
    return [bound_m = whole_bound_m_.value_or(std::numeric_limits<double>::quiet_NaN())] { return bound_m; };
  }
  if (depth_.pixels.empty()) return [] { return std::numeric_limits<double>::quiet_NaN(); };
  std::vector<std::pair<std::uint32_t, std::uint32_t>> rows;
  for (const CameraView& view : views_.views) rows.emplace_back(view.first_row, view.rows);
  return [depth = depth_, views = measured_views_, rows = std::move(rows)] {
    double bound_m = 0;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const auto [first_row, count] = rows[i];
      const auto first = depth.pixels.begin() + std::ptrdiff_t{first_row} * depth.width;
      const Image part{depth.width, count, 1, std::vector(first, first + std::ptrdiff_t{count} * depth.width)};
      bound_m = std::max(bound_m, depth_error_bound(part, views[i]));
    }
    return bound_m;
  };
}

Measurement Camera::measurement() const {
  Measurement measurement{
      .time_ns = measured_.time_ns, .world_from_sensor = measured_.world_from_sensor, .calibrations = calibrations_};
  measurement.arrays.reserve(2);
  if (desc_.color) measurement.arrays.push_back(image_array("color", color_, ImageContent::color));
  if (desc_.depth) measurement.arrays.push_back(image_array("depth", depth_, ImageContent::depth, "m"));
  truth_.add_to(measurement, "", "");
  if (flow_) flow_->add_to(measurement, "", "");
  if (layers_) layers_->add_to(measurement, "", "");
  objects_.add_to(measurement, std::array{""});
  return measurement;
}

std::vector<NumberOnRequest> Camera::on_request() const {
  if (!desc_.depth) return {};
  return {{std::string(kDepthErrorBound), "m", depth_bound()}};
}

}  // namespace simvis
