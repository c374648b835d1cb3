// Round shapes and planes without end: what is measured is the shape, not the flat sides that are drawn.
#include <doctest/doctest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>
#include <string>
#include <utility>

#include <simvis/pose.h>
#include "engine/draw/solid_cloud.h"
#include "scenegraph/primitive_meshes.h"
#include "tests/hard_cases/hard_case.h"
#include "tests/support/exact_shapes.h"
#include "tests/support/infinity.h"
#include "tests/support/random_room.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("hard_cases");

using namespace simvis;

namespace {

glm::dmat4 placed_at(const glm::dvec3& place) { return glm::translate(glm::dmat4(1.0), place); }

/// The nearest disc of a cloud in quadruple precision.
reference::Quad nearest_disc(const Mesh& cloud, const reference::MeshRay& ray) {
  reference::Quad nearest_m = kInfinity;
  for (const std::uint32_t vertex : cloud.indices) {
    const glm::dvec3 middle(cloud.positions[vertex]), normal(cloud.attributes[vertex].normal);
    nearest_m = std::min(nearest_m, reference::range_to_disc(ray, middle, normal, cloud.surface->radius_m));
  }
  return nearest_m;
}

/// The nearest shape of a world in quadruple precision.
ClosedForm nearest_shape(const DrawList& world, const glm::dmat4& world_from_sensor) {
  return [&world, world_from_sensor](const glm::dvec3& direction) {
    reference::Quad nearest_m = kInfinity;
    for (const DrawItem& item : world.items) {
      const Mesh& mesh = *world.meshes[item.mesh];
      const reference::MeshRay ray =
          reference::ray_in_mesh(world.world_from_node[item.transform], world_from_sensor, direction);
      nearest_m =
          std::min(nearest_m, is_cloud_of_discs(mesh) ? nearest_disc(mesh, ray)
                                                      : reference::ShapeRay(*mesh.surface, ray).nearest().range_m);
    }
    return static_cast<double>(nearest_m);
  };
}

ScanPattern rings_ahead(double half_width_rad, double half_height_rad) {
  return {.beams = 241,
          .rings = 25,
          .min_azimuth_rad = -half_width_rad,
          .max_azimuth_rad = half_width_rad,
          .min_elevation_rad = -half_height_rad,
          .max_elevation_rad = half_height_rad};
}

/// A wall without end that faces back along x.
void add_wall(DrawList& world, double distance_m) {
  const glm::dmat4 turned = matrix_from_degrees({0, 0, 0}, 0, -90, 0);
  add_item(world, endless_plane_mesh({kInfinity, kInfinity}), placed_at({distance_m, 0, 0}) * turned);
}

HardResults measure_shapes(HardCase& hard) {
  hard.truth = nearest_shape(hard.world, hard.world_from_sensor);
  return measure(hard);
}

}  // namespace

TEST_CASE("shapes before a wall without end") {
  for (const auto& [name, mesh] : {std::pair{"a sphere", sphere_mesh(0.5)},
                                   {"a cylinder", cylinder_mesh(0.4, 0.9)},
                                   {"a cone", cone_mesh(0.5, 1.1)},
                                   {"a capsule", capsule_mesh(0.3, 0.6)}}) {
    HardCase hard{.name = std::string(name) + " of about 1 m, 3 m away before a wall"};
    add_item(hard.world, mesh, matrix_from_degrees({3, 0.1, 0.05}, 20, 30, 40));
    add_wall(hard.world, 5);
    hard.scanner.pattern = rings_ahead(0.3, 0.3);
    measure_shapes(hard);
  }
}

// Every beam is within 10^-3 of the angle under which the outline is seen.
TEST_CASE("beams that graze the outline of a sphere") {
  HardCase hard{.name = "beams within 1e-3 of the outline of a sphere before a wall"};
  const double radius_m = 0.5, distance_m = 3, outline_rad = std::asin(radius_m / distance_m);
  add_item(hard.world, sphere_mesh(radius_m), placed_at({distance_m, 0, 0}));
  add_wall(hard.world, 5);
  hard.scanner.pattern = {.beams = 1001,
                          .rings = 1,
                          .min_azimuth_rad = outline_rad * (1 - 1e-3),
                          .max_azimuth_rad = outline_rad * (1 + 1e-3)};
  const HardResults results = measure_shapes(hard);
  const auto& ranges_m = results.raycast.scan.range_m;
  CHECK(ranges_m[0] < distance_m);
  CHECK(ranges_m[1000] > distance_m);
}

TEST_CASE("a sensor inside of shapes, and between nested ones") {
  const ScanPattern around{.beams = 181,
                           .rings = 21,
                           .min_azimuth_rad = -std::numbers::pi,
                           .max_azimuth_rad = std::numbers::pi,
                           .min_elevation_rad = -0.8,
                           .max_elevation_rad = 0.8};
  HardCase inside{.name = "inside of a sphere, off its middle", .world_from_sensor = placed_at({0.7, 0.5, -0.2})};
  add_item(inside.world, sphere_mesh(1), glm::dmat4(1));
  inside.scanner.pattern = around;
  measure_shapes(inside);

  HardCase nested{.name = "between five nested spheres", .world_from_sensor = placed_at({0.05, 0.02, 1.25})};
  for (const double radius_m : {0.5, 1.0, 1.5, 1.5000001, 2.0}) {
    add_item(nested.world, sphere_mesh(radius_m), glm::dmat4(1));
  }
  nested.scanner.pattern = around;
  measure_shapes(nested);

  HardCase pipe{.name = "in a pipe of 1 m, 200 m long", .world_from_sensor = placed_at({0, 0.3, 0.1})};
  add_item(pipe.world, cylinder_mesh(1, 200), matrix_from_degrees({80, 0, 0}, 0, 90, 0));
  pipe.scanner.pattern = around;
  pipe.scanner.range_max_m = 300;
  measure_shapes(pipe);
}

