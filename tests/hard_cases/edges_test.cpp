// Edges: silhouettes, borders that triangles share or do not, creases, and what is thinner than a pixel.
#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <random>
#include <sstream>

#include "scenegraph/pose.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/hard_cases/shapes.h"
#include "tests/ray_casting.h"

using namespace simvis;

namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kPlanarPixel_rad = 2 / kPlanarResolution, kRingsPixel_rad = 2 / kRingsResolution;

#ifdef __SANITIZE_ADDRESS__
constexpr std::uint32_t kBeams = 41;
#else
constexpr std::uint32_t kBeams = 401;
#endif

glm::dvec3 direction_of(double azimuth_rad, double elevation_rad) {
  return {std::cos(elevation_rad) * std::cos(azimuth_rad), std::cos(elevation_rad) * std::sin(azimuth_rad),
          std::sin(elevation_rad)};
}

/// Whether a reading is one that a surface gives within a pixel of the beam: the plane's range somewhere in the square
/// of a pixel to each side, or within the bound of what it gives along the beam. Anything between two surfaces is
/// neither.
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
  constexpr double kRounding = 1e-5;  // of raster ranges, relative; the surfaces here are metres apart
  return range_m >= low * (1 - kRounding) && range_m <= high * (1 + kRounding);
}

