// Edges: silhouettes, shared and unshared borders of triangles, creases, and objects thinner than a pixel.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <random>
#include <sstream>

#include <simvis/pose.h>
#include "tests/hard_cases/hard_case.h"
#include "tests/hard_cases/shapes.h"
#include "tests/support/infinity.h"
#include "tests/support/raster_grid.h"
#include "tests/support/ray_casting.h"
#include "tests/support/reference_directions.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("hard_cases");

using namespace simvis;

namespace {

constexpr double kPlanarPixel_rad = 2 / kPlanarResolution, kRingsPixel_rad = 2 / kRingsResolution;

const std::uint32_t kBeams = sanitized() ? 101 : 401, kRingBeams = sanitized() ? 25 : 50;

glm::dvec3 direction_of(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
          std::sin(elevation_rad)};
}

/// Whether a surface has the reading within a pixel of the beam: a range of its plane in the square of one pixel to
/// each side, or within the bound of the range along the beam. A range between two surfaces satisfies neither.
bool is_of(const Patch& patch, const HardCase& hard, double azimuth_rad, double elevation_rad, double range_m,
           double bound_m, double pixel_rad) {
  const glm::dvec3 origin(hard.world_from_sensor[3]);
  const auto range_at = [&](double across, double up) {
    return plane_range(patch, origin,
                       glm::dmat3(hard.world_from_sensor) *
                           direction_of(azimuth_rad + across * pixel_rad, elevation_rad + up * pixel_rad));
  };
  double low = kInfinity, high = 0;
  for (const double across : {-1.0, 1.0}) {
    for (const double up : {-1.0, 1.0}) {
      low = std::min(low, range_at(across, hard.scanner.pattern.rings > 1 ? up : 0));
      high = std::max(high, range_at(across, hard.scanner.pattern.rings > 1 ? up : 0));
    }
  }
  if (std::isfinite(bound_m)) return std::abs(range_m - range_at(0, 0)) <= bound_m;
  // Within the square a range is below those at its corners by at most the curvature of 1 / cos over half of it, and
  // raster ranges are rounded by less than kRounding. All values are relative; the surfaces here are metres apart.
  constexpr double kRounding = 1e-5;
  const double slack = kRounding + 2 * pixel_rad * pixel_rad;
  return range_m >= low * (1 - slack) && range_m <= high * (1 + slack);
}

std::size_t between_surfaces(const std::vector<Patch>& surfaces, const HardCase& hard, const Scan& scan,
                             double pixel_rad) {
  std::size_t between = 0;
  for (std::uint32_t ring = 0; ring < scan.rings; ++ring) {
    for (std::uint32_t beam = 0; beam < scan.beams; ++beam) {
      const std::size_t index = std::size_t{ring} * scan.beams + beam;
      between += std::ranges::none_of(surfaces, [&](const Patch& patch) {
        return is_of(patch, hard, scan.azimuth_rad[beam], scan.elevation_rad[ring], scan.range_m[index],
                     scan.error_bound_m[index], pixel_rad);
      });
    }
  }
  return between;
}

void check_none_between(const std::vector<Patch>& surfaces, const HardCase& hard, const HardResults& results,
                        double pixel_rad) {
  for (const HardResult* result : {&results.nearest, &results.planar, &results.hybrid, &results.raycast}) {
    CHECK(between_surfaces(surfaces, hard, result->scan, pixel_rad) == 0);
  }
}

/// Readings far from the truth: those of another surface.
std::size_t on_wrong_surface(const HardCase& hard, const Scan& scan) {
  std::size_t wrong = 0;
  for (std::size_t index = 0; index < scan.range_m.size(); ++index) {
    const double truth_m =
        hard.truth(direction_of(scan.azimuth_rad[index % scan.beams], scan.elevation_rad[index / scan.beams]));
    wrong += !(std::abs(scan.range_m[index] - truth_m) <= 0.1 * truth_m);
  }
  return wrong;
}

