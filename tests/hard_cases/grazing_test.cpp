// Surfaces that beams hit at grazing angles.
#include <doctest/doctest.h>

#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>

#include <simvis/pose.h>
#include "tests/hard_cases/hard_case.h"
#include "tests/hard_cases/shapes.h"
#include "tests/support/infinity.h"
#include "tests/support/reference_directions.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("hard_cases");

using namespace simvis;

namespace {

constexpr double kCoarse_px = 512;  // a common resolution in other simulators

const std::uint32_t kGrazingBeams = sanitized() ? 101 : 1001;

glm::dmat4 pose(const glm::dvec3& position_m, double roll_deg, double pitch_deg, double yaw_deg) {
  return matrix_from_degrees(position_m, roll_deg, pitch_deg, yaw_deg);
}

void measure_with_coarse(const HardCase& hard) {
  measure(hard);
  measure_raster(hard, kCoarse_px);
}

}  // namespace

TEST_CASE("the floor from 0.1 m above, out to 100 m") {
  constexpr double kHeight_m = 0.1, kNearest_m = 0.5, kFarthest_m = 100;
  HardCase hard =
      patch_case("floor 0.1 m below, 0.5 to 100 m away, 64 rings", {ground(200)}, pose({0, 0, kHeight_m}, 0, 0, 0));
  hard.scanner.pattern = {.beams = 31,
                          .rings = 64,
                          .min_azimuth_rad = -0.5,
                          .max_azimuth_rad = 0.5,
                          .min_elevation_rad = -std::asin(kHeight_m / kNearest_m),
                          .max_elevation_rad = -std::asin(kHeight_m / kFarthest_m)};
  hard.scanner.range_max_m = 200;
  hard.truth = [](const glm::dvec3& d) { return d.z < 0 ? -kHeight_m / d.z : kInfinity; };
  measure_with_coarse(hard);
}

TEST_CASE("the floor from straight below out to 100 m, by one ring") {
  constexpr double kHeight_m = 0.1, kFarthest_m = 100;
  SUBCASE("that stands upright") {
    HardCase hard = patch_case("floor 0.1 m below, 0.1 to 100 m away, upright ring", {ground(200)},
                               pose({0, 0, kHeight_m}, 90, 0, 0));
    hard.scanner.pattern = {
        .beams = kGrazingBeams, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = -std::asin(kHeight_m / kFarthest_m)};
    hard.scanner.range_max_m = 200;
    measure_with_coarse(hard);
  }
  SUBCASE("that is pitched down: ahead the floor is 5 m away") {
    constexpr double kAhead_m = 5;
    const double sine = kHeight_m / kAhead_m, side = std::acos(kAhead_m / kFarthest_m);
    HardCase hard = patch_case("floor 0.1 m below, 5 to 100 m away, ring pitched by 1.15 degrees", {ground(200)},
                               pose({0, 0, kHeight_m}, 0, std::asin(sine) * 180 / kPi, 0));
    hard.scanner.pattern = {.beams = kGrazingBeams, .min_azimuth_rad = -side, .max_azimuth_rad = side};
    hard.scanner.range_max_m = 200;
    measure_with_coarse(hard);
  }
}

TEST_CASE("a wall beside the scanner and parallel to its first beam") {
  constexpr double kDistance_m = 1, kFarthest_m = 30;
  const Patch wall{{-8, 1, -2}, {64, 0, 0}, {0, 0, 4}};
  SUBCASE("one ring") {
    HardCase hard = patch_case("wall 1 m to the side, 1 to 30 m away", {wall});
    hard.scanner.pattern = {
        .beams = kGrazingBeams, .min_azimuth_rad = std::asin(kDistance_m / kFarthest_m), .max_azimuth_rad = kPi / 2};
    hard.truth = [](const glm::dvec3& d) { return kDistance_m / d.y; };
    measure_with_coarse(hard);
  }
  SUBCASE("16 rings") {
    HardCase hard = patch_case("wall 1 m to the side, 1 to 30 m away, 16 rings", {wall});
    hard.scanner.pattern = {.beams = kGrazingBeams / 10,
                            .rings = 16,
                            .min_azimuth_rad = std::asin(kDistance_m / kFarthest_m),
                            .max_azimuth_rad = kPi / 2,
                            .min_elevation_rad = -0.05,
                            .max_elevation_rad = 0.05};
    hard.truth = [](const glm::dvec3& d) { return kDistance_m / d.y; };
    measure_with_coarse(hard);
  }
}

TEST_CASE("a corridor 2 m wide and 60 m long with a rotated scanner") {
  // Corners at +-1 m, -4 m and 56 m, floor at -0.5 m, ceiling at 2 m.
  const std::vector<Patch> corridor{
      {{-4, 1, -0.5f}, {60, 0, 0}, {0, 0, 2.5f}}, {{-4, -1, -0.5f}, {60, 0, 0}, {0, 0, 2.5f}},
      {{56, -1, -0.5f}, {0, 2, 0}, {0, 0, 2.5f}}, {{-4, -1, -0.5f}, {0, 2, 0}, {0, 0, 2.5f}},
      {{-4, -1, -0.5f}, {60, 0, 0}, {0, 2, 0}},   {{-4, -1, 2}, {60, 0, 0}, {0, 2, 0}}};
  HardCase hard = patch_case("corridor 2 m wide, 60 m long", corridor, pose({0, 0.25, 0}, 0, 0, 7));
  hard.scanner.pattern = {.beams = kGrazingBeams, .min_azimuth_rad = -kPi, .max_azimuth_rad = kPi};
  measure_with_coarse(hard);
}

