// The items that a pass reads back beside depth: what the ray through a pixel's centre meets.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include <simvis/ray_caster.h>
#include "tests/support/random_room.h"
#include "tests/support/ray_casting.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;
using namespace simvis::test;

namespace {

// Vertices are snapped to 1/256 of a pixel: each moves by at most half of that along each axis, so an edge moves by at
// most as much. Twice that leaves room for the rounding of positions to float32.
constexpr double kItemSnap_px = 1.0 / 256;

FramePlan items_plan(std::uint32_t width, std::uint32_t height, double f_px) {
  FramePlan plan = plan_of(width, height, f_px, false, true);
  plan.passes[0].items = true;
  view_of(plan).sees_back_faces = true;
  return plan;
}

/// The item of each of these places in the image, by exact rays; places in pixels.
std::vector<std::uint32_t> items_at(const DrawList& list, const View& view, const std::vector<glm::dvec2>& places) {
  std::vector<glm::dvec3> directions;
  for (const glm::dvec2& at_px : places) {
    const glm::dvec3 ray((at_px.x - view.pinhole.cx_px) / view.pinhole.fx_px,
                         (at_px.y - view.pinhole.cy_px) / view.pinhole.fy_px, 1);
    directions.push_back(glm::normalize(ray));
  }
  std::vector<std::uint32_t> items;
  for (const RayHit& hit : host_engine().cast(list, rigid_inverse(view.view_from_world), directions)) {
    items.push_back(std::isinf(hit.range_m) ? kNoItem : hit.item);
  }
  return items;
}

struct Compared {
  std::size_t pixels = 0, edges = 0, wrong = 0;
};

// A pixel whose item is not that of the ray counts as an edge if the item is met within kItemSnap_px of its centre.
Compared compare_items(const DrawList& list, const View& view, std::span<const std::uint32_t> drawn) {
  std::vector<glm::dvec2> centres;
  for (std::uint32_t y = 0; y < view.height_px; ++y) {
    for (std::uint32_t x = 0; x < view.width_px; ++x) centres.emplace_back(x + 0.5, y + 0.5);
  }
  Compared compared{.pixels = centres.size()};
  const std::vector<std::uint32_t> cast = items_at(list, view, centres);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    if (cast[i] == drawn[i]) continue;
    std::vector<glm::dvec2> around;
    for (int k = 0; k < 8; ++k) {
      around.push_back(centres[i] +
                       kItemSnap_px *
                           glm::dvec2(std::cos(k * std::numbers::pi / 4), std::sin(k * std::numbers::pi / 4)) *
                           std::numbers::sqrt2);
    }
    const std::vector<std::uint32_t> near = items_at(list, view, around);
    ++(std::ranges::find(near, drawn[i]) != near.end() ? compared.edges : compared.wrong);
  }
  return compared;
}

}  // namespace

TEST_CASE("each pixel has the item that its centre sees, and none where nothing is") {
  Renderer renderer(device());
  RendererScene scene;
  const std::uint32_t mesh = scene.add_mesh(rectangle(-1, -1, 0, 1)), material = scene.add_material({});
  scene.add(mesh, material, at(0, 0, 2));  // columns 0 to 15 of 32, rows 0 to 31
  scene.add(mesh, material, at(1, 0, 4));  // columns 16 to 23, rows 8 to 23
  const FramePlan plan = items_plan(32, 32, 32);
  const auto result = renderer.render(scene.list, plan)[0];
  REQUIRE(result.items.size() == 32 * 32);
  CHECK(result.color.empty());
  for (std::uint32_t y = 0; y < 32; ++y) {
    for (std::uint32_t x = 0; x < 32; ++x) {
      const bool second = x >= 16 && x < 24 && y >= 8 && y < 24;
      const std::uint32_t expected = x < 16 ? 0 : second ? 1 : kNoItem;
      CHECK(result.items[y * 32 + x] == expected);
      CHECK((result.depth[y * 32 + x] > 0) == (expected != kNoItem));
    }
  }
  // One mesh and one material: one instanced draw.
  CHECK(renderer.counters().draws == 1);
  CHECK(renderer.counters().bytes_read_back == 32 * 32 * (sizeof(float) + sizeof(std::uint32_t)));
}

TEST_CASE("items are those of exact rays, but at counted edges, and depth is that of a pass without items") {
  Renderer renderer(device());
  std::mt19937 random(3);
  Compared all;
  for (int room = 0; room < 3; ++room) {
    const DrawList list = random_room(static_cast<std::uint32_t>(room), 60, 24);
    FramePlan plan = items_plan(160, 120, 90);
    view_of(plan).view_from_world = rigid_inverse(at(0, 0, 1.2) * random_pose(random, 0.3));
    const auto result = renderer.render(list, plan)[0];
    const Compared compared = compare_items(list, view_of(plan), result.items);
    all.pixels += compared.pixels;
    all.edges += compared.edges;
    all.wrong += compared.wrong;
    const std::vector<float> depth = copy(result.depth);
    plan.passes[0].items = false;
    const auto alone = renderer.render(list, plan)[0];
    CHECK(alone.items.empty());
    CHECK(same_bytes<float>(depth, alone.depth));
  }
  CHECK(all.pixels == 3 * 160 * 120);
  CHECK(all.wrong == 0);
  MESSAGE(all.edges << " of " << all.pixels << " pixels lie on edges");
  // An edge decides wrongly in a band of 1/256 of a pixel. If every pixel had one edge, that would be 1 of 256.
  CHECK(all.edges < all.pixels / 256);
}

