// Each output of every sensor type arrives in shared memory, with its name, unit, shape and exact values.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <simvis_client/connection.h>
#include "tests/clients/shared_host.h"
#include "tests/support/every_sensor.h"

TEST_SUITE_BEGIN("clients");

namespace simvis::test {
namespace {

std::vector<double> numbers_of(const client::Measurement& measurement, const simvis_output& output, const char* name) {
  if (output.type == SIMVIS_FLOAT64) {
    const auto seen = measurement.output<double>(name);
    return {seen.begin(), seen.end()};
  }
  const auto seen = measurement.output<float>(name);
  return {seen.begin(), seen.end()};
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

void check(const SensorType& type, const std::string& attributes) {
  CAPTURE(type.name);
  CAPTURE(attributes);
  const Command command = parse_commands(sensor_xml(type.name, attributes), "s.xml", ".").at(0);
  Simulation simulation = scene_of(type.name, attributes);
  ServeDesc desc;
  desc.name = unique_name("outputs");
  simulation.serve(desc);
  drive(simulation);
  const Measurement measured = simulation.measurement(kSensor);
  const client::Connection connection(desc.name, "reader");
  const auto measurement = connection.latest(connection.sensor(std::string(kSensor)));
  REQUIRE(measurement);
  const simvis_view view = measurement->view();
  for (const OutputSpec& spec : expanded(outputs_of(type, command))) {
    CAPTURE(spec.name);
    const simvis_output* output = nullptr;
    const bool is_there = simvis_output_data(&view, spec.name.c_str(), &output) != nullptr;
    REQUIRE(is_there == !spec.derived);
    if (!is_there) continue;
    CHECK(simvis_output_unit(&view, output) == spec.unit);
    std::vector<double> expected;
    OutputShape shape{};
    if (const MeasuredArray* const array = measured.find(spec.name)) {
      for (std::size_t i = 0; i < array->count(); ++i) expected.push_back(array->number(i));
      shape = array->shape;
    } else {
      expected = {simulation.value(kSensor, spec.name)};
    }
    CHECK(OutputShape{output->rows, output->columns, output->channels} == shape);
    CHECK(std::ranges::equal(numbers_of(*measurement, *output, spec.name.c_str()), expected, same));
  }
  CHECK(measurement->whole());
}

}  // namespace

TEST_CASE("each output of every sensor type is in shared memory with its name, unit, shape and values") {
  for (const SensorType* type : sensor_types()) {
    for (const std::string& attributes : attributes_of(type->name)) check(*type, attributes);
  }
}

TEST_CASE("a measurement may have any number of outputs, with names of any length") {
  const std::string name = unique_name("outputs");
  SharedHost host(name);
  host.publish();
  const std::size_t sensor = host.add_sensor("MANY", "made_up");
  constexpr std::size_t kOutputs = 300;
  std::vector<std::string> names;
  std::vector<double> values;
  for (std::size_t i = 0; i < kOutputs; ++i) {
    names.push_back(std::string(i, 'n') + std::to_string(i));
    values.push_back(0.5 * static_cast<double>(i));
  }
  std::vector<SharedOutput> outputs;
  for (std::size_t i = 0; i < kOutputs; ++i) outputs.push_back({.name = names[i], .unit = "m/s", .data = &values[i]});
  host.publish(sensor, 0, 0, kIdentity, outputs);
  const client::Connection connection(name, "reader");
  const auto measurement = connection.latest(0);
  REQUIRE(measurement);
  const simvis_view view = measurement->view();
  for (std::uint32_t i = 0; i < kOutputs; ++i) {
    const simvis_output* const output = simvis_output_at(&view, i);
    REQUIRE(output != nullptr);
    CHECK(simvis_output_name(&view, output) == names[i]);
    CHECK(simvis_output_unit(&view, output) == std::string("m/s"));
    CHECK(measurement->output<double>(names[i].c_str())[0] == values[i]);
  }
  CHECK(simvis_output_at(&view, kOutputs) == nullptr);
}

}  // namespace simvis::test

TEST_SUITE_END();
