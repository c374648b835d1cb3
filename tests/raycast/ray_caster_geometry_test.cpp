// Hard geometry for the ray caster: grazing, distant, tiny and huge, mirrored, flattened, degenerate, coincident.
#include <doctest/doctest.h>

#include <cmath>
#include <vector>

#include "tests/support/infinity.h"
#include "tests/support/ray_casting.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("engine/raycast");

using namespace simvis;

namespace {

constexpr double kHalfUnit = 0x1p-24;  // of a float32, relative

}  // namespace

TEST_CASE("grazing a floor 0.1 m below, out to an incidence of 89.9999 degrees") {
  const RayEngine engine = each_engine();
  DrawList list;
  Mesh floor;
  floor.positions = {{-1e6f, -1e6f, 0}, {1e6f, -1e6f, 0}, {1e6f, 1e6f, 0}, {-1e6f, 1e6f, 0}};
  floor.indices = {0, 1, 2, 0, 2, 3};
  add_item(list, floor, glm::dmat4(1.0));
  const double height_m = 0.1;
  for (const double incidence_deg : {0.0, 60.0, 89.0, 89.9, 89.99, 89.999, 89.9999}) {
    for (const double azimuth : {0.0, 0.3, 2.0, 4.5}) {
      const double e = glm::radians(incidence_deg - 90);
      const glm::dvec3 direction = reference::beam_direction(azimuth, e);
      const RayHit hit = engine.cast_one(list, direction, at(0, 0, height_m));
      const double expected = height_m / -direction.z;
      CHECK(std::abs(hit.range_m - expected) <= hit.error_bound_m);
      CHECK(hit.error_bound_m <= 1e-6 * expected);
    }
  }
}

TEST_CASE("offsets from 10^3 to 10^7 m change nothing that a float32 range would show") {
  const RayEngine engine = each_engine();
  std::mt19937 random(4);
  const DrawList home = random_room(7, 60, 24);
  const glm::dmat4 pose = at(0.1, 0.2, 1.2);
  std::vector<glm::dvec3> directions(5000);
  for (glm::dvec3& direction : directions) direction = random_direction(random);
  const std::vector<RayHit> near = engine.cast(home, pose, directions);
  for (const double offset_m : {1e3, 1e5, 1e7}) {
    const glm::dmat4 offset = at(offset_m, -0.7 * offset_m, 0.1 * offset_m);
    DrawList moved = home;
    for (std::size_t t = 1; t < moved.world_from_node.size(); ++t) {
      moved.world_from_node[t] = offset * moved.world_from_node[t];
    }
    const std::vector<RayHit> far = engine.cast(moved, offset * pose, directions);
    std::size_t other = 0;
    for (std::size_t i = 0; i < directions.size(); ++i) {
      // Positions rounded at the offset move edges, and a beam in about 10^4 across them.
      if (far[i].item != near[i].item || far[i].primitive != near[i].primitive) {
        ++other;
        continue;
      }
      CHECK(std::abs(far[i].range_m - near[i].range_m) <= far[i].error_bound_m + near[i].error_bound_m);
    }
    CHECK(other <= directions.size() / 1000);
  }
}

TEST_CASE("a part 1 mm wide seen from 100 km, and one 100 km wide with the sensor on its surface") {
  const RayEngine engine = each_engine();
  DrawList list;
  add_item(list, sphere_mesh(0.0005, 64), at(1e5, 0, 0));
  const RayHit tiny = engine.cast_one(list, {1, 0, 0});
  CHECK(std::abs(tiny.range_m - (1e5 - 0.0005)) <= 1e-3);
  CHECK(engine.cast_one(list, glm::normalize(glm::dvec3(1e5, 0.0006, 0))).range_m == kInfinity);

  DrawList big;
  add_item(big, half_box_mesh({5e4, 5e4, 5e4}), at(5e4 + 0.25, 0, 0));
  const RayHit skin = engine.cast_one(big, {1, 0, 0});
  CHECK(std::abs(skin.range_m - 0.25) <= skin.error_bound_m);
  CHECK(skin.error_bound_m <= kHalfUnit * 0.25);
}

