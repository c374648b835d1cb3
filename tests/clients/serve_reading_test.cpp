// Readings reach clients as one array, in the order of the columns.
#include <doctest/doctest.h>

#include <algorithm>

#include <simvis/simulation.h>
#include <simvis_client/connection.h>
#include "tests/clients/shared_host.h"

using namespace simvis;
using client::Connection;

TEST_SUITE_BEGIN("clients");

TEST_CASE("a client reads the numbers of an imu and the detections of a radar, none included") {
  Simulation simulation = Simulation::from_string(R"(
    <part name="WALL" shape="box" size="0.25 4 4" insert_at="ROOT" pose_offset="3 0 0 0 0 0"/>
    <element type="pose" name="MOVE" insert_at="WALL"/>
    <part name="PLATE" shape="box" size="0.25 4 4" insert_at="WALL"/>
    <sensor type="imu" name="IMU" insert_at="ROOT" accelerometer_stddev="1"/>
    <sensor type="range" name="RANGE" insert_at="ROOT"/>
    <sensor type="radar" name="RADAR" insert_at="ROOT" angle_step="5" range_max="10"/>)");
  ServeDesc desc;
  desc.name = unique_name("serve-reading");
  simulation.serve(desc);
  simulation.step();
  Connection connection(desc.name, "reader");
  const auto check_same = [&](const char* sensor) {
    const auto measurement = connection.latest(connection.sensor(sensor));
    REQUIRE(measurement);
    const Reading& reading = simulation.reading(sensor);
    for (const MeasuredArray& column : reading.arrays) {
      CAPTURE(column.name);
      const simvis_view view = measurement->view();
      const simvis_output* shape = nullptr;
      REQUIRE(simvis_output_data(&view, column.name.c_str(), &shape) != nullptr);
      CHECK(shape->rows == reading.rows());
      CHECK(simvis_output_unit(&view, shape) == column.unit);
      const std::span<const double> seen = measurement->output<double>(column.name.c_str());
      for (std::size_t row = 0; row < seen.size(); ++row) CHECK(seen[row] == reading.find(column.name, row));
    }
  };
  check_same("IMU");
  check_same("RADAR");
  CHECK(simulation.reading("RADAR").rows() > 0);
  const auto range = connection.latest(connection.sensor("RANGE"));
  CHECK(range->output<double>("range_m")[0] == simulation.value("RANGE", "range_m"));
  simulation.execute(R"(<remove name="WALL"/>)");
  simulation.step();
  CHECK(simulation.reading("RADAR").rows() == 0);
  check_same("RADAR");
}

TEST_SUITE_END();
