#include <simvis/sensor_type.h>

#include <algorithm>
#include <iterator>

#include "engine/base/assert.h"
#include "scenegraph/language/type_registry.h"
#include "sensors/surface_output.h"
#include "sensors/timing_faults.h"

namespace simvis {
namespace {

TypeRegistry<SensorType>& registry() {
  static TypeRegistry<SensorType> types("sensor");
  return types;
}

constexpr AttributeSpec kIgnoreRow{
    .name = "ignore",
    .kind = AttributeKind::objects,
    .text =
        "parts, models and links that the sensor does not see; none: it sees everything; default: the shapes of its "
        "own link that contain it"};

constexpr AttributeSpec kVisibilityMaskRow{
    .name = "visibility_mask",
    .kind = AttributeKind::integer,
    .default_value = "4294967295",
    .text = "32 bits: the sensor sees the shapes with which it shares one, see the element visibility_flags",
    .min = 0,
    .max = 0xFFFFFFFF};

}  // namespace

SensorRegistration::SensorRegistration(const SensorType& type, std::string_view built_for) {
  registry().add(type, built_for);
}

const SensorType* find_sensor_type(std::string_view name) { return registry().find(name); }

std::vector<const SensorType*> sensor_types() { return registry().sorted(); }

std::vector<AttributeSpec> all_attributes(const SensorType& type) {
  std::vector<AttributeSpec> table = with_effect_attributes(type.capabilities, type.attributes);
  for (const AttributeSpec& row : {kIgnoreRow, kVisibilityMaskRow}) {
    if (std::ranges::count(table, row.name, &AttributeSpec::name) == 0) table.push_back(row);
  }
  std::ranges::copy(timing_attributes(), std::back_inserter(table));
  if ((type.capabilities & kShowsSurfaces) == 0) return table;
  const auto outputs = std::ranges::find(table, "outputs", &AttributeSpec::name);
  SIMVIS_ASSERT(outputs != table.end());
  outputs->choices = with_surface_outputs(outputs->choices);
  return table;
}

bool may_have(std::string_view sensor_type, const EffectType& effect) {
  const SensorType* const type = find_sensor_type(sensor_type);
  return type != nullptr && may_have(type->capabilities, effect);
}

}  // namespace simvis
