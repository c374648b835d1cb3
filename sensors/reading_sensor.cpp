#include <simvis/reading_sensor.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/base/assert.h"

namespace simvis {

ReadingSensor::ReadingSensor(std::vector<TableColumn> columns, bool one_row) {
  if (one_row) {
    set_columns(std::move(columns));
  } else {
    reading_.columns = std::move(columns);
  }
}

void ReadingSensor::set_columns(std::vector<TableColumn> columns) {
  reading_.columns = std::move(columns);
  reading_.values.clear();
  values_.clear();
  for (const TableColumn& column : reading_.columns) {
    values_.push_back({column.name, std::numeric_limits<double>::quiet_NaN()});
  }
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
  SIMVIS_ASSERT(!reading_.columns.empty() && values.size() % reading_.columns.size() == 0);
  SIMVIS_ASSERT(values_.empty() || values.size() == values_.size());
  reading_.time_ns = time.time_ns;
  reading_.world_from_sensor = world_from_sensor_;
  reading_.values = std::move(values);
  for (std::size_t i = 0; i < values_.size(); ++i) values_[i].value = reading_.values[i];
}

void ReadingSensor::write(OutputSink& sink) const { sink.rows(reading_.columns, reading_.values); }

}  // namespace simvis
