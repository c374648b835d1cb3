// The levels of meshes that a view draws: none coarser than its dial allows, and none without the dial.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "engine/geometry/mesh_levels.h"
#include "engine/render/renderer.h"
#include "tests/engine/level_meshes.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;

namespace {

Material white() {
  Material material = test::colored({1, 1, 1, 1});
  material.unlit = true;
  return material;
}

// A ball on the optical axis.
test::RendererScene ball_at(double distance_m, double scale = 1) {
  test::RendererScene scene;
  scene.list.environment.background = glm::vec3(0);
  glm::dmat4 place = test::at(0, 0, distance_m);
  for (int axis = 0; axis < 3; ++axis) place[axis][axis] = scale;
  scene.add(test::ball_mesh(), white(), place);
  return scene;
}

constexpr std::uint32_t kView_px = 256;
constexpr double kFocal_px = 300;

FramePlan dial_plan(double max_error_px) {
  FramePlan plan = test::plan_of(kView_px, kView_px, kFocal_px, true, false);
  test::view_of(plan).max_error_px = max_error_px;
  return plan;
}

struct Drawn {
  std::vector<glm::vec4> color;
  FrameCounters counters;
  std::vector<DrawnLevel> levels;
};

Drawn draw(const DrawList& list, double max_error_px) {
  Renderer renderer(test::device());
  FramePlan plan = dial_plan(max_error_px);
  Drawn drawn{test::copy(renderer.render(list, plan)[0].color), renderer.counters(), {}};
  renderer.complete(plan);
  drawn.levels = test::view_of(plan).levels;
  return drawn;
}

}  // namespace

TEST_CASE("a view draws the coarsest level whose projected error stays below its dial") {
  const std::vector<MeshLevel> levels = make_levels(test::ball_mesh(), LevelBorders::free, {});
  const double tangent = kView_px / 2.0 / kFocal_px, skew = std::sqrt(1 + 2 * tangent * tangent);
  int coarse = 0, exact = 0;
  for (const double scale : {0.5, 1.0, 2.0}) {
    for (const double distance_m : {5.0, 20.0, 80.0}) {
      for (const double dial_px : {0.05, 0.3, 1.0, 3.0}) {
        std::uint32_t expected = 0;
        double error_px = 0;
        for (std::size_t i = 0; i < levels.size(); ++i) {
          const double moved_m = scale * levels[i].error_m;
          const double px = kFocal_px * skew * moved_m / (distance_m - scale * test::kBallRadius_m - moved_m);
          if (px >= dial_px) continue;
          expected = static_cast<std::uint32_t>(i) + 1;
          error_px = px;
        }
        const Drawn drawn = draw(ball_at(distance_m, scale).list, dial_px);
        CAPTURE(scale);
        CAPTURE(distance_m);
        CAPTURE(dial_px);
        ++(expected == 0 ? exact : coarse);
        REQUIRE(drawn.levels.size() == (expected == 0 ? 0 : 1));
        if (expected == 0) continue;
        CHECK(drawn.levels[0].level == expected);
        CHECK(drawn.levels[0].items == 1);
        CHECK(drawn.levels[0].error_px == doctest::Approx(error_px).epsilon(1e-6));
        CHECK(drawn.levels[0].triangles == levels[expected - 1].mesh->indices.size() / 3);
        CHECK(drawn.levels[0].exact_triangles == test::ball_mesh().indices.size() / 3);
      }
    }
  }
  CHECK(coarse > 10);
  CHECK(exact > 5);
}

