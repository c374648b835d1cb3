// What registrations of sensors have in common: a desc is read from the attributes, and a sensor is made from the desc.
#pragma once

#include <memory>
#include <vector>

#include <simvis/sensor.h>
#include <simvis/sensor_type.h>
#include "scenegraph/language/attribute_rows.h"

namespace simvis {

/// The desc of a command: its rows, the seed of the run, and Desc::complete(), which derives members from the whole
/// command and checks them. Throws InputError at an attribute.
template <typename Desc>
Desc read_desc(const SensorContext& context) {
  Desc desc = rows_of<Desc>().read(context.command, context.attributes);
  if constexpr (requires { desc.seed; }) desc.seed = context.seed;
  if constexpr (requires { desc.complete(context); }) desc.complete(context);
  return desc;
}

/// For SensorType::create.
template <typename Made, typename Desc>
std::unique_ptr<Sensor> create_sensor(const SensorContext& context) {
  return std::make_unique<Made>(context.name, read_desc<Desc>(context));
}

/// For SensorType::outputs of a sensor whose readings always have the same columns.
template <const std::vector<TableColumn>& columns, bool one_row = true>
std::vector<OutputSpec> column_outputs_of(const SensorContext& context) {
  return reading_outputs(context, columns, one_row);
}

}  // namespace simvis
