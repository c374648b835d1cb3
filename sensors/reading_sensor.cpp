#include <simvis/reading_sensor.h>

#include <algorithm>
#include <utility>

#include "engine/base/assert.h"

namespace simvis {

ReadingSensor::ReadingSensor(const std::vector<TableColumn>& columns, bool one_row) : reading_(columns, {}, one_row) {}

void ReadingSensor::set_columns(const std::vector<TableColumn>& columns) {
  reading_.arrays = Reading(columns, {}, true).arrays;
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
  reading_.set_values([&](std::vector<double>& all) { all = std::move(values); });
  stamp(time);
}

void ReadingSensor::set_reading(const FrameTime& time, std::initializer_list<double> row) {
  reading_.set_values([&](std::vector<double>& all) { all.assign(row); });
  stamp(time);
}

void ReadingSensor::stamp(const FrameTime& time) {
  SIMVIS_ASSERT(reading_.arrays.front().kind == OutputKind::table_column || reading_.rows() == 1);
  reading_.time_ns = time.time_ns;
  reading_.world_from_sensor = world_from_sensor_;
}

}  // namespace simvis
