// Levels of round shapes: how far their meshes lie inside of the shape, which of them a view draws, and that nothing
// but the view decides it.
#include "engine/geometry/round_levels.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "engine/draw/round_mesh.h"
#include "engine/render/renderer.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

constexpr double kRadius_m = 0.5, kLength_m = 1.2;

// Each of three coordinates, below 1.2 m, is float32: half a unit in the last place of 1 m each.
constexpr double kVertex_m = 3 * 6e-8;

ExactSurface shape_of(SurfaceKind kind, int axis = 2) {
  return {.kind = kind, .axis = axis, .radius_m = kRadius_m, .length_m = kind == SurfaceKind::sphere ? 0.0 : kLength_m};
}

// The distance of a point from the shape along z, or from its round side if that is farther: negative inside.
double outside(const ExactSurface& shape, const glm::dvec3& p) {
  const double half = shape.length_m / 2, out = std::hypot(p.x, p.y);
  switch (shape.kind) {
    case SurfaceKind::sphere:
      return glm::length(p) - shape.radius_m;
    case SurfaceKind::capsule:
      return std::hypot(out, std::max(std::abs(p.z) - half, 0.0)) - shape.radius_m;
    case SurfaceKind::cylinder:
      return std::max(out - shape.radius_m, std::abs(p.z) - half);
    default: {
      const double slant = std::hypot(shape.radius_m, shape.length_m);
      return std::max((out - shape.radius_m * (half - p.z) / shape.length_m) * shape.length_m / slant, -half - p.z);
    }
  }
}

struct Depths {
  double most_outside_m = -1, deepest_m = 0;
};

// At 66 points of each triangle; `axis` is turned to z.
Depths depths_of(const Mesh& mesh, int axis) {
  constexpr int kSteps = 10;
  Depths depths;
  for (std::size_t t = 0; t < mesh.indices.size(); t += 3) {
    const auto corner = [&](std::size_t k) {
      const glm::dvec3 p(mesh.positions[mesh.indices[t + k]]);
      return glm::dvec3(p[(axis + 1) % 3], p[(axis + 2) % 3], p[axis]);
    };
    for (int a = 0; a <= kSteps; ++a) {
      for (int b = 0; a + b <= kSteps; ++b) {
        const glm::dvec3 p =
            (double(a) * corner(0) + double(b) * corner(1) + double(kSteps - a - b) * corner(2)) / double(kSteps);
        const double out_m = outside(*mesh.surface, p);
        depths.most_outside_m = std::max(depths.most_outside_m, out_m);
        depths.deepest_m = std::max(depths.deepest_m, -out_m);
      }
    }
  }
  return depths;
}

constexpr int kFinestSphere = 120;

constexpr std::uint32_t kView_px = 256;
constexpr double kFocal_px = 300;

FramePlan plan_with(double max_error_px) {
  FramePlan plan = test::plan_of(kView_px, kView_px, kFocal_px, true, false);
  test::view_of(plan).max_error_px = max_error_px;
  test::view_of(plan).culled = false;  // all triangles of what is drawn count
  return plan;
}

Material matte() { return test::colored({0.8f, 0.6f, 0.4f, 1}); }

test::RendererScene sphere_at(double distance_m) {
  test::RendererScene scene;
  scene.add(round_mesh(shape_of(SurfaceKind::sphere), kSidesAround), matte(), test::at(0, 0, distance_m));
  return scene;
}

// n sides around and n / 2 rows, of which the two at the poles are triangles.
std::uint64_t triangles_of_sphere(int sides) {
  return static_cast<std::uint64_t>(sides) * static_cast<std::uint64_t>(sides - 2);
}

// The coarsest sphere that deviates by less than `limit_px`, seen under the steepest angle of the view from its nearest
// point, by the deviation of a quad's diagonal.
int sides_for(double distance_m, double limit_px) {
  const double slant = std::sqrt(1 + 2 * std::pow(kView_px / 2.0 / kFocal_px, 2));
  for (const int sides : kRoundSides) {
    const double inside_m = kRadius_m * (1 - std::sqrt(std::cos(2 * std::acos(-1.0) / sides)));
    const double nearest_m = distance_m - kRadius_m - inside_m;
    if (sides == kFinestSphere) break;
    if (nearest_m > 0.05 && kFocal_px * slant * inside_m / nearest_m < limit_px) return sides;
  }
  return kFinestSphere;
}

}  // namespace

TEST_CASE("the meshes of round shapes lie inside of the shape, within the stated deviation") {
  for (const SurfaceKind kind : {SurfaceKind::sphere, SurfaceKind::cylinder, SurfaceKind::cone, SurfaceKind::capsule}) {
    for (const int sides : {8, 12, 44, 120}) {
      for (const int axis : {0, 1, 2}) {
        CAPTURE(sides);
        CAPTURE(axis);
        const Mesh mesh = round_mesh(shape_of(kind, axis), sides);
        const Depths depths = depths_of(mesh, axis);
        CHECK(depths.most_outside_m <= kVertex_m);
        // Points of an end are as deep below the round side as they are far from it.
        if (kind == SurfaceKind::sphere || kind == SurfaceKind::capsule) {
          CHECK(depths.deepest_m <= mesh.surface->deviation_m);
          CHECK(depths.deepest_m > 0.8 * mesh.surface->deviation_m - kVertex_m);
        }
        CHECK(mesh.surface->axis == axis);
      }
    }
  }
}