/// Beams over this number of pixels to each side of a direction.
ScanPattern beams_around(double azimuth_rad, double elevation_rad, double pixels, bool rings) {
  const double reach = pixels * (rings ? kRingsPixel_rad : kPlanarPixel_rad);
  ScanPattern pattern{.beams = kBeams, .min_azimuth_rad = azimuth_rad - reach, .max_azimuth_rad = azimuth_rad + reach};
  if (rings) {
    pattern.beams = pattern.rings = kRingBeams;
    pattern.min_elevation_rad = elevation_rad - reach;
    pattern.max_elevation_rad = elevation_rad + reach;
  }
  return pattern;
}

}  // namespace

TEST_CASE("beams beside a silhouette never lie between the two surfaces") {
  // The border of the slanted plate is at y = 0.5, 4 m ahead, in front of a wall with the opposite slant.
  const std::vector<Patch> surfaces{{{4, 0.5f, -4}, {1, -8, 0}, {0, 0, 8}}, {{12, -16, -16}, {-3, 32, 0}, {0, 0, 32}}};
  const double border_rad = std::atan2(0.5, 4);
  std::vector<HardCase> cases;
  for (const bool rings : {false, true}) {
    // With a roll angle, the border crosses the rows of pixels at an angle.
    for (const double roll_deg : rings ? std::vector<double>{0, 25} : std::vector<double>{0}) {
      HardCase hard =
          patch_case("silhouette", surfaces, matrix_from_degrees({0, 0, 0}, roll_deg, 0, border_rad * 180 / kPi));
      hard.scanner.pattern = beams_around(0, 0, 6, rings);
      cases.push_back(hard);
    }
  }
  const std::vector<HardResults> all = measure_together("beams beside a silhouette, 4 m and 11 m away", cases);
  std::array<std::size_t, 4> wrong{}, in_doubt{};
  std::size_t beams = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    CAPTURE(i);
    check_none_between(surfaces, cases[i], all[i], i == 0 ? kPlanarPixel_rad : kRingsPixel_rad);
    CHECK(all[i].planar.uncertain > 0);
    const std::array<const HardResult*, 4> results{&all[i].nearest, &all[i].planar, &all[i].hybrid, &all[i].raycast};
    for (std::size_t method = 0; method < 4; ++method) {
      wrong[method] += on_wrong_surface(cases[i], results[method]->scan);
      in_doubt[method] += results[method]->uncertain;
    }
    beams += all[i].raycast.scan.range_m.size();
  }
  std::array<std::string, 4> cells;
  for (std::size_t method = 0; method < 4; ++method) {
    cells[method] = std::to_string(wrong[method]) + " (" + std::to_string(in_doubt[method]) + ")";
  }
  add_line("  on the wrong surface (infinite bound), of " + std::to_string(beams), cells);
  CHECK(wrong[2] == 0);
  CHECK(wrong[3] == 0);
}

TEST_CASE("beams beside the border of a plate in front of empty space") {
  const std::vector<Patch> plate{{{4, 0.5f, -4}, {1, -8, 0}, {0, 0, 8}}};
  std::vector<HardCase> cases;
  for (const double roll_deg : {0.0, 25.0}) {
    HardCase hard =
        patch_case("plate", plate, matrix_from_degrees({0, 0, 0}, roll_deg, 0, std::atan2(0.5, 4) * 180 / kPi));
    for (const bool rings : {false, true}) {
      hard.scanner.pattern = beams_around(0, 0, 6, rings);
      cases.push_back(hard);
    }
  }
  for (const HardResults& results : measure_together("beams beside a silhouette before nothing", cases)) {
    CHECK(results.planar.uncertain > 0);
  }
}

