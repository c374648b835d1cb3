// Reflectivity in the unit of devices: matte surfaces by their reflectance, retro-reflectors above 100.
#include "effects/scanner/reflectivity.h"

#include <doctest/doctest.h>

#include <cmath>
#include <string>
#include <vector>

#include <simvis/simulation.h>
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("effects");

using namespace simvis;

namespace {

// A wall whose front is at x, and 13 beams at -60, -50, ..., 60 degrees.
Scan scan_of_wall(double x_m, const std::string& material, const std::string& attributes) {
  const std::string xml =
      R"(<simvis><part name="WALL" shape="box" size="0.2 80 4" insert_at="ROOT" pose_offset=")" +
      format_number(x_m + 0.1) + R"( 0 0 0 0 0"/><element type="material" name="M" insert_at="ROOT" part="WALL" )" +
      material +
      R"(/><sensor type="laser_scanner" name="SCAN" insert_at="ROOT" samples="13" min_angle="-60" max_angle="60" )" +
      attributes + "/></simvis>";
  Simulation simulation = Simulation::from_string(xml);
  simulation.step();
  return simulation.scan("SCAN");
}

TEST_CASE("reflectivity is 100 x reflectance x cosine at any range, and at most 255") {
  for (const double wall_m : {1.0, 4.0, 20.0}) {
    const Scan scan = scan_of_wall(wall_m, R"(reflectance="0.8")", R"(reflectivity="on")");
    const SharedNumbers<double> channel = scan.channel("reflectivity");
    REQUIRE(channel.size() == 13);
    for (int beam = 0; beam < 13; ++beam) {
      // No value is within rounding of a half: 80 cos(10 k degrees) is 80, 78.8, 75.2, 69.3, 61.3, 51.4 and 40. The
      // last one is exact but for rounding.
      CHECK(channel[static_cast<std::size_t>(beam)] == std::round(80 * std::cos((10 * beam - 60) * kPi / 180)));
    }
  }
  const Scan sign = scan_of_wall(4, R"(reflectance="0.8" retro_reflectance="2")", R"(reflectivity="on")");
  CHECK(sign.channel("reflectivity")[6] == 200);
  const Scan bright = scan_of_wall(4, R"(retro_reflectance="500")", R"(reflectivity="on")");
  CHECK(bright.channel("reflectivity")[6] == 255);
}

TEST_CASE("reflectivity that is off leaves the scan as it is, and there is none without a range") {
  const Scan plain = scan_of_wall(4, "", R"(method="raycast")"),
             off = scan_of_wall(4, "", R"(method="raycast" reflectivity="off")"),
             on = scan_of_wall(4, "", R"(reflectivity="on" range_max="5")");
  CHECK(off.range_m == plain.range_m);
  CHECK(off.channels().empty());
  for (std::size_t beam = 0; beam < 13; ++beam) {
    CHECK(std::isnan(on.channel("reflectivity")[beam]) == std::isinf(on.range_m[beam]));
  }
  CHECK(std::isinf(on.range_m[0]));
  CHECK(std::isfinite(on.range_m[6]));
}

}  // namespace

TEST_SUITE_END();
