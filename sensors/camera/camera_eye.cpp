#include "sensors/camera/camera_eye.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <utility>

#include <simvis/pose.h>
#include "effects/camera/rolling_shutter.h"
#include "engine/base/assert.h"
#include "scenegraph/motion_path.h"
#include "sensors/camera/resampled_image.h"

namespace simvis {
namespace {

// Views of two eyes share a pass if they fit side by side into a target that every Vulkan device supports.
constexpr std::uint32_t kMaxSharedWidth_px = 4096;

// The views of a direct image divide it into rows.
View whole_image(View first, std::uint32_t height_px) {
  first.y_px = 0;
  first.height_px = height_px;
  return first;
}

// The rows of a direct image that are those of a view.
Image part_of(const Image& image, const CameraView& view) {
  const auto first = image.pixels.begin() + std::ptrdiff_t{view.first_row} * image.width;
  return {image.width, view.rows, 1, std::vector(first, first + std::ptrdiff_t{view.rows} * image.width)};
}

// Those of ascending pixels that are in the rows of a view, as pixels of these rows.
std::vector<std::uint32_t> part_of(const std::vector<std::uint32_t>& pixels, const CameraView& view,
                                   std::uint32_t width_px) {
  const std::uint32_t start = view.first_row * width_px;
  const auto first = std::ranges::lower_bound(pixels, start);
  std::vector<std::uint32_t> part(first, std::ranges::lower_bound(pixels, start + view.rows * width_px));
  for (std::uint32_t& pixel : part) pixel -= start;
  return part;
}

std::vector<float>& start_image(Image& image, const CameraLayout& layout) {
  image.width = layout.width_px;
  image.height = layout.height_px;
  image.channels = 1;
  return image.pixels.overwrite();
}

}  // namespace

void EyeWorld::sense(const SensedWorld& world, const SensorNeeds& needs) {
  if (needs.item_moves) {
    moves = world.item_moves();
    path = &world.sensor_path();
  }
  if (needs.item_ids) ids = world.item_ids();
  if (needs.objects) objects = world.objects();
  if (needs.scene) kept_scene = scenes.keep(world.scene(), moves);
}

void EyeWorld::begin(const DrawList& of_frame) {
  drawn = &of_frame;
  list = &layers.begin(of_frame);
}

CameraEye::CameraEye(EyeDesc desc, EyeOptics& optics, const EyeWorld& world)
    : desc_(std::move(desc)),
      optics_(optics),
      world_(world),
      truth_(desc_.truth, desc_.pinhole.width_px, desc_.pinhole.height_px) {
  const bool depth = desc_.depth || desc_.disparity() || desc_.truth.any();
  if (depth && !optics.rays && !optics.resamples()) open_.emplace(optics.layout, optics.views, desc_.pinhole.near_m);
  if (desc_.truth.layers > 0) layers_.emplace(desc_.truth.layers, desc_.pinhole.width_px, desc_.pinhole.height_px);
  if (desc_.paths.by_paths()) {
    paths_.emplace(desc_.paths, desc_.sensor, desc_.seed, optics.layout, desc_.pinhole.near_m);
  }
  if (desc_.truth.flow.any()) flow_.emplace(desc_.truth.flow, optics.layout, optics.views, desc_.pinhole.near_m);
}

SensorNeeds CameraEye::needs() const {
  return {.item_moves = is_late(),
          .item_ids = desc_.truth.needs_ids(),
          .objects = desc_.truth.boxes,
          .scene = desc_.truth.flow.any()};
}

HistoryDependence CameraEye::history_dependence() const {
  if (remembers(desc_.effects)) return HistoryDependence::measurements;
  if (desc_.truth.flow.forward && !optics_.rays) return HistoryDependence::last_measurement;
  return is_late() || flow_ ? HistoryDependence::poses : HistoryDependence::none;
}

// Whether some rows are exposed before the frame's time.
bool CameraEye::is_late() const {
  const auto before = [](const auto& each) { return each.time_s != 0; };
  return !desc_.at_once &&
         (std::ranges::any_of(optics_.views.views, before) || std::ranges::any_of(optics_.samples, before));
}

void CameraEye::skip_frame(const FrameTime& time, const glm::dmat4& world_from_camera) {
  begin(time);
  world_from_camera_ = world_from_camera;
  if (flow_) flow_->skip(moment());
  last_ = Past{time.time_ns, world_from_camera};
}

// A frame that was not finished is repeated; its own measurement then does not count as the previous one.
void CameraEye::begin(const FrameTime& time) {
  time_ = time;
  if (last_ && last_->time_ns < time.time_ns) before_ = last_;
}

// What time_s is of the time between the last two measurements.
double CameraEye::share_before(double time_s) const {
  const double between_s = static_cast<double>(time_.time_ns - before_->time_ns) / 1e9;
  SIMVIS_ASSERT(between_s > 0);
  return time_s / between_s;
}

glm::dmat4 CameraEye::world_from_camera(double time_s) const {
  if (!before_ || time_s == 0) return world_from_camera_;
  if (world_.path != nullptr) return place_at(*world_.path, share_before(time_s), world_from_camera_);
  return pose_between(before_->world_from_camera, world_from_camera_, 1 + share_before(time_s));
}

// Where items were that have moved since.
std::vector<ItemPlace> CameraEye::places(double time_s) const {
  std::vector<ItemPlace> places;
  if (!before_ || time_s == 0) return places;
  const double share = share_before(time_s);
  const DrawList& list = *world_.drawn;
  for (const ItemMove& move : world_.moves) {
    places.push_back({move.item, place_at(*move.path, share, list.world_from_node[list.items[move.item].transform])});
  }
  return places;
}

// Views of the same rows share their pose.
CameraMoment CameraEye::moment() const {
  CameraMoment moment{.time_ns = time_.time_ns, .scene = world_.kept_scene, .rows = {}};
  std::uint32_t next_row = 0;
  for (const CameraView& view : optics_.views.views) {
    if (view.first_row < next_row) continue;
    next_row = view.first_row + view.rows;
    moment.rows.push_back({.first = view.first_row,
                           .count = view.rows,
                           .world_from_view = world_from_camera(view.time_s) * sensor_from_view(),
                           .share = before_ && view.time_s != 0 ? share_before(view.time_s) : 0});
  }
  return moment;
}

// Rows that share a pose, as the views of the eye do, `time_s` after their time. Their items are in `moved`.
std::vector<PixelRows> CameraEye::all_rows(std::vector<std::vector<ItemPlace>>& moved, double time_s) const {
  std::vector<PixelRows> rows;
  moved.clear();
  moved.reserve(optics_.views.views.size());
  for (const CameraView& view : optics_.views.views) {
    if (!rows.empty() && view.first_row < rows.back().first + rows.back().count) continue;
    moved.push_back(places(view.time_s + time_s));
    rows.push_back({.first = view.first_row,
                    .count = view.rows,
                    .world_from_view = world_from_camera(view.time_s + time_s) * sensor_from_view(),
                    .places = moved.back()});
  }
  return rows;
}

// Whether the eye or anything else has moved since the last measurement.
bool CameraEye::moves() const {
  if (!before_) return false;
  const bool eye_moves =
      world_.path != nullptr ? !world_.path->pieces.empty() : before_->world_from_camera != world_from_camera_;
  return eye_moves || !world_.moves.empty();
}

// One time shows an image through a pinhole in which nothing moves.
void CameraEye::choose_samples() {
  taken_samples_ = optics_.still_samples;
  const bool sampled = desc_.draws_color() && !optics_.layout.exposure.one_picture();
  if (sampled && (optics_.layout.exposure.aperture_m != 0 || moves())) taken_samples_ = optics_.samples;
}

void CameraEye::begin_plan(const glm::dmat4& world_from_camera) {
  world_from_camera_ = world_from_camera;
  looks_at_splats_ = may_show_splats() && has_splats(*world_.drawn);
  shows_round_ = open_ && open_->begin(*world_.drawn, desc_.truth.needs_items());
  choose_samples();
  choose_drawings();
}

// Colour, then depth, if one view cannot serve both.
void CameraEye::choose_drawings() {
  drawings_.clear();
  const bool depth = draws_depth(), one_sample = optics_.layout.exposure.one_picture();
  const char* const why =
      one_sample ? why_depth_apart(desc_.sampling) : ", apart: at one time, from the centre of the lens";
  const bool apart = desc_.draws_color() && depth && why != nullptr;
  for (std::size_t i = 0; desc_.draws_color() && i < taken_samples_.size(); ++i) {
    const std::string sample =
        "sample " + std::to_string(i + 1) + " of " + std::to_string(taken_samples_.size()) + " of the ";
    const bool both = depth && !apart;
    drawings_.push_back({.color = true,
                         .depth = both,
                         .what = (taken_samples_.size() == 1 ? "" : sample) + (both ? "colour and depth" : "colour"),
                         .sample = taken_samples_[i]});
  }
  if (depth && (apart || !desc_.draws_color())) {
    drawings_.push_back({.depth = true, .what = "depth", .why = apart ? why : ""});
  }
}

void CameraEye::draw(std::size_t drawing, FramePlan& plan, const Drawing* beside) {
  Drawing& own = drawings_[drawing];
  const std::uint32_t supersampling = own.color ? desc_.sampling.supersampling : 1;
  const bool shares =
      beside != nullptr && !optics_.resamples() && 2 * desc_.pinhole.width_px * supersampling <= kMaxSharedWidth_px;
  std::uint32_t left_px = 0;
  if (shares) {
    Pass& pass = plan.passes[beside->first_pass];
    own.first_pass = beside->first_pass;
    own.first_view = pass.views.size();
    left_px = std::exchange(pass.width_px, pass.width_px + desc_.pinhole.width_px);
  } else {
    own.first_pass = plan.passes.size();
    own.first_view = 0;
    for (const glm::uvec2& size : optics_.views.pass_size_px) {
      plan.passes.push_back({.name = desc_.sensor,
                             .width_px = size.x,
                             .height_px = size.y,
                             .color = own.color,
                             .depth = own.depth,
                             .items = own.depth && draws_items(),
                             .views = {},
                             .supersampling = supersampling,
                             .msaa = own.color ? desc_.sampling.msaa : 1});
    }
  }
  const std::vector<CameraView>& views = optics_.views.views;
  for (std::size_t i = 0; i < views.size(); ++i) {
    View view = view_of(views[i], own);
    if (views.size() > 1) view.name += "/view " + std::to_string(i);
    view.x_px += left_px;
    plan.passes[own.first_pass + views[i].pass].views.push_back(std::move(view));
  }
}

View CameraEye::view_of(const CameraView& seen, const Drawing& drawing) const {
  View view;
  view.name = desc_.name;
  view.reason = drawing.what + " of " + desc_.title + drawing.why;
  if (seen.rows < desc_.pinhole.height_px) {
    const double before_s = std::round(-seen.time_s * 1e9) / 1e9;
    view.reason += ": rows " + std::to_string(seen.first_row) + " to " +
                   std::to_string(seen.first_row + seen.rows - 1) + ", " + format_number(before_s) + " s before";
  }
  view.pinhole = pinhole_of(drawing.sample, seen.pinhole, optics_.layout.exposure.focus_m);
  view.max_error_px = drawing.color ? desc_.sampling.max_error_px : 0;
  view.near_m = desc_.pinhole.near_m;
  const double time_s = seen.time_s + drawing.sample.time_s;
  view.view_from_world = rigid_inverse(world_from_camera(time_s) * sensor_from_view() *
                                       glm::translate(glm::dmat4(1), glm::dvec3(drawing.sample.lens_m, 0)) *
                                       glm::dmat4(glm::transpose(seen.face_from_view)));
  view.places = places(time_s);
  view.x_px = seen.x_px;
  view.y_px = seen.y_px;
  view.width_px = seen.width_px;
  view.height_px = seen.height_px;
  return view;
}

void CameraEye::finish_plan(FramePlan& plan) {
  plan_rays(plan);
  if (looks_at_splats_) {
    if (!splats_) splats_.emplace(optics_.layout, optics_.views, desc_.pinhole.near_m);
    splats_->plan(*world_.drawn, desc_.title, desc_.sensor, plan);
  }
  if (open_) open_->plan(desc_.sensor, plan);
  if (flow_) {
    flow_->begin(moment());
    flow_->plan(desc_.sensor, !optics_.rays, plan);
  }
  depth_views_.clear();
  if (!draws_depth() || !reads_depth()) return;
  const Drawing& depth = drawings_.back();
  std::size_t next = 0;  // in its pass
  for (const CameraView& view : optics_.views.views) {
    if (&view != optics_.views.views.data() && view.pass != (&view - 1)->pass) next = 0;
    const Pass& pass = plan.passes[depth.first_pass + view.pass];
    depth_views_.push_back(depth_view(pass.views[depth.first_view + next++], *world_.drawn));
  }
}

void CameraEye::plan_rays(FramePlan& plan) const {
  const std::uint64_t pixels = std::uint64_t{desc_.pinhole.width_px} * desc_.pinhole.height_px;
  if (optics_.rays) {
    plan.casts.push_back(
        {.name = desc_.sensor,
         .reason = "the centre of each pixel of " + desc_.title +
                   (optics_.resamples() ? ", which is no pixel of a view" : ", as what is measured needs"),
         .max_rays = pixels});
  }
  if (paths_) paths_->plan(desc_.title, plan);
  if (desc_.truth.boxes) plan.casts.push_back(silhouette_cast(desc_.title, desc_.sensor, pixels));
}

CameraEye::Drawn CameraEye::drawn(const Drawing& drawing, const FramePlan& plan,
                                  std::span<const PassResult> results) const {
  const std::size_t first = drawing.first_pass, count = optics_.views.pass_size_px.size();
  return {std::span(plan.passes).subspan(first, count), results.subspan(first, count), drawing.first_view};
}

void CameraEye::collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) {
  if (desc_.draws_color()) collect_color(time, plan, results);
  if (draws_depth()) collect_depth(drawn(drawings_.back(), plan, results));
  measured_ = {time.time_ns, world_from_camera_};
  last_ = measured_;
}

