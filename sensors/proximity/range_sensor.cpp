// The sensor `range`: the distance along one beam, as laser rangefinders and time-of-flight sensors measure it.
//
//   <sensor type="range" name="FRONT" insert_at="ROBOT" range_min="0.03" range_max="4" stddev="0.01"/>
//
// Frame    the beam leaves along +x of the sensor frame.
// Values   range_m along the beam to the first surface: +infinity if there is none within range_max, 0 if the surface
//          is nearer than range_min. The true range decides; noise is added to ranges between the limits only, and
//          a noisy range is at least 0.
// Exact    except for rounding: <simvis/ray_caster.h>.
// Noise    sensors/noise_model.h.
// Message  sensor_msgs/Range, infrared.
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include <simvis/sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"
#include "sensors/proximity/ray_sensor.h"

namespace simvis {
namespace {

struct RangeSensorDesc {
  MeasuredLimits limits{0.02, 10};
  NoiseDesc noise{};
  std::uint64_t seed = 0;

  static AttributeRows<RangeSensorDesc> rows();
};

class RangeSensor : public RaySensor {
 public:
  RangeSensor(std::string name, const RangeSensorDesc& desc);

  void cast(RayCaster& rays) override;

 private:
  RangeSensorDesc desc_;
};

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