TEST_CASE("a view draws a sphere with as many sides as its picture needs") {
  Renderer renderer(test::device());
  int least = std::numeric_limits<int>::max(), most = 0;
  for (const double distance_m : {0.52, 0.8, 1.5, 3.0, 6.0, 12.0, 25.0, 50.0, 100.0, 400.0}) {
    const int sides = sides_for(distance_m, kRoundError_px);
    const test::RendererScene scene = sphere_at(distance_m);
    const FramePlan plan = plan_with(0);
    renderer.render(scene.list, plan);
    CAPTURE(distance_m);
    CHECK(renderer.counters().triangles == triangles_of_sphere(sides));
    least = std::min(least, sides);
    most = std::max(most, sides);
  }
  CHECK(least == 8);
  CHECK(most == kFinestSphere);
}

TEST_CASE("what a view draws depends neither on earlier frames nor on other views") {
  const test::RendererScene near = sphere_at(1.2), far = sphere_at(60);
  const auto alone = [](const test::RendererScene& scene) {
    Renderer renderer(test::device());
    const FramePlan plan = plan_with(0);
    return test::copy(renderer.render(scene.list, plan)[0].color);
  };
  const std::vector<glm::vec4> near_alone = alone(near), far_alone = alone(far);
  Renderer renderer(test::device());
  const FramePlan plan = plan_with(0);
  for (const bool is_near : {false, true, true, false, true}) {
    const auto color = test::copy(renderer.render(is_near ? near.list : far.list, plan)[0].color);
    CHECK(test::same_bytes<glm::vec4>(color, is_near ? near_alone : far_alone));
  }
  // Two passes see one sphere from near and from far.
  FramePlan both = plan_with(0);
  both.passes.push_back(both.passes[0]);
  both.passes[1].views[0].view_from_world = test::at(0, 0, 60 - 1.2);
  const auto results = renderer.render(near.list, both);
  CHECK(test::same_bytes<glm::vec4>(test::copy(results[0].color), near_alone));
  CHECK(results[0].views[0].triangles == triangles_of_sphere(sides_for(1.2, kRoundError_px)));
  CHECK(results[1].views[0].triangles == triangles_of_sphere(sides_for(60, kRoundError_px)));
}

// Near and far spheres take turns in the queue, which sorts alike items by their places.
TEST_CASE("spheres at one level share a draw") {
  test::RendererScene scene;
  const std::uint32_t mesh = scene.add_mesh(round_mesh(shape_of(SurfaceKind::sphere), kSidesAround)),
                      material = scene.add_material(matte());
  for (int i = 0; i < 40; ++i) scene.add(mesh, material, test::at(0.01 * i, 0, i % 2 == 0 ? 3 : 60));
  Renderer renderer(test::device());
  const FramePlan plan = plan_with(0);
  const auto results = renderer.render(scene.list, plan);
  CHECK(results[0].views[0].draws == 2);
  CHECK(results[0].views[0].triangles ==
        20 * (triangles_of_sphere(sides_for(3, kRoundError_px)) + triangles_of_sphere(sides_for(60, kRoundError_px))));
}

TEST_CASE("only the levels that views draw are held") {
  Renderer renderer(test::device());
  const FramePlan plan = plan_with(0);
  const test::RendererScene scene = sphere_at(60);
  renderer.render(scene.list, plan);
  CHECK(renderer.counters().meshes_held == 2);  // the mesh of the list, and the coarse one
  const std::uint64_t uploaded = renderer.counters().bytes_uploaded;
  renderer.render(scene.list, plan);
  CHECK(renderer.counters().meshes_held == 2);
  CHECK(renderer.counters().bytes_uploaded < uploaded);
  test::RendererScene flat;
  flat.add(test::rectangle(-1, -1, 1, 1), matte(), test::at(0, 0, 3));
  renderer.render(flat.list, plan);
  CHECK(renderer.counters().meshes_held == 1);
}

TEST_CASE("the dial of a view includes the deviation of round shapes") {
  Renderer renderer(test::device());
  for (const double limit_px : {0.02, 0.5, 3.0}) {
    FramePlan plan = plan_with(limit_px);
    const test::RendererScene scene = sphere_at(20);
    renderer.render(scene.list, plan);
    const int sides = sides_for(20, limit_px);
    CHECK(renderer.counters().triangles == triangles_of_sphere(sides));
    renderer.complete(plan);
    const std::vector<DrawnLevel>& levels = test::view_of(plan).levels;
    REQUIRE(levels.size() == (sides < kSidesAround ? 1 : 0));
    if (levels.empty()) continue;
    CHECK(levels[0].items == 1);
    CHECK(levels[0].triangles == triangles_of_sphere(sides));
    CHECK(levels[0].exact_triangles == triangles_of_sphere(kSidesAround));
    CHECK(levels[0].error_px < limit_px);
  }
  // The finest mesh is not fine enough, and the view says so.
  FramePlan plan = plan_with(0.1);
  const test::RendererScene scene = sphere_at(0.6);
  renderer.render(scene.list, plan);
  renderer.complete(plan);
  REQUIRE(test::view_of(plan).levels.size() == 1);
  CHECK(test::view_of(plan).levels[0].level == 0);
  CHECK(test::view_of(plan).levels[0].error_px >= 0.1);
}

TEST_SUITE_END();
