// Rays against round shapes and endless planes, compared with closed forms in quadruple precision. By hand:
// SIMVIS_TEST_SHAPE_RAYS=1000000 rays for each shape.
#include "tests/support/exact_shapes.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <simvis/surface_point.h>
#include "scenegraph/primitive_meshes.h"
#include "tests/support/infinity.h"
#include "tests/support/long_count.h"
#include "tests/support/ray_casting.h"

TEST_SUITE_BEGIN("engine/raycast");

using namespace simvis;

namespace {

// Half a unit in the last place of float32, in which ranges are stored, and what is left of double at grazing
// incidence.
constexpr double kMaxError_rel = 6e-8;

// A ray that passes an outline closer than this share of all lengths may hit or miss: 28 u of ray_caster.h and 57 u of
// ray_surface.h on what is left after a shear, with a factor of 10.
constexpr double kDoubt_rel = 1000 * 0x1p-53;

struct Placed {
  std::string name;
  Mesh mesh;
  glm::dmat4 world_from_mesh;
  double reach_m = 1;  // of the shape in the world
};

struct Outcome {
  std::size_t rays = 0, hits = 0, inside = 0, doubtful = 0;
  std::size_t wrong = 0, beyond_bound = 0;
  double worst_rel = 0;
  std::vector<double> bounds_rel;
};

glm::dmat4 sheared() {
  glm::dmat4 matrix(1);
  matrix[1][0] = 0.7;
  matrix[2][1] = -0.4;
  return matrix;
}

// The shape in poses, scales and mirrors; the reach is that of a shape of about one metre.
std::vector<Placed> placed_shapes(const std::string& name, const Mesh& mesh, std::mt19937& random) {
  const glm::dvec3 scales[] = {{1, 1, 1}, {-1, 1, 1}, {0.5, 2, 3}, {1e-3, -1, 1}, {1, 1, 1e-3}, {-20, -20, -20}};
  std::vector<Placed> all;
  for (const glm::dvec3& scale : scales) {
    const double reach_m = 3 * std::max({std::abs(scale.x), std::abs(scale.y), std::abs(scale.z)});
    all.push_back({name, mesh, glm::scale(random_pose(random, 5), scale), reach_m});
  }
  all.push_back({name + ", sheared", mesh, random_pose(random, 5) * sheared(), 5});
  all.push_back({name + ", 10^6 m away", mesh, at(1e6, -7e5, 3e5) * random_pose(random, 5), 3});
  return all;
}

// A third of the sensors stand far away, a third close by, a third within reach of the shape's middle, and so inside.
glm::dmat4 sensor_at(const Placed& placed, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0, 1);
  const double distances_m[] = {0.2 * unit(random), 0.5 + 2 * unit(random), std::pow(10, 1 + 2 * unit(random))};
  const double distance_m = placed.reach_m * distances_m[random() % 3];
  const glm::dvec3 middle(placed.world_from_mesh[3]);
  glm::dmat4 pose = random_pose(random, 0);
  pose[3] = glm::dvec4(middle + distance_m * random_direction(random), 1);
  return pose;
}

// Half of the directions are random towards the box, half pass the outline at a distance of 0.1 to 10^-9 of the size.
glm::dvec3 direction_to(const Placed& placed, const glm::dmat4& pose, std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const Mesh& mesh = placed.mesh;
  glm::dvec3 point;
  if (random() % 2 == 0) {
    const glm::dvec3 low(mesh.bounds_min), high(mesh.bounds_max), middle = 0.5 * (low + high);
    point = middle + 0.6 * (high - low) * glm::dvec3(unit(random), unit(random), unit(random));
  } else {
    const auto index = mesh.indices[random() % mesh.indices.size()];
    point =
        glm::dvec3(mesh.positions[index]) * (1 + std::pow(10, -5 + 4 * unit(random)) * (random() % 2 == 0 ? 1 : -1));
  }
  const glm::dvec3 way(rigid_inverse(pose) * (placed.world_from_mesh * glm::dvec4(point, 1)));
  return glm::length(way) > 0 ? glm::normalize(way) : glm::dvec3(1, 0, 0);
}

