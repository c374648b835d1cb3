// Degenerate geometry: triangles without area, slivers, the same face twice, objects without thickness.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <string>
#include <vector>

#include <simvis/device.h>
#include "engine/render/renderer.h"
#include "sensors/camera/camera.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/infinity.h"
#include "tests/support/measured_images.h"
#include "tests/support/random_room.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("hard_cases");

using namespace simvis;

namespace {

glm::dmat4 moved_to(double x, double y, double z) { return glm::translate(glm::dmat4(1.0), {x, y, z}); }

/// A rectangle perpendicular to x at x = 0, y and z within +-`half_m`.
Mesh plate(const glm::vec2& half_m) {
  Mesh mesh;
  mesh.positions = {
      {0, -half_m.x, -half_m.y}, {0, half_m.x, -half_m.y}, {0, half_m.x, half_m.y}, {0, -half_m.x, half_m.y}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  return mesh;
}

/// Range to a rectangle perpendicular to x at `x_m`, y and z within +-`half_m`.
double range_to_plate(const glm::dvec3& d, double x_m, const glm::dvec2& half_m) {
  const double range = d.x > 0 ? x_m / d.x : kInfinity;
  return std::abs(range * d.y) <= half_m.x && std::abs(range * d.z) <= half_m.y ? range : kInfinity;
}

/// A wide rectangle behind all others, which stops the beams that pass the others.
constexpr double kBack_m = 6;
void add_back(DrawList& world) { add_item(world, plate({100, 100}), moved_to(kBack_m, 0, 0)); }
double range_to_back(const glm::dvec3& d) { return range_to_plate(d, kBack_m, {100, 100}); }

/// Rings over the surfaces ahead. The number of beams and rings is odd, so one beam runs along x.
ScanPattern ahead(std::uint32_t samples = 181, std::uint32_t rings = 41) {
  return {.beams = samples,
          .rings = rings,
          .min_azimuth_rad = -kPi / 4,
          .max_azimuth_rad = kPi / 4,
          .min_elevation_rad = -kPi / 8,
          .max_elevation_rad = kPi / 8};
}

HardCase case_of(const std::string& name, double plate_m, const glm::dvec2& half_m) {
  HardCase hard{.name = name};
  hard.scanner.pattern = ahead();
  hard.truth = [=](const glm::dvec3& d) { return std::min(range_to_plate(d, plate_m, half_m), range_to_back(d)); };
  add_back(hard.world);
  return hard;
}

constexpr double kPlate_m = 3;
const glm::vec2 kHalf_m(0.9f, 0.55f);

}  // namespace

TEST_CASE("triangles without area are ignored") {
  HardCase hard = case_of("triangles without area, before a wall and within it", kPlate_m, kHalf_m);
  Mesh mesh = plate(kHalf_m);
  mesh.indices.insert(mesh.indices.end(), {0, 0, 0, 1, 1, 2, 0, 2, 0});  // a point, lines
  mesh.positions.insert(mesh.positions.end(),
                        {{0, -0.9f, 0}, {0, 0.9f, 0}, {0, 0, 0}, {-1, 0.2f, 0.1f}, {-1, 0.2f, 0.1f}});
  mesh.indices.insert(mesh.indices.end(), {4, 5, 6, 7, 8, 7, 7, 0, 8, 4, 6, 5});  // three in a line, equal vertices
  add_item(hard.world, mesh, moved_to(kPlate_m, 0, 0));
  measure(hard);
}

TEST_CASE("slivers of aspect 10^6") {
  // 10 m wide and 10 micrometres high: the beams of the middle ring run along and beside their edges.
  {
    constexpr int kSlivers = 200;
    constexpr double kHeight_m = 1e-5, kWidth_m = 10;
    HardCase hard{.name = "a wall with slivers of 10 m x 10 um in its middle"};
    Mesh mesh;
    const auto row = [&](double z) {
      mesh.positions.emplace_back(0, -kWidth_m / 2, z);
      mesh.positions.emplace_back(0, kWidth_m / 2, z);
    };
    row(-5);
    for (int i = 0; i <= kSlivers; ++i) row((i - kSlivers / 2) * kHeight_m);
    row(5);
    for (std::uint32_t i = 0; i + 3 < mesh.positions.size(); i += 2) {
      mesh.indices.insert(mesh.indices.end(), {i, i + 1, i + 2, i + 1, i + 3, i + 2});
    }
    add_item(hard.world, mesh, moved_to(kPlate_m, 0, 0));
    hard.scanner.pattern = {.beams = 181, .min_azimuth_rad = -kPi / 4, .max_azimuth_rad = kPi / 4};
    hard.truth = [](const glm::dvec3& d) { return range_to_plate(d, kPlate_m, {5, 5}); };
    measure(hard);
    hard.name = "the same by rings";
    hard.scanner.pattern = ahead();
    measure(hard);
  }
  // A fan of slivers with one common corner.
  {
    constexpr int kSlivers = 400;
    constexpr double kReach_m = 10, kWidth_m = 1e-5;
    HardCase hard{.name = "a wall that is a fan of slivers of 10 m x 10 um"};
    Mesh mesh;
    mesh.positions = {{0, -5, -5}, {0, 5, -5}};
    for (int i = 0; i <= kSlivers; ++i)
      mesh.positions.emplace_back(0, 5, -5 + kReach_m * 0.5 + (i - kSlivers / 2) * kWidth_m);
    mesh.positions.emplace_back(0, 5, 5);
    mesh.positions.emplace_back(0, -5, 5);
    for (std::uint32_t i = 1; i + 1 < mesh.positions.size(); ++i)
      mesh.indices.insert(mesh.indices.end(), {0, i, i + 1});
    add_item(hard.world, mesh, moved_to(kPlate_m, 0, 0));
    hard.scanner.pattern = ahead();
    hard.truth = [](const glm::dvec3& d) { return range_to_plate(d, kPlate_m, {5, 5}); };
    measure(hard);
  }
}

TEST_CASE("it does not matter which of several coincident faces is hit") {
  HardCase hard = case_of("a face", kPlate_m, kHalf_m);
  add_item(hard.world, plate(kHalf_m), moved_to(kPlate_m, 0, 0));
  const HardResults once = measure(hard);
  hard.name = "the same face twice, and twice within a mesh";
  Mesh twice = plate(kHalf_m);
  twice.indices.insert(twice.indices.end(), {0, 2, 3, 0, 1, 2});
  add_item(hard.world, plate(kHalf_m), moved_to(kPlate_m, 0, 0));
  add_item(hard.world, twice, moved_to(kPlate_m, 0, 0));
  const HardResults often = measure(hard);
  for (const HardResult HardResults::*method :
       {&HardResults::nearest, &HardResults::planar, &HardResults::hybrid, &HardResults::raycast}) {
    CHECK((once.*method).scan.range_m == (often.*method).scan.range_m);
    CHECK((once.*method).scan.error_bound_m == (often.*method).scan.error_bound_m);
  }
  // Other triangles in the same plane have other rounding, so the last bit of the range may differ.
  hard.name = "the same face, once cut along the other diagonal";
  Mesh other = plate(kHalf_m);
  other.indices = {1, 2, 3, 3, 0, 1};
  add_item(hard.world, other, moved_to(kPlate_m, 0, 0));
  measure(hard);
}

TEST_CASE("duplicate vertices and unused vertices") {
  HardCase hard = case_of("each triangle with vertices of its own, others that none uses", kPlate_m, kHalf_m);
  const Mesh shared = plate(kHalf_m);
  Mesh mesh;
  mesh.positions = {{1e6f, -1e6f, 1e6f}, {0, 0, 0}};
  for (const std::uint32_t i : shared.indices) {
    mesh.indices.push_back(static_cast<std::uint32_t>(mesh.positions.size()));
    mesh.positions.push_back(shared.positions[i]);
  }
  mesh.positions.emplace_back(-1e30f, 0, 0);
  add_item(hard.world, mesh, moved_to(kPlate_m, 0, 0));
  measure(hard);
}

TEST_CASE("scales of 10^-6 and 10^6, mirrored, flattened and collapsed to a point") {
  // A box about (kPlate_m, 0, kUp_m). The range to it is that of the point where the beam is within all three pairs of
  // planes.
  constexpr double kUp_m = 0.12;  // so that a ring hits the flat box at 2.25 degrees
  const auto measure_scaled = [](const std::string& name, const glm::dvec3& mesh_half_m, const glm::dvec3& scale,
                                 double hybrid_error_rel = kHybridError) {
    HardCase hard = case_of(name, kPlate_m, kHalf_m);
    hard.hybrid_error_rel = hybrid_error_rel;
    add_item(hard.world, half_box_mesh(mesh_half_m), glm::scale(moved_to(kPlate_m, 0, kUp_m), scale));
    const glm::dvec3 half_m = glm::abs(scale) * glm::dvec3(glm::vec3(mesh_half_m)), middle(kPlate_m, 0, kUp_m);
    const int flat = (half_m.x == 0) + (half_m.y == 0) + (half_m.z == 0);
    hard.truth = [=](const glm::dvec3& d) {
      double first = 0, last = kInfinity;
      for (int axis = 0; axis < 3; ++axis) {
        const double low = middle[axis] - half_m[axis], high = middle[axis] + half_m[axis];
        if (d[axis] == 0 && (low >= 0 || high <= 0)) return range_to_back(d);
        if (d[axis] == 0) continue;
        first = std::max(first, std::min(low / d[axis], high / d[axis]));
        last = std::min(last, std::max(low / d[axis], high / d[axis]));
      }
      return flat < 2 && first <= last ? first : range_to_back(d);
    };
    measure(hard);
  };
  measure_scaled("a box of 10^6 m, scaled by 10^-6", {0.3e6, 0.9e6, 0.55e6}, glm::dvec3(1e-6));
  measure_scaled("a box of 1 um, scaled by 10^6", {0.3e-6, 0.9e-6, 0.55e-6}, glm::dvec3(1e6));
  measure_scaled("a box scaled by (10^6, 1, 10^-6)", {0.3e-6, 0.9, 0.55e6}, {1e6, 1, 1e-6},
                 1e-3);  // bounds include the worst case of both scales
  measure_scaled("a box mirrored in one axis", {0.3, 0.9, 0.55}, {1, -1, 1});
  measure_scaled("a box mirrored in three axes", {0.3, 0.9, 0.55}, {-1, -1, -1});
  measure_scaled("a box flattened to a plane across the beams", {0.3, 0.9, 0.55}, {0, 1, 1});
  measure_scaled("a box flattened to a plane along the beams", {0.3, 0.9, 0.55}, {1, 1, 0});
  measure_scaled("a box scaled to a line", {0.3, 0.9, 0.55}, {1, 0, 0});
  measure_scaled("a box scaled to a point", {0.3, 0.9, 0.55}, {0, 0, 0});
}

TEST_CASE("a surface seen from its edge has no thickness and is not hit") {
  HardCase hard = case_of("a plane through the sensor, seen from its edge", kPlate_m, kHalf_m);
  add_item(hard.world, half_box_mesh({0.3, 0.9, 0.55}), glm::scale(moved_to(kPlate_m, 0, 0), {1, 1, 0}));
  hard.truth = range_to_back;
  measure(hard);
}

TEST_CASE("an empty scene, a single beam, no field of view") {
  HardCase hard{.name = "an empty scene"};
  hard.scanner.pattern = ahead();
  hard.truth = [](const glm::dvec3&) { return kInfinity; };
  measure(hard);
  hard.name = "a scene of an empty mesh and one of a single point";
  add_item(hard.world, Mesh{}, glm::dmat4(1.0));
  Mesh point;
  point.positions = {{3, 0, 0}};
  point.indices = {0, 0, 0};
  add_item(hard.world, point, glm::dmat4(1.0));
  measure(hard);

  HardCase wall = case_of("a single beam", kPlate_m, kHalf_m);
  add_item(wall.world, plate(kHalf_m), moved_to(kPlate_m, 0, 0));
  wall.scanner.pattern = {.beams = 1, .min_azimuth_rad = 0.1, .max_azimuth_rad = 0.2};
  measure(wall);
  wall.name = "a single beam of a single ring that is not level";
  wall.scanner.pattern = {
      .beams = 1, .min_azimuth_rad = 0.1, .max_azimuth_rad = 0.2, .min_elevation_rad = 0.05, .max_elevation_rad = 0.05};
  measure(wall);
  wall.name = "five beams and three rings in one direction";
  wall.scanner.pattern = {.beams = 5,
                          .rings = 3,
                          .min_azimuth_rad = 0.1,
                          .max_azimuth_rad = 0.1,
                          .min_elevation_rad = 0.05,
                          .max_elevation_rad = 0.05};
  for (const HardResults& results : {measure(wall)}) {
    for (const HardResult* result : {&results.nearest, &results.planar, &results.hybrid, &results.raycast}) {
      for (const float range : result->scan.range_m) CHECK(range == result->scan.range_m[0]);
    }
  }
  wall.name = "five beams in one direction";
  wall.scanner.pattern = {.beams = 5, .min_azimuth_rad = 0.1, .max_azimuth_rad = 0.1};
  measure(wall);
  wall.name = "straight up: all beams of a ring in one direction";
  wall.scanner.pattern = {.beams = 8,
                          .min_azimuth_rad = -kPi,
                          .max_azimuth_rad = kPi,
                          .min_elevation_rad = kPi / 2,
                          .max_elevation_rad = kPi / 2};
  add_item(wall.world, half_box_mesh({3, 3, 1}), moved_to(0, 0, 3));
  wall.truth = [](const glm::dvec3& d) { return 2 / d.z; };
  measure(wall);
}

TEST_CASE("pictures of degenerate geometry contain numbers") {
  DrawList world;
  Mesh folded = plate(kHalf_m);
  folded.indices.insert(folded.indices.end(), {0, 0, 0, 1, 1, 2, 0, 2, 0});
  add_item(world, folded, moved_to(kPlate_m, 1, 0));
  Mesh ball = sphere_mesh(0.5, 32);
  ball.attributes.resize(ball.positions.size());
  for (std::size_t i = 0; i < ball.positions.size(); ++i) ball.attributes[i].normal = glm::normalize(ball.positions[i]);
  int place = 0;
  for (const glm::dvec3& scale : {glm::dvec3(0, 1, 1), glm::dvec3(1, 1, 0), glm::dvec3(1, 0, 0), glm::dvec3(0, 0, 0),
                                  glm::dvec3(-1, 1, 1), glm::dvec3(1e-6), glm::dvec3(1e6), glm::dvec3(1, 1e-6, 1e6)}) {
    Mesh mesh = ball;
    for (glm::vec3& p : mesh.positions) p /= glm::max(glm::abs(glm::vec3(scale)), glm::vec3(1e-6f));
    add_item(world, mesh, glm::scale(moved_to(4, 1.5 - 0.4 * place++, -0.5), scale));
  }
  Mesh fan;
  fan.positions = {{0, -5, 0.5f}, {0, 5, 0.5f}, {0, 5, 0.50001f}, {0, 5, 0.50002f}};
  fan.indices = {0, 1, 2, 0, 2, 3, 3, 2, 0};
  add_item(world, fan, moved_to(kPlate_m, 0, 0));
  auto glossy = std::make_shared<Material>();
  glossy->roughness = 0.1f;
  world.materials.push_back(glossy);
  world.material_revision.push_back(0);
  for (std::size_t i = 0; i < world.items.size(); i += 2) world.items[i].material = 1;
  world.lights.push_back({.light = {.kind = LightKind::directional}, .transform = 0});
  world.lights.push_back({.light = {.kind = LightKind::point}, .transform = 1});  // on a face
  world.lights.push_back({.light = {.kind = LightKind::spot}, .transform = 5});   // scaled to a point

  Device device;
  Renderer renderer(device);
  Camera camera("CAMERA",
                {.pinhole = {.width_px = 160, .height_px = 120, .hfov_rad = kPi / 2}, .color = true, .depth = true});
  FramePlan plan;
  camera.plan(glm::dmat4(1.0), world, plan);
  camera.collect({}, plan, renderer.render(world, plan));
  for (const float value : color_of(camera).pixels) REQUIRE((std::isfinite(value) && value >= 0));
  for (const float depth_m : depth_of(camera).pixels) REQUIRE(depth_m > 0);
}

TEST_SUITE_END();
