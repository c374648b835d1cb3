// Boxes whose sizes are no floats: their faces are where the sizes say, within the bound of a ray in double.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <simvis/ray_caster.h>
#include "scenegraph/primitive_meshes.h"
#include "tests/support/ray_casting.h"

TEST_SUITE_BEGIN("engine/raycast");

using namespace simvis;

namespace {

using Exact3 = glm::vec<3, long double>;
using Exact4x4 = glm::mat<4, 4, long double>;

// From inside of the box around the origin of `world_from_box`, to its face along a ray from the origin of the world.
long double range_to_box(const glm::dvec3& size_m, const glm::dmat4& world_from_box, const glm::dvec3& direction) {
  const Exact4x4 box_from_world = glm::inverse(Exact4x4(world_from_box));
  const Exact3 from(box_from_world[3]), way = glm::mat<3, 3, long double>(box_from_world) * Exact3(direction);
  long double range_m = std::numeric_limits<long double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const long double face_m = std::copysign(static_cast<long double>(size_m[i]) / 2, way[i]);
    range_m = std::min(range_m, (face_m - from[i]) / way[i]);
  }
  return range_m;
}

}  // namespace

TEST_CASE("rays meet the faces of boxes of decimal sizes within their bounds") {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  const RayEngine engine{make_host_ray_caster({}, 1)};
  double largest_share = 0;
  for (const glm::dvec3& size_m : {glm::dvec3(0.2, 4, 2), glm::dvec3(0.7, 0.3, 0.1), glm::dvec3(1e-3, 3e-3, 1e3)}) {
    for (int turn = 0; turn < 20; ++turn) {
      glm::dmat4 place = random_pose(random, 0);
      place[3] = place * glm::dvec4(0.45 * unit(random) * size_m.x, 0.45 * unit(random) * size_m.y,
                                    0.45 * unit(random) * size_m.z, 1);
      DrawList list;
      add_item(list, box_mesh(size_m), place * exact_box_scale(size_m));
      std::vector<glm::dvec3> directions;
      for (int i = 0; i < 50; ++i) directions.push_back(random_direction(random));
      const std::vector<RayHit> hits = engine.cast(list, glm::dmat4(1), directions);
      for (std::size_t i = 0; i < hits.size(); ++i) {
        const auto error_m = static_cast<double>(
            std::abs(static_cast<long double>(hits[i].range_m) - range_to_box(size_m, place, directions[i])));
        largest_share = std::max(largest_share, error_m / hits[i].error_bound_m);
      }
    }
  }
  CHECK(largest_share <= 1);
}