// Whether a shape that is a little larger or smaller is hit elsewhere: at another face, or not at all.
bool is_doubtful(const Placed& placed, const glm::dmat4& pose, const glm::dvec3& direction, double lengths_m) {
  // No direction is shrunk to less than 1 / |inverse|.
  const glm::dmat3 inverse = glm::inverse(glm::dmat3(placed.world_from_mesh));
  const double by_m =
      kDoubt_rel * lengths_m *
      std::sqrt(glm::dot(inverse[0], inverse[0]) + glm::dot(inverse[1], inverse[1]) + glm::dot(inverse[2], inverse[2]));
  reference::ShapeHit hits[2];
  for (int i = 0; i < 2; ++i) {
    const auto shape = reference::grown(*placed.mesh.surface, i == 0 ? by_m : -by_m);
    if (!shape) return true;
    hits[i] = reference::nearest_hit(*shape, placed.world_from_mesh, pose, direction);
  }
  const bool first = hits[0].range_m < kInfinity, second = hits[1].range_m < kInfinity;
  if (first != second) return true;
  return first && std::abs(static_cast<double>(hits[0].range_m - hits[1].range_m)) > 1e-3 * lengths_m;
}

void hold(const Placed& placed, const glm::dmat4& pose, const glm::dvec3& direction, const RayHit& hit,
          Outcome& outcome) {
  const reference::ShapeHit exact =
      reference::nearest_hit(*placed.mesh.surface, placed.world_from_mesh, pose, direction);
  const auto truth_m = static_cast<double>(exact.range_m);
  const glm::dvec3 middle(placed.world_from_mesh[3]), sensor(pose[3]);
  const double lengths_m = placed.reach_m + glm::distance(middle, sensor) + glm::length(middle) + glm::length(sensor);
  ++outcome.rays;
  const bool same_kind = (truth_m < kInfinity) == (hit.range_m < kInfinity);
  const double error_m = same_kind && truth_m < kInfinity
                             ? std::abs(static_cast<double>(reference::Quad(hit.range_m) - exact.range_m))
                             : 0;
  if (!same_kind || error_m > hit.error_bound_m) {
    if (is_doubtful(placed, pose, direction, lengths_m)) {
      ++outcome.doubtful;
    } else {
      ++(same_kind ? outcome.beyond_bound : outcome.wrong);
    }
    return;
  }
  if (truth_m == kInfinity) return;
  ++outcome.hits;
  outcome.bounds_rel.push_back(hit.error_bound_m / truth_m);
  const double stored_m = static_cast<float>(hit.range_m);
  outcome.worst_rel = std::max(outcome.worst_rel, std::abs(stored_m - truth_m) / truth_m);
}

void check(const RayEngine& engine, const std::string& name, const Mesh& mesh, unsigned seed) {
  std::mt19937 random(seed);
  const std::vector<Placed> all = placed_shapes(name, mesh, random);
  const auto rays = static_cast<std::size_t>(count_of("SIMVIS_TEST_SHAPE_RAYS", 4000)) / all.size();
  Outcome sum;
  for (const Placed& placed : all) {
    DrawList list;
    add_item(list, placed.mesh, placed.world_from_mesh);
    constexpr std::size_t kFromOnePose = 50;
    for (std::size_t done = 0; done < rays; done += kFromOnePose) {
      const glm::dmat4 pose = sensor_at(placed, random);
      std::vector<glm::dvec3> directions;
      for (std::size_t i = 0; i < kFromOnePose; ++i) directions.push_back(direction_to(placed, pose, random));
      const std::vector<RayHit> hits = engine.cast(list, pose, directions);
      for (std::size_t i = 0; i < kFromOnePose; ++i) hold(placed, pose, directions[i], hits[i], sum);
    }
  }
  REQUIRE(!sum.bounds_rel.empty());
  std::ranges::nth_element(sum.bounds_rel, sum.bounds_rel.begin() + std::ptrdiff_t(sum.bounds_rel.size() / 2));
  MESSAGE(name << ": " << sum.rays << " rays, " << sum.hits << " hits, " << sum.doubtful << " at an outline; wrong "
               << sum.wrong << ", beyond the bound " << sum.beyond_bound << "; largest relative error as float32 "
               << sum.worst_rel << ", median bound / range " << sum.bounds_rel[sum.bounds_rel.size() / 2]);
  CHECK(sum.wrong == 0);
  CHECK(sum.beyond_bound == 0);
  CHECK(sum.worst_rel <= kMaxError_rel);
  CHECK(sum.hits > sum.rays / 4);
  CHECK(sum.doubtful < sum.rays / 1000 + 1);
}

}  // namespace

