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
#include <memory>
#include <string>
#include <utility>

#include <simvis/sensor.h>
#include "sensors/described_sensor.h"
#include "sensors/noise_model.h"
#include "sensors/proximity/ray_sensor.h"

namespace simvis {
namespace {

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

const std::vector<TableColumn> kTouchColumns{
    {.name = "pressed",
     .format = "%lld",
     .integer = true,
     .meaning = "1: something pushes the feeler; 0: nothing does"},
    {.name = "depth_m", .format = "%.12g", .unit = "m", .meaning = "how far the feeler is pushed in"}};

const SensorRegistration kTouchRegistration(
    {.name = "touch",
     .summary = "A straight feeler, such as a whisker or a probe, that is pushed in by what it meets.",
     .notes = "The feeler points along +x. It says whether a surface crosses it, and by how much it is pushed in.",
     .attributes = rows_of<TouchDesc>().table(),
     .create = create_sensor<TouchSensor, TouchDesc>,
     .outputs = column_outputs_of<kTouchColumns>});

}  // namespace

AttributeRows<TouchDesc> TouchDesc::rows() {
  return {row(&TouchDesc::length_m, "length", "m", kAboveZero, "length of the feeler along +x"),
          nested(&TouchDesc::noise, noise_rows("", "the depth", "m")), kRateAttribute};
}

TouchSensor::TouchSensor(std::string name, const TouchDesc& desc)
    : RaySensor(kTouchColumns, std::move(name), "feeler of touch sensor", {"depth", desc.noise, desc.seed}),
      desc_(desc) {}

void TouchSensor::cast(RayCaster& rays) {
  const double range_m = hits_of(rays)[0].range_m;
  const bool pressed = range_m <= desc_.length_m;
  set_row({pressed ? 1.0 : 0.0, noisy(pressed ? desc_.length_m - range_m : 0)});
}

}  // namespace simvis
