// The tolerance of a scan: which ranges meet it, and the error when no method does.
#include <doctest/doctest.h>

#include <limits>
#include <string>

#include "tests/sensors/auto_scan.h"
#include "tests/support/error_of.h"
#include "tests/support/random_room.h"
#include "tests/support/scan_truth.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;
using namespace simvis::test;

TEST_CASE("the error about a tolerance that no method meets names the smallest one that can be met") {
  struct Case {
    ScanMethod method;
    std::uint32_t rings;  // with many rings, no thread reads all of them
  };
  for (const auto& [method, rings] : {Case{ScanMethod::automatic, 1}, Case{ScanMethod::hybrid, 1},
                                      Case{ScanMethod::automatic, 64}, Case{ScanMethod::hybrid, 64}}) {
    LaserScannerDesc desc;
    desc.pattern = {.beams = 31, .rings = rings, .min_azimuth_rad = -0.5, .max_azimuth_rad = 0.5};
    if (rings > 1) desc.pattern.max_elevation_rad = 0.5;
    desc.method = method;
    desc.max_error_m = 2e-7;  // half an ulp of a float from 2 to 4 m is 1.2e-7, and from 4 to 8 m 2.4e-7
    desc.max_error_rel = std::numeric_limits<double>::infinity();
    desc.where_max_error_m = {.file = "scene.xml", .line = 3, .column = 14};
    DrawList near, far;
    add_item(near, half_box_mesh({3, 3, 3}), glm::dmat4(1.0));
    add_item(far, half_box_mesh({5, 5, 5}), glm::dmat4(1.0));
    LaserScanner scanner = make_scanner(desc, true);
    measure(scanner, near);
    const Scan before = *scanner.scan();
    far.revisions.structure = 7;
    const std::string message = error_of([&] { measure(scanner, far); });
    CHECK(contains(message, "scene.xml:3:14: error: attribute \"max_error_m\": 2e-07 cannot be kept by any method"));
    CHECK(contains(message, "sensor \"S\""));
    CHECK(scanner.scan()->range_m == before.range_m);  // complete and unchanged
    CHECK(scanner.scan()->error_bound_m == before.error_bound_m);
    const std::string best = " with every beam cast, is ";
    REQUIRE(contains(message, best));
    desc.max_error_m = std::stod(message.substr(message.find(best) + best.size()));
    CHECK(*desc.max_error_m < 3e-7);
    LaserScanner relaxed = make_scanner(desc, true);
    measure(relaxed, far);
    CHECK(relaxed.scan()->range_m.size() == 31 * rings);
    measure(scanner, near);  // the first scanner still works where it can
  }
}

TEST_CASE(
    "an unreachable tolerance of a scene: the error names its place, no frame is counted, and the step can be "
    "repeated") {
  for (const char* method : {"auto", "hybrid"}) {
    Simulation simulation = marvin_scanners({}, {{"method", method}, {"max_error_rel", "5e-8"}});
    const std::string message = error_of([&] { simulation.step(); });
    CHECK(contains(message,
                   "this test: error: attribute \"max_error_rel\": 5e-08 cannot be kept by any method for sensor \""));
    CHECK(contains(message, " of the range"));
    CHECK(simulation.measured().empty());
    CHECK(simulation.next_frame().index == 0);
    CHECK(sensor(simulation, "FRONT_SCANNER").frames == 0);
  }
}

TEST_CASE("beams that are rendered across a limit of the range are cast, and cast beams there meet the tolerance") {
  const RangeLimits limits{0.05, 80};
  ScanTolerance tolerance{.max_error_m = 0.01, .max_error_rel = std::numeric_limits<double>::infinity()};
  CHECK(tolerance.met(read_range({10, 0.009}, limits)));
  CHECK_FALSE(tolerance.met(read_range({10, 0.011}, limits)));
  CHECK_FALSE(tolerance.met(read_range({79.995, 0.009}, limits)));
  CHECK_FALSE(tolerance.met(read_range({80.005, 0.009}, limits)));
  CHECK_FALSE(tolerance.met(read_range({0.049, 0.009}, limits)));
  CHECK(tolerance.met(read_range({100, 5}, limits)));
  const double inf = std::numeric_limits<double>::infinity();
  CHECK(tolerance.met(read_range({inf, 0}, limits)));
  CHECK_FALSE(tolerance.met(read_range({inf, inf}, limits)));  // a silhouette in front of the sky
  ToleranceCheck check(tolerance);
  for (const RangeEstimate& cast : {RangeEstimate{80, 1e-13}, RangeEstimate{0.05, 1e-17}, RangeEstimate{inf, 0}}) {
    check.add(cast, read_range(cast, limits));
  }
  check.require("S");
}

TEST_CASE("a sensor that touches a surface meets the tolerance: its range is rounding error only") {
  const RangeLimits limits{0, 80};
  const ScanTolerance tolerance{.max_error_rel = 1e-6};
  ToleranceCheck touching(tolerance);
  for (const RangeEstimate& cast : {RangeEstimate{2e-16, 7e-13}, RangeEstimate{7e-13, 7e-13}}) {
    touching.add(cast, read_range(cast, limits));
  }
  touching.require("S");
  ToleranceCheck near(tolerance);
  near.add({1e-9, 7e-13}, read_range({1e-9, 7e-13}, limits));
  CHECK_FALSE(error_of([&] { near.require("S"); }).empty());
}

TEST_SUITE_END();