TEST_CASE("random rays meet round shapes where closed forms say, within their bounds") {
  const RayEngine engine = each_engine();
  check(engine, "sphere", sphere_mesh(1), 1);
  check(engine, "sphere of an odd radius", sphere_mesh(0.1234567), 2);
  check(engine, "cylinder", cylinder_mesh(0.4, 1.7), 3);
  check(engine, "long cylinder", cylinder_mesh(0.01, 2), 4);
  check(engine, "disc", cylinder_mesh(1, 0.001), 5);
  check(engine, "cone", cone_mesh(0.7, 1.1), 6);
  check(engine, "needle", cone_mesh(0.01, 2), 7);
  check(engine, "flat cone", cone_mesh(1, 0.01), 8);
  check(engine, "capsule", capsule_mesh(0.3, 1.2), 9);
  check(engine, "long capsule", capsule_mesh(0.01, 2), 10);
  check(engine, "plane", endless_plane_mesh({kInfinity, kInfinity}), 11);
  check(engine, "strip", endless_plane_mesh({0.8, kInfinity}), 12);
}

namespace {

// Round shapes, triangles, leaves, mirrors, flattened shapes and a ground without end, in one another.
DrawList world_of_shapes(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(0.1, 1);
  DrawList list = random_room(3, 20, 16);
  list.materials.push_back(leaves(random));
  list.material_revision.push_back(0);
  const Mesh meshes[] = {sphere_mesh(0.5), cylinder_mesh(0.3, 0.8), cone_mesh(0.4, 0.9), capsule_mesh(0.2, 0.5)};
  for (int i = 0; i < 60; ++i) {
    const glm::dvec3 scale(i % 5 == 0 ? -unit(random) : unit(random), unit(random), i % 7 == 0 ? 0 : unit(random));
    add_item(list, meshes[i % 4], at(0, 0, 1.2) * glm::scale(random_pose(random, 2), scale));
    if (i % 6 == 0) list.items.back().material = static_cast<std::uint32_t>(list.materials.size() - 1);
  }
  add_item(list, endless_plane_mesh({kInfinity, kInfinity}), at(0, 0, -0.2));
  return list;
}

}  // namespace

TEST_CASE("host and compute shader, packets and single rays, one origin and many give the same bytes") {
  std::mt19937 random(20);
  const DrawList list = world_of_shapes(random);
  std::size_t on_shapes = 0, with_ends = 0;
  for (int pose_number = 0; pose_number < 6; ++pose_number) {
    const glm::dmat4 pose = at(0, 0, 1.2) * random_pose(random, 1.5);
    const std::vector<glm::dvec3> directions = directions_into(list, pose, 3000, random);
    const RayEngine host = host_engine(), device = device_engine();
    const std::vector<RayHit> hits = host.cast(list, pose, directions);
    CHECK(device.cast(list, pose, directions) == hits);
    std::vector<glm::dvec3> backwards(directions.rbegin(), directions.rend());
    std::vector<RayHit> reversed = host.cast(list, pose, backwards);
    std::ranges::reverse(reversed);
    CHECK(reversed == hits);
    std::vector<RayHit> from_many(directions.size());
    host.caster->cast_from(pose, std::vector<glm::dvec3>(directions.size(), glm::dvec3(0)), directions, from_many);
    CHECK(from_many == hits);
    for (std::size_t i = 0; i < directions.size(); i += 7) CHECK(host.cast_one(list, directions[i], pose) == hits[i]);
    for (const RayHit& hit : hits) {
      const auto& surface = list.meshes[list.items[hit.item].mesh]->surface;
      if (hit.range_m == kInfinity || !surface) continue;
      ++on_shapes;
      with_ends += hit.primitive != kRoundFace;
    }
  }
  CHECK(on_shapes > 5000);
  CHECK(with_ends > 100);
}

