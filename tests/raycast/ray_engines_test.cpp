// The two engines of the ray caster agree to the bit. Features of the device engine only: candidate overflow and
// uploads.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <vector>

#include <simvis/simulation.h>
#include "engine/draw/canonical_order.h"
#include "shaders/interop.h"
#include "tests/support/ray_casting.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("engine/raycast");

using namespace simvis;

namespace {

const std::size_t kFewerRays = sanitized() ? 16 : 1;

void compare(const RayEngine& host, const RayEngine& device, const DrawList& list, const glm::dmat4& pose,
             const std::vector<glm::dvec3>& directions) {
  const std::vector<RayHit> expected = host.cast(list, pose, directions), hits = device.cast(list, pose, directions);
  std::size_t other = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) other += !(hits[i] == expected[i]);
  CHECK(other == 0);
}

/// Hits of rays from the origin, found by casting into each item alone: the nearest hit, or the first of equal ones.
std::vector<RayHit> nearest_of_each(const DrawList& list, const std::vector<glm::dvec3>& directions) {
  const RayEngine device = device_engine();
  std::vector<RayHit> nearest(directions.size());
  for (std::uint32_t item = 0; item < list.items.size(); ++item) {
    DrawList alone = list;
    alone.items = {list.items[item]};
    const std::vector<RayHit> hits = device.cast(alone, glm::dmat4(1.0), directions);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      if (hits[i].range_m >= nearest[i].range_m) continue;
      nearest[i] = hits[i];
      nearest[i].item = item;
    }
  }
  return nearest;
}

}  // namespace

TEST_CASE("random rooms with leaves and with mirrored, stretched and flattened items, up to 10^7 m away") {
  const RayEngine host = host_engine(), device = device_engine();
  std::mt19937 random(1);
  std::size_t rays = 0;
  for (int room = 0; room < 20; ++room) {
    const auto [list, pose] = room_of_hard_cases(room, random);
    const std::vector<glm::dvec3> directions = directions_into(list, pose, 10000 / kFewerRays, random);
    compare(host, device, list, pose, directions);
    rays += directions.size();
  }
  const RayCounters counters = device.caster->counters();
  MESSAGE(rays << " rays, " << counters.rays_walked << " of them walked by the host");
  CHECK(counters.dispatches == 20);
  CHECK(counters.rays_walked < rays / 2);  // flattened items are
}

TEST_CASE("the marvin laboratory from the robot and from a distance") {
  const RayEngine host = host_engine(), device = device_engine();
  Simulation simulation = Simulation::load(std::filesystem::path(SIMVIS_SOURCE_DIR) / "scenes/marvin/marvin.xml");
  std::mt19937 random(2);
  for (int turn = 0; turn < 4; ++turn) {
    simulation.set("R_POSE", "yaw", 77.0 * turn);
    simulation.step();
    glm::dmat4 pose(1.0);
    REQUIRE(simulation.sensor_pose("FRONT_SCANNER", pose));
    if (turn == 3) pose = at(300, 200, 100) * pose;
    compare(host, device, simulation.diagnostics().draw_list(), pose,
            directions_into(simulation.diagnostics().draw_list(), pose, 10000 / kFewerRays, random));
  }
  CHECK(device.caster->counters().rays_walked * 100 < device.caster->counters().rays);
}

TEST_CASE("more candidates than a ray can hold: leaves behind leaves, many surfaces at one place") {
  const RayEngine device = device_engine();
  std::mt19937 random(3);
  DrawList list;
  add_item(list, half_box_mesh({1, 40, 40}), at(50, 0, 0));
  list.materials.push_back(leaves(random));
  list.material_revision.push_back(0);
  constexpr int kCurtains = 4 * SIMVIS_MAX_CANDIDATES;
  for (int i = 0; i < kCurtains; ++i) {
    // Unordered, every fourth at the place of another.
    add_item(list, leaf_mesh(), at(2 + 0.1 * ((i - i % 4 / 3) * 11 % kCurtains), 0, 0));
    list.items.back().material = 1;
  }
  for (int i = 0; i < 3 * SIMVIS_MAX_CANDIDATES; ++i) add_item(list, sphere_mesh(0.5, 16), at(1, 3, 0));
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < 2000; ++i) {
    const double y = 0.4 * std::cos(0.7 * i), z = 0.4 * std::sin(0.013 * i);
    directions.push_back(glm::normalize(i % 2 == 0 ? glm::dvec3(1, y, z) : glm::dvec3(1, 3 + 0.5 * y, 0.5 * z)));
  }
  const std::vector<RayHit> hits = device.cast(list, glm::dmat4(1.0), directions);
  for (std::size_t i = 0; i < directions.size(); i += kFewerRays) {
    CHECK(std::isfinite(hits[i].range_m));
    if (i % 2 == 1) CHECK(hits[i].item == kCurtains + 1);
  }
  CHECK(hits == nearest_of_each(list, directions));
  CHECK(device.caster->counters().rays_walked > 100);
}