std::size_t between_surfaces(const std::vector<Patch>& surfaces, const HardCase& hard, const Scan& scan,
                             double pixel_rad) {
  std::size_t between = 0;
  for (std::uint32_t ring = 0; ring < scan.rings; ++ring) {
    for (std::uint32_t beam = 0; beam < scan.columns; ++beam) {
      const std::size_t index = std::size_t{ring} * scan.columns + beam;
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

/// Beams over this many pixels to each side of a direction.
ScanPattern beams_around(double azimuth_rad, double elevation_rad, double pixels, bool rings) {
  const double reach = pixels * (rings ? kRingsPixel_rad : kPlanarPixel_rad);
  ScanPattern pattern{
      .samples = kBeams, .min_azimuth_rad = azimuth_rad - reach, .max_azimuth_rad = azimuth_rad + reach};
  if (rings) {
    pattern.samples = pattern.rings = kBeams / 8;
    pattern.min_elevation_rad = elevation_rad - reach;
    pattern.max_elevation_rad = elevation_rad + reach;
  }
  return pattern;
}

}  // namespace

TEST_CASE("beams beside a silhouette never lie between the two surfaces") {
  // The border of the slanted plate stands at y = 0.5, 4 m ahead, before a wall slanted the other way.
  const std::vector<Patch> surfaces{{{4, 0.5f, -4}, {1, -8, 0}, {0, 0, 8}}, {{12, -16, -16}, {-3, 32, 0}, {0, 0, 32}}};
  const double border_rad = std::atan2(0.5, 4);
  std::vector<HardCase> cases;
  for (const bool rings : {false, true}) {
    // Rolled, the border crosses the rows of pixels at an angle.
    for (const double roll_deg : rings ? std::vector<double>{0, 25} : std::vector<double>{0}) {
      HardCase hard =
          patch_case("silhouette", surfaces, matrix_from_degrees({0, 0, 0}, roll_deg, 0, border_rad * 180 / kPi));
      hard.scanner.pattern = beams_around(0, 0, 6, rings);
      cases.push_back(hard);
    }
  }
  const std::vector<HardResults> all = measure_together("beams beside a silhouette, 4 m and 11 m away", cases);
  for (std::size_t i = 0; i < all.size(); ++i) {
    CAPTURE(i);
    check_none_between(surfaces, cases[i], all[i], i == 0 ? kPlanarPixel_rad : kRingsPixel_rad);
    CHECK(all[i].planar.uncertain > 0);
  }
}

TEST_CASE("beams exactly on edges and vertices that triangles of one flat wall share") {
  // Four patches around a vertex straight ahead; a level ring runs along their border from end to end.
  const glm::vec3 middle{4, 0, 0}, left{1, 8, 0}, up{0.5f, 0, 6};
  const std::vector<Patch> wall{{middle, left, up}, {middle, -left, up}, {middle, left, -up}, {middle, -left, -up}};
  std::vector<HardCase> cases;
  for (const double roll_deg : {0.0, 30.0}) {
    for (const std::uint32_t rings : {1u, 21u}) {
      HardCase hard = welded_case("flat wall", wall, matrix_from_degrees({0, 0, 0}, roll_deg, 0, 0));
      const double side = rings > 1 ? 0.01 : 1;  // around the vertex; along the edge
      hard.scanner.pattern = {.samples = rings > 1 ? 21 : kBeams,
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
  const auto add = [&](const char* name, std::vector<Patch> surfaces, bool rings, double roll_deg) {
    surfaces.insert(surfaces.end(), wall_behind.begin(), wall_behind.end());
    HardCase hard = welded_case(name, surfaces, matrix_from_degrees({0, 0, 0}, roll_deg, 0, 0));
    hard.scanner.pattern = beams_around(0, 0, 6, rings);
    cases.push_back(hard);
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
        add("upright crease", upright, rings, roll_deg);
        add("level crease", level, rings, roll_deg);
        add("corner", corner, rings, roll_deg);
      }
    }
  }
  measure_together("beams along and across creases, convex and concave, and corners", cases);
}

namespace {

/// One long patch above, two short ones below: the lower ones' common corner lies on the border of the upper one, which
/// has a vertex there or, at a T-junction, has none. Far behind is a wall, which a gap would show.
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
    level.scanner.pattern = {.samples = kBeams, .min_azimuth_rad = -0.9, .max_azimuth_rad = 0.9};
    cases.push_back(level);
    // The rasteriser rounds corners to parts of a pixel, each where it lies: at a T-junction it leaves gaps, at some
    // slants a pixel's centre lies in one. No beam of these (their number is even) is exactly on the border.
    for (const double roll_deg : {29.9, 40.4, 45.3}) {
      HardCase rolled = welded_case("lidar", patches, matrix_from_degrees({0, 0, 0}, roll_deg, 0, 10));
      rolled.scanner.pattern = {.samples = kBeams - 1,
                                .rings = kBeams - 1,
                                .min_azimuth_rad = -0.5,
                                .max_azimuth_rad = 0.5,
                                .min_elevation_rad = -0.4,
                                .max_elevation_rad = 0.4};
      cases.push_back(rolled);
    }
    const auto all = measure_together(names[shares_vertex], cases);
    for (const auto& r : all)
      MESSAGE(r.nearest.worst_error_rel << " " << r.planar.worst_error_rel << " " << r.planar.uncertain << " "
                                        << r.planar.violations);
    // Nothing is lost where vertices are shared.
    if (shares_vertex) {
      for (const HardResults& results : all) CHECK(results.planar.uncertain == 0);
    }
  }
}

TEST_CASE("beams exactly on the border at a T-junction, from turned sensors") {
  // What is promised: where vertices are shared, nothing passes. Without, which side of two nearly equal edges a beam
  // is on is decided for each edge by itself, so that a beam within rounding of both may pass between them; one that is
  // farther beside, by kBeside_rad, may not: corners are rounded to 1e-15 of their distance, so edges lie no farther
  // apart.
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
    for (const bool shares_vertex : {false, true}) {
      DrawList world;
      add_item(world, welded(Junction{}.patches(shares_vertex)), glm::dmat4(1.0));
      const auto passes = [&](const std::vector<glm::dvec3>& directions) {
        // The border is at most 11 m away from the sensor, the wall behind at least 11.5 m ahead in x.
        return static_cast<std::size_t>(std::ranges::count_if(cast(world, world_from_sensor, directions),
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
