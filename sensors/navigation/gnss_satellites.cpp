#include "sensors/navigation/gnss_satellites.h"

#include <limits>
#include <utility>
#include <vector>

namespace simvis {

namespace {

constexpr double kNoSignal = std::numeric_limits<double>::quiet_NaN();

const std::vector<TableColumn> kSatelliteColumns{
    {.name = "satellite", .format = "%lld", .integer = true, .meaning = "number of the satellite, from 1 on"},
    {.name = "azimuth_deg",
     .format = "%.12g",
     .unit = "deg",
     .meaning = "direction, clockwise from north",
     .frame = "east, north, up"},
    {.name = "elevation_deg",
     .format = "%.12g",
     .unit = "deg",
     .meaning = "direction, above the horizon",
     .frame = "east, north, up"},
    {.name = "direct", .format = "%lld", .integer = true, .meaning = "1: its direct signal is received"},
    {.name = "extra_path_m",
     .format = "%.12g",
     .unit = "m",
     .meaning = "by which the reflected signal is longer than the direct one",
     .nothing = kNoSignal},
    {.name = "error_m",
     .format = "%.12g",
     .unit = "m",
     .meaning = "what reflection adds to the pseudorange",
     .nothing = kNoSignal},
    {.name = "used", .format = "%lld", .integer = true, .meaning = "1: it is received and not jammed"}};

const SensorRegistration kGnssSatellitesRegistration(
    {.name = "gnss_satellites",
     .summary = "The satellites above a receiver of satellite navigation: which signals arrive, and by which way.",
     .notes = "A table has a row for each satellite above the elevation mask. A sensor of type gnss with the same "
              "attributes makes its fix of those that are used.",
     .message = "sensor_msgs/msg/PointCloud2",
     .attributes = rows_of<GnssSatellitesDesc>().table(),
     .create = create_sensor<GnssSatellites, GnssSatellitesDesc>,
     .outputs = column_outputs_of<kSatelliteColumns, false>});

}  // namespace

AttributeRows<GnssSatellitesDesc> GnssSatellitesDesc::rows() {
  return {nested(&GnssSatellitesDesc::origin, geodetic_rows()),
          nested(&GnssSatellitesDesc::satellites, satellites_rows()), kRateAttribute};
}

void GnssSatellitesDesc::complete(const SensorContext& context) const {
  if (!satellites.none()) return;
  fail_at(context.attributes.where("satellites"),
          "attribute \"satellites\": \"none\" is not allowed for this sensor, expected gps or directions");
}

GnssSatellites::GnssSatellites(std::string name, const GnssSatellitesDesc& desc)
    : ReadingSensor(kSatelliteColumns, false),
      name_(std::move(name)),
      desc_(desc),
      signals_(desc.satellites, desc.origin) {}

void GnssSatellites::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  ReadingSensor::plan(world_from_sensor, list, plan);
  list_ = &list;
  signals_.plan(name_, "satellites " + name_, plan);
}

void GnssSatellites::cast(RayCaster& rays) {
  std::vector<double> values;
  const double time_s = static_cast<double>(time_.time_ns) / 1e9;
  for (const SatelliteSignal& each : signals_.find(rays, *list_, world_from_sensor(), time_s)) {
    const Satellite& satellite = each.satellite;
    const bool used = each.received() && !is_jammed_;
    values.insert(values.end(), {static_cast<double>(satellite.number), satellite.azimuth_deg, satellite.elevation_deg,
                                 each.direct ? 1.0 : 0.0, each.extra_path_m, each.error_m(desc_.satellites.reflection),
                                 used ? 1.0 : 0.0});
  }
  set_reading(time_, std::move(values));
}

}  // namespace simvis
