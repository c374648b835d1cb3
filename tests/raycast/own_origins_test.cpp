// Packets whose rays have origins of their own: which rays they take, and hits that are those of a sensor at each
// origin, to the bit.
#include <doctest/doctest.h>

#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include <simvis/ray_caster.h>
#include "engine/base/thread_pool.h"
#include "engine/raycast/item_tree.h"
#include "engine/raycast/packet_cast.h"
#include "engine/raycast/packet_finish.h"
#include "tests/support/ray_casting.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("engine/raycast");

namespace simvis {
namespace {

struct OwnRays {
  std::vector<glm::dvec3> origins_m{}, directions{};
};

// Bundles of neighbours: directions within 0.1 of one that may point to a corner or an edge, origins within `spread_m`.
OwnRays bundles(const DrawList& list, const glm::dmat4& pose, std::size_t count, double spread_m,
                std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto vector = [&] { return glm::dvec3(unit(random), unit(random), unit(random)); };
  OwnRays rays;
  for (const glm::dvec3& middle : directions_into(list, pose, count / RayPacket::kMax, random)) {
    const glm::dvec3 place_m = 0.3 * vector();
    for (unsigned i = 0; i < RayPacket::kMax; ++i) {
      rays.origins_m.push_back(place_m + spread_m * vector());
      // A ray to a point that the middle one may have been aimed at.
      rays.directions.push_back(i % 4 == 0 ? glm::normalize(middle - rays.origins_m.back() / 3.0)
                                           : glm::normalize(middle + 0.1 * vector()));
    }
  }
  return rays;
}

// Rays from places within `spread_m` along each axis. Half of them point to corners, edges or inner points of
// triangles; each group of a full packet has one side.
OwnRays scattered(const DrawList& list, const glm::dmat4& pose, std::size_t count, double spread_m,
                  std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  OwnRays rays;
  while (rays.directions.size() < count) {
    const glm::dvec3 origin_m = spread_m * glm::dvec3(unit(random), unit(random), unit(random));
    for (const glm::dvec3& direction : directions_into(list, glm::translate(pose, origin_m), 2, random)) {
      const std::size_t side = rays.directions.size() / RayPacket::kMax % RayPacket::kSides;
      if (RayPacket::side_of(direction) != side || rays.directions.size() == count) continue;
      rays.origins_m.push_back(origin_m);
      rays.directions.push_back(direction);
    }
  }
  return rays;
}

std::vector<RayHit> one_by_one(const DrawList& list, const glm::dmat4& pose, const OwnRays& rays) {
  const std::unique_ptr<RayCaster> caster = make_host_ray_caster();
  caster->set_world(list);
  std::vector<RayHit> hits(rays.directions.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    caster->cast(glm::translate(pose, rays.origins_m[i]), std::span(rays.directions).subspan(i, 1),
                 std::span(hits).subspan(i, 1));
  }
  return hits;
}

std::size_t differences(const std::vector<RayHit>& a, const std::vector<RayHit>& b) {
  REQUIRE(a.size() == b.size());
  std::size_t other = 0;
  for (std::size_t i = 0; i < a.size(); ++i) other += !(a[i] == b[i]);
  return other;
}

// The hits of packets, with bundles whose rays go through meshes one by one below `min_rays_per_leaf`.
std::vector<RayHit> in_packets(const DrawList& list, const glm::dmat4& pose, const OwnRays& rays,
                               double min_rays_per_leaf, RayPacket::Kind kind = RayPacket::Kind::bundle) {
  RayInstances items({}, shared_thread_pool(1));
  ItemTree tree;
  RayView view;
  items.update(list, {}, glm::dvec3(pose[3]));
  tree.update(items);
  view.begin(list, items, pose);
  view.min_rays_per_leaf = min_rays_per_leaf;
  const glm::dmat3 turn = glm::transpose(glm::dmat3(pose));
  std::vector<RayOrigin> origins;
  for (const glm::dvec3& origin_m : rays.origins_m) {
    const glm::dvec3 world_m(glm::translate(pose, origin_m)[3]);
    origins.push_back({world_m, turn * (world_m - glm::dvec3(pose[3])), glm::length(world_m)});
  }
  std::vector<RayHit> hits(rays.directions.size());
  for (std::size_t first = 0; first < hits.size();) {
    RayPacket packet(std::span(rays.directions).subspan(first), {}, std::span(origins).subspan(first), kind);
    if (kind == RayPacket::Kind::scattered) CHECK(packet.count == RayPacket::kMax);
    traverse_from_origins(view, tree.tree(), packet);
    finish_packet(view, packet, hits.data() + first);
    first += packet.count;
  }
  return hits;
}

TEST_CASE("a packet takes rays that start near its first one") {
  const std::vector<glm::dvec3> directions(RayPacket::kMax, glm::dvec3(1, 0, 0));
  std::vector<RayOrigin> origins(RayPacket::kMax);
  for (unsigned i = 0; i < origins.size(); ++i) origins[i].sensor_m = {7, i % 2 == 0 ? 0.02 : -0.02, 0};
  const RayPacket all(directions, {}, origins);
  CHECK(all.count == RayPacket::kMax);
  CHECK(all.apex_m == glm::dvec3(7, 0.02, 0));
  CHECK(all.spread_m == doctest::Approx(0.04));
  origins[13].sensor_m.z = RayPacket::kMaxSpread_m;
  CHECK(RayPacket(directions, {}, origins).count == 13);
}

TEST_CASE("rays of one packet that start at places of their own have the hits of sensors there, to the bit") {
  const std::size_t rays_of_room = sanitized() ? 320 : 3200;
  std::size_t hits = 0;
  for (int room = 0; room < 20; ++room) {
    CAPTURE(room);
    std::mt19937 random(static_cast<unsigned>(room));
    const RoomWithSensor world = room_of_hard_cases(room, random);
    // From origins at one point to origins that no packet can have together.
    const double spread_m = std::vector{0.0, 1e-6, 1e-3, 0.01, 0.2}[static_cast<std::size_t>(room) % 5];
    const OwnRays rays = bundles(world.list, world.world_from_sensor, rays_of_room, spread_m, random);
    const std::vector<RayHit> expected = one_by_one(world.list, world.world_from_sensor, rays);
    for (const RayHit& hit : expected) hits += std::isfinite(hit.range_m);
    for (const double min_rays_per_leaf : {0.0, std::numeric_limits<double>::infinity()}) {
      CAPTURE(min_rays_per_leaf);
      CHECK(differences(in_packets(world.list, world.world_from_sensor, rays, min_rays_per_leaf), expected) == 0);
    }
    const std::unique_ptr<RayCaster> caster = make_host_ray_caster();
    caster->set_world(world.list);
    std::vector<RayHit> cast(rays.directions.size());
    caster->cast_from(world.world_from_sensor, rays.origins_m, rays.directions, cast);
    CHECK(differences(cast, expected) == 0);
  }
  CHECK(hits > 20 * rays_of_room / 2);
}

TEST_CASE("scattered rays have the hits of sensors at their origins, to the bit") {
  const std::size_t rays_of_room = RayPacket::kMax * std::size_t{sanitized() ? 12U : 120U};
  std::size_t hits = 0;
  for (int room = 0; room < 20; ++room) {
    CAPTURE(room);
    std::mt19937 random(static_cast<unsigned>(room));
    const RoomWithSensor world = room_of_hard_cases(room, random);
    const double spread_m = std::vector{0.0, 0.01, 1.0, 3.0, 100.0}[static_cast<std::size_t>(room) % 5];
    const OwnRays rays = scattered(world.list, world.world_from_sensor, rays_of_room, spread_m, random);
    const std::vector<RayHit> expected = one_by_one(world.list, world.world_from_sensor, rays);
    for (const RayHit& hit : expected) hits += std::isfinite(hit.range_m);
    CHECK(differences(in_packets(world.list, world.world_from_sensor, rays, RayView::kMinRaysPerLeaf,
                                 RayPacket::Kind::scattered),
                      expected) == 0);
    const std::unique_ptr<RayCaster> caster = make_host_ray_caster();
    caster->set_world(world.list);
    std::vector<RayHit> cast(rays.directions.size());
    caster->cast_from(world.world_from_sensor, rays.origins_m, rays.directions, cast);
    CHECK(differences(cast, expected) == 0);
  }
  CHECK(hits > 20 * rays_of_room / 4);
}

TEST_CASE("a cast bundles neighbours, and gathers scattered rays of one side in packets") {
  const DrawList list = random_room(3, 5, 16);
  constexpr unsigned kRays = 10 * RayPacket::kMax;
  const auto counters = [&](double spread_m) {
    const std::unique_ptr<RayCaster> caster = make_host_ray_caster();
    caster->set_world(list);
    OwnRays rays;
    for (unsigned i = 0; i < kRays; ++i) {
      rays.origins_m.emplace_back(i % 2 == 0 ? spread_m : -spread_m, 0, 0);
      rays.directions.emplace_back(1, 0, 0);
    }
    std::vector<RayHit> hits(kRays);
    caster->cast_from(at(0, 0, 1.2), rays.origins_m, rays.directions, hits);
    return caster->counters();
  };
  const RayCounters near = counters(0.01), apart = counters(0.5);
  CHECK(near.single_rays == 0);
  CHECK(apart.single_rays >= kRays);
  CHECK(apart.item_tests < kRays);  // packets of one ray each would test at least one item
}

TEST_CASE("rays from places of their own into exact shapes have the hits of sensors there, to the bit") {
  std::mt19937 random(5);
  DrawList list = random_room(3, 5, 16);
  const SurfaceKind kinds[] = {SurfaceKind::sphere, SurfaceKind::cylinder, SurfaceKind::plane};
  for (int i = 0; i < 12; ++i) {
    Mesh mesh = closed_sphere_mesh(0.5, 16);
    mesh.surface = ExactSurface{.kind = kinds[i % 3], .axis = i % 2, .radius_m = 0.5, .length_m = 0.5};
    add_item(list, std::move(mesh), at(0, 0, 1.2) * random_pose(random, 2));
  }
  const glm::dmat4 pose = at(0, 0, 1.2) * random_pose(random, 0.5);
  const OwnRays rays = bundles(list, pose, 3200, 0.01, random);
  const std::vector<RayHit> expected = one_by_one(list, pose, rays);
  std::size_t of_shapes = 0;
  for (const RayHit& hit : expected) {
    of_shapes += std::isfinite(hit.range_m) && list.meshes[list.items[hit.item].mesh]->surface.has_value();
  }
  CHECK(of_shapes > 500);
  CHECK(differences(in_packets(list, pose, rays, RayView::kMinRaysPerLeaf), expected) == 0);
  const OwnRays apart = scattered(list, pose, 3200, 2, random);
  CHECK(differences(in_packets(list, pose, apart, RayView::kMinRaysPerLeaf, RayPacket::Kind::scattered),
                    one_by_one(list, pose, apart)) == 0);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