TEST_CASE("behind the nearest hit a ray meets the far side, and then nothing") {
  const RayEngine engine = each_engine();
  DrawList list;
  add_item(list, cylinder_mesh(0.5, 2), at(3, 0, 0));
  const std::vector<glm::dvec3> directions(3, glm::dvec3(1, 0, 0));
  std::vector<RayHit> hits(3);
  engine.caster->set_world(list);
  const std::vector<double> behind_m{0, 2.6, 3.6};
  engine.caster->cast(glm::dmat4(1), directions, hits, behind_m);
  CHECK(std::abs(hits[0].range_m - 2.5) <= hits[0].error_bound_m);
  CHECK(std::abs(hits[1].range_m - 3.5) <= hits[1].error_bound_m);
  CHECK(hits[2].range_m == kInfinity);
}

TEST_CASE("a plane without end is hit far beyond its drawn part") {
  const RayEngine engine = each_engine();
  DrawList list;
  add_item(list, endless_plane_mesh({kInfinity, kInfinity}), at(0, 0, -1));
  add_item(list, sphere_mesh(0.5), at(0, 3, 0));
  const RayHit hit = engine.cast_one(list, glm::normalize(glm::dvec3(5000, 0, -1)));
  CHECK(std::abs(hit.range_m - std::hypot(5000, 1)) <= hit.error_bound_m);
  CHECK(engine.cast_one(list, glm::normalize(glm::dvec3(5000, 0, 1))).range_m == kInfinity);
}

// Of two shapes at the same place the one that comes first by content counts, whatever the order of the items.
TEST_CASE("a tie between shapes is decided by content") {
  const RayEngine engine = each_engine();
  for (const bool swapped : {false, true}) {
    DrawList list;
    add_item(list, swapped ? capsule_mesh(0.5, 1) : cylinder_mesh(0.5, 1), at(3, 0, 0));
    add_item(list, swapped ? cylinder_mesh(0.5, 1) : capsule_mesh(0.5, 1), at(3, 0, 0));
    const RayHit hit = engine.cast_one(list, {1, 0, 0});
    CHECK(hit.range_m == 2.5);
    static std::string first_name;
    const std::string name = list.meshes[list.items[hit.item].mesh]->name;
    if (!swapped) first_name = name;
    CHECK(name == first_name);
  }
}

// The transform has no inverse: rays meet the disc that the mesh becomes.
TEST_CASE("a flattened sphere is its flattened mesh") {
  const RayEngine engine = each_engine();
  DrawList list;
  add_item(list, sphere_mesh(0.5), glm::scale(at(3, 0, 0), {0, 1, 1}));
  CHECK(engine.cast_one(list, glm::normalize(glm::dvec3(3, 0.1, 0.2))).range_m ==
        doctest::Approx(std::sqrt(9 + 0.01 + 0.04)));
  CHECK(engine.cast_one(list, glm::normalize(glm::dvec3(3, 0.6, 0))).range_m == kInfinity);
}

