// The ray caster compared with a test of every triangle and with a second ray cast in double, in closed meshes and
// through holes, and its cost.
#include <simvis/ray_caster.h>

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/raycast/ray_triangle.h"
#include "tests/support/infinity.h"
#include "tests/support/ray_casting.h"
#include "tests/support/reference_raycast.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("engine/raycast");

using namespace simvis;

namespace {

constexpr double kHalfUlp = 0x1p-24;  // of a float32, relative

// Brute force is about twenty times slower under sanitizers.
const int kFewer = sanitized() ? 16 : 1;

/// The hit of a ray, found by testing every triangle.
RayHit brute_force(const DrawList& list, const glm::dmat4& world_from_sensor, const glm::dvec3& direction) {
  const ShearedRay ray(direction);
  RayHit nearest;
  for (std::uint32_t i = 0; i < list.items.size(); ++i) {
    const Mesh& mesh = *list.meshes[list.items[i].mesh];
    const MeshPlacement placement = place_mesh(list.world_from_node[list.items[i].transform], world_from_sensor);
    for (std::uint32_t t = 0; t < mesh.indices.size() / 3; ++t) {
      TriangleHit hit;
      if (!intersect(ray, place_corners(mesh, t, placement), hit) || hit.range_m >= nearest.range_m) continue;
      nearest.range_m = hit.range_m;
      nearest.item = i;
      nearest.primitive = t;
    }
  }
  return nearest;
}

bool same(const RayHit& a, const RayHit& b) {
  return a.range_m == b.range_m && a.item == b.item && a.primitive == b.primitive;
}

/// A square of 2 x 2 m perpendicular to x. Its uv goes from (0, 0) at (y, z) = (1, 1) to (1, 1) at (-1, -1).
Mesh square() {
  Mesh mesh;
  mesh.positions = {{0, 1, 1}, {0, -1, 1}, {0, -1, -1}, {0, 1, -1}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.attributes.resize(4);
  const glm::vec2 uvs[] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  for (std::size_t i = 0; i < 4; ++i) mesh.attributes[i].uv[0] = uvs[i];
  return mesh;
}

/// A square with its own material 2 m ahead and a wall 5 m ahead.
DrawList curtain(const Material& material, const Mesh& mesh = square()) {
  DrawList list;
  add_item(list, half_box_mesh({1, 40, 40}), at(6, 0, 0));
  add_item(list, half_box_mesh({1, 1, 1}), at(2, 0, 0));
  auto shown = std::make_shared<Mesh>(mesh);
  compute_bounds(*shown);
  list.meshes[1] = shown;
  list.materials.push_back(std::make_shared<Material>(material));
  list.material_revision.push_back(0);
  list.items[1].material = 1;
  return list;
}

/// Direction to the point of the curtain with these texture coordinates.
glm::dvec3 towards(double u, double v) { return glm::normalize(glm::dvec3(2, 1 - 2 * u, 1 - 2 * v)); }

}  // namespace

TEST_CASE("each ray has the hit that a test of every triangle finds, to the bit") {
  const RayEngine engine = each_engine();
  std::mt19937 random(1);
  for (int room = 0; room * kFewer < 32; ++room) {
    DrawList list = random_room(static_cast<std::uint32_t>(room), 16, 16);
    // Some items mirrored, stretched, tiny, flattened.
    for (std::size_t i = 1; i < list.items.size(); ++i) {
      const glm::dvec3 scales[] = {{1, 1, 1}, {-1, 1, 1}, {1, 2, 0.01}, {1e-6, 1e-6, 1e-6}, {1, 1, 0}, {1, 1e-9, 1}};
      glm::dmat4& pose = list.world_from_node[list.items[i].transform];
      pose = glm::scale(pose, scales[i % std::size(scales)]);
    }
    const glm::dmat4 pose = at(0, 0, 1.2) * (room % 2 == 0 ? random_pose(random, 0.3) : glm::dmat4(1.0));
    std::vector<glm::dvec3> directions;
    for (int ray = 0; ray < 160; ++ray) directions.push_back(random_direction(random));
    // Along the axes, as close as rounding allows and closer, 16 of a kind side by side.
    for (int axis = 0; axis < 3; ++axis) {
      for (int signs = 0; signs < 8; ++signs) {
        for (int k = 0; k < 16; ++k) {
          const double off = std::pow(10, -6 - 3 * k);
          glm::dvec3 direction(signs & 1 ? off : -off, signs & 2 ? off : -off, signs & 4 ? off : -off);
          direction[axis] = signs & 1 << axis ? 1 : -1;
          directions.push_back(glm::dvec3(rigid_inverse(pose) * glm::dvec4(direction, 0)));
        }
      }
    }
    for (std::size_t i = 1; i < list.items.size(); ++i) {  // towards the small ones
      const glm::dvec3 place(list.world_from_node[list.items[i].transform][3]);
      directions.push_back(glm::normalize(glm::dvec3(rigid_inverse(pose) * glm::dvec4(place, 1))));
    }
    const std::vector<RayHit> hits = engine.cast(list, pose, directions);
    for (std::size_t i = 0; i < directions.size(); ++i) {
      REQUIRE(same(hits[i], brute_force(list, pose, directions[i])));
      REQUIRE(std::isfinite(hits[i].range_m));
    }
  }
}

TEST_CASE("the same from a distance, with worlds from a millimetre to 1000 km") {
  const RayEngine engine = each_engine();
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::size_t met = 0, rays = 0;
  for (const double scale : {1e-4, 1e-2, 1.0, 1e2, 1e5}) {
    for (const double distance_m : {0.0, 30.0, 3e3, 1e5, 3e7}) {
      DrawList list = random_room(static_cast<std::uint32_t>(rays), kFewer > 1 ? 6 : 16, 16);
      const glm::dmat4 away = glm::scale(at(0.6 * distance_m, -0.7 * distance_m, 0.2 * distance_m), glm::dvec3(scale));
      for (std::size_t t = 1; t < list.world_from_node.size(); ++t) {
        list.world_from_node[t] = away * list.world_from_node[t];
      }
      const glm::dmat4 pose = random_pose(random, 0.1 * scale);
      std::vector<glm::dvec3> directions;
      for (int ray = 0; ray < 150; ++ray) {
        const glm::dvec4 point(5.5 * unit(random), 4.5 * unit(random), 1.5 + 2 * unit(random), 1);
        directions.push_back(glm::normalize(glm::dvec3(rigid_inverse(pose) * (away * point))));
      }
      const std::vector<RayHit> hits = engine.cast(list, pose, directions);
      for (std::size_t i = 0; i < directions.size(); ++i, ++rays) {
        REQUIRE(same(hits[i], brute_force(list, pose, directions[i])));
        met += std::isfinite(hits[i].range_m);
      }
    }
  }
  CHECK(met > rays / 2);
}

TEST_CASE("300,000 beams in random rooms against a second ray cast in double") {
  const RayEngine engine = each_engine();
  std::mt19937 random(2);
  std::size_t beams = 0;
  double worst = 0, worst_use = 0;
  for (int room = 0; room * kFewer < 30; ++room) {
    const DrawList list = random_room(static_cast<std::uint32_t>(room), 60, 24);
    const glm::dmat4 pose = at(0, 0, 1.2) * random_pose(random, 0.3);
    const reference::RayCaster truth(list, rigid_inverse(pose));
    std::vector<glm::dvec3> directions(10000);
    for (glm::dvec3& direction : directions) direction = random_direction(random);
    const std::vector<RayHit> hits = engine.cast(list, pose, directions);
    for (std::size_t i = 0; i < hits.size(); ++i, ++beams) {
      const double expected = truth.cast(directions[i]).range_m, error = std::abs(hits[i].range_m - expected);
      REQUIRE(std::isfinite(expected));
      worst = std::max(worst, error / expected);
      worst_use = std::max(worst_use, error / hits[i].error_bound_m);
      REQUIRE(hits[i].error_bound_m <= 1e-6 * expected);
    }
  }
  MESSAGE(beams << " beams: relative error at most " << worst << ", " << worst_use << " of the bound");
  // The reference has the same rounding as the caster and no bound of its own: both may deviate in either direction.
  CHECK(worst_use <= 2);
  CHECK(worst <= kHalfUlp);
}

TEST_CASE("no beam leaves closed meshes between triangles, along edges or at vertices") {
  const RayEngine engine = each_engine();
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::size_t beams = 0, escaped = 0;
  for (int turn = 0; turn * kFewer < 26; ++turn) {
    DrawList list;
    add_item(list, turn % 3 == 0 ? half_box_mesh({5, 4, 3}) : closed_sphere_mesh(3, turn % 3 == 1 ? 16 : 64),
             turn < 8 ? glm::dmat4(1.0) : random_pose(random, turn < 16 ? 1 : 0));
    const Mesh& mesh = *list.meshes[0];
    // At the centre, where tessellation lines run through the axes, and at other places inside.
    const glm::dmat4 pose = turn % 2 == 0 ? glm::dmat4(1.0) : random_pose(random, 0.4);
    const glm::dmat4 sensor_from_mesh = rigid_inverse(pose) * list.world_from_node[1];
    std::vector<glm::dvec3> directions;
    const auto aim = [&](const glm::dvec3& point) {
      directions.push_back(glm::normalize(glm::dvec3(sensor_from_mesh * glm::dvec4(point, 1))));
    };
    for (const glm::vec3& vertex : mesh.positions) aim(vertex);
    while (directions.size() < 40000) {
      const std::size_t triangle = random() % (mesh.indices.size() / 3), corner = random() % 3;
      const glm::dvec3 a(mesh.positions[mesh.indices[3 * triangle + corner]]);
      const glm::dvec3 b(mesh.positions[mesh.indices[3 * triangle + (corner + 1) % 3]]);
      aim(a + unit(random) * (b - a));
      aim(0.5 * (a + b));
      directions.push_back(random_direction(random));
    }
    for (const RayHit& hit : engine.cast(list, pose, directions)) escaped += std::isinf(hit.range_m);
    beams += directions.size();
  }
  MESSAGE(beams << " beams, " << escaped << " escaped");
  CHECK(escaped == 0);
}

TEST_CASE("masked texels let beams pass exactly where geometry says") {
  const RayEngine engine = each_engine();
  constexpr std::uint32_t kTexels = 8;
  auto texture = std::make_shared<Texture>();
  texture->width = texture->height = kTexels;
  texture->rgba.assign(4 * kTexels * kTexels, 255);
  const auto solid = [](std::int64_t x, std::int64_t y) { return (x * 3 + y * 5) % 7 < 4; };
  for (std::uint32_t i = 0; i < kTexels * kTexels; ++i) {
    texture->rgba[4 * i + 3] = solid(i % kTexels, i / kTexels) ? 200 : 100;
  }
  texture->sampler = {.wrap_u = Wrap::mirrored_repeat, .wrap_v = Wrap::clamp_to_edge, .magnify = Filter::nearest};
  Material material;
  material.alpha_mode = AlphaMode::mask;
  material.alpha_cutoff = 0.6f;  // 200 / 255 is above, 100 / 255 below
  material.base_color_texture = texture;
  material.uv_transform = glm::mat3x2(2, 0, 0, 2, -0.5f, -0.5f);  // -0.5 to 1.5: both wraps show
  const DrawList list = curtain(material);
  std::mt19937 random(6);
  std::uniform_real_distribution<double> unit(0.01, 0.99);
  int passed = 0, met = 0;
  for (int ray = 0; ray < 3000; ++ray) {
    const double u = unit(random), v = unit(random);
    const double s = (2 * u - 0.5) * kTexels, t = (2 * v - 0.5) * kTexels;
    // Beams so close to a texel's border that float32 texture coordinates decide are excluded.
    if (std::abs(s - std::round(s)) < 1e-5 || std::abs(t - std::round(t)) < 1e-5) continue;
    const std::int64_t column = s < 0          ? static_cast<std::int64_t>(-s)
                                : s >= kTexels ? 2 * kTexels - 1 - static_cast<std::int64_t>(s)
                                               : static_cast<std::int64_t>(s);
    const std::int64_t row = std::clamp<std::int64_t>(static_cast<std::int64_t>(std::floor(t)), 0, kTexels - 1);
    const RayHit hit = engine.cast_one(list, towards(u, v));
    CHECK(hit.item == (solid(column, row) ? 1u : 0u));
    ++(hit.item == 1 ? met : passed);
  }
  CHECK(passed > 500);
  CHECK(met > 500);
}

TEST_CASE(
    "alpha is base colour times vertex colour times interpolated texture; blended surfaces are hit from one half on") {
  const RayEngine engine = each_engine();
  auto texture = std::make_shared<Texture>();
  texture->width = 2;
  texture->height = 1;
  texture->rgba = {0, 0, 0, 0, 0, 0, 0, 255};  // alpha rises from 0 at u = 1/4 to 1 at u = 3/4
  texture->sampler.wrap_u = Wrap::clamp_to_edge;
  Material material;
  material.alpha_mode = AlphaMode::blend;
  material.base_color_texture = texture;
  material.uv_set = 1;
  Mesh mesh = square();
  for (VertexAttributes& vertex : mesh.attributes) {
    std::swap(vertex.uv[0], vertex.uv[1]);
    vertex.color.a = 0.8f;
  }
  material.base_color.a = 0.9f;
  const double met_from = 0.25 + 0.5 * (0.5 / (0.8 * 0.9));
  const DrawList list = curtain(material, mesh);
  CHECK(engine.cast_one(list, towards(met_from - 1e-5, 0.3)).item == 0);
  CHECK(engine.cast_one(list, towards(met_from + 1e-5, 0.3)).item == 1);
  Material plain;
  plain.base_color.a = 0.49f;
  plain.alpha_mode = AlphaMode::blend;
  CHECK(engine.cast_one(curtain(plain), towards(0.4, 0.3)).item == 0);
}

TEST_CASE("a moved part costs its box, a new mesh its tree, a moved sensor nothing") {
  const RayEngine engine = each_engine();
  DrawList list;
  add_item(list, closed_sphere_mesh(0.1, 16), at(0, 0, 0));
  for (int i = 1; i < 1000; ++i) {
    list.items.push_back({0, 0, static_cast<std::uint32_t>(list.world_from_node.size())});
    list.world_from_node.push_back(at(0.3 * (i % 100), 0.3 * (i / 100), 0));
  }
  const std::vector<glm::dvec3> down{{0, 0, -1}};
  std::vector<RayHit> hits(1);
  // Counters of devices are tested elsewhere.
  const auto look_from = [&](double x, double y) {
    engine.caster->set_world(list);
    engine.caster->cast(at(x, y, 1), down, hits);
    RayCounters counters = engine.caster->counters();
    counters.item_tests = counters.triangle_tests = counters.single_rays = 0;  // the counts depend on the trees
    counters.bytes_uploaded = counters.dispatches = counters.rays_walked = 0;
    return counters;
  };
  const std::uint64_t triangles = list.meshes[0]->indices.size() / 3;
  RayCounters expected{
      .rays = 1, .meshes_built = 1, .triangles_built = triangles, .items_placed = 1000, .item_trees_built = 1};
  CHECK(look_from(0.3, 0.3) == expected);
  CHECK(hits[0].item == 101);
  expected.rays = 2;
  CHECK(look_from(3, 0.3) == expected);
  CHECK(hits[0].item == 110);

  list.world_from_node[list.items[110].transform] = at(3, 0.3, 0.5);
  ++expected.rays;
  ++expected.items_placed;
  ++expected.item_trees_refitted;
  CHECK(look_from(3, 0.3) == expected);
  CHECK(hits[0].range_m == doctest::Approx(0.4).epsilon(1e-6));

  // As in animation, another mesh replaces the old one.
  list.meshes[0] = std::make_shared<Mesh>(*list.meshes[0]);
  ++expected.rays;
  ++expected.meshes_built;
  expected.triangles_built += triangles;
  expected.items_placed += 1000;
  ++expected.item_trees_built;
  CHECK(look_from(3, 0.3) == expected);

  // Beyond the reach of the tree, boxes are counted from a new origin.
  ++expected.rays;
  expected.items_placed += 1000;
  ++expected.item_trees_refitted;
  CHECK(look_from(5000, 0) == expected);
  CHECK(hits[0].range_m == kInfinity);
}

TEST_CASE("the other rays of a packet do not change a hit") {
  const RayEngine engine = each_engine();
  const DrawList list = random_room(9, 60, 24);
  const glm::dmat4 pose = at(0, 0, 1.2);
  std::mt19937 random(8);
  std::vector<glm::dvec3> directions(20000);
  for (glm::dvec3& direction : directions) direction = random_direction(random);
  const std::vector<RayHit> hits = engine.cast(list, pose, directions);
  CHECK(hits == engine.cast(list, pose, directions));
  std::vector<glm::dvec3> reversed(directions.rbegin(), directions.rend());
  std::vector<RayHit> back = engine.cast(list, pose, reversed);
  std::ranges::reverse(back);
  CHECK(hits == back);
  for (std::size_t i = 0; i < directions.size(); i += 1000)
    CHECK(engine.cast_one(list, directions[i], pose) == hits[i]);
}

TEST_CASE("rays of one group share a packet with no other group") {
  // Two boxes side by side. Groups of rays hit one and the other in turns; the first of all rays points elsewhere.
  DrawList list;
  add_item(list, half_box_mesh({0.1, 0.1, 0.1}), at(2, 0.25, 0));
  add_item(list, half_box_mesh({0.1, 0.1, 0.1}), at(2, -0.25, 0));
  constexpr std::size_t kGroups = 64, kGroup = RayCaster::kPacketSize;
  std::vector<glm::dvec3> directions;
  for (std::size_t i = 0; i < kGroups * kGroup; ++i) {
    const double side = i / kGroup % 2 == 0 ? 0.25 : -0.25;
    directions.push_back(i == 0 ? glm::dvec3(-1, 0, 0) : glm::normalize(glm::dvec3(2, side, 1e-3 * (i % kGroup))));
  }
  const RayEngine host = host_engine();
  host.cast(list, glm::dmat4(1.0), directions);
  CHECK(host.caster->counters().item_tests == kGroups);
}

TEST_CASE("each hit is reported once, by any thread, before the cast returns") {
  const RayEngine engine = each_engine();
  const DrawList list = random_room(9, 60, 24);
  std::mt19937 random(8);
  for (const std::size_t rays : {0, 1, 20000}) {
    std::vector<glm::dvec3> directions(rays);
    for (glm::dvec3& direction : directions) direction = random_direction(random);
    std::vector<RayHit> hits(rays), told(rays);
    std::vector<int> times(rays, 0);  // no two threads report the same one
    engine.caster->set_world(list);
    engine.caster->cast(at(0, 0, 1.2), directions, hits, {}, [&](std::size_t first, std::size_t count) {
      for (std::size_t i = first; i < first + count; ++i) {
        told[i] = hits[i];
        ++times[i];
      }
    });
    CHECK(told == hits);
    CHECK(std::ranges::count(times, 1) == static_cast<std::ptrdiff_t>(rays));
  }
}

TEST_SUITE_END();
