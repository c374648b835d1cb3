#include "sensors/proximity/range_sensor.h"

#include <limits>
#include <memory>
#include <utility>

#include "sensors/range_limits.h"

namespace simvis {

namespace {

AttributeTable range_attributes() {
  static const AttributeTable table =
      join_tables({range_limit_rows("0.02", "10"), noise_rows("", "the range", "m"), {kRateAttribute}});
  return table;
}

std::vector<TableColumn> range_columns() {
  return {{.name = "range_m",
           .format = "%.12g",
           .unit = "m",
           .meaning = "distance along +x; 0: nearer than range_min",
           .frame = "sensor",
           .nothing = std::numeric_limits<double>::infinity()}};
}

std::unique_ptr<Sensor> create_range_sensor(const SensorContext& context) {
  return std::make_unique<RangeSensor>(context.name, range_sensor_desc(context));
}

const SensorRegistration kRangeRegistration(
    {.name = "range",
     .summary = "The distance along one beam, as laser rangefinders and time-of-flight sensors measure it.",
     .notes = "The beam leaves along +x. A range is inf if nothing is within range_max, and 0 if a surface is nearer "
              "than range_min.",
     .message = "sensor_msgs/msg/Range",
     .attributes = range_attributes(),
     .create = create_range_sensor,
     .outputs = [](const SensorContext& context) { return reading_outputs(context, range_columns()); }});

}  // namespace

RangeSensorDesc range_sensor_desc(const SensorContext& context) {
  const auto [min_m, max_m] = read_range_limits(context.attributes);
  return {.range_min_m = min_m,
          .range_max_m = max_m,
          .noise = NoiseDesc::read(context.attributes, ""),
          .seed = context.seed};
}

RangeSensor::RangeSensor(std::string name, const RangeSensorDesc& desc)
    : RaySensor(range_columns(), std::move(name), "beam of range sensor", {"range", desc.noise, desc.seed}),
      desc_(desc) {
  set_constant("radiation_type", kInfraredRange);
  set_constant("range_min_m", desc.range_min_m);
  set_constant("range_max_m", desc.range_max_m);
}

void RangeSensor::cast(RayCaster& rays) {
  set_constant("range_variance", white_variance());
  set_row({reported_range({desc_.range_min_m, desc_.range_max_m}, hits_of(rays)[0].range_m)});
}

}  // namespace simvis
