#include "sensors/psd/psd.h"

#include <cmath>
#include <limits>
#include <optional>

#include <simvis/pose.h>

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
      pinhole_(centred_pinhole(desc.resolution_px, desc.resolution_px, desc.opening_rad)) {
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
}

// With c the cosine of a pixel's angle from the axis, its solid angle is proportional to c^3, and 1 / r = c / Z.
double Psd::range_of(std::span<const float> depth) const {
  const double rim = std::tan(desc_.opening_rad / 2);
  double light = 0, moment = 0;
  for (std::uint32_t y = 0; y < desc_.resolution_px; ++y) {
    for (std::uint32_t x = 0; x < desc_.resolution_px; ++x) {
      const double u = (x + 0.5 - pinhole_.cx_px) / pinhole_.fx_px, v = (y + 0.5 - pinhole_.cy_px) / pinhole_.fy_px;
      if (u * u + v * v > rim * rim) continue;
      const double per_depth = static_cast<double>(depth[std::size_t{y} * desc_.resolution_px + x]) / kNear_m;
      const double cosine = 1 / std::sqrt(1 + u * u + v * v);
      const double returned = std::pow(cosine, 5) * per_depth * per_depth;
      light += returned;
      moment += returned * per_depth;
    }
  }
  return light > 0 ? light / moment : kInfinity;
}

void Psd::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult> results) {
  const double range_m = range_of(results[pass_].depth);
  set_reading(time, {limited_range(desc_.limits, range_m),
                     curve_.at(range_m) + desc_.noise_v * random_.gaussian(random_key(time), 0, 0)});
}

}  // namespace simvis