TEST_CASE("a wall with varying range across a limit along the ray") {
  // The wall is perpendicular to the scanner at 20 m. A third of the beams hit it within 0.1 mm on either side of a
  // limit.
  constexpr double kWall_m = 20, kLimit_m = kWall_m + 1e-4;
  std::vector<HardCase> cases;
  for (const bool is_min : {true, false}) {
    for (const std::uint32_t rings : {1u, 8u}) {
      HardCase hard = patch_case("wall", {{{kWall_m, -2, -2}, {0, 4, 0}, {0, 0, 4}}});
      hard.scanner.pattern = {.beams = kBeams - 1,
                              .rings = rings,
                              .min_azimuth_rad = -0.01,
                              .max_azimuth_rad = 0.01,
                              .max_elevation_rad = rings > 1 ? 1e-3 : 0.0};
      (is_min ? hard.scanner.range_min_m : hard.scanner.range_max_m) = kLimit_m;
      cases.push_back(hard);
    }
  }
  measure_together("wall 0.1 mm before and beyond range_min and range_max", cases);
}

TEST_CASE("beams exactly on shared edges and vertices of a flat wall's triangles") {
  // Four patches around a vertex straight ahead. A horizontal ring runs along their border from end to end.
  const glm::vec3 middle{4, 0, 0}, left{1, 8, 0}, up{0.5f, 0, 6};
  const std::vector<Patch> wall{{middle, left, up}, {middle, -left, up}, {middle, left, -up}, {middle, -left, -up}};
  std::vector<HardCase> cases;
  for (const double roll_deg : {0.0, 30.0}) {
    for (const std::uint32_t rings : {1u, 21u}) {
      HardCase hard = welded_case("flat wall", wall, matrix_from_degrees({0, 0, 0}, roll_deg, 0, 0));
      const double side = rings > 1 ? 0.01 : 1;  // around the vertex; along the edge
      hard.scanner.pattern = {.beams = rings > 1 ? 21 : kBeams,
                              .rings = rings,
                              .min_azimuth_rad = -side,
                              .max_azimuth_rad = side,
                              .min_elevation_rad = rings > 1 ? -side : 0,
                              .max_elevation_rad = rings > 1 ? side : 0};
      cases.push_back(hard);
    }
  }
  for (const HardResults& results :
       measure_together("beams on shared edges and a shared vertex of a flat wall", cases)) {
    CHECK(results.planar.uncertain == 0);
  }
}

TEST_CASE("beams along and across creases, and at a corner of three planes") {
  const std::vector<Patch> wall_behind{{{16, -64, -64}, {0, 128, 0}, {0, 0, 128}}};
  std::vector<HardCase> cases;
  std::vector<bool> square_to_pixels;  // a crease along rows or columns of pixels: they show where the planes cross
  const auto add = [&](const char* name, std::vector<Patch> surfaces, bool rings, double roll_deg, bool is_crease) {
    surfaces.insert(surfaces.end(), wall_behind.begin(), wall_behind.end());
    HardCase hard = welded_case(name, surfaces, matrix_from_degrees({0, 0, 0}, roll_deg, 0, 0));
    hard.scanner.pattern = beams_around(0, 0, 6, rings);
    cases.push_back(hard);
    square_to_pixels.push_back(is_crease && roll_deg == 0);
  };
  for (const float back : {1.0f, -1.0f}) {  // the edge is nearest, the edge is farthest
    const glm::vec3 edge{4, 0, 0};
    const std::vector<Patch> upright{{edge - glm::vec3{0, 0, 8}, {2 * back, 2, 0}, {0, 0, 16}},
                                     {edge - glm::vec3{0, 0, 8}, {0.5f * back, -2, 0}, {0, 0, 16}}};
    const std::vector<Patch> level{{edge - glm::vec3{0, 8, 0}, {2 * back, 0, 2}, {0, 16, 0}},
                                   {edge - glm::vec3{0, 8, 0}, {0.5f * back, 0, -2}, {0, 16, 0}}};
    const glm::vec3 a{2 * back, 4, -3}, b{1.5f * back, -4, -3.5f}, c{1 * back, 0.5f, 5};
    const std::vector<Patch> corner{{edge, a, b}, {edge, b, c}, {edge, c, a}};
    for (const double roll_deg : {0.0, 20.0}) {
      for (const bool rings : {false, true}) {
        add("upright crease", upright, rings, roll_deg, true);
        add("level crease", level, rings, roll_deg, true);
        add("corner", corner, rings, roll_deg, false);
      }
    }
  }
  const std::vector<HardResults> all =
      measure_together("beams along and across creases, convex and concave, and corners", cases);
  for (std::size_t i = 0; i < all.size(); ++i) {
    CAPTURE(i);
    if (!square_to_pixels[i]) continue;
    // The wall's edges are 181 m long. Rounding may displace the drawn image by this much, so the side of a pixel's
    // centre on which a beam lies is open. If the pixel next to it belongs to the crease, no plane remains. Corners
    // that are snapped before they give depth displace the planes by that much more.
    constexpr double kDisplaced_px = 0.12;
    const double displaced_px = kDisplaced_px + raster_grid().depth_snap_px;
    const Scan& scan = all[i].planar.scan;
    for (std::size_t beam = 0; beam < scan.range_m.size(); ++beam) {
      if (std::isfinite(scan.error_bound_m[beam])) continue;
      const double focal_px = (scan.rings == 1 ? kPlanarResolution : kRingsResolution) / 2;
      const double x_px = focal_px * std::tan(scan.azimuth_rad[beam % scan.beams]);
      const double y_px = focal_px * std::tan(scan.elevation_rad[beam / scan.beams]);
      CHECK(std::min(std::abs(std::abs(x_px) - 1), std::abs(std::abs(y_px) - 1)) <= displaced_px);
    }
  }
}