void CameraEye::collect_color(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) {
  mean_.begin();
  const bool several = taken_samples_.size() > 1;
  for (std::size_t i = 0; i < taken_samples_.size(); ++i) {
    read_color_of(drawn(drawings_[i], plan, results));
    if (several) mean_.add(color_, taken_samples_[i].colors);
  }
  if (several) mean_.finish(color_);
  if (!looks_at_splats_) post_process(desc_.effects, time, optics_.layout, color_);
}

void CameraEye::read_color_of(const Drawn& drawn) {
  if (optics_.resamples()) {
    resample_color(optics_.layout, optics_.views, drawn.passes, drawn.results, color_);
  } else {
    read_color(drawn.passes[0], whole_image(drawn.view(0), desc_.pinhole.height_px), drawn.results[0], color_);
  }
}

void CameraEye::collect_depth(const Drawn& drawn) {
  drawn_depth_ = {};  // its memory is used again
  for (DepthView& view : depth_views_) view.reach.depth_snap_px = drawn.results[0].depth_snap_px;
  if (optics_.resamples()) {
    whole_bound_m_ = resample_depth(optics_.layout, optics_.views, drawn.passes, drawn.results, depth_views_, depth_);
  } else if (reads_depth()) {
    read_depth(drawn.passes[0], whole_image(drawn.view(0), desc_.pinhole.height_px), drawn.results[0], depth_);
  }
  if (desc_.disparity()) read_disparity(drawn);
  if (desc_.truth.any() || shows_round_) read_truth(drawn);
  if (!optics_.resamples()) {
    for (DepthView& view : depth_views_) view.rounding.complete();  // the list changes before someone asks
  }
  std::swap(measured_views_, depth_views_);
}