TEST_CASE("tiny and huge shapes, and shapes far away") {
  HardCase tiny{.name = "a sphere of 1 um before a wall, 2 mm away"};
  add_item(tiny.world, sphere_mesh(1e-6), placed_at({2e-3, 0, 0}));
  add_wall(tiny.world, 4e-3);
  tiny.scanner.pattern = rings_ahead(7e-4, 7e-4);
  tiny.scanner.range_min_m = 0;
  tiny.narrow = true;  // a pixel is 1.5 mrad
  measure_shapes(tiny);

  HardCase huge{.name = "a sphere of 10^7 m, 2 m below", .world_from_sensor = placed_at({0, 0, 1e7 + 2})};
  add_item(huge.world, sphere_mesh(1e7), glm::dmat4(1));
  huge.scanner.pattern = {.beams = 61,
                          .rings = 40,
                          .min_azimuth_rad = -0.4,
                          .max_azimuth_rad = 0.4,
                          .min_elevation_rad = -1.2,
                          .max_elevation_rad = 0.01};
  huge.scanner.range_max_m = 1e6;
  measure_shapes(huge);

  for (const double offset_m : {0.0, 1e7}) {
    const glm::dvec3 offset = offset_m * glm::dvec3(1, -0.6875, 0.0625);
    HardCase far{
        .name = "a sphere before a wall, " + std::to_string(static_cast<long>(offset_m)) + " m from the world's origin",
        .world_from_sensor = placed_at(offset)};
    add_item(far.world, sphere_mesh(0.5), placed_at(offset + glm::dvec3(3, 0.125, 0.0625)));
    add_item(far.world, endless_plane_mesh({kInfinity, kInfinity}),
             placed_at(offset + glm::dvec3(5, 0, 0)) * matrix_from_degrees({0, 0, 0}, 0, -90, 0));
    far.scanner.pattern = rings_ahead(0.3, 0.3);
    measure_shapes(far);
  }
}

TEST_CASE("different scales along different axes, and mirrors") {
  for (const auto& [name, scale] : {std::pair{"(1, 0.1, 2)", glm::dvec3(1, 0.1, 2)},
                                    {"(0.001, 1, 1)", glm::dvec3(1e-3, 1, 1)},
                                    {"(-1, 1, 0.5)", glm::dvec3(-1, 1, 0.5)}}) {
    for (const auto& [shape, mesh] : {std::pair{"a sphere", sphere_mesh(0.5)}, {"a cone", cone_mesh(0.5, 1)}}) {
      HardCase hard{.name = std::string(shape) + " scaled by " + name};
      add_item(hard.world, mesh, glm::scale(matrix_from_degrees({3, 0, 0}, 10, 20, 30), scale));
      add_wall(hard.world, 5);
      hard.scanner.pattern = rings_ahead(0.35, 0.35);
      measure_shapes(hard);
    }
  }
}

TEST_CASE("discs of a cloud, from such that face the scanner to such that it sees along") {
  for (const auto& [name, scale] : {std::pair{"as they are", glm::dvec3(1)}, {"mirrored", {1, -1, 2}}}) {
    HardCase hard{.name = std::string("discs at 0 to 89.99 degrees before a wall, ") + name};
    Mesh cloud;
    cloud.topology = Topology::points;
    cloud.surface = ExactSurface{.kind = SurfaceKind::disc, .radius_m = 0.1};
    for (std::uint32_t i = 0; i < 25; ++i) {
      const float y = 0.4f * (static_cast<float>(i % 5) - 2), z = 0.4f * (static_cast<float>(i / 5) - 2);
      cloud.positions.emplace_back(3, y, z);
      // The angle between the normal and the beam to the middle.
      const double angle = i < 9 ? 10.0 * i : 90 - std::pow(10, -0.125 * (i - 8));
      const glm::dvec3 beam = glm::normalize(glm::dvec3(3, y, z)),
                       aside = glm::normalize(glm::cross(beam, glm::dvec3(0.3, 0.2, 1)));
      const double turned = angle * std::numbers::pi / 180;
      cloud.attributes.push_back({.normal = glm::vec3(std::cos(turned) * beam + std::sin(turned) * aside)});
      cloud.indices.push_back(i);
    }
    compute_bounds(cloud);
    add_item(hard.world, cloud, glm::scale(glm::dmat4(1), scale));
    add_wall(hard.world, 5);
    hard.scanner.pattern = rings_ahead(0.3, 0.3);
    measure_shapes(hard);
  }
}

// The drawn part ends 50 m away; the ground does not.
TEST_CASE("a ground without end, to its horizon") {
  HardCase hard{.name = "a ground without end, 1 m below, to 5 km", .world_from_sensor = placed_at({0, 0, 1})};
  add_item(hard.world, endless_plane_mesh({kInfinity, kInfinity}), glm::dmat4(1));
  hard.scanner.range_max_m = 5000;
  hard.scanner.pattern = {.beams = 61,
                          .rings = 64,
                          .min_azimuth_rad = -3,
                          .max_azimuth_rad = 3,
                          .min_elevation_rad = -0.5,
                          .max_elevation_rad = -2.5e-4};
  const HardResults results = measure_shapes(hard);
  CHECK(results.raycast.scan.range_m.back() > 3900);
}
