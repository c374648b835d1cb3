// Rays from many places equal those of a sensor there, to the bit.
#include <doctest/doctest.h>

#include "tests/support/ray_casting.h"

TEST_SUITE_BEGIN("sensors");

namespace simvis {
namespace {

TEST_CASE("rays from many places have the same hits as those of a sensor there, to the bit") {
  const RayEngine engine = each_engine();
  std::mt19937 random(21);
  for (int room = 0; room < 4; ++room) {
    const DrawList list = random_room(static_cast<std::uint32_t>(room), 20, 16);
    const glm::dmat4 pose = at(0, 0, 1.2) * random_pose(random, 0.3);
    std::uniform_real_distribution<double> unit(-1, 1);
    std::vector<glm::dvec3> origins, directions;
    for (int place = 0; place < 200; ++place) {
      // One of them is so far away that the tree over items needs another origin.
      const glm::dvec3 origin =
          place == 50 ? glm::dvec3(5e3, 0, 0) : glm::dvec3(unit(random), unit(random), 0.5 * unit(random));
      for (int ray = 0; ray <= place % 11; ++ray) {
        origins.push_back(origin);
        directions.push_back(random_direction(random));
      }
    }
    std::vector<RayHit> hits(directions.size());
    engine.caster->set_world(list);
    const std::uint64_t before = engine.caster->counters().rays;
    engine.caster->cast_from(pose, origins, directions, hits);
    CHECK(engine.caster->counters().rays == before + directions.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
      REQUIRE(hits[i] == engine.cast_one(list, directions[i], glm::translate(pose, origins[i])));
    }
    engine.caster->cast_from(pose, {}, {}, {});
  }
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
