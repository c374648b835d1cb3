// Items that rays pass because a sensor ignores them: as if they were not visible in the list.
#include <doctest/doctest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/support/ray_casting.h"

TEST_SUITE_BEGIN("engine/raycast");

namespace simvis {
namespace {

std::vector<std::uint32_t> some_items(const DrawList& list, std::mt19937& random) {
  std::vector<std::uint32_t> items;
  for (std::uint32_t i = 0; i < list.items.size(); ++i) {
    if (random() % 3 == 0) items.push_back(i);
  }
  return items;
}

std::vector<RayHit> cast_ignoring(const RayEngine& engine, const std::vector<std::uint32_t>& ignored,
                                  const glm::dmat4& pose, const std::vector<glm::dvec3>& directions) {
  std::vector<RayHit> hits(directions.size());
  engine.caster->ignore(ignored);
  engine.caster->cast(pose, directions, hits);
  return hits;
}

}  // namespace

TEST_CASE("rays pass ignored items as if these were not visible, one set after the other") {
  const RayEngine engine = each_engine(), without = host_engine();
  std::mt19937 random(7);
  constexpr std::size_t kRays = 2000;
  std::size_t other = 0, hit_before = 0;
  for (int room = 0; room < 5; ++room) {
    const auto [list, pose] = room_of_hard_cases(room, random);
    const std::vector<glm::dvec3> directions = directions_into(list, pose, kRays, random);
    engine.caster->set_world(list);
    const std::vector<RayHit> all = cast_ignoring(engine, {}, pose, directions);
    for (int set = 0; set < 3; ++set) {
      const std::vector<std::uint32_t> ignored = some_items(list, random);
      DrawList seen = list;
      for (const std::uint32_t item : ignored) seen.items[item].visible = false;
      const std::vector<RayHit> expected = without.cast(seen, pose, directions),
                                hits = cast_ignoring(engine, ignored, pose, directions);
      for (std::size_t i = 0; i < hits.size(); ++i) {
        other += !(hits[i] == expected[i]);
        hit_before += !(hits[i] == all[i]);
      }
    }
    const std::vector<RayHit> again = cast_ignoring(engine, {}, pose, directions);
    CHECK(again == all);
  }
  CHECK(other == 0);
  CHECK(hit_before > kRays);  // of 15 casts
}

TEST_CASE("what rays ignore costs no tree, and is forgotten with the world") {
  const RayEngine engine = each_engine();
  std::mt19937 random(8);
  const auto [list, pose] = room_of_hard_cases(1, random);
  const std::vector<glm::dvec3> directions = directions_into(list, pose, 200, random);
  engine.caster->set_world(list);
  const std::vector<RayHit> all = cast_ignoring(engine, {}, pose, directions);
  const RayCounters before = engine.caster->counters();
  for (int i = 0; i < 4; ++i)
    cast_ignoring(engine, i % 2 == 0 ? some_items(list, random) : std::vector<std::uint32_t>(), pose, directions);
  const RayCounters after = engine.caster->counters();
  CHECK(after.item_trees_built == before.item_trees_built);
  CHECK(after.item_trees_refitted == before.item_trees_refitted);
  CHECK(after.items_placed == before.items_placed);
  CHECK(after.meshes_built == before.meshes_built);
  cast_ignoring(engine, some_items(list, random), pose, directions);
  CHECK(engine.cast(list, pose, directions) == all);
}

}  // namespace simvis

TEST_SUITE_END();
