// method="auto": the methods that it chooses, and the tolerance and determinism of its scans.
#include <doctest/doctest.h>

#include <algorithm>
#include <limits>
#include <string>

#include <simvis/pose.h>
#include "program/report/run_report.h"
#include "tests/sensors/auto_scan.h"
#include "tests/support/error_of.h"
#include "tests/support/random_room.h"
#include "tests/support/reference_directions.h"
#include "tests/support/scan_truth.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;
using namespace simvis::test;

namespace {

// The reference is about twenty times slower under sanitizers.
const std::uint32_t kFewerBeams = sanitized() ? 8 : 1;

/// Checks that every bound meets the tolerance, and that the truth lies within every bound.
void check_kept(const LaserScanner& scanner, const LaserScannerDesc& desc, const DrawList& list,
                const glm::dmat4& world_from_sensor) {
  const Scan& scan = *scanner.scan();
  for (std::size_t beam = 0; beam < scan.range_m.size(); ++beam) {
    const double range = scan.range_m[beam], bound = scan.error_bound_m[beam];
    CHECK((bound == 0 || (bound <= desc.max_error_m.value_or(1e9) && bound <= desc.max_error_rel * range)));
  }
  ScanComparison comparison;
  const std::string chosen = noted(scanner.report(), "chosen");
  const double pixel_rad = chosen == "raycast" ? 0 : 2 / std::stod(chosen.substr(chosen.find(' ')));
  compare(scan, reference::RayCaster(list, rigid_inverse(world_from_sensor)), desc.range_min_m, desc.range_max_m,
          pixel_rad, comparison);
  CHECK(comparison.violations == 0);
  CHECK(comparison.uncertain == 0);
}

}  // namespace

TEST_CASE("every beam meets the tolerance with every chosen method") {
  struct Tolerance {
    std::optional<double> max_error_m;
    double max_error_rel;
  };
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const DrawList list = random_room(7, 60, 24);
  Pose pose;
  pose.position_m = {0.3, -0.2, 1.2};
  pose.yaw_rad = 0.7;
  for (const Tolerance& tolerance : {Tolerance{0.01, kNone}, Tolerance{1e-4, kNone}, Tolerance{{}, 1e-4},
                                     Tolerance{1e-3, 2e-4}, Tolerance{{}, 1e-6}}) {
    for (const std::uint32_t rings : {1u, 16u}) {
      for (const bool cheap_to_render : {false, true}) {
        LaserScannerDesc desc;
        desc.pattern = {.beams = rings == 1 ? 1441 / kFewerBeams : 90 / kFewerBeams,
                        .rings = rings,
                        .min_azimuth_rad = -kPi,
                        .max_azimuth_rad = kPi};
        if (rings > 1) desc.pattern.min_elevation_rad = -kPi / 8, desc.pattern.max_elevation_rad = kPi / 8;
        desc.method = ScanMethod::automatic;
        desc.max_error_m = tolerance.max_error_m;
        desc.max_error_rel = tolerance.max_error_rel;
        LaserScanner scanner = make_scanner(desc, cheap_to_render);
        CAPTURE(rings);
        measure(scanner, list, to_matrix(pose));  // surveys
        CHECK(scanner.cast_share() == 1);
        check_kept(scanner, desc, list, to_matrix(pose));
        measure(scanner, list, to_matrix(pose));
        check_kept(scanner, desc, list, to_matrix(pose));
        const bool renders = cheap_to_render && desc.max_error_rel >= min_planar_bound();
        CHECK(noted(scanner.report(), "chosen").starts_with(renders ? "hybrid" : "raycast"));
        CHECK((*scanner.cast_share() < 1) == renders);
      }
    }
  }
}

TEST_CASE("beams in the marvin laboratory meet the tolerance while the robot drives") {
  const CostsFolder cache(made_up_costs(true));
  for (const char* attribute : {"max_error_m", "max_error_rel"}) {
    Simulation simulation =
        marvin_scanners(cache.folder.path(), {{"method", "auto"}, {attribute, "3e-4"}, {"samples", "721"}});
    ScanComparison comparison;
    for (int frame = 0; frame < 3; ++frame) {
      simulation.set("R_POSE", "yaw", 18.0 * frame);
      simulation.step();
      for (const char* name : kMarvinScanners) {
        glm::dmat4 world_from_sensor(1.0);
        REQUIRE(simulation.sensor_pose(name, world_from_sensor));
        const Scan& scan = simulation.scan(name);
        for (std::size_t beam = 0; beam < scan.range_m.size(); ++beam) {
          const bool absolute = attribute == std::string("max_error_m");
          CHECK(scan.error_bound_m[beam] <= 3e-4 * (absolute ? 1 : static_cast<double>(scan.range_m[beam])));
        }
        compare(scan, reference::RayCaster(simulation.diagnostics().draw_list(), rigid_inverse(world_from_sensor)),
                0.05, 80, 2.0 / 512, comparison);
        CHECK(chosen(simulation, name).starts_with("hybrid"));
      }
    }
    CHECK(comparison.violations == 0);
  }
}

