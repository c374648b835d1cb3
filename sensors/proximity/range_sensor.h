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
#pragma once

#include <string>

#include <simvis/sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"
#include "sensors/proximity/ray_sensor.h"

namespace simvis {

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

}  // namespace simvis