TEST_CASE("scales from 1e-6 to 1e6, mirrored") {
  const RayEngine engine = each_engine();
  for (const double scale : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
    for (const double mirror : {1.0, -1.0}) {
      DrawList list;
      add_item(list, sphere_mesh(1, 48), glm::scale(at(3 * scale, 0, 0), glm::dvec3(scale, mirror * scale, scale)));
      const RayHit hit = engine.cast_one(list, {1, 0, 0});
      CHECK(std::abs(hit.range_m - 2 * scale) <= hit.error_bound_m);
      CHECK(hit.error_bound_m <= kHalfUnit * hit.range_m);
      CHECK(engine.cast_one(list, {-1, 0, 0}).range_m == kInfinity);
    }
  }
}

TEST_CASE("an item flattened to a plane is hit at its place, and one collapsed to a line or point is not hit") {
  const RayEngine engine = each_engine();
  const auto sphere_scaled = [](const glm::dvec3& scale) {
    DrawList list;
    add_item(list, sphere_mesh(1, 48), glm::scale(at(3, 0, 0), scale));
    return list;
  };
  const RayHit flat = engine.cast_one(sphere_scaled({0, 1, 1}), glm::normalize(glm::dvec3(3, 0.5, 0.25)));
  CHECK(std::abs(flat.range_m - std::sqrt(9 + 0.25 + 0.0625)) <= flat.error_bound_m);
  CHECK(engine.cast_one(sphere_scaled({0, 1, 1}), glm::normalize(glm::dvec3(3, 1.1, 0))).range_m == kInfinity);
  CHECK(engine.cast_one(sphere_scaled({1, 0, 1}), {1, 0, 0}).range_m == kInfinity);  // edge-on
  CHECK(engine.cast_one(sphere_scaled({0, 0, 1}), {1, 0, 0}).range_m == kInfinity);
  CHECK(engine.cast_one(sphere_scaled({0, 0, 0}), {1, 0, 0}).range_m == kInfinity);
}

TEST_CASE("degenerate triangles are ignored; slivers are exact") {
  const RayEngine engine = each_engine();
  Mesh mesh;
  mesh.positions = {{2, -1, 0}, {2, 1, 0}, {2, 0, 1e-6f}, {1, 0, 0}, {1, 1, 1}};
  mesh.indices = {3, 3, 3, 3, 4, 4, 3, 4, 3, 0, 1, 2};
  DrawList list;
  add_item(list, mesh, glm::dmat4(1.0));
  add_item(list, half_box_mesh({1, 40, 40}), at(6, 0, 0));
  // In the sliver, 2 m wide and a micrometre high; just above it; through the degenerate ones.
  const RayHit inside = engine.cast_one(list, glm::normalize(glm::dvec3(2, 0.01, 4e-7)));
  CHECK(inside.item == 0);
  CHECK(inside.primitive == 3);
  CHECK(std::abs(inside.range_m - std::hypot(2, 0.01, 4e-7)) <= inside.error_bound_m);
  CHECK(inside.error_bound_m <= kHalfUnit * inside.range_m);
  CHECK(engine.cast_one(list, glm::normalize(glm::dvec3(2, 0.01, 1.1e-6))).item == 1);
  CHECK(engine.cast_one(list, glm::normalize(glm::dvec3(1, 0.5, 0.5))).item == 1);
}

TEST_CASE("the first triangle of the first item is hit among coincident faces") {
  const RayEngine engine = each_engine();
  DrawList list;
  for (int copy = 0; copy < 4; ++copy) add_item(list, sphere_mesh(1, 32), at(3, 0.1, 0.2));
  std::mt19937 random(5);
  std::vector<glm::dvec3> directions;
  for (int ray = 0; ray < 500; ++ray)
    directions.push_back(glm::normalize(glm::dvec3(3, 0.1, 0.2) + 0.5 * random_direction(random)));
  for (const RayHit& hit : engine.cast(list, glm::dmat4(1.0), directions)) {
    REQUIRE(std::isfinite(hit.range_m));
    CHECK(hit.item == 0);
  }
}

TEST_CASE("empty meshes, lines and points are not hit; a list may be empty") {
  const RayEngine engine = each_engine();
  DrawList list;
  CHECK(engine.cast_one(list, {1, 0, 0}) == RayHit{});
  for (const Topology topology : {Topology::lines, Topology::points}) {
    Mesh mesh = half_box_mesh({1, 1, 1});
    mesh.topology = topology;
    add_item(list, mesh, at(3, 0, 0));
  }
  Mesh empty;
  add_item(list, empty, glm::dmat4(1.0));
  CHECK(engine.cast_one(list, {1, 0, 0}) == RayHit{});
  CHECK(engine.cast(list, glm::dmat4(1.0), {}).empty());
}

TEST_SUITE_END();
