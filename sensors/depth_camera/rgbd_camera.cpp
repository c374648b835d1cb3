#include "sensors/depth_camera/rgbd_camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

#include <simvis/pose.h>
#include "engine/base/thread_pool.h"
#include "engine/draw/splat_item.h"
#include "engine/splats/splat_rays.h"
#include "sensors/camera/camera_outputs.h"
#include "sensors/camera/depth_error_bound.h"
#include "sensors/camera/pixel_truth.h"
#include "sensors/cloud_attributes.h"
#include "sensors/depth_camera/rgbd_camera_presets.h"

namespace simvis {
namespace {

constexpr std::uint8_t kRgbdCameraCapabilities = kHasImageSensor | kHasLens | kSeesSplats;

std::vector<OutputSpec> rgbd_camera_outputs(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  OutputSpec depth = depth_output("depth", a);
  depth.meaning = "measured depth along the optical axis";
  depth.bound.clear();
  OutputSpec bound = depth_bound_output(a);
  bound.meaning = "largest error of all depths of the frame before noise and rounding";
  return {color_output("color", a),
          depth,
          {.name = "depth_state",
           .kind = OutputKind::image,
           .value_type = ValueType::u8,
           .shape = depth.shape,
           .meaning = "0: measured, 1: nothing seen, 2: hidden from the second viewpoint, 3: outside its image, 4: "
                      "beyond depth_min or depth_max, or its disparity is not above 0",
           .when = "depth_state among outputs",
           .given = a.flag("outputs", "depth_state")},
          bound};
}

const SensorRegistration kRgbdCameraRegistration(
    {.name = "rgbd_camera",
     .summary = "A depth camera that triangulates between two viewpoints, two imagers or imager and projector; colour.",
     .notes =
         "The sensor frame is that of the imager. The second viewpoint stands baseline to its right (-y). A pixel "
         "has a depth only where the second viewpoint sees the same point: objects cast shadows without depth, and "
         "a band at the left edge has none. Errors are those of the disparity f baseline / Z.",
     .capabilities = kRgbdCameraCapabilities,
     .attributes = rows_of<RgbdCameraDesc>().table(),
     .create = create_sensor<RgbdCamera, RgbdCameraDesc>,
     .presets = rgbd_camera_presets(),
     .outputs = rgbd_camera_outputs});

EyeDesc color_eye_of(const std::string& name, const RgbdCameraDesc& desc) {
  return {.name = name,
          .sensor = name,
          .title = "RGB-D camera " + name,
          .color_name = "color",
          .pinhole = desc.pinhole,
          .color = desc.color,
          .sampling = desc.sampling,
          .effects = desc.effects};
}

}  // namespace

AttributeRows<RgbdCameraDesc> RgbdCameraDesc::rows() {
  using Desc = RgbdCameraDesc;
  constexpr AttributeLimits kBelowHalfTurn{.min = 0, .max = 180, .open_min = true, .open_max = true};
  return {kPresetAttribute,
          nested(&Desc::pinhole, PinholeDesc::rows()),
          row(&Desc::baseline_m, "baseline", "m", kAboveZero,
              "distance from the imager to the second viewpoint, an imager or a projector"),
          row(&Desc::second_hfov_rad, "second_hfov", kDegrees, kBelowHalfTurn,
              "horizontal field of view of the second viewpoint, with the aspect ratio of the image; default: that of "
              "the first one"),
          row(&Desc::disparity_noise_px, "disparity_noise", "px", kNotNegative,
              "standard deviation s of the disparity: that of a depth Z is Z^2 s / (f baseline)"),
          row(&Desc::disparity_step_px, "disparity_step", "px", kNotNegative,
              "disparities are rounded to multiples of it; 0: they are not"),
          row(&Desc::depth_min_m, "depth_min", "m", kNotNegative, "nearer surfaces have no depth"),
          row(&Desc::depth_max_m, "depth_max", "m", kAboveZero, "farther surfaces have no depth; default: all have one")
              .without_default(),
          flags_row<Desc>("outputs", {{"color", &Desc::color}, {"depth", &Desc::depth}, {"depth_state", &Desc::state}},
                          "what the camera measures; depth_state: why a pixel has no depth"),
          nested(&Desc::sampling, ColorSampling::rows()),
          kDenseAttribute,
          kRateAttribute};
}

void RgbdCameraDesc::complete(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  check_max_error_px(sampling, color, a);
  if (depth_min_m > depth_max_m) {
    fail_at(a.where("depth_max"), "attribute \"depth_max\": " + format_number(depth_max_m) +
                                      " is not allowed with depth_min=\"" + format_number(depth_min_m) +
                                      "\", expected that or more");
  }
  effects =
      camera_effects(kRgbdCameraCapabilities, {a, context.seed, context.name, shown_outputs(color, depth || state)});
}

RgbdCamera::RgbdCamera(std::string name, const RgbdCameraDesc& desc)
    : name_(std::move(name)),
      desc_(desc),
      eye_desc_(color_eye_of(name_, desc)),
      optics_(eye_desc_),
      world_({}),
      eye_(eye_desc_, optics_, world_),
      rays_(optics_.layout, optics_.views, desc.pinhole.near_m),
      second_(desc.second_hfov_rad
                  ? centred_pinhole(desc.pinhole.width_px, desc.pinhole.height_px, *desc.second_hfov_rad)
                  : optics_.layout.pinhole),
      random_(desc.seed, name_ + "/disparity"),
      calibrations_(PixelOptics(name_, optics_.layout, desc.pinhole.near_m).calibrations()) {}

void RgbdCamera::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  moment_.world_from_sensor = world_from_sensor;
  world_.begin(list);
  eye_.begin_plan(world_from_sensor);
  for (std::size_t i = 0; i < eye_.drawings().size(); ++i) eye_.draw(i, plan);
  eye_.finish_plan(plan);
  if (casts()) plan_casts(list, plan);
  plan_effects(name_, desc_.effects, plan);
}

