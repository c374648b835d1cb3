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

std::unique_ptr<Sensor> create_touch(const SensorContext& context) {
  return std::make_unique<TouchSensor>(context.name, touch_desc(context));
}

const SensorRegistration kTouchRegistration(
    {.name = "touch",
     .summary = "A straight feeler, such as a whisker or a probe, that is pushed in by what it meets.",
     .notes = "The feeler points along +x. It says whether a surface crosses it, and by how much it is pushed in.",
     .attributes = touch_attributes(),
     .create = create_touch});

}  // namespace

TouchDesc touch_desc(const SensorContext& context) {
  return {.length_m = context.attributes.number("length"),
          .noise = NoiseDesc::read(context.attributes, ""),
          .seed = context.seed};
}

TouchSensor::TouchSensor(std::string name, const TouchDesc& desc)
    : ReadingSensor({{.name = "pressed", .format = "%lld", .integer = true},
                     {.name = "depth_m", .format = "%.12g", .unit = "m"}}),
      name_(std::move(name)),
      desc_(desc),
      noise_(desc.noise, {desc.seed, name_ + "/depth"}) {}

void TouchSensor::plan(const glm::dmat4& world_from_sensor, const DrawList& list, FramePlan& plan) {
  ReadingSensor::plan(world_from_sensor, list, plan);
  plan.casts.push_back({.name = name_, .reason = "feeler of touch sensor " + name_, .max_rays = 1});
}

void TouchSensor::cast(RayCaster& rays) {
  const glm::dvec3 forward(1, 0, 0);
  RayHit hit;
  rays.cast(world_from_sensor(), {&forward, 1}, {&hit, 1});
  const bool pressed = hit.range_m <= desc_.length_m;
  const double depth_m = pressed ? desc_.length_m - hit.range_m : 0;
  set_reading(time_, {pressed ? 1.0 : 0.0, noise_.apply(depth_m, 0, time_, sample_period_s(rate_hz, time_))});
}

}  // namespace simvis
