// Depth images and rendered scans of round shapes: the bound contains the distance of the drawn mesh from the shape.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include <simvis/device.h>
#include <simvis/pose.h>
#include "engine/render/renderer.h"
#include "scenegraph/primitive_meshes.h"
#include "sensors/camera/camera.h"
#include "sensors/camera/depth_error_bound.h"
#include "sensors/laser_scanner/laser_scanner.h"
#include "tests/support/exact_shapes.h"
#include "tests/support/infinity.h"
#include "tests/support/long_count.h"
#include "tests/support/measured_images.h"
#include "tests/support/random_room.h"
#include "tests/support/reference_directions.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

struct SeenShape {
  double range_m = kInfinity;
  std::size_t item = 0;
};

// The nearest shape along a ray, in quadruple precision.
SeenShape shape_along(const DrawList& list, const glm::dmat4& world_from_sensor, const glm::dvec3& ray) {
  SeenShape seen;
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const DrawItem& item = list.items[i];
    const auto hit = reference::nearest_hit(*list.meshes[item.mesh]->surface, list.world_from_node[item.transform],
                                            world_from_sensor, ray);
    const auto range_m = static_cast<double>(hit.range_m);
    if (range_m < seen.range_m) seen = {range_m, i};
  }
  return seen;
}

struct Pixel {
  double depth_m = kInfinity;
  std::size_t item = 0;
};

// Of all pixel centres of an image, row by row.
std::vector<Pixel> pixels_of(const DrawList& list, const View& view) {
  const Pinhole& k = view.pinhole;
  const glm::dmat4 world_from_view = rigid_inverse(view.view_from_world);
  std::vector<Pixel> pixels;
  for (std::uint32_t y = 0; y < view.height_px; ++y) {
    for (std::uint32_t x = 0; x < view.width_px; ++x) {
      const glm::dvec3 ray =
          glm::normalize(glm::dvec3((x + 0.5 - k.cx_px) / k.fx_px, (y + 0.5 - k.cy_px) / k.fy_px, 1));
      const SeenShape seen = shape_along(list, world_from_view, ray);
      pixels.push_back({seen.range_m * ray.z, seen.item});
    }
  }
  return pixels;
}

// Whether the four neighbours of a pixel show something in the image.
bool is_inside(const Image& depth, std::size_t at) {
  return std::ranges::all_of(std::array{at - 1, at + 1, at - depth.width, at + depth.width},
                             [&](std::size_t i) { return std::isfinite(depth.pixels[i]); });
}

// Whether the eight neighbours of a pixel show the same shape.
bool is_inner(const std::vector<Pixel>& pixels, std::uint32_t width, std::size_t at) {
  for (std::size_t row = at - width; row <= at + width; row += width) {
    for (std::size_t i = row - 1; i <= row + 1; ++i) {
      if (pixels[i].depth_m == kInfinity || pixels[i].item != pixels[at].item) return false;
    }
  }
  return true;
}

struct Outcome {
  std::size_t pixels = 0, beyond = 0, beams = 0, beams_beyond = 0, unbounded = 0;
  double largest_m = 0, largest_share = 0;  // of errors, and of an error of its bound
};

// Pixels whose neighbours show another shape or nothing, in truth or in the image, are beside an outline, which bounds
// of images do not cover.
void check_image(const DrawList& list, const CameraDesc& desc, Renderer& renderer, Outcome& outcome) {
  Camera camera("C", desc);
  FramePlan plan;
  camera.plan(glm::dmat4(1), list, plan);
  camera.collect({}, plan, renderer.render(list, plan));
  const Image depth = depth_of(camera);
  const std::vector<Pixel> pixels = pixels_of(list, plan.passes[0].views[0]);
  const std::vector<double> bounds_m = depth_error_bounds(depth, depth_view(plan.passes[0].views[0], list));
  outcome.unbounded += !std::isfinite(requested(camera, kDepthErrorBound));
  for (std::uint32_t y = 1; y + 1 < depth.height; ++y) {
    for (std::uint32_t x = 1; x + 1 < depth.width; ++x) {
      const std::size_t at = std::size_t{y} * depth.width + x;
      if (pixels[at].depth_m == kInfinity || !is_inner(pixels, depth.width, at) || !is_inside(depth, at)) continue;
      const double error_m = std::abs(depth.pixels[at] - pixels[at].depth_m);
      outcome.beyond += !(error_m <= bounds_m[at]);
      outcome.largest_m = std::max(outcome.largest_m, error_m);
      outcome.largest_share = std::max(outcome.largest_share, error_m / bounds_m[at]);
      ++outcome.pixels;
    }
  }
}

