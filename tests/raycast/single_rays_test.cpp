// Rays that go through meshes one by one have the hits of packets, bit for bit; and which of the two ways is chosen.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>
#include <span>
#include <vector>

#include <simvis/ray_caster.h>
#include "engine/base/thread_pool.h"
#include "engine/raycast/item_tree.h"
#include "engine/raycast/packet_cast.h"
#include "engine/raycast/packet_finish.h"
#include "scenegraph/primitive_meshes.h"
#include "tests/support/ray_casting.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("engine/raycast");

namespace simvis {
namespace {

constexpr double kNeverSingly = 0, kAlwaysSingly = std::numeric_limits<double>::infinity();  // min_rays_per_leaf
const std::size_t kRaysOfRoom = sanitized() ? 250 : 4000;

/// The hits of packets in a world.
class PacketWorld {
 public:
  PacketWorld(const DrawList& list, const glm::dmat4& world_from_sensor, HitSides sides) {
    items_.update(list, {}, glm::dvec3(world_from_sensor[3]));
    tree_.update(items_);
    view_.begin(list, items_, world_from_sensor, sides);
  }

  std::vector<RayHit> cast(const std::vector<glm::dvec3>& directions, const std::vector<double>& t_min_m,
                           double min_rays_per_leaf) {
    std::vector<RayHit> hits(directions.size());
    view_.min_rays_per_leaf = min_rays_per_leaf;
    for (std::size_t first = 0; first < directions.size();) {
      const std::span<const glm::dvec3> left = std::span(directions).subspan(first);
      RayPacket packet(left, part_of(t_min_m, first, left.size()));
      traverse_packet(view_, tree_.tree(), packet);
      finish_packet(view_, packet, hits.data() + first);
      first += packet.count;
    }
    return hits;
  }

  std::uint64_t single_rays() const { return view_.single_rays; }
  std::uint64_t finished_singly() const { return view_.finished_singly; }

 private:
  RayInstances items_{{}, shared_thread_pool(1)};
  ItemTree tree_;
  RayView view_;
};

/// Casts both ways and returns the number of rays that went through meshes one by one.
std::uint64_t compare_ways(const DrawList& list, const glm::dmat4& pose, const std::vector<glm::dvec3>& directions,
                           const std::vector<double>& t_min_m = {}, HitSides sides = HitSides::both) {
  PacketWorld world(list, pose, sides);
  const std::vector<RayHit> expected = world.cast(directions, t_min_m, kNeverSingly);
  CHECK(world.single_rays() == 0);
  const std::vector<RayHit> hits = world.cast(directions, t_min_m, kAlwaysSingly);
  std::size_t other = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) other += !(hits[i] == expected[i]);
  CHECK(other == 0);
  return world.single_rays();
}

/// Directions of neighbours form packets.
void sort_by_azimuth(std::vector<glm::dvec3>& directions) {
  std::ranges::sort(directions, {}, [](const glm::dvec3& d) { return std::atan2(d.y, d.x); });
}

std::vector<glm::dvec3> planar_scan(int beams, double width_rad) {
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < beams; ++i) {
    const double azimuth = width_rad * (i / (beams - 1.0) - 0.5);
    directions.emplace_back(std::cos(azimuth), std::sin(azimuth), 0);
  }
  return directions;
}

TEST_CASE("single rays and packets agree in rooms with leaves and with mirrored, stretched and flattened items") {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> unit(0, 1);
  std::uint64_t single = 0;
  for (int room = 0; room < 20; ++room) {
    const auto [list, pose] = room_of_hard_cases(room, random);
    std::vector<glm::dvec3> directions = directions_into(list, pose, kRaysOfRoom, random);
    if (room % 2 == 0) sort_by_azimuth(directions);
    std::vector<double> t_min_m;
    for (std::size_t i = 0; i < directions.size() && room % 3 == 0; ++i)
      t_min_m.push_back(i % 2 == 0 ? 0 : unit(random));
    single += compare_ways(list, pose, directions, t_min_m, room % 5 == 0 ? HitSides::front : HitSides::both);
  }
  CHECK(single > 20 * kRaysOfRoom);
}

