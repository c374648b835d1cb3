#include "sensors/proximity/range_sensor.h"

#include <limits>
#include <memory>
#include <utility>

namespace simvis {

namespace {

const std::vector<TableColumn> kRangeColumns{{.name = "range_m",
                                              .format = "%.12g",
                                              .unit = "m",
                                              .meaning = "distance along +x; 0: nearer than range_min",
                                              .frame = "sensor",
                                              .nothing = std::numeric_limits<double>::infinity()}};

const SensorRegistration kRangeRegistration(
    {.name = "range",
     .summary = "The distance along one beam, as laser rangefinders and time-of-flight sensors measure it.",
     .notes = "The beam leaves along +x. A range is inf if nothing is within range_max, and 0 if a surface is nearer "
              "than range_min.",
     .capabilities = kSeesSplats | kRaysHitSplats,
     .message = "sensor_msgs/msg/Range",
     .attributes = rows_of<RangeSensorDesc>().table(),
     .create = create_sensor<RangeSensor, RangeSensorDesc>,
     .outputs = column_outputs_of<kRangeColumns>});

}  // namespace

AttributeRows<RangeSensorDesc> RangeSensorDesc::rows() {
  return {nested(&RangeSensorDesc::limits, range_limit_rows()),
          nested(&RangeSensorDesc::noise, noise_rows("", "the range", "m")), kRateAttribute};
}

RangeSensor::RangeSensor(std::string name, const RangeSensorDesc& desc)
    : RaySensor(kRangeColumns, std::move(name), "beam of range sensor", {"range", desc.noise, desc.seed}), desc_(desc) {
  set_constant("radiation_type", kInfraredRange);
  set_constant("range_min_m", desc.limits.min_m);
  set_constant("range_max_m", desc.limits.max_m);
}

void RangeSensor::cast(RayCaster& rays) {
  set_constant("range_variance", white_variance());
  set_row({reported_range(desc_.limits, hits_of(rays)[0].range_m)});
}

}  // namespace simvis