// Of methods that render. All beams count: bounds of beams cover outlines.
void check_scan(const DrawList& list, const LaserScannerDesc& desc, Renderer& renderer, Outcome& outcome) {
  LaserScanner scanner("S", desc);
  FramePlan plan;
  scanner.plan(glm::dmat4(1), list, plan);
  scanner.collect({}, plan, renderer.render(list, plan));
  const Scan& scan = *scanner.scan();
  for (std::uint32_t ring = 0; ring < scan.rings; ++ring) {
    for (std::uint32_t beam = 0; beam < scan.beams; ++beam) {
      const std::size_t at = std::size_t{ring} * scan.beams + beam;
      const glm::dvec3 ray = reference::beam_direction(scan.azimuth_rad[beam], scan.elevation_rad[ring]);
      const double expected_m = shape_along(list, glm::dmat4(1), ray).range_m, range_m = scan.range_m[at];
      const double error_m = expected_m == range_m ? 0 : std::abs(range_m - expected_m);
      outcome.beams_beyond += !(error_m <= scan.error_bound_m[at]);
      outcome.beams += expected_m < kInfinity;
    }
  }
}

// Shapes in a row across the view, each turned and scaled at random.
DrawList row_of_shapes(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const Mesh meshes[] = {sphere_mesh(0.4), cylinder_mesh(0.3, 0.8), cone_mesh(0.4, 0.8), capsule_mesh(0.2, 0.5)};
  DrawList list;
  for (int i = 0; i < 4; ++i) {
    Pose pose;
    pose.position_m = {3 + unit(random), 1.2 * (i - 1.5), 0.2 * unit(random)};
    pose.roll_rad = 3 * unit(random);
    pose.pitch_rad = unit(random);
    const glm::dvec3 scale(1, i % 2 == 0 ? -1 : 0.7, 1 + 0.3 * unit(random));
    add_item(list, meshes[i], glm::scale(to_matrix(pose), scale));
  }
  return list;
}

// Shapes from a millimetre to a hundred metres large, from outlines of a pixel to ones that fill the view.
DrawList shapes_of_any_size(std::mt19937& random, double& size_m) {
  std::uniform_real_distribution<double> unit(-1, 1);
  size_m = std::pow(10, -0.5 + 2.5 * unit(random));
  DrawList list;
  for (int i = 0; i < 4; ++i) {
    const double radius_m = size_m * (0.65 + 0.35 * unit(random)), length_m = size_m * (2 + 1.5 * unit(random));
    const double away_m = (radius_m + length_m) * std::pow(10, 1.2 + unit(random));
    Pose pose;
    pose.position_m = away_m * glm::normalize(glm::dvec3(1, 0.5 * unit(random), 0.3 * unit(random)));
    pose.roll_rad = 3 * unit(random);
    pose.pitch_rad = unit(random);
    const glm::dvec3 scale(1, i % 2 == 0 ? -1 : 0.7, 1 + 0.3 * unit(random));
    const Mesh meshes[] = {sphere_mesh(radius_m), cylinder_mesh(radius_m, length_m), cone_mesh(radius_m, length_m),
                           capsule_mesh(radius_m, length_m)};
    add_item(list, meshes[i], glm::scale(to_matrix(pose), scale));
  }
  return list;
}

