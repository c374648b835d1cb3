#include <simvis/reading_sensor.h>

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"

namespace simvis {

ReadingSensor::ReadingSensor(std::vector<TableColumn> columns, bool one_row) {
  reading_.columns = std::move(columns);
  reading_.one_row = one_row;
}

void ReadingSensor::set_columns(std::vector<TableColumn> columns) {
  reading_.columns = std::move(columns);
  reading_.values = {};
  reading_.one_row = true;
}

void ReadingSensor::set_constant(std::string_view name, double value) {
  const auto known = std::ranges::find(reading_.constants, name, &NamedValue::name);
  if (known == reading_.constants.end()) {
    reading_.constants.push_back({name, value});
  } else {
    known->value = value;
  }
}

void ReadingSensor::set_reading(const FrameTime& time, std::vector<double> values) {
  reading_.values.overwrite() = std::move(values);
  stamp(time);
}

void ReadingSensor::set_reading(const FrameTime& time, std::initializer_list<double> row) {
  reading_.values.overwrite().assign(row);
  stamp(time);
}

void ReadingSensor::stamp(const FrameTime& time) {
  SIMVIS_ASSERT(!reading_.columns.empty() && reading_.values.size() % reading_.columns.size() == 0);
  SIMVIS_ASSERT(!reading_.one_row || reading_.values.size() == reading_.columns.size());
  reading_.time_ns = time.time_ns;
  reading_.world_from_sensor = world_from_sensor_;
}

}  // namespace simvis
