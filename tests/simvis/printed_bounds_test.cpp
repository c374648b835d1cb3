// The bounds of a table hold for the decimals that it prints: for readers who take both columns as doubles.
#include <doctest/doctest.h>

#include <cmath>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include <simvis/error.h>
#include <simvis/simulation.h>
#include "program/output/csv_file.h"
#include "program/output/number_text.h"
#include "program/output/output_writer.h"
#include "tests/support/infinity.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("simvis");

namespace simvis {
namespace {

double printed(const NumberFormat& format, double value) { return std::stod(number_cell(format, value)); }

double printed_bound(const NumberFormat& format, double bound, double value) {
  std::string text;
  append_bound(text, format, bound, format, value);
  return std::stod(text);
}

TEST_CASE("a printed bound covers the rounding of the printed value, and little more") {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> exponent(-3, 3), bound_exponent(-12, 2), sign(-1, 1);
  const NumberFormat nine{NumberFormat::Style::general, 9}, fixed{NumberFormat::Style::fixed, 6};
  std::uint64_t exceeded = 0, loose = 0;
  for (int i = 0; i < 200'000; ++i) {
    const double value = static_cast<float>(std::pow(10, exponent(random)));
    const double bound = static_cast<float>(std::pow(10, bound_exponent(random)));
    // The ends of the interval, rounded to the inside.
    const double low = std::nextafter(value - bound, kInfinity), high = std::nextafter(value + bound, -kInfinity);
    for (const NumberFormat& format : {nine, fixed}) {
      const double decimal = printed(format, value), decimal_bound = printed_bound(format, bound, value);
      exceeded += std::abs(decimal - low) > decimal_bound || std::abs(decimal - high) > decimal_bound;
      // One and a half units of the bound's last digit, and the reserve for the sums: an ulp of the value.
      const double unit = format.style == NumberFormat::Style::fixed ? 1e-6 : decimal_bound * 1e-8;
      loose += decimal_bound > bound + std::abs(decimal - value) + 1.5 * unit + 0x1p-51 * value;
    }
  }
  CHECK(exceeded == 0);
  CHECK(loose == 0);
  CHECK(printed_bound(nine, 0, 4) == 0);  // exact, and printed exactly
  CHECK(printed_bound(nine, 0, 0.1f) >= std::abs(0.1f - printed(nine, 0.1f)));
  CHECK(printed_bound(nine, kInfinity, 4) == kInfinity);
  CHECK(printed_bound(nine, 0, kInfinity) == 0);
  CHECK(printed_bound(nine, 1e-300, 0) >= 1e-300);
}

TEST_CASE("a bound is of a column to its left") {
  CHECK_THROWS_AS(csv_columns(std::vector<TableColumn>{{"bound", "%.9g", false, "range"}, {"range", "%.9g"}}),
                  InputError);
  const std::vector<CsvColumn> columns = csv_columns(
      std::vector<TableColumn>{{"frame", "%lld", true}, {"range", "%.9g"}, {"bound", "%.9g", false, "range"}});
  CHECK(columns[2].bound_of == 1);
  CHECK(columns[1].bound_of == 1);
}

TEST_CASE("the ranges of a cast scan lie within the printed bounds") {
  constexpr int kBeams = 2001;
  const TemporaryFolder folder;
  Simulation simulation = Simulation::load(write_wall_scene(
      folder.path(), "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' samples='" + std::to_string(kBeams) +
                         "' min_angle='-60' max_angle='60' method='raycast'/>"));
  OutputWriter writer({.folder = folder / "out", .sensors = {"SCAN"}});
  const FrameTime time = simulation.next_frame();
  simulation.step();
  writer.write("SCAN", time, glm::dmat4(1), simulation.measurement("SCAN"));
  writer.finish();
  std::istringstream table(read_text(folder / "out/SCAN.csv"));
  std::string line;
  std::getline(table, line);
  int beams = 0, exceeded = 0, exceeded_by_float_bound = 0;
  for (; std::getline(table, line); ++beams) {
    std::istringstream row(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    const double azimuth_rad = simulation.scan("SCAN").azimuth_rad[static_cast<std::size_t>(beams)];
    const double error_m = std::abs(std::stod(cells[6]) - 4 / std::cos(azimuth_rad));  // the wall is 4 m away
    exceeded += error_m > std::stod(cells[7]);
    exceeded_by_float_bound += error_m > simulation.scan("SCAN").error_bound_m[static_cast<std::size_t>(beams)];
  }
  CHECK(beams == kBeams);
  CHECK(exceeded == 0);
  CHECK(exceeded_by_float_bound > kBeams / 100);  // so the rounding matters here
}

// A beam along the wall at the angle of incidence i turns an error of its direction into one of its range that is
// tan(i) times as large: here up to 990 times. Angles with nine digits are off by up to 9e-10 rad.
TEST_CASE("beams whose directions are taken from the table lie within the printed bounds") {
  constexpr std::size_t kBeams = 1501, kRings = 3;
  constexpr double kScanner_m = 3.99, kWall_m = 4;
  const TemporaryFolder folder;
  Simulation simulation = Simulation::load(
      write_wall_scene(folder.path(),
                       "<sensor type='laser_scanner' name='SCAN' insert_at='ROOT' "
                       "pose_offset='3.99 0 0 0 0 0' samples='1501' min_angle='-89.95' max_angle='89.7' "
                       "vertical_samples='3' vertical_min_angle='-0.7' vertical_max_angle='0.4' "
                       "range_min='0.001' method='raycast'/>"));
  OutputWriter writer({.folder = folder / "out", .sensors = {"SCAN"}});
  const FrameTime time = simulation.next_frame();
  simulation.step();
  writer.write("SCAN", time, glm::dmat4(1), simulation.measurement("SCAN"));
  writer.finish();
  const Scan& scan = simulation.scan("SCAN");
  std::istringstream table(read_text(folder / "out/SCAN.csv"));
  std::string line;
  std::getline(table, line);
  std::size_t beams = 0, hits = 0, exceeded = 0, other_angles = 0;
  for (; std::getline(table, line); ++beams) {
    std::istringstream row(line);
    std::vector<std::string> cells;
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    const double azimuth_rad = glm::radians(std::stod(cells[4])), elevation_rad = glm::radians(std::stod(cells[5]));
    other_angles += azimuth_rad != scan.azimuth_rad[beams % kBeams];
    other_angles += elevation_rad != scan.elevation_rad[beams / kBeams];
    const double range_m = std::stod(cells[6]);
    if (!std::isfinite(range_m)) continue;
    ++hits;
    // The cosine in long double, since that of a double near a quarter turn has few exact digits.
    const long double true_m =
        (kWall_m - kScanner_m) / (std::cos(static_cast<long double>(azimuth_rad)) * std::cos(elevation_rad));
    exceeded += std::abs(range_m - true_m) > std::stod(cells[7]);
  }
  CHECK(beams == kBeams * kRings);
  CHECK(hits > beams / 2);
  CHECK(other_angles == 0);
  CHECK(exceeded == 0);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