// A shape whose outline is 4 to 14 pixels wide, in the middle of a view of 24 x 24 pixels.
DrawList shape_of_few_pixels(std::mt19937& random, const CameraDesc& camera) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const Mesh meshes[] = {sphere_mesh(0.5), cylinder_mesh(0.4, 0.6), cone_mesh(0.5, 0.8), capsule_mesh(0.3, 0.5)};
  const double focal_px = camera.pinhole.width_px / (2 * std::tan(camera.pinhole.hfov_rad / 2));
  Pose pose;
  pose.position_m.x = focal_px / (9 + 5 * unit(random));
  pose.position_m.y = 2 * unit(random) * pose.position_m.x / focal_px;
  pose.roll_rad = 3 * unit(random);
  pose.pitch_rad = 1.5 * unit(random);
  const glm::dvec3 scale(1, 0.8 + 0.4 * unit(random), 1 + 0.5 * unit(random));
  DrawList list;
  add_item(list, meshes[random() % 4], glm::scale(to_matrix(pose), scale));
  return list;
}

}  // namespace

TEST_CASE("depths of shapes that are a few pixels wide lie within the bound of their pixel") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(7);
  Outcome outcome;
  const int scenes = count_of("SIMVIS_TEST_SMALL_SHAPES", 300);
  for (int scene = 0; scene < scenes; ++scene) {
    const CameraDesc camera{
        .pinhole = {.width_px = 24, .height_px = 24, .hfov_rad = glm::radians(40.0), .near_m = 0.05},
        .color = false,
        .depth = true};
    check_image(shape_of_few_pixels(random, camera), camera, renderer, outcome);
  }
  MESSAGE(outcome.pixels << " pixels, an error up to " << outcome.largest_share << " of its bound, "
                         << outcome.unbounded << " of " << scenes << " images without a bound");
  CHECK(outcome.beyond == 0);
  CHECK(outcome.pixels > 10 * static_cast<std::size_t>(scenes));
  CHECK(outcome.unbounded == 0);
}

TEST_CASE("depths of round shapes lie within the bound, which is that of the drawn mesh") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(5);
  Outcome outcome;
  for (int image = 0; image < 4; ++image) {
    const CameraDesc desc{.pinhole = {.width_px = 200, .height_px = 80, .hfov_rad = glm::radians(80.0), .near_m = 0.05},
                          .color = false,
                          .depth = true};
    check_image(row_of_shapes(random), desc, renderer, outcome);
  }
  CHECK(outcome.beyond == 0);
  CHECK(outcome.unbounded == 0);
  CHECK(outcome.pixels > 3000);
  CHECK(outcome.largest_m > 1e-5);  // much more than rounding: the mesh is not the shape
}

TEST_CASE("depths and beams on round shapes of all sizes lie within their bounds") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(6);
  Outcome outcome;
  const int scenes = count_of("SIMVIS_TEST_ROUND_SCENES", 12);
  for (int scene = 0; scene < scenes; ++scene) {
    double size_m = 0;
    const DrawList list = shapes_of_any_size(random, size_m);
    const CameraDesc camera{.pinhole = {.width_px = scene % 2 == 0 ? 96u : 320u,
                                        .height_px = scene % 2 == 0 ? 64u : 64u,
                                        .hfov_rad = glm::radians(scene % 3 == 0 ? 40.0 : 80.0),
                                        .near_m = 0.05 * size_m},
                            .color = false,
                            .depth = true};
    check_image(list, camera, renderer, outcome);
    LaserScannerDesc scanner{.pattern = {.beams = 121,
                                         .rings = scene % 2 == 0 ? 1u : 15u,
                                         .min_azimuth_rad = -0.55,
                                         .max_azimuth_rad = 0.55,
                                         .min_elevation_rad = scene % 2 == 0 ? 0.0 : -0.3,
                                         .max_elevation_rad = scene % 2 == 0 ? 0.0 : 0.3},
                             .range_min_m = 0,
                             .range_max_m = 1e6};
    for (const ScanMethod method : {ScanMethod::nearest, ScanMethod::planar}) {
      scanner.method = method;
      check_scan(list, scanner, renderer, outcome);
    }
  }
  MESSAGE(outcome.pixels << " pixels, an error up to " << outcome.largest_share << " of its bound, "
                         << outcome.unbounded << " of " << scenes << " images without a bound; " << outcome.beams
                         << " beams");
  CHECK(outcome.beyond == 0);
  CHECK(outcome.beams_beyond == 0);
  CHECK(outcome.pixels > 500);
  CHECK(outcome.beams > 500);
}
