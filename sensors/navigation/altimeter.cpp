#include "sensors/navigation/altimeter.h"

#include <memory>

namespace simvis {

namespace {

AttributeTable altimeter_attributes() {
  static const AttributeTable table = join_tables(
      {{{.name = "reference", .default_value = "0", .unit = "m", .text = "height in the world that reads 0"}},
       noise_rows("vertical_position_", "the height", "m"),
       noise_rows("vertical_velocity_", "the rate", "m/s"),
       {kRateAttribute}});
  return table;
}

std::vector<TableColumn> altimeter_columns() {
  return {{.name = "vertical_position_m",
           .format = "%.12g",
           .unit = "m",
           .meaning = "height above the reference",
           .frame = "world"},
          {.name = "vertical_velocity_m_s",
           .format = "%.12g",
           .unit = "m/s",
           .meaning = "rate of the height",
           .frame = "world"}};
}

std::unique_ptr<Sensor> create_altimeter(const SensorContext& context) {
  return std::make_unique<Altimeter>(context.name, altimeter_desc(context));
}

const SensorRegistration kAltimeterRegistration({.name = "altimeter",
                                                 .summary = "The height above a reference, and its rate.",
                                                 .attributes = altimeter_attributes(),
                                                 .create = create_altimeter,
                                                 .outputs = [](const SensorContext& context) {
                                                   return reading_outputs(context, altimeter_columns());
                                                 }});

}  // namespace

AltimeterDesc altimeter_desc(const SensorContext& context) {
  return {.reference_m = context.attributes.number("reference"),
          .position = NoiseDesc::read(context.attributes, "vertical_position_"),
          .velocity = NoiseDesc::read(context.attributes, "vertical_velocity_"),
          .seed = context.seed};
}

Altimeter::Altimeter(const std::string& name, const AltimeterDesc& desc)
    : ReadingSensor(altimeter_columns()),
      desc_(desc),
      position_(desc.position, {desc.seed, name + "/position"}),
      velocity_(desc.velocity, {desc.seed, name + "/velocity"}) {}

void Altimeter::collect(const FrameTime& time, const FramePlan&, std::span<const PassResult>) {
  const double period_s = sample_period_s(rate_hz, time);
  set_reading(time, {position_.apply(world_from_sensor()[3].z - desc_.reference_m, 0, time, period_s),
                     velocity_.apply(velocity_mps_, 0, time, period_s)});
}

}  // namespace simvis