TEST_CASE("no beam is cast with a loose tolerance where there are no edges") {
  DrawList list;
  add_item(list, half_box_mesh({20, 20, 20}), glm::dmat4(1.0));
  LaserScannerDesc desc;
  desc.pattern = {.beams = 361, .min_azimuth_rad = -kPi / 6, .max_azimuth_rad = kPi / 6};  // to one wall
  desc.method = ScanMethod::automatic;
  desc.max_error_m = 0.05;
  desc.max_error_rel = std::numeric_limits<double>::infinity();
  LaserScanner scanner = make_scanner(desc, true);
  measure(scanner, list);
  const RayCounters surveyed = machine().caster->counters();
  measure(scanner, list);
  CHECK(machine().caster->counters() == surveyed);
  CHECK(scanner.cast_share() == 0);
  CHECK(noted(scanner.report(), "chosen") == "hybrid 512");
  CHECK(contains(scanner.report().explanation, "  * hybrid 512: "));
  CHECK(contains(scanner.report().explanation, ", 0 beams cast, "));
  CHECK(contains(scanner.report().explanation, "    raycast: "));
}

TEST_CASE("the cheapest method is chosen, and the plan names it and the reason") {
  const DrawList list = random_room(3, 20, 12);
  const glm::dmat4 pose = to_matrix({{0, 0, 1.2}, 0, 0, 0});  // its floor is at 0: no beam runs along an edge
  LaserScannerDesc desc;
  desc.pattern = {.beams = 181, .min_azimuth_rad = -1, .max_azimuth_rad = 1};
  desc.method = ScanMethod::automatic;
  desc.max_error_m = 0.01;
  desc.max_error_rel = std::numeric_limits<double>::infinity();
  for (const bool cheap_to_render : {true, false}) {
    LaserScanner scanner = make_scanner(desc, cheap_to_render);
    FramePlan survey, plan;
    scanner.plan(pose, list, survey);
    CHECK(survey.passes.size() == std::size(kPlanarResolutions));
    measure(scanner, list, pose);
    scanner.plan(pose, list, plan);
    REQUIRE(plan.casts.size() == 1);
    CHECK(plan.passes.size() == (cheap_to_render ? 1 : 0));
    CHECK(contains(plan.casts[0].reason, "by " + noted(scanner.report(), "chosen") + ", the cheapest method"));
    CHECK(contains(noted(scanner.report(), "chosen_because"), "0.01 m"));
  }
  desc.resolution_px = 700;
  LaserScanner given = make_scanner(desc, true);
  measure(given, list, pose);
  CHECK(noted(given.report(), "chosen") == "hybrid 700");
}

TEST_CASE("the same costs give the same bytes") {
  const TemporaryFolder cache;
  std::string first;
  for (int run = 0; run < 2; ++run) {
    Simulation simulation = marvin_scanners(cache.path(), {{"method", "auto"}, {"max_error_m", "0.003"}});
    std::string bytes;
    for (int frame = 0; frame < 3; ++frame) {
      simulation.set("R_POSE", "yaw", 18.0 * frame);
      simulation.step();
      for (const char* name : kMarvinScanners) {
        const Scan& scan = simulation.scan(name);
        bytes.append(reinterpret_cast<const char*>(scan.range_m.data()), scan.range_m.size() * sizeof(float));
        bytes.append(reinterpret_cast<const char*>(scan.error_bound_m.data()), scan.range_m.size() * sizeof(float));
      }
    }
    RunReport report;
    report.sensors = simulation.sensors();
    bytes += to_json(report);
    if (run == 0) first = bytes;
    CHECK(bytes == first);  // measured in the first run, kept for the second
  }
  const auto files = files_below(cache.path());
  CHECK(std::ranges::count_if(files, [](const std::string& file) { return file.starts_with("costs-"); }) == 1);
}

TEST_SUITE_END();