namespace {

/// One long patch above and two short ones below. The common corner of the lower ones lies on the border of the upper
/// one, which has a vertex there or, at a T-junction, has none. A wall far behind would show through a gap.
struct Junction {
  glm::vec3 left_end{3, -8, 0}, corner{4.125f, 1, 0}, up{0.5f, 0, 6};
  glm::vec3 first{1.125f, 9, 0}, second{0.875f, 7, 0};

  std::vector<Patch> patches(bool shares_vertex) const {
    std::vector<Patch> patches{
        {left_end, first, -up}, {corner, second, -up}, {{12, -64, -64}, {0, 128, 0}, {0, 0, 128}}};
    if (shares_vertex) {
      patches.insert(patches.end(), {{left_end, first, up}, {corner, second, up}});
    } else {
      patches.push_back({left_end, first + second, up});
    }
    return patches;
  }
};

}  // namespace

TEST_CASE("a T-junction: one long edge against two short ones") {
  const std::array<const char*, 2> names{"a T-junction, its corner no vertex of the long edge",
                                         "the same tessellated with a shared vertex"};
  for (const bool shares_vertex : {false, true}) {
    const std::vector<Patch> patches = Junction{}.patches(shares_vertex);
    std::vector<HardCase> cases;
    HardCase level = welded_case("level ring along the border", patches);
    level.scanner.pattern = {.beams = kBeams, .min_azimuth_rad = -0.9, .max_azimuth_rad = 0.9};
    cases.push_back(level);
    // The rasteriser snaps each corner to parts of a pixel at its own place. At a T-junction this leaves gaps, and at
    // some slants the centre of a pixel lies in one. The number of these beams is even, so none is exactly on the
    // border.
    for (const double roll_deg : {29.9, 40.4, 45.3}) {
      HardCase rolled = welded_case("lidar", patches, matrix_from_degrees({0, 0, 0}, roll_deg, 0, 10));
      rolled.scanner.pattern = {.beams = kBeams - 1,
                                .rings = kBeams - 1,
                                .min_azimuth_rad = -0.5,
                                .max_azimuth_rad = 0.5,
                                .min_elevation_rad = -0.4,
                                .max_elevation_rad = 0.4};
      cases.push_back(rolled);
    }
    const auto all = measure_together(names[shares_vertex], cases);
    // No beam is lost where vertices are shared.
    if (shares_vertex) {
      for (const HardResults& results : all) CHECK(results.planar.uncertain == 0);
    }
  }
}

