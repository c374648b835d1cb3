// What a sensor gives equals its outputs, which are known before anything runs: names, order, number types, shapes,
// units and the values for nothing, for every sensor type.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "exchange/messages/cdr.h"
#include "exchange/messages/from_reading.h"
#include "sensors/measured_table.h"
#include "tests/support/every_sensor.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis::test {
namespace {

/// Whether `value` is what the output may give.
bool fits(const OutputSpec& spec, double value) {
  if (spec.nothing && (value == *spec.nothing || (std::isnan(value) && std::isnan(*spec.nothing)))) return true;
  if (!std::isfinite(value)) return false;
  if (is_integer(spec.value_type)) return value == std::trunc(value);
  return spec.value_type == ValueType::f64 || value == static_cast<double>(static_cast<float>(value));
}

bool fits(const OutputShape& spec, const OutputShape& shape) {
  const auto same = [](std::uint32_t promised, std::uint32_t given) { return promised == 0 || promised == given; };
  return same(spec.rows, shape.rows) && same(spec.columns, shape.columns) && same(spec.channels, shape.channels);
}

void check_array(const OutputSpec& spec, const MeasuredArray& array) {
  CHECK(array.kind == spec.kind);
  CHECK(array.value_type == spec.value_type);
  CHECK(array.unit == spec.unit);
  CHECK(array.content == spec.content);
  CHECK(array.frame == spec.frame);
  CHECK(array.meaning == spec.meaning);
  CHECK(array.bound == spec.bound);
  CHECK(array.message == spec.message);
  CHECK(fits(spec.shape, array.shape));
  std::size_t unfit = 0;
  for (std::size_t i = 0; i < array.count(); ++i) unfit += !fits(spec, array.number(i));
  CHECK(unfit == 0);
}

void check_bounds(std::span<const OutputSpec> specs, const MeasuredTable& table) {
  for (const TableColumn& column : table.columns) {
    if (column.bound_of.empty()) continue;
    const auto bounded = std::ranges::find(specs, column.bound_of, &OutputSpec::name);
    REQUIRE(bounded != specs.end());
    CHECK(bounded->bound == column.name);
  }
}

void check_column(const OutputSpec& spec, const MeasuredTable& table) {
  const auto column = std::ranges::find(table.columns, spec.name, &TableColumn::name);
  REQUIRE(column != table.columns.end());
  CHECK(column->unit == spec.unit);
  CHECK(value_type(*column) == spec.value_type);
  CHECK(std::size_t{spec.shape.rows} * spec.shape.columns == table.rows());
  const auto c = static_cast<std::size_t>(column - table.columns.begin());
  std::size_t unfit = 0;
  for (std::size_t row = 0; row < table.rows(); ++row)
    unfit += !fits(spec, table.values[row * table.columns.size() + c]);
  CHECK(unfit == 0);
}

void check(std::string_view type, const std::string& attributes) {
  CAPTURE(type);
  CAPTURE(attributes);
  const Command command = parse_commands(sensor_xml(type, attributes), "s.xml", ".").at(0);
  const std::vector<OutputSpec> specs = expanded(outputs_of(*find_sensor_type(type), command));
  REQUIRE_FALSE(specs.empty());
  Simulation simulation = scene_of(type, attributes);
  CHECK(simulation.measurement(kSensor).time_ns == 0);
  for (const MeasuredArray& each : simulation.measurement(kSensor).arrays) {
    const bool is_layout = each.name.starts_with("azimuth") || each.name.starts_with("elevation") ||
                           each.name == "ring" || each.name == "origin_m";
    CHECK((each.count() == 0 || is_layout));
  }
  drive(simulation);
  const Measurement measurement = simulation.measurement(kSensor);
  const MeasuredTable table = measured_table(measurement);
  glm::dmat4 pose;
  REQUIRE(simulation.sensor_pose(kSensor, pose));
  CHECK(measurement.world_from_sensor == pose);
  CHECK(measurement.time_ns > 0);
  std::size_t arrays = 0, on_request = 0;
  for (const OutputSpec& spec : specs) {
    CAPTURE(spec.name);
    const std::optional<double> value = simulation.find_value(kSensor, spec.name);
    CHECK(value.has_value() == (spec.kind == OutputKind::scalar));
    if (value) CHECK(fits(spec, *value));
    CHECK((spec.bound.empty() || simulation.find_value(kSensor, spec.bound) || measurement.find(spec.bound)));
    arrays += !spec.derived && !spec.on_request;
    on_request += spec.on_request;
    const MeasuredArray* const array = measurement.find(spec.name);
    CHECK((array != nullptr) == (!spec.derived && !spec.on_request));
    if (array != nullptr) check_array(spec, *array);
    if (spec.derived) check_column(spec, table);
  }
  CHECK(measurement.arrays.size() == arrays);
  CHECK(measurement.on_request.size() == on_request);
  check_bounds(specs, table);
}

TEST_CASE("every sensor gives exactly what its type says before anything runs") {
  int types = 0;
  for (const SensorType* type : sensor_types()) {
    ++types;
    for (const std::string& attributes : attributes_of(type->name)) check(type->name, attributes);
  }
  CHECK(types >= 20);
  check("laser_scanner", "pattern='device:velodyne_vlp16'");
}

TEST_CASE("outputs have a meaning, names of their own, and each bound is an output") {
  for (const SensorType* type : sensor_types()) {
    CAPTURE(type->name);
    const std::vector<OutputSpec> specs = all_outputs(*type);
    REQUIRE_FALSE(specs.empty());
    std::set<std::string> names;
    for (const OutputSpec& spec : specs) {
      CAPTURE(spec.name);
      CHECK(names.insert(spec.name).second);
      CHECK_FALSE(spec.meaning.empty());
      CHECK((spec.bound.empty() || std::ranges::find(specs, spec.bound, &OutputSpec::name) != specs.end()));
      CHECK((spec.given || !spec.when.empty()));
    }
  }
}

TEST_CASE("the message of a reading depends on exactly the outputs that name it") {
  int messages = 0;
  for (const SensorType* type : sensor_types()) {
    if (type->message.empty()) continue;
    ++messages;
    CAPTURE(type->name);
    const std::vector<OutputSpec> specs = expanded(all_outputs(*type));
    std::vector<TableColumn> columns;
    for (const OutputSpec& spec : specs) columns.push_back({.name = spec.name, .format = "%.9g"});
    std::vector<double> values(columns.size());
    std::iota(values.begin(), values.end(), 1);
    const auto bytes = [&] {
      const Reading reading(columns, values);
      const auto message = ros::message_of(reading, type->message, "frame");
      REQUIRE(message.has_value());
      return std::visit([](const auto& each) { return ros::encode(each); }, message->message);
    };
    const std::string before = bytes();
    for (std::size_t i = 0; i < specs.size(); ++i) {
      CAPTURE(specs[i].name);
      values[i] += 100;
      CHECK((bytes() != before) == (specs[i].message == type->message));
      values[i] -= 100;
    }
  }
  CHECK(messages >= 13);
}

TEST_CASE("outputs of a command that its type does not allow are refused with the place") {
  const Command wrong =
      parse_commands("<sensor type='range' name='S' insert_at='ROOT' rang_max='1'/>", "s.xml", ".").at(0);
  CHECK_THROWS_AS(outputs_of(*find_sensor_type("range"), wrong), InputError);
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