void RgbdCamera::plan_casts(const DrawList& list, FramePlan& plan) {
  const std::string rays = "the centre of each pixel of RGB-D camera " + name_ + ", from both viewpoints";
  const std::uint64_t max_rays = 2 * std::uint64_t{desc_.pinhole.width_px} * desc_.pinhole.height_px;
  plan.casts.push_back({.name = name_, .reason = rays, .max_rays = max_rays});
  looks_at_splats_ = has_splats(list);
  if (!looks_at_splats_) return;
  if (!splats_) splats_.emplace(optics_.layout, optics_.views, desc_.pinhole.near_m);
  plan_splat_rays(list, rays, max_rays, name_, plan);
}

void RgbdCamera::collect(const FrameTime& time, const FramePlan& plan, std::span<const PassResult> results) {
  moment_.time = time;
  eye_.collect(time, plan, results);
  if (!casts()) measured_ = moment_;
}

void RgbdCamera::cast(RayCaster& caster) {
  eye_.cast(caster);
  if (!casts()) return;
  const PixelRows rows{.count = desc_.pinhole.height_px,
                       .world_from_view = moment_.world_from_sensor * sensor_from_view()};
  cast_first(caster, rows);
  cast_second(caster, rows.world_from_view);
  measure();
  measured_ = moment_;
}

// The surfaces of all pixels, and their depths.
void RgbdCamera::cast_first(RayCaster& caster, const PixelRows& rows) {
  seen_.assign(rays_.directions().size(), {});
  rays_.begin(*world_.drawn);
  rays_.cast(caster, rows, seen_);
  depth_.width = desc_.pinhole.width_px;
  depth_.height = desc_.pinhole.height_px;
  depth_.channels = 1;
  std::vector<float>& depth = depth_.pixels.overwrite();
  depth.resize(seen_.size());
  bound_m_ = cast_depth(rows, rays_.directions(), seen_, desc_.pinhole.width_px, depth);
  if (!looks_at_splats_) return;
  splats_->look(*world_.drawn, std::span(&rows, 1), depth_, caster.threads());
  splats_->add_to_surfaces(seen_);
  if (splats_->in_depth()) bound_m_ = std::numeric_limits<double>::infinity();
}

// Whether the image of the second viewpoint has the point; view frame of the first one.
bool RgbdCamera::in_second_image(const glm::dvec3& point_m) const {
  if (point_m.z <= 0) return false;
  double column_px = second_.fx_px * (point_m.x - desc_.baseline_m) / point_m.z + second_.cx_px,
         row_px = second_.fy_px * point_m.y / point_m.z + second_.cy_px;
  if (optics_.resamples() && !desc_.second_hfov_rad) {
    const auto seen = optics_.layout.pixel(point_m - glm::dvec3(desc_.baseline_m, 0, 0));
    if (!seen) return false;
    column_px = seen->x;
    row_px = seen->y;
  }
  return column_px >= 0 && column_px < desc_.pinhole.width_px && row_px >= 0 && row_px < desc_.pinhole.height_px;
}

// States of all pixels before their depths are measured.
void RgbdCamera::cast_second(RayCaster& caster, const glm::dmat4& world_from_view) {
  const glm::dmat4 world_from_second = glm::translate(world_from_view, second_m());
  Sights sights = second_sights();
  sights.hits.resize(sights.pixels.size());
  caster.cast(world_from_second, sights.directions, sights.hits, sights.near_m);
  if (looks_at_splats_) stop_at_splats(world_from_second, caster.threads(), sights);
  for (std::size_t i = 0; i < sights.pixels.size(); ++i) {
    states_[sights.pixels[i]] = is_hidden(sights, i) ? State::hidden : State::measured;
  }
}

// Sets the states of the pixels that have none.
RgbdCamera::Sights RgbdCamera::second_sights() {
  Sights sights;
  states_.assign(seen_.size(), State::nothing);
  for (std::uint32_t pixel = 0; pixel < seen_.size(); ++pixel) {
    if (seen_[pixel].item == kNoItem) continue;
    const glm::dvec3 point_m = seen_[pixel].range_m * rays_.directions()[pixel];
    states_[pixel] = State::outside;
    if (!in_second_image(point_m)) continue;
    sights.pixels.push_back(pixel);
    sights.distances_m.push_back(glm::distance(point_m, second_m()));
    sights.directions.push_back((point_m - second_m()) / sights.distances_m.back());
    sights.near_m.push_back(desc_.pinhole.near_m / sights.directions.back().z);
  }
  return sights;
}