void CameraEye::read_truth(const Drawn& drawn) {
  truth_.begin();
  const Pass& pass = drawn.passes[0];
  const PassResult& result = drawn.results[0];
  for (std::size_t i = 0; i < optics_.views.views.size(); ++i) {
    const CameraView& seen = optics_.views.views[i];
    const View& view = drawn.view(i);
    const std::vector<double> bounds_m = depth_bounds(i);
    if (desc_.truth.of_surfaces()) {
      truth_.read(pass, view, result, world_.identified(), seen.first_row, bounds_m);
    }
    if (flow_) flow_->read(pass, view, result, i);
    if (open_) open_->read(pass, view, result, seen.first_row, desc_.truth.needs_exact_points(), bounds_m);
  }
}

// Of the pixels of a view; empty unless an output needs them.
std::vector<double> CameraEye::depth_bounds(std::size_t view) const {
  if (!desc_.truth.needs_bounds()) return {};
  return depth_error_bounds(part_of(depth_, optics_.views.views[view]), depth_views_[view]);
}

// Reversed depth is d = near / Z, so the disparity of a direct image is d times a constant.
void CameraEye::read_disparity(const Drawn& drawn) {
  std::vector<float>& pixels = start_image(disparity_, optics_.layout);
  pixels.resize(std::size_t{desc_.pinhole.width_px} * desc_.pinhole.height_px);
  if (optics_.resamples()) {
    for (std::size_t i = 0; i < pixels.size(); ++i) set_disparity(i, static_cast<double>(depth_.pixels[i]));
    return;
  }
  const double disparity_per_d = disparity_times_depth() / desc_.pinhole.near_m;
  const View view = whole_image(drawn.view(0), desc_.pinhole.height_px);
  for (std::uint32_t row = 0; row < desc_.pinhole.height_px; ++row) {
    const std::size_t from = std::size_t{row} * drawn.passes[0].width_px + view.x_px;
    std::ranges::transform(drawn.results[0].depth.subspan(from, desc_.pinhole.width_px),
                           pixels.begin() + std::ptrdiff_t{row} * desc_.pinhole.width_px,
                           [&](float d) { return static_cast<float>(disparity_per_d * static_cast<double>(d)); });
  }
}