TEST_CASE("single rays and packets agree on a room's corners, edges and equal surfaces, seen along its axes") {
  DrawList list;
  add_item(list, half_box_mesh({4, 3, 2}), at(0, 0, 0));
  add_item(list, half_box_mesh({1, 3, 2}), at(3, 0, 0));  // with four faces in planes of the first one
  for (int copy = 0; copy < 2; ++copy) add_item(list, closed_sphere_mesh(0.5, 32), at(1, 1, 0));
  Mesh slivers;
  slivers.positions = {{1, -1, 0}, {1, 1, 0}, {1, 1, 1e-7f}, {0.5f, 0, 0}, {0.9f, 0, 0}, {0.7f, 0, 0}};
  slivers.indices = {0, 1, 2, 3, 4, 5, 3, 3, 3, 0, 2, 1};
  add_item(list, slivers, at(0, 0, 0));
  std::vector<glm::dvec3> directions;
  for (int x = -4; x <= 4; ++x) {
    for (int y = -3; y <= 3; ++y) {
      for (int z = -2; z <= 2; ++z) {
        if (x != 0 || y != 0 || z != 0) directions.push_back(glm::normalize(glm::dvec3(x, y, z)));
      }
    }
  }
  for (const double height_m : {0.0, 2.0, -2.0, 1e-9}) CHECK(compare_ways(list, at(0, 0, height_m), directions) > 0);
  std::mt19937 random(22);
  CHECK(compare_ways(list, glm::dmat4(1.0), directions_into(list, glm::dmat4(1.0), kRaysOfRoom, random)) > 0);
}

TEST_CASE("single rays and packets agree on parts far away and parts of any size") {
  std::mt19937 random(23);
  for (const double distance_m : {1e3, 1e6, 1e9, 1e17}) {
    for (const double size_m : {1e-3, 1.0, 1e3, 1e8}) {
      CAPTURE(distance_m);
      CAPTURE(size_m);
      DrawList list;
      add_item(list, sphere_mesh(1, 32), glm::scale(at(distance_m, 0.2 * distance_m, 0), glm::dvec3(size_m)));
      compare_ways(list, glm::dmat4(1.0), directions_into(list, glm::dmat4(1.0), kRaysOfRoom / 4, random));
    }
  }
}

TEST_CASE("rays go through a mesh one by one where they lie farther apart than its triangles") {
  // A planar scan of 0.5 degrees from a beam to the next meets a sphere of 1 m at 3 m; its leaves are about as large as
  // two of its triangles. With 16 segments these are 0.4 m wide, with 512 segments 12 mm; the beams are 26 mm apart.
  const auto single_rays = [](int segments, int beams) {
    DrawList list;
    add_item(list, sphere_mesh(1, segments), at(3, 0, 0));
    const RayEngine host = host_engine();
    host.cast(list, glm::dmat4(1.0), planar_scan(beams, std::numbers::pi / 6));
    return host.caster->counters().single_rays;
  };
  CHECK(single_rays(16, 61) == 0);
  CHECK(single_rays(512, 61) > 20);
  CHECK(single_rays(512, 6001) == 0);
}

// The beams of a planar scan sweep over a wall with a ball before it: two batches at the outline hold rays of both
// kinds, with at most three rays on the wall each.
TEST_CASE("a visible shape slows down only the batches of rays that meet it") {
  DrawList list;
  add_item(list, half_box_mesh({5, 5, 5}), at(0, 0, 0));
  add_item(list, cylinder_mesh(0.3, 1), at(3, 0, 0));
  PacketWorld world(list, glm::dmat4(1.0), HitSides::both);
  const std::vector<RayHit> hits = world.cast(planar_scan(1001, std::numbers::pi / 2), {}, RayView::kMinRaysPerLeaf);
  const auto on_shape = std::ranges::count_if(hits, [](const RayHit& hit) { return hit.item == 1; });
  CHECK(on_shape > 100);
  CHECK(on_shape < 200);
  CHECK(world.finished_singly() <= 2 * (RayPacket::kLanes - 1));
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
