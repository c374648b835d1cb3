// Rays that ignore hits up to a range: compared with a test of every triangle in double, for both engines, to the bit.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/draw/surface_alpha.h"
#include "engine/raycast/ray_triangle.h"
#include "tests/support/ray_casting.h"

TEST_SUITE_BEGIN("engine/raycast");

namespace simvis {
namespace {

std::shared_ptr<Material> holes(std::mt19937& random) {
  auto texture = std::make_shared<Texture>();
  texture->width = texture->height = 8;
  for (int i = 0; i < 4 * 8 * 8; ++i) texture->rgba.push_back(static_cast<std::uint8_t>(random() % 256));
  auto material = std::make_shared<Material>();
  material->alpha_mode = AlphaMode::mask;
  material->base_color_texture = texture;
  return material;
}

// A room divided by masked curtains.
DrawList room_with_curtains(std::uint32_t seed) {
  std::mt19937 random(seed);
  DrawList list = random_room(seed, 24, 12);
  list.materials.push_back(holes(random));
  list.material_revision.push_back(0);
  for (int i = 0; i < 6; ++i) {
    Mesh mesh;
    mesh.positions = {{0, 2, 2}, {0, -2, 2}, {0, -2, -2}, {0, 2, -2}};
    mesh.indices = {0, 1, 2, 0, 2, 3};
    mesh.attributes.resize(4);
    const glm::vec2 uvs[] = {{0, 0}, {3, 0}, {3, 3}, {0, 3}};
    for (std::size_t k = 0; k < 4; ++k) mesh.attributes[k].uv[0] = uvs[k];
    add_item(list, mesh, at(0, 0, 1.2) * random_pose(random, 3));
    list.items.back().material = 1;
  }
  return list;
}

// The ranges of all triangles that the ray hits where they are solid, ascending.
std::vector<double> all_ranges(const DrawList& list, const glm::dmat4& pose, const glm::dvec3& direction) {
  std::vector<double> ranges;
  const ShearedRay ray(direction);
  for (const DrawItem& item : list.items) {
    const Mesh& mesh = *list.meshes[item.mesh];
    const MeshPlacement placement = place_mesh(list.world_from_node[item.transform], pose);
    for (std::uint32_t t = 0; t < mesh.indices.size() / 3; ++t) {
      TriangleHit hit;
      if (!intersect(ray, place_corners(mesh, t, placement), hit)) continue;
      const double area = hit.weights.x + hit.weights.y + hit.weights.z;
      if (is_solid(*list.materials[item.material], mesh, t, hit.weights / area)) ranges.push_back(hit.range_m);
    }
  }
  std::ranges::sort(ranges);
  return ranges;
}

}  // namespace

TEST_CASE("hits at or before the given range are ignored, and the next one is reported, to the bit") {
  const RayEngine engine = each_engine();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> metres(0, 8);
  for (std::uint32_t seed = 0; seed < 4; ++seed) {
    const DrawList list = room_with_curtains(seed);
    const glm::dmat4 offset = seed % 2 == 0 ? glm::dmat4(1.0) : at(2e5, -3e4, 10);
    DrawList moved = list;
    for (std::size_t t = 1; t < moved.world_from_node.size(); ++t) {
      moved.world_from_node[t] = offset * moved.world_from_node[t];
    }
    const glm::dmat4 pose = offset * at(0, 0, 1.2) * random_pose(random, 0.3);
    std::vector<glm::dvec3> directions;
    std::vector<double> t_min_m, expected_m;
    for (int i = 0; i < 160; ++i) {
      const glm::dvec3 direction = random_direction(random);
      const std::vector<double> ranges = all_ranges(moved, pose, direction);
      REQUIRE(!ranges.empty());  // the room is closed
      // Nothing, anywhere, and the first, second and last hit: to the bit, and one step before.
      std::vector<double> starts{0, metres(random), ranges.front(), ranges.back(), std::nextafter(ranges.front(), 0.0)};
      if (ranges.size() > 1) starts.push_back(ranges[1]);
      for (const double start : starts) {
        const auto next = std::ranges::upper_bound(ranges, start);
        directions.push_back(direction);
        t_min_m.push_back(start);
        expected_m.push_back(next == ranges.end() ? std::numeric_limits<double>::infinity() : *next);
      }
    }
    std::vector<RayHit> hits(directions.size()), plain(directions.size()), from_zero(directions.size());
    engine.caster->set_world(moved);
    engine.caster->cast(pose, directions, hits, t_min_m);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < hits.size(); ++i) wrong += hits[i].range_m != expected_m[i];
    CHECK(wrong == 0);
    // Without, and with nothing to pass, it is one.
    engine.caster->cast(pose, directions, plain);
    engine.caster->cast(pose, directions, from_zero, std::vector<double>(directions.size(), 0.0));
    CHECK(plain == from_zero);
  }
}

TEST_CASE("the engines agree to the bit on hits beyond the range") {
  const RayEngine host = host_engine(), device = device_engine();
  std::mt19937 random(6);
  std::uniform_real_distribution<double> metres(0, 8);
  for (std::uint32_t seed = 10; seed < 14; ++seed) {
    const DrawList list = room_with_curtains(seed);
    const glm::dmat4 pose = at(0, 0, 1.2);
    std::vector<glm::dvec3> directions;
    for (int i = 0; i < 2000; ++i) directions.push_back(random_direction(random));
    std::vector<double> t_min_m(directions.size());
    for (double& start : t_min_m) start = metres(random);
    std::vector<RayHit> by_host(directions.size()), by_device(directions.size());
    // Through all surfaces, one after the other.
    for (int surface = 0; surface < 6; ++surface) {
      host.caster->set_world(list);
      host.caster->cast(pose, directions, by_host, t_min_m);
      device.caster->set_world(list);
      device.caster->cast(pose, directions, by_device, t_min_m);
      CHECK(by_host == by_device);
      for (std::size_t i = 0; i < directions.size(); ++i) {
        if (std::isfinite(by_host[i].range_m)) t_min_m[i] = by_host[i].range_m;
      }
    }
  }
  // The shader skips ignored hits, so few rays are left to the host.
  CHECK(device.caster->counters().rays_walked * 20 < device.caster->counters().rays);
}

}  // namespace simvis

TEST_SUITE_END();