// A surface beside or behind the camera is in no rectified image.
void CameraEye::set_disparity(std::size_t pixel, double depth_m) {
  disparity_.pixels.edit()[pixel] = depth_m > 0 ? static_cast<float>(disparity_times_depth() / depth_m) : 0;
}

// Where nothing moves, all samples have the same rows.
void CameraEye::trace(RayCaster& caster) {
  if (!paths_) return;
  paths_->begin(*world_.drawn, time_);
  const bool moving = moves();
  std::vector<std::vector<ItemPlace>> moved;
  std::vector<PixelRows> rows;
  for (std::uint32_t sample = 0; paths_->wants(sample); ++sample) {
    if (sample == 0 || moving) rows = all_rows(moved, paths_->time_s(sample));
    paths_->take(sample, caster, rows);
  }
  paths_->finish(color_);
  if (desc_.color) post_process(desc_.effects, time_, optics_.layout, color_);
}

void CameraEye::cast(RayCaster& caster) {
  if (open_) cast_open_pixels(caster);
  if (optics_.rays) {
    cast_pixels(caster);
    if (flow_) flow_->cast(caster, *world_.list, *optics_.rays, optics_.seen);
  } else if (flow_) {
    flow_->complete_drawn(caster.threads());
  }
  if (looks_at_splats_) add_splats(caster.threads());
}

