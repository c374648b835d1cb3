// Surfaces that beams meet at the flattest angles.
#include <doctest/doctest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>

#include "scenegraph/pose.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/hard_cases/shapes.h"

using namespace simvis;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPi = std::numbers::pi;
constexpr double kCoarse_px = 512;  // what other simulators commonly take

#ifdef __SANITIZE_ADDRESS__
constexpr std::uint32_t kBeams = 101;
#else
constexpr std::uint32_t kBeams = 1001;
#endif

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
  hard.scanner.pattern = {.samples = 31,
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
        .samples = kBeams, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = -std::asin(kHeight_m / kFarthest_m)};
    hard.scanner.range_max_m = 200;
    measure_with_coarse(hard);
  }
  SUBCASE("that is pitched down: ahead the floor is 5 m away") {
    constexpr double kAhead_m = 5;
    const double sine = kHeight_m / kAhead_m, side = std::acos(kAhead_m / kFarthest_m);
    HardCase hard = patch_case("floor 0.1 m below, 5 to 100 m away, ring pitched by 1.15 degrees", {ground(200)},
                               pose({0, 0, kHeight_m}, 0, std::asin(sine) * 180 / kPi, 0));
    hard.scanner.pattern = {.samples = kBeams, .min_azimuth_rad = -side, .max_azimuth_rad = side};
    hard.scanner.range_max_m = 200;
    measure_with_coarse(hard);
  }
}

TEST_CASE("a wall beside the scanner, parallel to its first beam") {
  constexpr double kDistance_m = 1, kFarthest_m = 30;
  const Patch wall{{-8, 1, -2}, {64, 0, 0}, {0, 0, 4}};
  SUBCASE("one ring") {
    HardCase hard = patch_case("wall 1 m to the side, 1 to 30 m away", {wall});
    hard.scanner.pattern = {
        .samples = kBeams, .min_azimuth_rad = std::asin(kDistance_m / kFarthest_m), .max_azimuth_rad = kPi / 2};
    hard.truth = [](const glm::dvec3& d) { return kDistance_m / d.y; };
    measure_with_coarse(hard);
  }
  SUBCASE("16 rings") {
    HardCase hard = patch_case("wall 1 m to the side, 1 to 30 m away, 16 rings", {wall});
    hard.scanner.pattern = {.samples = kBeams / 10,
                            .rings = 16,
                            .min_azimuth_rad = std::asin(kDistance_m / kFarthest_m),
                            .max_azimuth_rad = kPi / 2,
                            .min_elevation_rad = -0.05,
                            .max_elevation_rad = 0.05};
    hard.truth = [](const glm::dvec3& d) { return kDistance_m / d.y; };
    measure_with_coarse(hard);
  }
}

TEST_CASE("a corridor 2 m wide and 60 m long, the scanner turned in it") {
  // Corners at +-1 m, -4 m and 56 m, floor at -0.5 m, ceiling at 2 m.
  const std::vector<Patch> corridor{
      {{-4, 1, -0.5f}, {60, 0, 0}, {0, 0, 2.5f}}, {{-4, -1, -0.5f}, {60, 0, 0}, {0, 0, 2.5f}},
      {{56, -1, -0.5f}, {0, 2, 0}, {0, 0, 2.5f}}, {{-4, -1, -0.5f}, {0, 2, 0}, {0, 0, 2.5f}},
      {{-4, -1, -0.5f}, {60, 0, 0}, {0, 2, 0}},   {{-4, -1, 2}, {60, 0, 0}, {0, 2, 0}}};
  HardCase hard = patch_case("corridor 2 m wide, 60 m long", corridor, pose({0, 0.25, 0}, 0, 0, 7));
  hard.scanner.pattern = {.samples = kBeams, .min_azimuth_rad = -kPi, .max_azimuth_rad = kPi};
  measure_with_coarse(hard);
}

