// Depth images of round shapes: the bound contains the distance of the drawn mesh from the shape.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <simvis/device.h>
#include <simvis/pose.h>
#include "engine/render/renderer.h"
#include "scenegraph/primitive_meshes.h"
#include "sensors/camera/camera.h"
#include "tests/support/exact_shapes.h"
#include "tests/support/infinity.h"
#include "tests/support/measured_images.h"
#include "tests/support/random_room.h"

TEST_SUITE_BEGIN("sensors");

using namespace simvis;

namespace {

struct SeenShape {
  double depth_m = kInfinity;
  std::size_t item = 0;
};

// The nearest shape at a pixel's centre, in quadruple precision.
SeenShape shape_at(const DrawList& list, const View& view, std::int64_t x, std::int64_t y) {
  const Pinhole& k = view.pinhole;
  const glm::dvec3 ray = glm::normalize(glm::dvec3((static_cast<double>(x) + 0.5 - k.cx_px) / k.fx_px,
                                                   (static_cast<double>(y) + 0.5 - k.cy_px) / k.fy_px, 1));
  SeenShape seen;
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    const DrawItem& item = list.items[i];
    const auto hit = reference::nearest_hit(*list.meshes[item.mesh]->surface, list.world_from_node[item.transform],
                                            rigid_inverse(view.view_from_world), ray);
    const double depth_m = static_cast<double>(hit.range_m) * ray.z;
    if (depth_m < seen.depth_m) seen = {depth_m, i};
  }
  return seen;
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

}  // namespace

// Pixels whose neighbours show another shape or nothing are beside an outline.
TEST_CASE("depths of round shapes lie within the bound, which is that of the drawn mesh") {
  Device device;
  Renderer renderer(device);
  std::mt19937 random(5);
  std::size_t pixels = 0;
  double largest_m = 0;
  for (int image = 0; image < 4; ++image) {
    const DrawList list = row_of_shapes(random);
    const CameraDesc desc{.width_px = 200,
                          .height_px = 80,
                          .hfov_rad = glm::radians(80.0),
                          .near_m = 0.05,
                          .color = false,
                          .depth = true};
    Camera camera("C", desc);
    FramePlan plan;
    camera.plan(glm::dmat4(1), list, plan);
    camera.collect({}, plan, renderer.render(list, plan));
    const View& view = plan.passes[0].views[0];
    const Image depth = depth_of(camera);
    const double bound_m = requested(camera, kDepthErrorBound);
    CHECK(std::isfinite(bound_m));
    for (std::int64_t y = 1; y + 1 < depth.height; ++y) {
      for (std::int64_t x = 1; x + 1 < depth.width; ++x) {
        const SeenShape seen = shape_at(list, view, x, y);
        if (seen.depth_m == kInfinity) continue;
        bool inner = true;
        for (std::int64_t v = y - 1; v <= y + 1; ++v) {
          for (std::int64_t u = x - 1; u <= x + 1; ++u) {
            const SeenShape beside = shape_at(list, view, u, v);
            inner = inner && beside.depth_m < kInfinity && beside.item == seen.item;
          }
        }
        if (!inner) continue;
        const double error_m = std::abs(depth.pixels[static_cast<std::size_t>(y * depth.width + x)] - seen.depth_m);
        CHECK(error_m <= bound_m);
        largest_m = std::max(largest_m, error_m);
        ++pixels;
      }
    }
  }
  CHECK(pixels > 3000);
  CHECK(largest_m > 1e-4);  // much more than rounding: the mesh is not the shape
  CHECK(device.validation_messages() == 0);
}