// Bounds of drawn depths follow from these depths alone.
void CameraEye::keep_drawn_depth() {
  if (drawn_depth_.pixels.empty()) drawn_depth_ = depth_;
}

void CameraEye::cast_open_pixels(RayCaster& caster) {
  std::vector<std::vector<ItemPlace>> moved;
  const std::vector<PixelRows> rows = all_rows(moved);
  const TruthImages images{
      .truth = truth_, .flow = flow_ ? &*flow_ : nullptr, .set_depth = [this](std::uint32_t pixel, double depth_m) {
        keep_drawn_depth();
        if (reads_depth()) depth_.pixels.edit()[pixel] = static_cast<float>(depth_m);
        if (desc_.disparity()) set_disparity(pixel, depth_m);
      }};
  open_->cast(caster, rows, world_.identified(), images);
}

// Views of the same rows share their pose, and their rays are cast together.
void CameraEye::cast_pixels(RayCaster& caster) {
  PixelRays& rays = *optics_.rays;
  const std::size_t pixels = rays.directions().size();
  optics_.seen.assign(pixels, {});
  truth_.begin();
  std::vector<float>& depth = start_image(depth_, optics_.layout);
  if (reads_depth()) depth.assign(pixels, std::numeric_limits<float>::infinity());
  rays.begin(*world_.list);
  if (layers_) layers_->begin(*world_.drawn, world_.ids.instance);
  double bound_m = 0;
  std::vector<std::vector<ItemPlace>> moved;
  for (const PixelRows& rows : all_rows(moved)) {
    rays.cast(caster, rows, optics_.seen);
    truth_.read(rows, rays.directions(), optics_.seen, world_.identified());
    if (layers_) layers_->cast(rows, rays, caster.threads());
    if (reads_depth()) {
      bound_m = std::max(bound_m, cast_depth(rows, rays.directions(), optics_.seen, desc_.pinhole.width_px, depth));
    }
  }
  whole_bound_m_ = bound_m;
  if (!desc_.disparity()) return;
  start_image(disparity_, optics_.layout).resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) set_disparity(i, optics_.seen[i].range_m * rays.directions()[i].z);
}