TEST_CASE("beams exactly on the border at a T-junction, from rotated sensors") {
  // Guarantee: where vertices are shared, no beam passes. Otherwise each of two nearly equal edges decides separately
  // on which side a beam lies, so a beam within rounding of both may pass between them. A beam that is farther away, by
  // kBeside_rad, may not: corners are rounded to 1e-15 of their distance, so the edges are no farther apart.
  constexpr double kBeside_rad = 1e-14;
  constexpr std::size_t kPerPose = 1000;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  std::array<std::size_t, 2> passed{}, passed_beside{};
  std::size_t beams = 0;
  for (int turn = 0; turn < 20; ++turn) {
    const glm::dmat4 world_from_sensor = random_pose(random, 0.5);
    const glm::dmat3 sensor_from_world = glm::transpose(glm::dmat3(world_from_sensor));
    std::vector<glm::dvec3> on, beside;
    for (std::size_t i = 0; i < kPerPose; ++i) {
      const Junction junction;
      const glm::dvec3 point =
          glm::dvec3(junction.left_end) + unit(random) * glm::dvec3(junction.first + junction.second);
      const glm::dvec3 direction = glm::normalize(point - glm::dvec3(world_from_sensor[3]));
      on.push_back(glm::normalize(sensor_from_world * direction));
      beside.push_back(
          glm::normalize(sensor_from_world * (direction + glm::dvec3(0, 0, i % 2 ? 1 : -1) * kBeside_rad)));
    }
    beams += kPerPose;
    const RayEngine engine{make_ray_caster(ray_device())};
    for (const bool shares_vertex : {false, true}) {
      DrawList world;
      add_item(world, welded(Junction{}.patches(shares_vertex)), glm::dmat4(1.0));
      const auto passes = [&](const std::vector<glm::dvec3>& directions) {
        // The border is at most 11 m away from the sensor, and the wall behind it is at least 11.5 m ahead in x.
        return static_cast<std::size_t>(std::ranges::count_if(engine.cast(world, world_from_sensor, directions),
                                                              [](const RayHit& hit) { return hit.range_m > 11; }));
      };
      passed[shares_vertex] += passes(on);
      passed_beside[shares_vertex] += passes(beside);
    }
  }
  CHECK(passed[true] == 0);
  CHECK(passed_beside[true] == 0);
  CHECK(passed_beside[false] == 0);
  std::ostringstream outcome;
  outcome << "raycast: " << passed[false] << " pass, with a shared vertex " << passed[true];
  add_line(std::to_string(beams) + " beams exactly on the border at a T-junction", outcome.str());
}

TEST_CASE("a T-junction whose corner is not exactly on the border leaves a slit that beams pass") {
  const Junction junction;
  constexpr float kSlit_m = 0x1p-20f;  // two units in the last place of 4 m: the rounding to float32
  const glm::vec3 down{0, 0, kSlit_m};
  HardCase hard = welded_case("slit of 1 micrometre at a T-junction, 4 m away",
                              {{junction.left_end, junction.first - down, -junction.up},
                               {junction.corner - down, junction.second + down, -junction.up},
                               {junction.left_end, junction.first + junction.second, junction.up},
                               {{12, -64, -64}, {0, 128, 0}, {0, 0, 128}}});
  hard.scanner.pattern = {.beams = 101, .min_azimuth_rad = 0.1, .max_azimuth_rad = 0.4};
  hard.scanner.pattern.min_elevation_rad = hard.scanner.pattern.max_elevation_rad = -kSlit_m / 3 / 4.25;
  hard.narrow = true;
  const HardResults results = measure(hard);
  for (const float range : results.raycast.scan.range_m) CHECK(range > 11);
}

