#include "sensors/proximity/touch.h"

#include <memory>
#include <utility>

namespace simvis {

namespace {

AttributeTable touch_attributes() {
  static const AttributeTable table = join_tables({{{.name = "length",
                                                     .default_value = "0.1",
                                                     .unit = "m",
                                                     .text = "length of the feeler along +x",
                                                     .min = 0,
                                                     .open_min = true}},
                                                   noise_rows("", "the depth", "m"),
                                                   {kRateAttribute}});
  return table;
}

std::vector<TableColumn> touch_columns() {
  return {{.name = "pressed",
           .format = "%lld",
           .integer = true,
           .meaning = "1: something pushes the feeler; 0: nothing does"},
          {.name = "depth_m", .format = "%.12g", .unit = "m", .meaning = "how far the feeler is pushed in"}};
}

std::unique_ptr<Sensor> create_touch(const SensorContext& context) {
  return std::make_unique<TouchSensor>(context.name, touch_desc(context));
}

const SensorRegistration kTouchRegistration(
    {.name = "touch",
     .summary = "A straight feeler, such as a whisker or a probe, that is pushed in by what it meets.",
     .notes = "The feeler points along +x. It says whether a surface crosses it, and by how much it is pushed in.",
     .attributes = touch_attributes(),
     .create = create_touch,
     .outputs = [](const SensorContext& context) { return reading_outputs(context, touch_columns()); }});

}  // namespace

TouchDesc touch_desc(const SensorContext& context) {
  return {.length_m = context.attributes.number("length"),
          .noise = NoiseDesc::read(context.attributes, ""),
          .seed = context.seed};
}

TouchSensor::TouchSensor(std::string name, const TouchDesc& desc)
    : RaySensor(touch_columns(), std::move(name), "feeler of touch sensor", {"depth", desc.noise, desc.seed}),
      desc_(desc) {}

void TouchSensor::cast(RayCaster& rays) {
  const double range_m = hits_of(rays)[0].range_m;
  const bool pressed = range_m <= desc_.length_m;
  set_row({pressed ? 1.0 : 0.0, noisy(pressed ? desc_.length_m - range_m : 0)});
}

}  // namespace simvis