// Replaces hits by the splats before them at which half of the light is left. Rays are given by pixel, as those of
// neighbours are looked at together.
void RgbdCamera::stop_at_splats(const glm::dmat4& world_from_second, unsigned threads, Sights& sights) const {
  std::vector<glm::dvec3> directions(seen_.size(), glm::dvec3(0));
  std::vector<double> near_m(seen_.size()), end_m(seen_.size());
  for (std::size_t i = 0; i < sights.pixels.size(); ++i) {
    directions[sights.pixels[i]] = sights.directions[i];
    near_m[sights.pixels[i]] = sights.near_m[i];
    end_m[sights.pixels[i]] = sights.hits[i].range_m;
  }
  std::vector<SplatSight> seen(seen_.size());
  see_through(see_splats(*world_.drawn, world_from_second, {}), {desc_.pinhole.width_px, directions, near_m, end_m},
              *shared_thread_pool(threads), seen);
  for (std::size_t i = 0; i < sights.pixels.size(); ++i) {
    const SplatSight& sight = seen[sights.pixels[i]];
    if (sight.half_item != kNoItem) sights.hits[i] = {.range_m = sight.half_m, .item = sight.half_item};
  }
}

// Whether the second viewpoint sees something else than the surface of the pixel.
bool RgbdCamera::is_hidden(const Sights& sights, std::size_t ray) const {
  constexpr double kTouching = 1e-6;  // of the distance, see Limits
  constexpr double kSame_px = 1;      // of disparity, see Splats
  const RayHit& hit = sights.hits[ray];
  const double distance_m = sights.distances_m[ray];
  const auto is_splat = [&](std::uint32_t item) { return is_splat_item(*world_.drawn, item); };
  if (!std::isfinite(hit.range_m)) return is_splat(seen_[sights.pixels[ray]].item);
  if (!is_splat(seen_[sights.pixels[ray]].item) && !is_splat(hit.item)) {
    return hit.range_m < (1 - kTouching) * distance_m;
  }
  const double per_range = disparity_times_depth() / sights.directions[ray].z;
  return std::abs(per_range / hit.range_m - per_range / distance_m) > kSame_px;
}

// With the errors of its disparity; not above 0: the disparity is not.
double RgbdCamera::measured_depth(std::size_t pixel) const {
  const double z_m = seen_[pixel].range_m * rays_.directions()[pixel].z;
  if (desc_.disparity_noise_px == 0 && desc_.disparity_step_px == 0) return z_m;
  const double scale = disparity_times_depth();
  double disparity_px = scale / z_m;
  if (desc_.disparity_noise_px > 0) {
    disparity_px +=
        desc_.disparity_noise_px * random_.gaussian(random_key(moment_.time), static_cast<std::uint32_t>(pixel), 0);
  }
  if (desc_.disparity_step_px > 0) {
    disparity_px = std::round(disparity_px / desc_.disparity_step_px) * desc_.disparity_step_px;
  }
  return disparity_px > 0 ? scale / disparity_px : 0;
}

// Depths are those of the true surfaces before.
void RgbdCamera::measure() {
  std::vector<float>& depth = depth_.pixels.edit();
  std::vector<std::uint8_t>& states = state_.overwrite();
  states.resize(states_.size());
  for (std::size_t pixel = 0; pixel < states_.size(); ++pixel) {
    State& state = states_[pixel];
    if (state == State::measured) {
      const double z_m = measured_depth(pixel);
      if (z_m > 0 && z_m >= desc_.depth_min_m && z_m <= desc_.depth_max_m) {
        depth[pixel] = static_cast<float>(z_m);
      } else {
        state = State::beyond;
      }
    }
    if (state != State::measured) depth[pixel] = std::numeric_limits<float>::infinity();
    states[pixel] = static_cast<std::uint8_t>(state);
  }
}

Measurement RgbdCamera::measurement() const {
  Measurement measurement{.time_ns = measured_.time.time_ns,
                          .world_from_sensor = measured_.world_from_sensor,
                          .calibrations = calibrations_};
  eye_.add_to(measurement);
  if (desc_.depth) measurement.arrays.push_back(image_array("depth", depth_, ImageContent::depth, "m"));
  if (desc_.state) {
    const OutputShape shape =
        state_.empty() ? OutputShape{0, 0, 1} : OutputShape{desc_.pinhole.height_px, desc_.pinhole.width_px, 1};
    measurement.arrays.push_back(
        {{.name = "depth_state", .kind = OutputKind::image, .value_type = ValueType::u8, .shape = shape}, state_});
  }
  return measurement;
}

std::vector<NumberOnRequest> RgbdCamera::on_request() const {
  if (!desc_.depth) return {};
  return {{std::string(kDepthErrorBound), "m", [bound_m = bound_m_] { return bound_m; }}};
}

}  // namespace simvis
