// The sensor `touch`: a straight feeler, such as a whisker or a probe, that is pushed in by what it meets.
//
//   <sensor type="touch" name="WHISKER" insert_at="ROBOT" pose_offset="0.2 0 0.05 0 0 30" length="0.1"/>
//
// Frame    the feeler stands on the origin and points along +x of the sensor frame.
// Values   pressed: 1 if a surface crosses the feeler, else 0. depth_m: by how much the surface pushes it in, from 0 to
//          `length`; 0 if it is not touched.
// Noise    of the depth: sensors/noise_model.h. It does not change `pressed`.
// Exact    except for rounding: <simvis/ray_caster.h>. A robot whose own surface covers the origin does not matter if
//          the feeler stands outside of it.
#pragma once

#include <string>

#include <simvis/sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"
#include "sensors/proximity/ray_sensor.h"

namespace simvis {

struct TouchDesc {
  double length_m = 0.1;
  NoiseDesc noise{};
  std::uint64_t seed = 0;

  static AttributeRows<TouchDesc> rows();
};

class TouchSensor : public RaySensor {
 public:
  TouchSensor(std::string name, const TouchDesc& desc);

  void cast(RayCaster& rays) override;

 private:
  TouchDesc desc_;
};

}  // namespace simvis
