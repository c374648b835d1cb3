#include "sensors/psd/psd.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <simvis/effect.h>
#include <simvis/pose.h>
#include "engine/base/thread_pool.h"
#include "engine/splats/splat_rays.h"
#include "sensors/camera/camera_splats.h"

namespace simvis {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A surface that touches the device is still visible.
constexpr double kNear_m = 1e-3;

const std::vector<TableColumn> kPsdColumns{{.name = "range_m",
                                            .format = "%.9g",
                                            .unit = "m",
                                            .meaning = "range along the axis, without noise; 0: nearer than range_min",
                                            .nothing = kInfinity},
                                           {.name = "voltage_v",
                                            .format = "%.9g",
                                            .unit = "V",
                                            .meaning = "voltage of the device, with noise",
                                            .in_message = false}};

std::unique_ptr<Sensor> create_psd(const SensorContext& context) {
  const AttributeValues& a = context.attributes;
  std::optional<VoltageCurve> curve = parse_voltage_curve(a.text("curve"));
  if (!curve) {
    fail_at(a.where("curve"), "attribute \"curve\": \"" + a.text("curve") +
                                  "\" is not allowed, expected gp2y0a21yk or two points or more, as " +
                                  "RANGE_M:VOLT, with increasing ranges above 0");
  }
  return std::make_unique<Psd>(context.name, read_desc<PsdDesc>(context), *std::move(curve));
}

const SensorRegistration kPsdRegistration(
    {.name = "psd",
     .summary = "An infrared distance sensor (position-sensitive detector, PSD) with an analogue voltage, like those "
                "made by Sharp.",
     .notes = "The sensor measures along +x, from a small depth image of its cone; sensors/psd/psd.h says how. The "
              "reading does not depend on the colour or the slant of the surface. A curve of points is linear in 1 / "
              "range between its points.",
     .capabilities = kSeesSplats,
     .message = "sensor_msgs/msg/Range",
     .attributes = rows_of<PsdDesc>().table(),
     .create = create_psd,
     .outputs = column_outputs_of<kPsdColumns>});

}  // namespace

AttributeRows<PsdDesc> PsdDesc::rows() {
  using Desc = PsdDesc;
  return {row(&Desc::opening_rad, "opening", kDegrees, {.min = 0, .max = 90, .open_min = true},
              "full angle of the cone of light"),
          row(&Desc::resolution_px, "resolution", "px", {.min = 2, .max = 1024},
              "pixels of the depth image across the cone"),
          AttributeSpec{.name = "curve",
                        .kind = AttributeKind::text,
                        .default_value = "gp2y0a21yk",
                        .text = "voltage over range: gp2y0a21yk for that device, or points RANGE_M:VOLT"},
          nested(&Desc::limits, range_limit_rows(" along the axis")),
          row(&Desc::noise_v, "noise", "V", kNotNegative, "standard deviation of the Gaussian noise of the voltage"),
          kRateAttribute};
}

Psd::Psd(std::string name, const PsdDesc& desc, VoltageCurve curve)
    : ReadingSensor(kPsdColumns),
      name_(std::move(name)),
      desc_(desc),
      curve_(std::move(curve)),
      random_(desc.seed, name_),
      pinhole_(centred_pinhole(desc.resolution_px, desc.resolution_px, desc.opening_rad)),
      rim_squared_(std::tan(desc.opening_rad / 2) * std::tan(desc.opening_rad / 2)) {
  set_constant("radiation_type", kInfraredRange);
  set_constant("field_of_view_rad", desc.opening_rad);
  set_constant("range_min_m", desc.limits.min_m);
  set_constant("range_max_m", desc.limits.max_m);
}

