// Measurements that come from other processes: only those whose arrays fit together become tables and scans.
#include <doctest/doctest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sensors/measured_table.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

template <typename Number>
MeasuredArray array_of(std::string name, OutputKind kind, OutputShape shape) {
  const std::size_t count = std::size_t{shape.rows} * shape.columns * shape.channels;
  return {{.name = std::move(name), .kind = kind, .shape = shape}, SharedArray<Number>(std::vector<Number>(count))};
}

// Two rings of three beams.
Measurement scan() {
  constexpr OutputKind kColumn = OutputKind::scan_column;
  Measurement measurement;
  measurement.arrays = {
      array_of<float>("range_m", kColumn, {2, 3, 1}), array_of<float>("error_bound_m", kColumn, {2, 3, 1}),
      array_of<double>("azimuth_rad", kColumn, {1, 3, 1}), array_of<double>("elevation_rad", kColumn, {2, 1, 1}),
      array_of<double>("intensity", kColumn, {2, 3, 1})};
  return measurement;
}

}  // namespace

TEST_CASE("a reading gets new rows in the memory of the old ones unless a copy holds them") {
  const std::vector<TableColumn> columns = {{.name = "a", .format = "%.9g"}, {.name = "b", .format = "%.9g"}};
  Reading reading(columns, {1, 2, 3, 4});
  const Measurement kept = reading;
  reading.set_values([](std::vector<double>& all) { all.assign({5, 6}); });
  REQUIRE(reading.rows() == 1);
  CHECK(reading.find("b") == 6);
  CHECK_FALSE(reading.find("b", 1));
  REQUIRE(kept.arrays[1].count() == 2);
  CHECK(kept.arrays[1].number(1) == 4);
  const double* const memory = reading.values().data();
  reading.set_values([](std::vector<double>& all) { all.assign({7, 8}); });
  CHECK(reading.values().data() == memory);
}

TEST_CASE("arrays fit together if they are one scan or one table") {
  CHECK(fits_together(scan()));
  CHECK(measured_table(scan()).values.size() == 6 * measured_table(scan()).columns.size());
  for (std::size_t missing = 0; missing < 4; ++missing) {  // all but the intensity
    Measurement damaged = scan();
    damaged.arrays.erase(damaged.arrays.begin() + static_cast<std::ptrdiff_t>(missing));
    CHECK_FALSE(fits_together(damaged));
  }
  for (std::size_t other = 0; other < 5; ++other) {
    for (const OutputShape shape : {OutputShape{2, 2, 1}, OutputShape{2, 3, 3}, OutputShape{0, 3, 1}}) {
      Measurement damaged = scan();
      MeasuredArray& array = damaged.arrays[other];
      array =
          other < 2 ? array_of<float>(array.name, array.kind, shape) : array_of<double>(array.name, array.kind, shape);
      CHECK_FALSE(fits_together(damaged));
    }
  }
  Measurement typed = scan();
  typed.arrays[0] = array_of<std::uint8_t>("range_m", OutputKind::scan_column, {2, 3, 1});
  CHECK_FALSE(fits_together(typed));
}

// Arrays that measured_table() reads besides those that make the scan.
TEST_CASE("every array of a scan has a number for each beam") {
  constexpr OutputKind kColumn = OutputKind::scan_column;
  for (const char* name : {"ring", "azimuth_deg", "elevation_deg", "intensity"}) {
    CAPTURE(name);
    const bool is_channel = std::string(name) == "intensity";
    for (const OutputShape shape : {OutputShape{2, 3, 1}, OutputShape{3, 2, 1}, OutputShape{6, 1, 1},
                                    OutputShape{1, 3, 1}, OutputShape{1, 1, 6}, OutputShape{0, 0, 1}}) {
      CAPTURE(shape.rows);
      CAPTURE(shape.columns);
      Measurement measurement = scan();
      measurement.arrays.back() = array_of<double>(name, kColumn, shape);
      const bool fits = shape == OutputShape{2, 3, 1} || (shape == OutputShape{1, 3, 1} && !is_channel);
      CHECK(fits_together(measurement) == fits);
    }
  }
  for (const OutputShape shape : {OutputShape{2, 3, 3}, OutputShape{2, 3, 1}, OutputShape{1, 3, 3}}) {
    Measurement measurement = scan();
    measurement.arrays.back() = array_of<double>("origin_m", kColumn, shape);
    CHECK(fits_together(measurement) == (shape == OutputShape{2, 3, 3}));
  }
  Measurement with_image = scan();
  with_image.arrays.push_back(array_of<float>("picture", OutputKind::image, {1, 1, 4}));
  CHECK(fits_together(with_image));
  CHECK(measured_table(with_image).values == measured_table(scan()).values);
}

TEST_CASE("columns of a table have one length") {
  Measurement table;
  table.arrays = {array_of<double>("a", OutputKind::table_column, {4, 1, 1}),
                  array_of<double>("b", OutputKind::table_column, {4, 1, 1}),
                  array_of<float>("image", OutputKind::image, {2, 2, 4})};
  CHECK(fits_together(table));
  table.arrays[1] = array_of<double>("b", OutputKind::table_column, {3, 1, 1});
  CHECK_FALSE(fits_together(table));
  table.arrays[1] = array_of<double>("ring", OutputKind::table_column, {3, 1, 1});
  CHECK_FALSE(fits_together(table));
  CHECK(fits_together({}));
}

TEST_SUITE_END();