TEST_CASE("among faces in one plane the same item is hit in any order of traversal or declaration") {
  // The face of the second item lies in the plane of the first one's, and its box is entered first because of a corner
  // far from all rays. The third item is a thousand times as large and rotated about the axis through the plane. All
  // corners across that axis have one depth, which is then the range to the bit.
  DrawList list;
  add_item(list, half_box_mesh({1, 1, 1}), at(3, 0, 0));
  Mesh face;
  face.positions = {{0, -3, 0}, {0, 3, -4}, {0, 3, 4}, {-1.5f, 30, 0}};
  face.indices = {0, 1, 2, 1, 2, 3};
  add_item(list, face, at(2, 0, 0));
  add_item(list, half_box_mesh({1000, 1000, 1000}), glm::rotate(at(1002, 0, 0), 0.3, {1, 0, 0}));
  std::mt19937 random(9);
  std::uniform_real_distribution<double> unit(-0.9, 0.9);
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < 3000; ++i) directions.push_back(glm::normalize(glm::dvec3(2, unit(random), unit(random))));
  const std::vector<RayHit> hits = device_engine().cast(list, glm::dmat4(1.0), directions);
  const std::uint32_t first = canonical_compare(list, list.items[0], list.items[1]) < 0 ? 0 : 1;
  for (const RayHit& hit : hits) CHECK(hit.item == first);
  std::swap(list.items[0], list.items[1]);
  const std::vector<RayHit> swapped = device_engine().cast(list, glm::dmat4(1.0), directions);
  for (std::size_t i = 0; i < hits.size(); ++i) {
    CHECK(swapped[i].item == 1 - first);
    CHECK(swapped[i].range_m == hits[i].range_m);
  }
}

TEST_CASE("both engines let rays pass parts faded below one half, and no part has to move for that") {
  const RayEngine engine = each_engine();
  DrawList list;
  add_item(list, half_box_mesh({1, 40, 40}), at(6, 0, 0));
  add_item(list, half_box_mesh({1, 1, 1}), at(3, 0, 0));
  list.items[1].material = 1;
  list.materials.resize(2);
  list.material_revision.push_back(0);
  const auto range_with = [&](float opacity, AlphaMode mode, float alpha) {
    Material material;
    material.opacity = opacity;
    material.alpha_mode = mode;
    material.base_color.a = alpha;
    list.materials[1] = std::make_shared<Material>(material);
    return engine.cast_one(list, {1, 0, 0}).range_m;
  };
  CHECK(range_with(1, AlphaMode::opaque, 1) == 2);
  CHECK(range_with(0.49f, AlphaMode::opaque, 1) == 5);
  CHECK(range_with(0.5f, AlphaMode::opaque, 1) == 2);
  CHECK(range_with(0.49f, AlphaMode::mask, 1) == 5);
  CHECK(range_with(0.75f, AlphaMode::blend, 0.6f) == 5);
  CHECK(range_with(0.75f, AlphaMode::blend, 0.7f) == 2);
}

TEST_CASE("one moved part of 1,000 costs its block and the nodes above it, and nothing else is uploaded") {
  DrawList list;
  add_item(list, closed_sphere_mesh(0.1, 32), at(0, 0, 0));
  for (int i = 1; i < 1000; ++i) {
    list.items.push_back({0, 0, static_cast<std::uint32_t>(list.world_from_node.size())});
    list.world_from_node.push_back(at(0.3 * (i % 100), 0.3 * (i / 100), 0));
  }
  const RayEngine device = device_engine();
  CHECK(device.caster->counters() == RayCounters{});
  const auto cost_of = [&](const auto& change) {
    const RayCounters before = device.caster->counters();
    change();
    device.cast_one(list, {0, 0, -1}, at(3, 0.3, 1));
    RayCounters cost = device.caster->counters();
    CHECK(cost.dispatches == before.dispatches + 1);
    cost.meshes_built -= before.meshes_built;
    cost.item_trees_built -= before.item_trees_built;
    cost.item_trees_refitted -= before.item_trees_refitted;
    cost.bytes_uploaded -= before.bytes_uploaded;
    return cost;
  };
  const std::uint64_t block = sizeof(shader::GpuRayInstance), node = sizeof(shader::TreeNode);
  const RayCounters first = cost_of([] {});
  CHECK(first.meshes_built == 1);
  CHECK(first.bytes_uploaded > list.meshes[0]->indices.size() / 3 * sizeof(shader::RayTriangle));
  CHECK(cost_of([] {}).bytes_uploaded == 0);
  const RayCounters moved = cost_of([&] { list.world_from_node[list.items[500].transform] = at(0.1, 1.5, 0.3); });
  CHECK(moved.meshes_built == 0);
  CHECK(moved.item_trees_built == 0);
  CHECK(moved.item_trees_refitted == 1);
  CHECK(moved.bytes_uploaded >= block + node);
  CHECK(moved.bytes_uploaded <= block + node * SIMVIS_TREE_DEPTH);
  // All parts, far from the place for which the tree was built: it is rebuilt, with 2 * 1000 - 1 nodes.
  const RayCounters mixed = cost_of([&] {
    for (std::size_t i = 0; i < 1000; ++i) {
      const double place = static_cast<double>(i * 389 % 1000);
      list.world_from_node[list.items[i].transform] = at(0.3 * std::fmod(place, 10), 0.3 * std::floor(place / 10), 0);
    }
  });
  CHECK(mixed.meshes_built == 0);
  CHECK(mixed.item_trees_built == 1);
  CHECK(mixed.bytes_uploaded == 1000 * block + 1999 * node);
}