TEST_CASE("masked surfaces have items where they are kept, also through a strip of pixels") {
  Renderer renderer(device());
  Material leaves;
  leaves.alpha_mode = AlphaMode::mask;
  leaves.alpha_cutoff = 0.5f;
  leaves.base_color_texture = four_texels();  // alpha 0, 100, 200, 255 of 255
  RendererScene scene;
  scene.add(rectangle(-1, -1, 1, 1), leaves, at(0, 0, 1));
  scene.add(rectangle(-9, -9, 9, 9), {}, at(0, 0, 4));
  FramePlan plan = plan_of(4, 4, 2, false, true);
  plan.passes[0].items = true;
  const auto items = renderer.render(scene.list, plan)[0].items;
  for (std::uint32_t i = 0; i < 16; ++i) CHECK(items[i] == (i % 4 < 2 ? 1 : 0));

  std::mt19937 random(5);
  const DrawList list = random_room(9, 60, 24);
  for (const bool both_sides :
       {false, true}) {  // opaque triangles of strips that see both sides are drawn without items
    FramePlan strip = items_plan(320, 3, 180);
    view_of(strip).sees_back_faces = both_sides;
    view_of(strip).view_from_world = rigid_inverse(at(0, 0, 1.2) * random_pose(random, 0.3));
    const std::vector<std::uint32_t> culled = copy(renderer.render(list, strip)[0].items);
    view_of(strip).culled = false;
    CHECK(same_bytes<std::uint32_t>(culled, renderer.render(list, strip)[0].items));
    // The room is closed, and its walls show their backs.
    CHECK((std::ranges::count(culled, kNoItem) == 0) == both_sides);
    CHECK(std::ranges::any_of(culled, [](std::uint32_t item) { return item != kNoItem; }));
  }
}

TEST_CASE("a pass of colour has the items of a pass of depth, in its alpha, and no pixel and no byte more") {
  Renderer renderer(device());
  std::mt19937 random(6);
  for (int room = 0; room < 3; ++room) {
    DrawList list = random_room(static_cast<std::uint32_t>(room), 60, 24);
    // Some materials cover less, some more than half of what lies behind them, some have holes.
    for (std::size_t m = 0; m < list.materials.size(); ++m) {
      auto material = std::make_shared<Material>(*list.materials[m]);
      if (m % 4 == 1) material->opacity = 0.3f;
      if (m % 4 == 2) material->opacity = 0.7f;
      if (m % 4 == 3) {
        material->alpha_mode = AlphaMode::mask;
        material->base_color_texture = four_texels();
      }
      list.materials[m] = std::move(material);
    }
    FramePlan apart = items_plan(160, 120, 90);
    view_of(apart).sees_back_faces = false;
    view_of(apart).view_from_world = rigid_inverse(at(0, 0, 1.2) * random_pose(random, 0.3));
    const std::vector<std::uint32_t> items = copy(renderer.render(list, apart)[0].items);
    const std::vector<float> depth = copy(renderer.render(list, apart)[0].depth);
    FramePlan plan = plan_of(160, 120, 90, true, true);
    view_of(plan).view_from_world = view_of(apart).view_from_world;
    const std::vector<glm::vec4> color = copy(renderer.render(list, plan)[0].color);
    const FrameCounters without = renderer.counters();
    plan.passes[0].items = true;
    const PassResult result = renderer.render(list, plan)[0];
    CHECK(renderer.counters().bytes_read_back == without.bytes_read_back);
    CHECK(renderer.counters().draws == without.draws);
    CHECK(result.items.empty());
    CHECK(same_bytes<float>(depth, result.depth));
    REQUIRE(result.color.size() == items.size());
    std::size_t differ = 0, shown = 0;
    for (std::size_t i = 0; i < items.size(); ++i) {
      differ += result.item_of(i) != items[i];
      shown += items[i] != kNoItem;
      CHECK(glm::vec3(result.color[i]) == glm::vec3(color[i]));
      CHECK(color[i].a == 1);
      CHECK((result.color[i].a < 0) == (items[i] == kNoItem));
    }
    CHECK(differ == 0);
    CHECK(shown > 500);
  }
}

TEST_CASE("a plan without items has neither their buffers nor their pipelines") {
  Renderer renderer(device());
  const DrawList list = random_room(4, 30, 16);
  FramePlan plan = plan_of(64, 48, 40, false, true);
  const auto has_items = [&] {
    FramePlan complete = plan;
    renderer.complete(complete);
    const bool memory = std::ranges::any_of(
        complete.memory, [](const PlannedMemory& each) { return each.name.find("item") != std::string::npos; });
    const bool pipeline = std::ranges::any_of(view_of(complete).pipelines, [](const PlannedPipeline& each) {
      return each.variant.find("with items") != std::string::npos;
    });
    CHECK(memory == pipeline);
    return memory;
  };
  renderer.render(list, plan);
  const FrameCounters before = renderer.counters();
  CHECK_FALSE(has_items());
  plan.passes[0].items = true;
  renderer.render(list, plan);
  CHECK(has_items());
  CHECK(renderer.counters().triangles == before.triangles);
  CHECK(renderer.counters().bytes_read_back == before.bytes_read_back + 64 * 48 * sizeof(std::uint32_t));
}

TEST_SUITE_END();
