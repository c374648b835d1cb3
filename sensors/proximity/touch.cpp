#include "sensors/proximity/touch.h"

#include <memory>
#include <utility>

namespace simvis {

namespace {

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
