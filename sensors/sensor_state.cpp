#include "sensors/sensor_state.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <simvis/pose.h>
#include <simvis/reading_sensor.h>

namespace simvis {
namespace {

// Static text with these letters, as NamedValue::name has to be.
std::string_view static_text(const std::string& text) {
  static std::mutex mutex;
  static std::set<std::string> all;
  const std::lock_guard lock(mutex);
  return *all.insert(text).first;
}

template <std::size_t type = 0>
void archive_numbers(StateArchive& state, std::uint32_t held, MeasuredArray& array) {
  if constexpr (type < std::variant_size_v<MeasuredNumbers>) {
    if (held != type) return archive_numbers<type + 1>(state, held, array);
    using Numbers = std::variant_alternative_t<type, MeasuredNumbers>;
    std::vector<std::decay_t<decltype(*std::declval<Numbers>().data())>> numbers;
    if (!state.is_reading()) {
      const Numbers& all = std::get<type>(array.numbers);
      for (std::size_t i = 0; i < array.count(); ++i) numbers.push_back(all[array.first + i * array.stride]);
    }
    state(numbers);
    state.require(numbers.size() == array.count());
    if (!state.is_reading()) return;
    array.numbers = Numbers(std::move(numbers));
    array.first = 0;
    array.stride = 1;
  } else {
    state.require(false);
  }
}

// Before its first measurement a scanner lacks the arrays of its channels: such an array has a name, a kind and a unit
// alone.
void archive_array(StateArchive& state, MeasuredArray& array, const std::vector<MeasuredArray>& known) {
  std::string name = array.name;
  state(name);
  if (state.is_reading()) {
    const auto found = std::ranges::find(known, name, &MeasuredArray::name);
    array = found == known.end() ? MeasuredArray() : *found;
    array.name = name;
  }
  auto held = static_cast<std::uint32_t>(array.numbers.index());
  state.choice(array.kind, OutputKind::scalar);
  state(array.unit, array.shape.rows, array.shape.columns, array.shape.channels, held);
  archive_numbers(state, held, array);
}

}  // namespace

void archive_state(StateArchive& state, Sensor& sensor) {
  if (auto* const own = dynamic_cast<Stateful*>(&sensor)) return own->archive(state);
  const HistoryDependence dependence = sensor.history_dependence();
  if (dependence == HistoryDependence::none) return;
  if (dependence == HistoryDependence::poses && dynamic_cast<const ReadingSensor*>(&sensor) != nullptr) return;
  if (!state.is_on()) return;
  state.refuse("its measurements depend on earlier frames, expected a type that is Stateful");
}

void archive_measurement(StateArchive& state, Measurement& measurement) {
  state(measurement.time_ns);
  state.require_past(measurement.time_ns);
  state.finite(measurement.world_from_sensor);
  std::size_t arrays = measurement.arrays.size(), constants = measurement.constants.size();
  state.count(arrays, 4 * sizeof(std::uint64_t));
  const std::vector<MeasuredArray> known = measurement.arrays;
  measurement.arrays.resize(arrays);
  for (MeasuredArray& each : measurement.arrays) archive_array(state, each, known);
  state.count(constants, 2 * sizeof(double));
  measurement.constants.resize(constants);
  for (NamedValue& each : measurement.constants) {
    std::string name(each.name);
    state(name, each.value);
    if (state.is_reading()) each.name = static_text(name);
  }
}

void require_scan(const StateArchive& state, const Scan& scan) {
  const auto is_number = [](double value) { return !std::isnan(value); };
  const auto is_coordinate = [](double value) { return std::abs(value) <= kMaxCoordinate_m; };
  const auto is_range = [&](double value) { return !std::isfinite(value) || is_coordinate(value); };
  for (glm::length_t axis = 0; axis < 3; ++axis) state.require(is_coordinate(scan.world_from_sensor[3][axis]));
  for (std::size_t i = 0; i < scan.azimuth_rad.size(); ++i) state.require(std::isfinite(scan.azimuth_rad[i]));
  for (std::size_t i = 0; i < scan.elevation_rad.size(); ++i) state.require(std::isfinite(scan.elevation_rad[i]));
  for (std::size_t i = 0; i < scan.range_m.size(); ++i) state.require(is_range(scan.range_m[i]));
  for (std::size_t i = 0; i < scan.error_bound_m.size(); ++i) state.require(is_number(scan.error_bound_m[i]));
  for (std::size_t i = 0; i < scan.origin_m.size(); ++i) state.require(is_coordinate(scan.origin_m[i]));
}

Reading reading_of(const StateArchive& state, Reading reading, const Measurement& measurement) {
  std::vector<const MeasuredArray*> columns;
  for (const MeasuredArray& each : reading.arrays) {
    columns.push_back(measurement.find(each.name));
    state.require(columns.back() != nullptr && columns.back()->count() == columns.front()->count());
  }
  const std::size_t rows = columns.empty() ? 0 : columns.front()->count();
  if (!columns.empty()) {
    reading.set_values([&](std::vector<double>& all) {
      all.clear();
      for (std::size_t row = 0; row < rows; ++row) {
        for (const MeasuredArray* const column : columns) all.push_back(column->number(row));
      }
    });
  }
  reading.time_ns = measurement.time_ns;
  reading.world_from_sensor = measurement.world_from_sensor;
  reading.constants = measurement.constants;
  return reading;
}

}  // namespace simvis
