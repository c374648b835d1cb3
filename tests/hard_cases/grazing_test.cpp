// Surfaces that beams meet at the flattest angles.
#include <doctest/doctest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>

#include "tests/hard_cases/hard_case.h"
#include "tests/random_room.h"

using namespace simvis;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// A square of 2 x `half_m` metres across z at z = 0.
Mesh floor_mesh(float half_m) {
  Mesh mesh;
  mesh.positions = {{-half_m, -half_m, 0}, {half_m, -half_m, 0}, {half_m, half_m, 0}, {-half_m, half_m, 0}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

}  // namespace

TEST_CASE("the floor from 0.1 m above, out to 100 m") {
  constexpr double kHeight_m = 0.1, kNearest_m = 0.5, kFarthest_m = 100;
  HardCase hard{.name = "floor 0.1 m below, 0.5 to 100 m away"};
  add_item(hard.world, floor_mesh(200), glm::dmat4(1.0));
  hard.world_from_sensor = glm::translate(glm::dmat4(1.0), {0, 0, kHeight_m});
  hard.scanner.pattern = {.samples = 31,
                          .rings = 64,
                          .min_azimuth_rad = -0.5,
                          .max_azimuth_rad = 0.5,
                          .min_elevation_rad = -std::asin(kHeight_m / kNearest_m),
                          .max_elevation_rad = -std::asin(kHeight_m / kFarthest_m)};
  hard.scanner.range_max_m = 200;
  hard.truth = [](const glm::dvec3& d) { return d.z < 0 ? -kHeight_m / d.z : kInfinity; };
  measure(hard);
}
