// A scene far from the world's origin gives the same ranges and pictures.
#include <doctest/doctest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <simvis/simulation.h>
#include "engine/base/srgb.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

// Rounding of world coordinates of 7.6e6 m in double is 1e-9 m, far below that of float32 at several metres. 1e-6
// allows for a dozen roundings of float32 in the other direction.
constexpr double kRange = 1e-6;

Simulation marvin_at(const std::string& offset) {
  const std::filesystem::path folder = std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/marvin";
  std::ifstream in(folder / "marvin.xml");
  std::string xml{std::istreambuf_iterator<char>(in), {}};
  const std::string at = "insert_at=\"ROOT\"";
  std::size_t moved = 0;
  for (std::size_t i = xml.find(at); i != std::string::npos; i = xml.find(at, i + 1), ++moved) {
    xml.insert(i + at.size(), " pose_offset=\"" + offset + "\"");
  }
  REQUIRE(moved == 1);  // the whole laboratory depends on it
  return Simulation::from_string(xml, {}, folder, "marvin.xml");
}

}  // namespace

TEST_CASE("moved by (1.2e6, -7.6e6, 300) m the laboratory gives the same ranges and pictures") {
  Simulation home = marvin_at("0 0 0 0 0 0"), away = marvin_at("1.2e6 -7.6e6 300 0 0 0");
  home.step();
  away.step();
  int compared = 0;
  for (const char* name : {"FRONT_SCANNER", "REAR_SCANNER", "TILT_SCANNER"}) {
    const Scan &a = home.scan(name), &b = away.scan(name);
    for (std::size_t beam = 0; beam < a.range_m.size(); ++beam) {
      if (std::isinf(a.error_bound_m[beam]) || std::isinf(b.error_bound_m[beam])) continue;
      ++compared;
      CHECK(std::abs(a.range_m[beam] - b.range_m[beam]) <= kRange * a.range_m[beam]);
    }
  }
  CHECK(compared > 1000);
  const std::vector<float>&a = home.color("ROBOT_CAM").pixels, &b = away.color("ROBOT_CAM").pixels;
  REQUIRE(a.size() == b.size());
  int largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::abs(srgb_code(a[i]) - srgb_code(b[i])));
  CHECK(largest <= 1);
}

TEST_SUITE_END();