// The outline of a ball of radius r at the distance d on the axis is a circle of f r / sqrt(d^2 - r^2) pixels.
TEST_CASE("the silhouette of a ball moves by no more than the dial") {
  int changed = 0;
  for (const double distance_m : {2.5, 4.0, 9.0}) {
    const test::RendererScene scene = ball_at(distance_m);
    const Drawn exact = draw(scene.list, 0);
    const double outline_px = kFocal_px * test::kBallRadius_m /
                              std::sqrt(distance_m * distance_m - test::kBallRadius_m * test::kBallRadius_m);
    // The exact mesh lies within the ball by its sagitta.
    const double mesh_px =
        kFocal_px * test::sagitta_m(test::kBallRadius_m, test::kBallSegments) / (distance_m - test::kBallRadius_m);
    for (const double dial_px : {0.5, 1.0, 2.0, 4.0, 8.0}) {
      const Drawn coarse = draw(scene.list, dial_px);
      for (std::uint32_t y = 0; y < kView_px; ++y) {
        for (std::uint32_t x = 0; x < kView_px; ++x) {
          const std::size_t pixel = std::size_t{y} * kView_px + x;
          const auto covered = [pixel](const Drawn& drawn) { return drawn.color[pixel].r > 0.5f; };  // white on black
          if (covered(exact) == covered(coarse)) continue;
          ++changed;
          const double from_outline_px =
              std::abs(std::hypot(x + 0.5 - kView_px / 2.0, y + 0.5 - kView_px / 2.0) - outline_px);
          CHECK(from_outline_px <= dial_px + mesh_px);
        }
      }
    }
  }
  CHECK(changed > 20);
}

TEST_CASE("a large mesh is exact where it is near and coarser where it is far, without gaps") {
  test::RendererScene scene;
  scene.list.environment.background = glm::vec3(0);
  // The mesh's y axis recedes along the optical axis, and its z axis is up.
  const glm::dmat4 ground({1, 0, 0, 0}, {0, 0, 1, 0}, {0, -1, 0, 0}, {-1, 0.5, 0.6, 1});
  scene.add(test::hills(test::kTiledCells, 6), white(), ground);
  const Drawn exact = draw(scene.list, 0), coarse = draw(scene.list, 3);
  std::uint64_t coarse_tiles = 0;
  for (const DrawnLevel& level : coarse.levels) coarse_tiles += level.items;
  CHECK(coarse_tiles > 0);
  CHECK(coarse_tiles < 16);  // the nearest tiles are exact
  CHECK(coarse.counters.triangles < exact.counters.triangles);
  for (std::uint32_t y = kView_px * 7 / 8; y < kView_px; ++y) {  // the farther edge is above
    for (std::uint32_t x = kView_px / 4; x < kView_px * 3 / 4; ++x) {
      const std::size_t pixel = std::size_t{y} * kView_px + x;
      REQUIRE(exact.color[pixel].r > 0.5f);
      CHECK(coarse.color[pixel].r > 0.5f);
    }
  }
}

TEST_CASE("without the dial nothing of levels is made, held or drawn") {
  const test::RendererScene scene = ball_at(20);
  const Drawn exact = draw(scene.list, 0), coarse = draw(scene.list, 2), hardly = draw(scene.list, 1e-6);
  CHECK(exact.counters.levels_held == 0);
  CHECK(exact.counters.meshes_held == 1);
  CHECK(exact.levels.empty());
  CHECK(coarse.counters.levels_held > 0);
  CHECK(coarse.counters.meshes_held == 1 + coarse.counters.levels_held);
  CHECK(coarse.counters.triangles < exact.counters.triangles);
  CHECK(hardly.counters.triangles == exact.counters.triangles);
  CHECK(test::same_bytes<glm::vec4>(hardly.color, exact.color));
  CHECK_FALSE(test::same_bytes<glm::vec4>(coarse.color, exact.color));
  // One renderer, one frame after the other: what is held does not reach into exact views.
  Renderer renderer(test::device());
  const auto color = [&](double dial_px) {
    return test::copy(renderer.render(scene.list, dial_plan(dial_px))[0].color);
  };
  CHECK(test::same_bytes<glm::vec4>(color(2), coarse.color));
  CHECK(test::same_bytes<glm::vec4>(color(1e-6), exact.color));
  CHECK(test::same_bytes<glm::vec4>(color(0), exact.color));
}

TEST_SUITE_END();
