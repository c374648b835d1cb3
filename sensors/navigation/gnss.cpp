#include "sensors/navigation/gnss.h"

#include <memory>

namespace simvis {

namespace {

const std::vector<TableColumn> kGnssColumns{
    {.name = "latitude_deg",
     .format = "%.15g",
     .unit = "deg",
     .meaning = "geodetic latitude, to the north",
     .frame = "WGS 84"},
    {.name = "longitude_deg",
     .format = "%.15g",
     .unit = "deg",
     .meaning = "geodetic longitude, to the east",
     .frame = "WGS 84"},
    {.name = "altitude_m", .format = "%.12g", .unit = "m", .meaning = "height above the ellipsoid", .frame = "WGS 84"},
    {.name = "velocity_east_m_s",
     .format = "%.12g",
     .unit = "m/s",
     .meaning = "velocity to the east",
     .frame = "east, north, up",
     .in_message = false},
    {.name = "velocity_north_m_s",
     .format = "%.12g",
     .unit = "m/s",
     .meaning = "velocity to the north",
     .frame = "east, north, up",
     .in_message = false},
    {.name = "velocity_up_m_s",
     .format = "%.12g",
     .unit = "m/s",
     .meaning = "velocity upwards",
     .frame = "east, north, up",
     .in_message = false}};

// A circle with half of the fixes has the radius 1.17741 s, half of the heights and speeds lie within 0.67449 s.
constexpr PresetAttribute kF9p[] = {
    {"horizontal_stddev", "1.274"}, {"vertical_stddev", "2.965"}, {"velocity_stddev", "0.0741"}, {"rate", "9"}};
constexpr PresetAttribute kF9pRtk[] = {
    {"horizontal_stddev", "0.00849"}, {"vertical_stddev", "0.0148"}, {"velocity_stddev", "0.0741"}, {"rate", "7"}};

std::vector<OutputSpec> gnss_outputs(const SensorContext& context) {
  std::vector<OutputSpec> outputs = reading_outputs(context, kGnssColumns);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (!kGnssColumns[i].in_message) outputs[i].message = "geometry_msgs/msg/TwistWithCovarianceStamped";
  }
  return outputs;
}

constexpr std::string_view kF9pSource = "u-blox, ZED-F9P-04B data sheet, UBX-21044850 R05, section 1.2, tables 1 and 2";

constexpr SensorPreset kGnssPresets[] = {
    {"ublox_f9p", "u-blox ZED-F9P without corrections, four systems, 9 Hz", kF9pSource, kF9p,
     "Horizontal 1.5 m (CEP), vertical 2.0 m (median), 0.05 m/s (half of the speeds at 30 m/s), as white noise: the "
     "sheet does not say how errors are correlated in time, and those of a real receiver are."},
    {"ublox_f9p_rtk", "u-blox ZED-F9P with RTK, four systems, 7 Hz", kF9pSource, kF9pRtk,
     "Horizontal 0.01 m (CEP), vertical 0.01 m (median), 0.05 m/s (half of the speeds at 30 m/s), as white noise: the "
     "sheet does not say how errors are correlated in time. Not taken over: 1 ppm of the distance to the base."},
};

const SensorRegistration kGnssRegistration(
    {.name = "gnss",
     .summary = "A receiver of satellite navigation: latitude, longitude, altitude and velocity, with noise and drift.",
     .notes =
         "The world's origin stands at the given place on the ellipsoid of WGS 84. With heading 0 its x axis points "
         "east and its y axis north. A fix is always there; satellites are not simulated.",
     .message = "sensor_msgs/msg/NavSatFix",
     .attributes = rows_of<GnssDesc>().table(),
     .create = create_sensor<Gnss, GnssDesc>,
     .presets = kGnssPresets,
     .outputs = gnss_outputs,
     .sees_shapes = false});

}  // namespace

AttributeRows<GnssDesc> GnssDesc::rows() {
  using Desc = GnssDesc;
  return {nested(&Desc::origin, geodetic_rows()),
          nested(&Desc::horizontal, noise_rows("horizontal_", "the east and north position", "m")),
          nested(&Desc::vertical, noise_rows("vertical_", "the altitude", "m")),
          nested(&Desc::velocity, noise_rows("velocity_", "the velocity", "m/s")),
          kRateAttribute,
          kPresetAttribute};
}

Gnss::Gnss(const std::string& name, const GnssDesc& desc)
    : ReadingSensor(kGnssColumns),
      desc_(desc),
      local_(desc.origin.latitude_deg, desc.origin.longitude_deg, desc.origin.elevation_m),
      horizontal_(desc.horizontal, {desc.seed, name + "/horizontal"}),
      vertical_(desc.vertical, {desc.seed, name + "/vertical"}),
      velocity_(desc.velocity, {desc.seed, name + "/velocity"}) {}

void Gnss::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  const double period_s = sample_period_s(rate_hz, time);
  set_constant("horizontal_variance", desc_.horizontal.white_variance(period_s));
  set_constant("vertical_variance", desc_.vertical.white_variance(period_s));
  set_constant("velocity_variance", desc_.velocity.white_variance(period_s));
  const glm::dvec3 place = desc_.origin.to_east_north_up(glm::dvec3(world_from_sensor()[3])),
                   speed = desc_.origin.to_east_north_up(motion_.velocity_mps);
  double latitude = 0, longitude = 0, altitude = 0;
  local_.Reverse(horizontal_.apply(place.x, 0, time, period_s), horizontal_.apply(place.y, 1, time, period_s),
                 vertical_.apply(place.z, 0, time, period_s), latitude, longitude, altitude);
  set_reading(time, {latitude, longitude, altitude, velocity_.apply(speed.x, 0, time, period_s),
                     velocity_.apply(speed.y, 1, time, period_s), velocity_.apply(speed.z, 2, time, period_s)});
}

}  // namespace simvis
