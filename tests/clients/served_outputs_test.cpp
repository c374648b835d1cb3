// Outputs in shared memory: any number of them, with names of any length. every_consumer_test.cpp has those of all
// types.
#include <doctest/doctest.h>

#include <fcntl.h>
#include <unistd.h>

#include <string>
#include <vector>

#include <simvis_client/connection.h>
#include "tests/clients/shared_host.h"

TEST_SUITE_BEGIN("clients");

namespace simvis::test {

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
  std::vector<MeasuredArray> outputs;
  for (std::size_t i = 0; i < kOutputs; ++i) {
    outputs.push_back({{.name = names[i], .unit = "m/s"}, SharedArray<double>{values[i]}});
  }
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

TEST_CASE("a table that grows row by row leaves no memory that is too small for it") {
  const std::string name = unique_name("growing");
  SharedHost host(name);
  host.publish();
  const std::size_t sensor = host.add_sensor("TABLE", "made_up");
  constexpr std::uint32_t kRows = 2'000'000, kMoreRows = 10'000;
  constexpr std::uint64_t kSlots = 4;
  const SharedArray<double> numbers(std::vector<double>(kRows, 1.0));
  for (std::uint32_t rows = kMoreRows; rows <= kRows; rows += kMoreRows) {
    const MeasuredArray output{{.name = "x_m", .shape = {rows}}, numbers};
    host.publish(sensor, rows, 0, kIdentity, {&output, 1});
  }
  // Slots half as large again as the last measurement, after pieces of 2/3, 4/9, ... of it, a sum of at most 3 of them.
  const int file = open_object(name);
  REQUIRE(file >= 0);
  simvis_header header;
  REQUIRE(::pread(file, &header, sizeof header, 0) == sizeof header);
  ::close(file);
  CHECK(header.outputs.count <= 3 * 1.5 * kSlots * kRows * sizeof(double));
  const client::Connection connection(name, "reader");
  const auto measurement = connection.latest(0);
  REQUIRE(measurement);
  CHECK(measurement->output<double>("x_m")[kRows - 1] == 1.0);
}

}  // namespace simvis::test

TEST_SUITE_END();
