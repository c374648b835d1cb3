// A real furnished house, 87 parts from 62 files made by others, as one scene with a lidar and a camera.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <simvis/pose.h>
#include <simvis/simulation.h>
#include "sensors/laser_scanner/laser_scanner.h"
#include "tests/support/scan_truth.h"
#include "tests/support/skip.h"

TEST_SUITE_BEGIN("scenes");

using namespace simvis;

namespace {

constexpr double kDegrees = 57.29577951308232;

// parts.csv: name, file, x, y, z in metres, roll, pitch, yaw in radians, three scales (all 1 here).
std::string scene_from_parts(const std::filesystem::path& csv) {
  std::ifstream in(csv);
  std::ostringstream xml;
  xml.precision(17);
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::vector<std::string> cells;
    std::istringstream row(line);
    for (std::string cell; std::getline(row, cell, ',');) cells.push_back(cell);
    REQUIRE(cells.size() == 11);
    std::string name = cells[0];
    for (char& c : name) c = c == '/' ? '_' : c;
    xml << "<part file=\"" << cells[1] << "\" name=\"" << name << "\" insert_at=\"ROOT\" pose_offset=\"" << cells[2]
        << ' ' << cells[3] << ' ' << cells[4] << ' ' << std::stod(cells[5]) * kDegrees << ' '
        << std::stod(cells[6]) * kDegrees << ' ' << std::stod(cells[7]) * kDegrees << "\"/>\n";
  }
  xml << "<sensor type=\"laser_scanner\" name=\"LIDAR\" insert_at=\"ROOT\" pose_offset=\"1 1 0.6 0 0 0\" "
         "samples=\"1024\""
         " min_angle=\"-180\" max_angle=\"180\" vertical_samples=\"16\" vertical_min_angle=\"-15\""
         " vertical_max_angle=\"15\" method=\"planar\"/>\n"
         "<sensor type=\"camera\" name=\"CAM\" insert_at=\"ROOT\" pose_offset=\"1 1 1.4 0 10 180\" hfov=\"80\""
         " outputs=\"color depth\"/>\n";
  return xml.str();
}

}  // namespace

TEST_CASE("test data: the furnished house runs with a lidar and a camera") {
  const auto data = test::test_data("house/parts.csv");
  if (!data) return;
  const std::filesystem::path house = data->parent_path();
  Simulation simulation = Simulation::from_string(scene_from_parts(house / "parts.csv"), {}, house, "house.xml");
  simulation.step();
  // 87 instances of 62 files, 145,844 triangles, says the folder's own list, of which two balls are no files.
  CHECK(simulation.diagnostics().draw_list().items.size() >= 85);

  const Image& depth = simulation.depth("CAM");
  std::size_t seen = 0;
  for (const float z : depth.pixels) seen += std::isfinite(z);
  CHECK(seen > depth.pixels.size() / 2);

  glm::dmat4 world_from_sensor(1.0);
  REQUIRE(simulation.sensor_pose("LIDAR", world_from_sensor));
  ScanComparison comparison;
  compare(simulation.scan("LIDAR"),
          reference::RayCaster(simulation.diagnostics().draw_list(), rigid_inverse(world_from_sensor)), 0.05, 80,
          2 / kRingsResolution, comparison);
  std::ostringstream text;
  text << comparison;
  MESSAGE(text.str());
  CHECK(comparison.violations == 0);
  // Chandelier arms and cupboard mouldings are finer than a pixel at some metres: the stated limit, not many beams.
  CHECK(comparison.narrow < comparison.beams / 1000);
  CHECK(comparison.median_error() <= 2e-7);
}

TEST_SUITE_END();
