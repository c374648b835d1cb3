// Shadow maps are drawn again only where their casters, their light or their place have changed.
#include <doctest/doctest.h>

#include <random>
#include <vector>

#include "effects/scene/shadows.h"
#include "scenegraph/primitive_meshes.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("effects");

namespace simvis::test {
namespace {

constexpr std::uint64_t kCubeSides = 6;

// A wall at z = 6 with two boxes before it, lit by a lamp with shadows beside the camera. Both boxes and the wall lie
// on one side of the lamp's cube; other sides are empty.
struct LitBoxes {
  RendererScene scene = scene_with_ambient(0.25);
  std::uint32_t moving = 0;  // transform of a box
  std::uint32_t shadow_px = 64;

  LitBoxes() {
    scene.add(rectangle(-5, -5, 5, 5), colored({1, 1, 1, 1}), at(0, 0, 6));
    scene.add(box_mesh(glm::dvec3(1)), colored({1, 1, 1, 1}), at(-1.5, 0, 4));
    moving = scene.add_transform(at(1.5, 0, 4));
    scene.list.items.push_back(
        {scene.add_mesh(box_mesh(glm::dvec3(1))), scene.add_material(colored({1, 0, 0, 1})), moving});
    scene.add_light({.kind = LightKind::point, .intensity = 40, .shadow_px = shadow_px}, at(0.5, 0.5, 0));
  }

  FramePlan plan(std::uint32_t width_px = 64) const {
    FramePlan made = plan_of(width_px, 64, 32, true, false);
    plan_shadows(scene.list, device().target_limits(), made);
    return made;
  }
};

std::vector<glm::vec4> picture(Renderer& renderer, const LitBoxes& world, const FramePlan& plan) {
  return copy(renderer.render(world.scene.list, plan)[0].color);
}

std::vector<glm::vec4> picture_anew(const LitBoxes& world, const FramePlan& plan) {
  Renderer renderer(device());
  return picture(renderer, world, plan);
}

TEST_CASE("a still scene draws its shadow maps once and compiles nothing in its second frame") {
  LitBoxes world;
  Renderer renderer(device());
  const std::vector<glm::vec4> first = picture(renderer, world, world.plan());
  CHECK(renderer.counters().shadow_maps == kCubeSides);
  const std::uint64_t passes = renderer.counters().passes;
  CHECK(picture(renderer, world, world.plan()) == first);
  CHECK(renderer.counters().shadow_maps == 0);
  CHECK(renderer.counters().pipelines_made == 0);
  CHECK(renderer.counters().passes == passes - 1);
}

TEST_CASE("a moving camera keeps the maps, and a moving caster draws the sides that it stands in") {
  LitBoxes world;
  Renderer renderer(device());
  picture(renderer, world, world.plan());
  FramePlan aside = world.plan();
  view_of(aside).view_from_world = at(-0.25, 0, 0);
  aside.passes.resize(1);
  view_of(aside).shadows.clear();
  plan_shadows(world.scene.list, device().target_limits(), aside);
  CHECK(picture(renderer, world, aside) == picture_anew(world, aside));
  CHECK(renderer.counters().shadow_maps == 0);

  const std::vector<glm::vec4> before = picture(renderer, world, world.plan());
  world.scene.list.world_from_node[world.moving] = at(1, 0.5, 3.5);
  const std::vector<glm::vec4> after = picture(renderer, world, world.plan());
  CHECK(renderer.counters().shadow_maps > 0);
  CHECK(renderer.counters().shadow_maps < kCubeSides);
  CHECK(after != before);
  CHECK(after == picture_anew(world, world.plan()));
}

TEST_CASE("where a caster moves, only the casters that reach its texels are drawn") {
  LitBoxes world;
  world.scene.add(box_mesh(glm::dvec3(0.25)), colored({0, 1, 0, 1}), at(0, 3, 4));
  const auto draws_of_maps = [&](Renderer& renderer) {
    const std::vector<glm::vec4> now = picture(renderer, world, world.plan());
    const std::uint64_t draws = renderer.counters().draws;
    CHECK(picture(renderer, world, world.plan()) == now);
    CHECK(renderer.counters().shadow_maps == 0);
    CHECK(now == picture_anew(world, world.plan()));
    return draws - renderer.counters().draws;
  };
  Renderer renderer(device());
  const std::uint64_t all = draws_of_maps(renderer);
  world.scene.list.world_from_node[world.moving] = at(1.5, 0.125, 4);
  const std::uint64_t some = draws_of_maps(renderer);
  // Of the side with both boxes, the wall and the small box, only the wall and the moving box.
  CHECK(some == 2);
  CHECK(all > some);
}

TEST_CASE("casters that move at random, appear and come before the light leave the maps of a first frame") {
  LitBoxes world;
  std::vector<std::uint32_t> transforms;
  std::mt19937 random(22);
  std::uniform_real_distribution<double> place(-4, 4);
  const auto anywhere = [&] { return at(place(random), place(random), place(random)); };
  for (int i = 0; i < 6; ++i) {
    transforms.push_back(world.scene.add_transform(anywhere()));
    world.scene.list.items.push_back({world.scene.add_mesh(box_mesh(glm::dvec3(0.25 + 0.25 * i))),
                                      world.scene.add_material(colored({1, 1, 0, 1})), transforms.back()});
  }
  Renderer renderer(device());
  std::uint64_t partly = 0;
  for (std::size_t frame = 0; frame < 24; ++frame) {
    CAPTURE(frame);
    if (frame > 0) world.scene.list.world_from_node[transforms[frame % transforms.size()]] = anywhere();
    CHECK(picture(renderer, world, world.plan()) == picture_anew(world, world.plan()));
    partly += renderer.counters().shadow_maps > 0 && renderer.counters().shadow_maps < kCubeSides;
  }
  CHECK(partly > 0);
}

TEST_CASE("a moved light and a changed mesh draw all maps") {
  LitBoxes world;
  Renderer renderer(device());
  picture(renderer, world, world.plan());
  world.scene.list.world_from_node[world.scene.list.lights[0].transform] = at(0.25, 0.5, 0);
  CHECK(picture(renderer, world, world.plan()) == picture_anew(world, world.plan()));
  CHECK(renderer.counters().shadow_maps > 0);

  DrawItem& box = world.scene.list.items.back();
  box.mesh = world.scene.add_mesh(box_mesh(glm::dvec3(0.5)));
  CHECK(picture(renderer, world, world.plan()) == picture_anew(world, world.plan()));
  CHECK(renderer.counters().shadow_maps == kCubeSides);
}

TEST_CASE("frames without shadows and with an atlas of another size lose nothing") {
  LitBoxes small, large;
  for (LightItem& item : large.scene.list.lights) item.light.shadow_px = 128;
  const std::vector<glm::vec4> small_picture = picture_anew(small, small.plan()),
                               large_picture = picture_anew(large, large.plan());
  FramePlan unlit = plan_of(64, 64, 32, false, true);
  Renderer renderer(device());
  for (int round = 0; round < 2; ++round) {
    CHECK(picture(renderer, small, small.plan()) == small_picture);
    renderer.render(small.scene.list, unlit);
    CHECK(picture(renderer, small, small.plan()) == small_picture);
    CHECK(renderer.counters().shadow_maps == 0);
    CHECK(picture(renderer, large, large.plan()) == large_picture);
  }
}

}  // namespace
}  // namespace simvis::test

TEST_SUITE_END();