TEST_CASE("incidences of 89.9, 89.99 and 89.999 degrees") {
  // A wall along x, so close beside the scanner that the hits are about ten metres away. The distance of its vanishing
  // line from the beams is their angle to the wall: 3.6, 0.36 and 0.036 pixels of 4096 across 90 degrees.
  struct Grazing {
    double angle_deg;  // between beam and wall
    float beside_m;
    const char* name;
  };
  constexpr Grazing kCases[] = {{0.1, 0x1p-6f, "incidence around 89.9 degrees, 9 m away"},
                                {0.01, 0x1p-9f, "incidence around 89.99 degrees, 11 m away"},
                                {0.001, 0x1p-12f, "incidence around 89.999 degrees, 14 m away"}};
  for (const Grazing& grazing : kCases) {
    // The scanner is rotated, so that the wall does not run along its axes.
    constexpr double kTurn_deg = 27;
    HardCase hard = patch_case(grazing.name, {{{-4, grazing.beside_m, -4}, {68, 0, 0}, {0, 0, 8}}},
                               pose({0, 0, 0}, 0, 0, -kTurn_deg));
    const double angle = grazing.angle_deg * kPi / 180;
    hard.scanner.pattern = {.beams = kGrazingBeams,
                            .min_azimuth_rad = kTurn_deg * kPi / 180 + 0.8 * angle,
                            .max_azimuth_rad = kTurn_deg * kPi / 180 + 1.25 * angle};
    measure_with_coarse(hard);
  }
}

namespace {

constexpr double kGround_m = 1.5;  // height of the tilted scanners over the ground

/// The largest height of a scan's points above or below the ground on which they lie, in metres. Each point is checked:
/// its error is at most that of its range, which is at most its bound and this share of the range, times the slope of
/// its beam. So no point lies deeper below the ground either.
double farthest_from_ground(const glm::dmat4& world_from_sensor, const Scan& scan, double share_of_range) {
  constexpr double kRounding_m = 1e-12;  // of this function's own numbers, several hundred metres in double
  double farthest_m = 0;
  for (std::size_t index = 0; index < scan.range_m.size(); ++index) {
    const double range = scan.range_m[index];
    const double a = scan.azimuth_rad[index % scan.beams], e = scan.elevation_rad[index / scan.beams];
    const glm::dvec3 direction = glm::dmat3(world_from_sensor) * reference::beam_direction(a, e);
    if (!std::isfinite(range)) continue;
    const double height_m = kGround_m + range * direction.z;
    const double bound_m = std::min<double>(scan.error_bound_m[index], share_of_range * range);
    CHECK(std::abs(height_m) <= bound_m * std::abs(direction.z) + kRounding_m);
    farthest_m = std::max(farthest_m, std::abs(height_m));
  }
  return farthest_m;
}

std::string metres(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2g m", value);
  return text;
}

}  // namespace

TEST_CASE(
    "tilted and rolled scanners over flat ground: a straight line stays straight, and no point is below the ground") {
  const glm::dmat4 world_from_sensor = pose({100, -50, kGround_m}, 4, 3, 30);
  HardCase ring = patch_case("tilted and rolled ring over flat ground", {ground(512)}, world_from_sensor);
  ring.scanner.pattern = {.beams = kGrazingBeams, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = kPi / 2};
  HardCase lidar = ring;
  lidar.name = "tilted and rolled lidar over flat ground";
  lidar.scanner.pattern = {.beams = kGrazingBeams / 5,
                           .rings = 16,
                           .min_azimuth_rad = -kPi,
                           .max_azimuth_rad = kPi,
                           .min_elevation_rad = -0.26,
                           .max_elevation_rad = 0.26};
  for (HardCase& hard : {std::ref(ring), std::ref(lidar)}) {
    const HardResults results = measure(hard);
    // All points of a ring lie in its scan plane for any range. So their distance from the straight line in which this
    // plane cuts the ground is their height over the sine of the angle between the two planes.
    const glm::dvec3 up = glm::dmat3(world_from_sensor)[2];
    const double scale = hard.scanner.pattern.rings == 1 ? std::hypot(up.x, up.y) : 1;
    const auto cell = [&](const Scan& scan, double share) {
      return metres(farthest_from_ground(world_from_sensor, scan, share) / scale);
    };
    add_line(hard.scanner.pattern.rings == 1 ? "  its points' largest distance from a straight line"
                                             : "  its points' largest height above or below the ground",
             {cell(results.nearest.scan, kInfinity), cell(results.planar.scan, kInfinity),
              cell(results.hybrid.scan, kHybridError), cell(results.raycast.scan, kCastError)});
    hard.scanner.resolution_px = kCoarse_px;
    add_line("  the same with 512 pixels across 90 degrees",
             {cell(measure(hard, ScanMethod::nearest).scan, kInfinity),
              cell(measure(hard, ScanMethod::planar).scan, kInfinity), "", ""});
  }
}

TEST_SUITE_END();
