#include "sensors/navigation/gnss.h"

#include <algorithm>
#include <limits>
#include <memory>
#include <utility>

namespace simvis {

namespace {

constexpr double kNoValue = std::numeric_limits<double>::quiet_NaN();

const std::vector<TableColumn> kGnssColumns{{.name = "latitude_deg",
                                             .format = "%.15g",
                                             .unit = "deg",
                                             .meaning = "geodetic latitude, to the north",
                                             .frame = "WGS 84",
                                             .nothing = kNoValue},
                                            {.name = "longitude_deg",
                                             .format = "%.15g",
                                             .unit = "deg",
                                             .meaning = "geodetic longitude, to the east",
                                             .frame = "WGS 84",
                                             .nothing = kNoValue},
                                            {.name = "altitude_m",
                                             .format = "%.12g",
                                             .unit = "m",
                                             .meaning = "height above the ellipsoid",
                                             .frame = "WGS 84",
                                             .nothing = kNoValue},
                                            {.name = "velocity_east_m_s",
                                             .format = "%.12g",
                                             .unit = "m/s",
                                             .meaning = "velocity to the east",
                                             .frame = "east, north, up",
                                             .nothing = kNoValue,
                                             .in_message = false},
                                            {.name = "velocity_north_m_s",
                                             .format = "%.12g",
                                             .unit = "m/s",
                                             .meaning = "velocity to the north",
                                             .frame = "east, north, up",
                                             .nothing = kNoValue,
                                             .in_message = false},
                                            {.name = "velocity_up_m_s",
                                             .format = "%.12g",
                                             .unit = "m/s",
                                             .meaning = "velocity upwards",
                                             .frame = "east, north, up",
                                             .nothing = kNoValue,
                                             .in_message = false}};

// A circle with half of the fixes has the radius 1.17741 s, half of the heights and speeds lie within 0.67449 s.
constexpr PresetAttribute kF9p[] = {
    {"horizontal_stddev", "1.274"}, {"vertical_stddev", "2.965"}, {"velocity_stddev", "0.0741"}, {"rate", "9"}};
constexpr PresetAttribute kF9pRtk[] = {
    {"horizontal_stddev", "0.00849"}, {"vertical_stddev", "0.0148"}, {"velocity_stddev", "0.0741"}, {"rate", "7"}};

// With satellites.
const std::vector<TableColumn> kFixColumns{{.name = "satellites_visible",
                                            .format = "%lld",
                                            .integer = true,
                                            .meaning = "satellites above the mask whose direct signal is received",
                                            .in_message = false},
                                           {.name = "satellites_used",
                                            .format = "%lld",
                                            .integer = true,
                                            .meaning = "satellites of the fix, those by reflection alone included; "
                                                       "0: there is no fix",
                                            .in_message = false},
                                           {.name = "hdop",
                                            .format = "%.9g",
                                            .meaning = "dilution of precision, east and north",
                                            .nothing = kNoValue,
                                            .in_message = false},
                                           {.name = "vdop",
                                            .format = "%.9g",
                                            .meaning = "dilution of precision, up",
                                            .nothing = kNoValue,
                                            .in_message = false},
                                           {.name = "pdop",
                                            .format = "%.9g",
                                            .meaning = "dilution of precision of the position",
                                            .nothing = kNoValue,
                                            .in_message = false}};

std::vector<TableColumn> gnss_columns(bool has_satellites) {
  std::vector<TableColumn> columns = kGnssColumns;
  if (has_satellites) columns.insert(columns.end(), kFixColumns.begin(), kFixColumns.end());
  return columns;
}

std::vector<OutputSpec> gnss_outputs(const SensorContext& context) {
  std::vector<OutputSpec> outputs = reading_outputs(context, gnss_columns(true));
  const bool given = read_desc<GnssDesc>(context).has_satellites();
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    if (i >= kGnssColumns.size()) {
      outputs[i].when = "satellites";
      outputs[i].given = given;
    } else if (!kGnssColumns[i].in_message) {
      outputs[i].message = "geometry_msgs/msg/TwistWithCovarianceStamped";
    }
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
         "east and its y axis north.\nWithout the attribute satellites a fix is always there. With it, surfaces of the "
         "scene hide satellites and reflect their signals, and the position follows from those that are received. "
         "Without a fix position and velocity are nan. docs/sensors.md has an example. An element gnss_jammer jams "
         "receivers of both kinds.",
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
          nested(&Desc::satellites, satellites_rows()),
          nested(&Desc::pseudorange, noise_rows("pseudorange_", "the distance to each satellite", "m"))
              .only(kWithSatellites, &Desc::has_satellites),
          row(&Desc::max_pdop, "max_pdop", "", {.min = 0, .max = kMaxPdop, .open_min = true},
              "with satellites: no fix if the dilution of precision of the position is above this")
              .only(kWithSatellites, &Desc::has_satellites),
          kRateAttribute,
          kPresetAttribute};
}

Gnss::Gnss(std::string name, const GnssDesc& desc)
    : ReadingSensor(gnss_columns(desc.has_satellites())),
      name_(std::move(name)),
      desc_(desc),
      local_(desc.origin.latitude_deg, desc.origin.longitude_deg, desc.origin.elevation_m),
      horizontal_(desc.horizontal, {desc.seed, name_ + "/horizontal"}),
      vertical_(desc.vertical, {desc.seed, name_ + "/vertical"}),
      velocity_(desc.velocity, {desc.seed, name_ + "/velocity"}),
      pseudorange_(desc.pseudorange, {desc.seed, name_ + "/pseudorange"}),
      signals_(desc.satellites, desc.origin) {}

void Gnss::sense(const SensedWorld& world) {
  motion_ = world.motion();
  is_jammed_ = world.gnss_is_jammed();
}

void Gnss::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  ReadingSensor::plan(world_from_sensor, list, plan);
  list_ = &list;
  if (desc_.has_satellites()) signals_.plan(name_, "gnss receiver " + name_, plan);
}