// In front of what the eye has seen.
void CameraEye::add_splats(unsigned threads) {
  std::vector<std::vector<ItemPlace>> moved;
  const std::vector<PixelRows> rows = all_rows(moved);
  splats_->look(*world_.list, rows, depth_, threads);
  if (desc_.color) {
    splats_->add_to_color(color_);
    post_process(desc_.effects, time_, optics_.layout, color_);
  }
  keep_drawn_depth();
  if (desc_.depth) splats_->add_to_depth(depth_);
  if (desc_.disparity()) splats_->add_to_disparity(disparity_, disparity_times_depth());
  if (desc_.truth.of_surfaces()) splats_->add_to_truth(truth_, world_.identified());
}

void CameraEye::add_objects(ObjectTable& objects, std::size_t view, unsigned threads) const {
  std::vector<std::vector<ItemPlace>> moved;
  const std::vector<PixelRows> rows = all_rows(moved);
  objects.add({.world = world_.identified(),
               .pixels = truth_.items(),
               .rows = rows,
               .world_from_camera = world_from_camera_ * sensor_from_view(),
               .threads = threads},
              view, *optics_.silhouettes);
}

// It works with the depth and the views of the last measurement.
std::function<double()> CameraEye::depth_bound() const {
  if (looks_at_splats_ && splats_->in_depth()) return [] { return std::numeric_limits<double>::infinity(); };
  if (optics_.resamples() || optics_.rays) {
    return [bound_m = whole_bound_m_.value_or(std::numeric_limits<double>::quiet_NaN())] { return bound_m; };
  }
  const Image& drawn = drawn_depth_.pixels.empty() ? depth_ : drawn_depth_;
  if (drawn.pixels.empty()) return [] { return std::numeric_limits<double>::quiet_NaN(); };
  return [depth = drawn, views = measured_views_, rows = optics_.views.views, cast = open_->pixels(),
          bound_of_cast_m = open_->bound_m()] {
    double bound_m = bound_of_cast_m;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      bound_m =
          std::max(bound_m, depth_error_bound(part_of(depth, rows[i]), views[i], part_of(*cast, rows[i], depth.width)));
    }
    return bound_m;
  };
}

void CameraEye::add_to(Measurement& measurement) const {
  const auto add = [&](const std::string& name, const Image& image, ImageContent content, const char* unit) {
    measurement.arrays.push_back(image_array(name, image, content, unit, desc_.view));
  };
  if (desc_.color) add(desc_.color_name, color_, ImageContent::color, "");
  if (desc_.paths.stddev) add(desc_.color_name + "_stddev", paths_->stddev(), ImageContent::numbers, "");
  if (desc_.depth) add(desc_.prefix + "depth", depth_, ImageContent::depth, "m");
  truth_.add_to(measurement, desc_.prefix, desc_.view);
  if (flow_) flow_->add_to(measurement, desc_.prefix, desc_.view);
  if (layers_) layers_->add_to(measurement, desc_.prefix, desc_.view);
}

void CameraEye::archive(StateArchive& state, const CameraEye* beside) {
  state(before_, last_);
  // Of a frame that failed, both are the one before; the next frame comes behind it.
  state.require(!before_ || (last_ && before_->time_ns <= last_->time_ns));
  state.require(!before_ || !state.is_reading() || before_->time_ns <= state.last_ns());
  if (flow_) flow_->archive(state, beside == nullptr ? nullptr : &*beside->flow_);
  for (const ChosenCameraEffect& each : desc_.effects) {
    if (auto* const own = dynamic_cast<Stateful*>(std::const_pointer_cast<CameraEffect>(each.effect).get())) {
      own->archive(state);
    } else if (each.effect->remembers() && state.is_on()) {
      state.refuse("effect " + std::string(each.type->name) + " remembers earlier images, expected it to be Stateful");
    }
  }
}

}  // namespace simvis