// The view has a pass of its own: the last bit of its depth depends on its position in the target, and must not depend
// on other elements of the scene.
void Psd::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  ReadingSensor::plan(world_from_sensor, list, plan);
  View view;
  view.name = name_;
  view.reason = "cone of light of distance sensor " + name_;
  view.pinhole = pinhole_;
  view.near_m = kNear_m;
  view.view_from_world = rigid_inverse(world_from_sensor * sensor_from_view());
  view.width_px = view.height_px = desc_.resolution_px;
  view.sees_back_faces = true;
  view.sees_lines_and_points = false;
  pass_ = plan.passes.size();
  plan.passes.push_back({.name = name_,
                         .width_px = view.width_px,
                         .height_px = view.height_px,
                         .color = false,
                         .depth = true,
                         .views = {}});
  plan.passes.back().views.push_back(std::move(view));
  list_ = &list;
  looks_at_splats_ = has_splats(list);
  shows_splats_ = false;
  if (!looks_at_splats_) return;
  plan_splat_rays(list, "the pixels of distance sensor " + name_,
                  std::uint64_t{desc_.resolution_px} * desc_.resolution_px, name_, plan);
}

void Psd::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult> results) {
  time_ = time;
  const std::span<const float> depth = results[pass_].depth;
  per_depth_.resize(depth.size());
  std::ranges::transform(depth, per_depth_.begin(), [](float d) { return static_cast<double>(d) / kNear_m; });
  if (!looks_at_splats_) measure();
}

void Psd::cast(RayCaster& caster) {
  if (!looks_at_splats_) return;
  stop_at_splats(caster.threads());
  measure();
}

// Of the centre of a pixel, on the plane at 1 m.
glm::dvec2 Psd::place_of(std::size_t pixel) const {
  const std::size_t x = pixel % desc_.resolution_px, y = pixel / desc_.resolution_px;
  return {(static_cast<double>(x) + 0.5 - pinhole_.cx_px) / pinhole_.fx_px,
          (static_cast<double>(y) + 0.5 - pinhole_.cy_px) / pinhole_.fy_px};
}

bool Psd::is_in_cone(const glm::dvec2& place) const { return place.x * place.x + place.y * place.y <= rim_squared_; }

// Replaces what is drawn by the splats before it.
void Psd::stop_at_splats(unsigned threads) {
  const std::size_t pixels = per_depth_.size();
  std::vector<glm::dvec3> directions(pixels, glm::dvec3(0));  // none outside of the cone
  std::vector<double> near_m(pixels), end_m(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const glm::dvec2 place = place_of(i);
    if (!is_in_cone(place)) continue;
    directions[i] = glm::normalize(glm::dvec3(place, 1));
    near_m[i] = kNear_m / directions[i].z;
    end_m[i] = 1 / (per_depth_[i] * directions[i].z);
  }
  std::vector<SplatSight> sights(pixels);
  see_through(see_splats(*list_, world_from_sensor() * sensor_from_view(), {}),
              {desc_.resolution_px, directions, near_m, end_m}, *shared_thread_pool(threads), sights);
  for (std::size_t i = 0; i < pixels; ++i) {
    if (sights[i].half_item == kNoItem) continue;
    per_depth_[i] = 1 / (sights[i].half_m * directions[i].z);
    shows_splats_ = true;
  }
}

// With c the cosine of a pixel's angle from the axis, its solid angle is proportional to c^3, and 1 / r = c / Z.
double Psd::range_of(std::span<const double> per_depth) const {
  double light = 0, moment = 0;
  for (std::size_t i = 0; i < per_depth.size(); ++i) {
    const glm::dvec2 place = place_of(i);
    if (!is_in_cone(place)) continue;
    const double cosine = 1 / std::sqrt(1 + place.x * place.x + place.y * place.y);
    const double returned = std::pow(cosine, 5) * per_depth[i] * per_depth[i];
    light += returned;
    moment += returned * per_depth[i];
  }
  return light > 0 ? light / moment : kInfinity;
}

void Psd::measure() {
  const double range_m = range_of(per_depth_);
  set_reading(time_, {limited_range(desc_.limits, range_m),
                      curve_.at(range_m) + desc_.noise_v * random_.gaussian(random_key(time_), 0, 0)});
}

}  // namespace simvis