TEST_CASE("normals, and the colours of textures, are those of the shape") {
  auto texture = std::make_shared<Texture>();
  // Two columns: the half from +x over +y to -x is black, the other half white; alpha 255.
  texture->width = 2;
  texture->height = 1;
  texture->rgba = {0, 0, 0, 255, 255, 255, 255, 255};
  texture->sampler.magnify = Filter::nearest;
  auto material = std::make_shared<Material>();
  material->base_color_texture = texture;
  std::mt19937 random(9);
  const glm::dmat4 scaled = glm::scale(at(0.3, -0.2, 0.1) * random_pose(random, 0), {1, 2, 0.5});
  const Mesh meshes[] = {sphere_mesh(0.5), cylinder_mesh(0.4, 0.8), cone_mesh(0.5, 1), capsule_mesh(0.3, 0.6)};
  for (const Mesh& mesh : meshes) {
    DrawList list;
    add_item(list, mesh, scaled);
    list.materials = {material};
    std::size_t hits = 0, dark = 0;
    for (int i = 0; i < 500; ++i) {
      glm::dmat4 pose = random_pose(random, 0);
      pose[3] = glm::dvec4(4.0 * random_direction(random), 1);
      std::uniform_real_distribution<double> unit(-0.4, 0.4);
      const glm::dvec3 inside(scaled * glm::dvec4(unit(random), unit(random), unit(random), 1));
      const glm::dvec3 direction = glm::normalize(glm::dvec3(rigid_inverse(pose) * glm::dvec4(inside, 1)));
      const RayHit hit = host_engine().cast_one(list, direction, pose);
      if (hit.range_m == kInfinity || hit.primitive != kRoundFace) continue;
      const SurfacePoint point = surface_point(list, pose, direction, hit);
      const glm::dvec3 at_world(pose * glm::dvec4(hit.range_m * direction, 1));
      const glm::dvec3 p(glm::inverse(scaled) * glm::dvec4(at_world, 1));
      // The gradient of each shape's equation.
      const ExactSurface& s = *mesh.surface;
      const double half = s.length_m / 2, k = s.radius_m / s.length_m;
      glm::dvec3 gradient(p.x, p.y, 0);
      if (s.kind == SurfaceKind::sphere) gradient.z = p.z;
      if (s.kind == SurfaceKind::cone) gradient.z = k * k * (half - p.z);
      if (s.kind == SurfaceKind::capsule) gradient.z = p.z - std::clamp(p.z, -half, half);
      const glm::dmat3 sensor_from_mesh = glm::dmat3(rigid_inverse(pose) * scaled);
      const glm::dvec3 normal = glm::normalize(glm::transpose(glm::inverse(sensor_from_mesh)) * gradient);
      CHECK(glm::dot(point.normal, direction) < 0);
      // The expected normal has some roundings of its own, magnified by the ratio of the scales.
      constexpr double kOwn_rad = 1e-13;
      CHECK(glm::length(glm::cross(point.normal, normal)) <= point.normal_error_rad + kOwn_rad);
      CHECK(point.normal_error_rad < 1e-9);
      ++hits;
      if (std::abs(p.y) < 1e-3) continue;  // beside the border of the two halves
      const bool is_dark = point.base_color.r == 0;
      CHECK(is_dark == (p.y > 0));
      dark += is_dark;
    }
    CHECK(hits > 200);
    CHECK(dark > 50);
    CHECK(dark < hits - 50);
  }
}

// The upper half of the texture has no alpha: rays from above pass the upper half of the sphere and meet the lower one.
TEST_CASE("a masked sphere is hit where its texture is solid") {
  auto texture = std::make_shared<Texture>();
  texture->width = 1;
  texture->height = 2;
  texture->rgba = {255, 255, 255, 0, 255, 255, 255, 255};
  texture->sampler.magnify = Filter::nearest;
  auto material = std::make_shared<Material>();
  material->base_color_texture = texture;
  material->alpha_mode = AlphaMode::mask;
  const RayEngine engine = each_engine();
  DrawList list;
  add_item(list, sphere_mesh(0.5), at(3, 0, 0));
  list.materials = {material};
  const double z = 0.2, x = std::sqrt(0.25 - z * z);
  CHECK(engine.cast_one(list, {1, 0, 0}, at(0, 0, z)).range_m == kInfinity);
  const RayHit below = engine.cast_one(list, {1, 0, 0}, at(0, 0, -z));
  CHECK(std::abs(below.range_m - (3 - x)) <= below.error_bound_m);
  const RayHit through = engine.cast_one(list, {0, 0, -1}, at(3, 0.1, 2));
  CHECK(std::abs(through.range_m - (2 + std::sqrt(0.25 - 0.01))) <= through.error_bound_m);
}

TEST_CASE("exact shapes have no trees, and hidden and moved ones are as other items") {
  const RayEngine engine = host_engine();
  DrawList list;
  add_item(list, sphere_mesh(0.5), at(3, 0, 0));
  add_item(list, endless_plane_mesh({kInfinity, kInfinity}), at(0, 0, -1));
  CHECK(engine.cast_one(list, {1, 0, 0}).range_m == 2.5);
  CHECK(engine.caster->counters().meshes_built == 2);
  CHECK(engine.caster->counters().triangles_built == 0);
  list.world_from_node[list.items[0].transform] = at(4, 0, 0);
  CHECK(engine.cast_one(list, {1, 0, 0}).range_m == 3.5);
  list.items[0].visible = false;
  CHECK(engine.cast_one(list, {1, 0, 0}).range_m == kInfinity);
  CHECK(engine.cast_one(list, {0, 0, -1}).range_m == 1);
  list.items[1].visible = false;
  CHECK(engine.cast_one(list, {0, 0, -1}).range_m == kInfinity);
}