namespace {

constexpr float kPole_m = 8, kWall_m = 12;

/// A flat vertical pole 8 m ahead, with its right border at `right_m`, in front of a slanted wall.
std::vector<Patch> pole_and_wall(double right_m, double width_m) {
  const auto right = static_cast<float>(right_m), width = static_cast<float>(width_m);
  return {{{kPole_m, right, -2}, {0, width, 0}, {0, 0, 4}}, {{kWall_m, -8, -4}, {2, 16, 0}, {0, 0, 8}}};
}

/// The width, at the pole's distance, of a pixel in the middle of a face, where pixels are widest.
double pixel_m(double resolution_px) { return kPole_m * 2 / resolution_px; }

HardCase pole_case(const std::string& name, double right_m, double width_m, double resolution_px) {
  constexpr double kReach_px = 6;
  HardCase hard = patch_case(name, pole_and_wall(right_m, width_m));
  hard.scanner.resolution_px = resolution_px;
  // An odd number of beams that do not divide a pixel into equal parts: none lies on a border of a pole.
  hard.scanner.pattern = {.beams = 143,
                          .min_azimuth_rad = -kReach_px * 2 / resolution_px,
                          .max_azimuth_rad = kReach_px * 2 / resolution_px};
  hard.narrow = width_m < 3 * pixel_m(resolution_px);
  return hard;
}

bool on_pole(double range_m) { return range_m < (kPole_m + kWall_m) / 2; }

}  // namespace

TEST_CASE("a pole thinner than a pixel and one of four pixels") {
  const double pixel = pixel_m(kPlanarResolution);
  HardCase thin =
      pole_case("pole 1 mm thin (a quarter of a pixel), 8 m away", 0.25 * pixel, 0.25 * pixel, kPlanarResolution);
  measure(thin);
  HardCase wide = pole_case("pole 16 mm wide (four pixels), 8 m away", 0.25 * pixel, 4 * pixel, kPlanarResolution);
  measure(wide);
  wide.narrow = true;  // half a pixel of these
  measure_raster(wide, 512);
}

TEST_CASE("the widths from which planar sees a pole and is certain of it") {
  // An object one pixel wide covers the centre of a pixel at every position, so some beam sees it. An object three
  // pixels wide covers three centres, so some beam has enough neighbours to be certain. The bound does not cover
  // thinner objects.
  const int kPlaces = sanitized() ? 4 : 16;
  for (const double resolution_px : {256.0, 512.0, 1024.0, 4096.0}) {
    const double pixel = pixel_m(resolution_px);
    double min_seen_px = kInfinity, min_certain_px = kInfinity;  // by some beam, for every position of the pole
    for (const double width_px : {4.0, 3.0, 2.75, 2.0, 1.0, 0.75, 0.25, 0.0625}) {
      int seen = 0, certain = 0;
      for (int place = 0; place < kPlaces; ++place) {
        const double right_m = (-2 + static_cast<double>(place) / kPlaces) * pixel, width_m = width_px * pixel;
        const HardCase hard = pole_case("pole", right_m, width_m, resolution_px);
        const std::vector<Patch> surfaces = pole_and_wall(right_m, width_m);
        const HardResult planar = measure(hard, ScanMethod::planar), raycast = measure(hard, ScanMethod::raycast);
        CAPTURE(resolution_px);
        CAPTURE(width_px);
        CAPTURE(place);
        CHECK(between_surfaces(surfaces, hard, planar.scan, 2 / resolution_px) == 0);
        if (!hard.narrow) CHECK(planar.violations == 0);
        CHECK(raycast.violations == 0);
        CHECK(raycast.worst_error_rel <= kCastError);
        bool is_seen = false, is_certain = false;
        for (std::size_t beam = 0; beam < planar.scan.range_m.size(); ++beam) {
          const bool on = on_pole(planar.scan.range_m[beam]);
          is_seen = is_seen || on;
          is_certain = is_certain || (on && std::isfinite(planar.scan.error_bound_m[beam]));
        }
        seen += is_seen;
        certain += is_certain;
      }
      if (seen == kPlaces) min_seen_px = width_px;
      if (certain == kPlaces) min_certain_px = width_px;
    }
    CHECK(min_seen_px == 1);
    CHECK(min_certain_px == 3);
    std::ostringstream name, outcome;
    name << "pole 8 m away, " << resolution_px << " pixels across 90 degrees";
    outcome.precision(3);
    outcome << "planar sees it from " << 1000 * min_seen_px * pixel << " mm, is certain from "
            << 1000 * min_certain_px * pixel << " mm; raycast sees any";
    add_line(name.str(), outcome.str());
  }
}

TEST_SUITE_END();