TEST_CASE("an item without a finite place is not hit and hides nothing") {
  const RayEngine engine = each_engine();
  DrawList list;
  for (const double nowhere : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    add_item(list, sphere_mesh(1, 16), at(nowhere, 0, 0));
    add_item(list, sphere_mesh(1, 16), glm::scale(at(3, 0, 0), glm::dvec3(1, nowhere, 1)));
  }
  add_item(list, half_box_mesh({1, 1, 1}), at(3, 0, 0));
  const RayHit hit = engine.cast_one(list, {1, 0, 0});
  CHECK(hit.range_m == 2);
  CHECK(hit.item == 4);
}

TEST_CASE("items that are hidden, shown again and get other meshes, by a list with a change log") {
  const RayEngine engine = each_engine();
  std::mt19937 random(6);
  DrawList list = random_room(5, 60, 16);
  list.changes.mark_structure_dirty();
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < 2000; ++i) directions.push_back(random_direction(random));
  const glm::dmat4 pose = at(0, 0, 1.2);
  engine.cast(list, pose, directions);
  const RayCounters first = engine.caster->counters();
  for (int frame = 0; frame < 12; ++frame) {
    CAPTURE(frame);
    for (int change = 0; change < 20; ++change) {
      const auto item = static_cast<std::uint32_t>(random() % list.items.size());
      list.items[item].visible = !list.items[item].visible;
      list.changes.mark_item_dirty(item);
    }
    const std::uint32_t mesh = list.items[static_cast<std::size_t>(frame)].mesh;
    Mesh larger = *list.meshes[mesh];
    for (glm::vec3& position : larger.positions) position *= 1.05f;
    compute_bounds(larger);
    list.meshes[mesh] = std::make_shared<const Mesh>(std::move(larger));
    for (std::uint32_t item = 0; item < list.items.size(); ++item) {
      if (list.items[item].mesh == mesh) list.changes.mark_item_dirty(item);
    }
    const std::vector<RayHit> hits = engine.cast(list, pose, directions);
    CHECK(hits == host_engine().cast(DrawList(list), pose, directions));
    CHECK(std::ranges::none_of(
        hits, [&](const RayHit& hit) { return std::isfinite(hit.range_m) && !list.items[hit.item].visible; }));
  }
  const RayCounters counters = engine.caster->counters();
  CHECK(counters.item_trees_built == first.item_trees_built);
  CHECK(counters.meshes_built == first.meshes_built + 12);
}

TEST_CASE("meshes are added and removed, as in animation") {
  const RayEngine device = device_engine();
  std::mt19937 random(4);
  DrawList list = random_room(3, 12, 32);
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < 500; ++i) directions.push_back(random_direction(random));
  const std::vector<RayHit> expected = device.cast(list, at(0, 0, 1.2), directions);
  for (int frame = 0; frame < 40; ++frame) {
    auto& mesh = list.meshes[static_cast<std::size_t>(frame) % list.meshes.size()];
    mesh = std::make_shared<Mesh>(*mesh);
    REQUIRE(device.cast(list, at(0, 0, 1.2), directions) == expected);
  }
  CHECK(device.cast(DrawList{}, glm::dmat4(1.0), directions) == std::vector<RayHit>(directions.size()));
  CHECK(device.cast(list, at(0, 0, 1.2), directions) == expected);
}

TEST_CASE("the engine is the host if the device runs on the same cores, otherwise the device") {
  CHECK(make_ray_caster(ray_device())->engine() == (ray_device().is_cpu() ? "the host" : "a compute shader"));
  CHECK(device_engine().caster->engine() == "a compute shader");
}

TEST_SUITE_END();