TEST_CASE("incidences of 89.9, 89.99 and 89.999 degrees") {
  // A wall along x, so close beside the scanner that the hits lie some ten metres away. Its vanishing line lies as far
  // from the beams as their angle to the wall: 3.6, 0.36 and 0.036 pixels of 4096 across 90 degrees.
  struct Grazing {
    double angle_deg;  // between beam and wall
    float beside_m;
    const char* name;
  };
  constexpr Grazing kCases[] = {{0.1, 0x1p-6f, "incidence around 89.9 degrees, 9 m away"},
                                {0.01, 0x1p-9f, "incidence around 89.99 degrees, 11 m away"},
                                {0.001, 0x1p-12f, "incidence around 89.999 degrees, 14 m away"}};
  for (const Grazing& grazing : kCases) {
    // The scanner is turned, so that the wall does not run along its axes.
    constexpr double kTurn_deg = 27;
    HardCase hard = patch_case(grazing.name, {{{-4, grazing.beside_m, -4}, {68, 0, 0}, {0, 0, 8}}},
                               pose({0, 0, 0}, 0, 0, -kTurn_deg));
    const double angle = grazing.angle_deg * kPi / 180;
    hard.scanner.pattern = {.samples = kBeams,
                            .min_azimuth_rad = kTurn_deg * kPi / 180 + 0.8 * angle,
                            .max_azimuth_rad = kTurn_deg * kPi / 180 + 1.25 * angle};
    measure_with_coarse(hard);
  }
}

TEST_CASE("a tilted and rolled scanner over flat ground: a straight line stays straight, nothing goes below") {
  constexpr double kHeight_m = 1.5;
  const glm::dmat4 world_from_sensor = pose({100, -50, kHeight_m}, 4, 3, 30);
  HardCase hard = patch_case("tilted and rolled ring over flat ground", {ground(512)}, world_from_sensor);
  hard.scanner.pattern = {.samples = kBeams, .min_azimuth_rad = -kPi / 2, .max_azimuth_rad = kPi / 2};
  const HardResults results = measure(hard);
  measure_raster(hard, kCoarse_px);

  // The scan plane cuts the ground in a line. A point that a beam reports lies in the scan plane; its distance from the
  // line is its height over the ground over the sine of the planes' angle, and its height is the error of its range
  // times the beam's slope.
  const glm::dmat3 turn(world_from_sensor);
  const double sine = std::hypot(turn[2].x, turn[2].y);
  const auto farthest_from_line = [&](const HardResult& result, double share_of_range) {
    double farthest_m = 0;
    for (std::uint32_t beam = 0; beam < result.scan.columns; ++beam) {
      const double range = result.scan.range_m[beam], a = result.scan.azimuth_rad[beam];
      if (!std::isfinite(range)) continue;
      const glm::dvec3 direction = turn * glm::dvec3(std::cos(a), std::sin(a), 0);
      const double height_m = kHeight_m + range * direction.z;
      // The bound of a range is a bound of how far its point lies above or below; kRounding is double's, of this test.
      constexpr double kRounding_m = 1e-12;
      const double allowed_m = std::min<double>(result.scan.error_bound_m[beam], share_of_range * range) * -direction.z;
      REQUIRE(direction.z < 0);
      CHECK(height_m >= -allowed_m - kRounding_m);
      CHECK(height_m <= allowed_m + kRounding_m);
      farthest_m = std::max(farthest_m, std::abs(height_m) / sine);
    }
    return farthest_m;
  };
  const auto metres = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.2g m", value);
    return std::string(text);
  };
  hard.scanner.resolution_px = kCoarse_px;
  add_line(
      "  its points' largest distance from the straight line",
      {metres(farthest_from_line(results.nearest, kInfinity)), metres(farthest_from_line(results.planar, kInfinity)),
       metres(farthest_from_line(results.hybrid, kHybridError)),
       metres(farthest_from_line(results.raycast, kCastError))});
  add_line("  the same with 512 pixels across 90 degrees",
           {metres(farthest_from_line(measure(hard, ScanMethod::nearest), kInfinity)),
            metres(farthest_from_line(measure(hard, ScanMethod::planar), kInfinity)), "", ""});
}