void Gnss::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  time_ = time;
  set_constant("horizontal_variance", desc_.horizontal.white_variance(period_s()));
  set_constant("vertical_variance", desc_.vertical.white_variance(period_s()));
  set_constant("velocity_variance", desc_.velocity.white_variance(period_s()));
  if (desc_.has_satellites()) return;
  const std::array<double, 6> v = measured(is_jammed_ ? std::nullopt : std::optional(glm::dvec3(0)));
  set_reading(time, {v[0], v[1], v[2], v[3], v[4], v[5]});
}

void Gnss::cast(RayCaster& rays) {
  if (!desc_.has_satellites()) return;
  std::vector<SatelliteSignal> signals =
      signals_.find(rays, *list_, world_from_sensor(), static_cast<double>(time_.time_ns) / 1e9);
  const auto visible = std::ranges::count_if(signals, &SatelliteSignal::direct);
  std::erase_if(signals, [&](const SatelliteSignal& each) { return is_jammed_ || !each.received(); });
  const std::optional<PositionFix> fix = fix_of(signals);
  set_variances(fix ? fix->cofactors : glm::dmat3(0));
  const std::array<double, 6> of_fix = measured(fix ? std::optional(fix->error_m) : std::nullopt);
  std::vector<double> values(of_fix.begin(), of_fix.end());
  values.push_back(static_cast<double>(visible));
  values.push_back(fix ? static_cast<double>(signals.size()) : 0);
  for (double (PositionFix::*const dilution)() const : {&PositionFix::hdop, &PositionFix::vdop, &PositionFix::pdop}) {
    values.push_back(fix ? ((*fix).*dilution)() : kNoValue);
  }
  set_reading(time_, std::move(values));
}

std::optional<PositionFix> Gnss::fix_of(std::span<const SatelliteSignal> received) const {
  std::vector<Pseudorange> pseudoranges;
  for (const SatelliteSignal& each : received) {
    const double error_m = each.error_m(desc_.satellites.reflection);
    pseudoranges.push_back({.direction = each.satellite.direction,
                            .error_m = pseudorange_.apply(error_m, each.satellite.number, time_, period_s())});
  }
  const std::optional<PositionFix> fix = fix_position(pseudoranges);
  return fix && fix->pdop() <= desc_.max_pdop ? fix : std::nullopt;
}

// Of the position with satellites, E: those of the pseudoranges and of the noise on top.
void Gnss::set_variances(const glm::dmat3& of_satellites) {
  const double square_m = desc_.pseudorange.white_variance(period_s()),
               horizontal = desc_.horizontal.white_variance(period_s());
  const glm::dmat3 covariance = square_m * of_satellites;
  set_constant("east_variance", covariance[0][0] + horizontal);
  set_constant("north_variance", covariance[1][1] + horizontal);
  set_constant("up_variance", covariance[2][2] + desc_.vertical.white_variance(period_s()));
  set_constant("east_north_covariance", covariance[0][1]);
  set_constant("east_up_covariance", covariance[0][2]);
  set_constant("north_up_covariance", covariance[1][2]);
}

std::array<double, 6> Gnss::measured(const std::optional<glm::dvec3>& error_m) const {
  if (!error_m) return {kNoValue, kNoValue, kNoValue, kNoValue, kNoValue, kNoValue};
  const glm::dvec3 place = desc_.origin.to_east_north_up(glm::dvec3(world_from_sensor()[3])) + *error_m,
                   speed = desc_.origin.to_east_north_up(motion_.velocity_mps);
  double latitude = 0, longitude = 0, altitude = 0;
  local_.Reverse(horizontal_.apply(place.x, 0, time_, period_s()), horizontal_.apply(place.y, 1, time_, period_s()),
                 vertical_.apply(place.z, 0, time_, period_s()), latitude, longitude, altitude);
  return {latitude,
          longitude,
          altitude,
          velocity_.apply(speed.x, 0, time_, period_s()),
          velocity_.apply(speed.y, 1, time_, period_s()),
          velocity_.apply(speed.z, 2, time_, period_s())};
}

}  // namespace simvis
