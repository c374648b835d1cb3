#include <doctest/doctest.h>

#include <simvis/error.h>
#include "engine/vulkan/device_impl.h"
#include "shaders/interop.h"
#include "tests/support/renderer_scene.h"
#include "tests/support/tested_build.h"

TEST_SUITE_BEGIN("engine");

using namespace simvis;
using namespace simvis::test;

TEST_CASE("only content that a pass can show is uploaded, and only once") {
  Renderer renderer(device());
  auto large = std::make_shared<Texture>();
  large->name = "large";
  large->width = large->height = 64;
  large->rgba.resize(64 * 64 * 4, 200);
  Material painted, plain;
  painted.base_color_texture = large;
  RendererScene scene = scene_with_ambient(1);
  scene.add(rectangle(-1, -1, 1, 1), painted, at(0, 0, 2));
  scene.add(rectangle(-1, -1, 1, 1), plain, at(0, 0, 3));
  constexpr std::uint64_t kPositions = 2 * (4 * 12 + 6 * 4), kAttributes = 2 * 4 * 32,
                          kInstances = 2 * sizeof(shader::Instance);
  constexpr std::uint64_t kMaterials = 2 * sizeof(shader::MaterialBlock);
  constexpr std::uint64_t kTexture = 4 * (64 * 64 + 32 * 32 + 16 * 16 + 8 * 8 + 4 * 4 + 2 * 2 + 1);  // all levels

  renderer.render(scene.list, wall_plan(false, true));
  CHECK(renderer.counters().bytes_uploaded == kPositions + kInstances);
  renderer.render(scene.list, wall_plan(false, true));
  CHECK(renderer.counters().bytes_uploaded == kInstances);
  renderer.render(scene.list, wall_plan(true, false));
  CHECK(renderer.counters().bytes_uploaded == kAttributes + kInstances + kMaterials + kTexture);
  renderer.render(scene.list, wall_plan(true, false));
  CHECK(renderer.counters().bytes_uploaded == kInstances);
  renderer.render(scene.list, wall_plan(false, true));
  CHECK(renderer.counters().bytes_uploaded == kInstances);
  CHECK(renderer.counters().draws == 2);
}

TEST_CASE("a changed material uploads its slot only") {
  Renderer renderer(device());
  RendererScene scene = scene_with_ambient(1);
  auto material = std::make_shared<Material>(colored({0.5f, 0.5f, 0.5f, 1}));
  scene.add(rectangle(-1, -1, 1, 1), {}, at(0, 0, 1));
  scene.list.materials[0] = material;
  scene.add(rectangle(-1, -1, 1, 1), {}, at(0, 0, 4));
  CHECK(renderer.render(scene.list, wall_plan(true, false))[0].color[5].r == 0.5f);
  material->base_color.r = 0.75f;
  ++scene.list.material_revision[0];
  ++scene.list.revisions.materials;
  CHECK(renderer.render(scene.list, wall_plan(true, false))[0].color[5].r == 0.75f);
  CHECK(renderer.counters().bytes_uploaded == 2 * sizeof(shader::Instance) + sizeof(shader::MaterialBlock));
  // A change of kind takes effect too.
  material->alpha_mode = AlphaMode::blend;
  material->base_color.a = 0;
  ++scene.list.material_revision[0];
  CHECK(renderer.render(scene.list, wall_plan(true, false))[0].color[5].r == 1);
}

TEST_CASE("staging copies give the same result as direct writes to device memory") {
  std::vector<std::vector<glm::vec4>> seen;
  for (const bool direct : {true, false}) {
    Device own({.select = "", .validation = false, .cache_dir = tested_build() + "/test_cache"});
    if (direct && !own.impl().direct_upload) MESSAGE("this device has no way but staging copies");
    own.impl().direct_upload = own.impl().direct_upload && direct;
    Renderer renderer(own);
    Material material;
    material.base_color_texture = four_texels();
    RendererScene scene = textured_wall(material);
    std::vector<glm::vec4> pixels;
    // In the second round the buffers grow while they hold unchanged content.
    for (const int extra : {0, 5000}) {
      Mesh mesh = rectangle(-0.5f, -0.5f, 0.5f, 0.5f);
      mesh.positions.resize(mesh.positions.size() + extra);
      mesh.attributes.resize(mesh.positions.size());
      scene.add(mesh, colored({0.5f, 0.25f, 0.125f, 1}), at(0.25 * (extra > 0), 0, 0.75));
      const auto color = renderer.render(scene.list, wall_plan(true, false))[0].color;
      pixels.insert(pixels.end(), color.begin(), color.end());
    }
    seen.push_back(pixels);
  }
  CHECK(seen[0] == seen[1]);
  CHECK(seen[0][5] == glm::vec4(0.5f, 0.25f, 0.125f, 1));
}

TEST_CASE("lists of different origin are distinguished") {
  Renderer renderer(device());
  for (const float grey : {0.25f, 0.5f, 0.75f}) {
    RendererScene scene = scene_with_ambient(1);
    scene.add(rectangle(-1, -1, 1, 1), colored({grey, grey, grey, 1}), at(0, 0, 1));
    CHECK(renderer.render(scene.list, wall_plan(true, false))[0].color[5].r == grey);
  }
}

TEST_CASE("a texture that is too large is the user's error, and the renderer still works") {
  Renderer renderer(device());
  auto wide = std::make_shared<Texture>();
  wide->name = "WIDE";
  wide->width = 1u << 18;
  wide->height = 1;
  wide->rgba.resize(std::size_t{4} << 18, 255);
  Material material;
  material.base_color_texture = wide;
  const RendererScene scene = textured_wall(material);
  CHECK_THROWS_WITH_AS(renderer.render(scene.list, wall_plan(true, false)), doctest::Contains("WIDE"), InputError);
  const RendererScene plain = textured_wall(colored({0.5f, 0.5f, 0.5f, 1}));
  CHECK(renderer.render(plain.list, wall_plan(true, false))[0].color[5].r == 0.5f);
  CHECK(renderer.render(scene.list, wall_plan(false, true))[0].depth[5] > 0);
}

TEST_CASE("passes of one plan have separate results") {
  Renderer renderer(device());
  RendererScene scene = scene_with_ambient(1);
  scene.add(rectangle(-9, -9, 9, 9), colored({0.5f, 0.5f, 0.5f, 1}), at(0, 0, 2));
  FramePlan plan = wall_plan(true, true);
  plan.passes.push_back(plan.passes[0]);
  plan.passes[1].views[0].view_from_world = at(0, 0, 2);
  plan.passes.push_back(wall_plan(false, true).passes[0]);
  plan.passes[2].views[0].view_from_world = at(0, 0, 3);
  const auto results = renderer.render(scene.list, plan);
  REQUIRE(results.size() == 3);
  for (int i = 0; i < 3; ++i)
    CHECK(results[i].depth[0] == doctest::Approx(0.05 / (i < 2 ? 2 + 2 * i : 5)).epsilon(1e-6));
  CHECK(results[1].color[0].r == 0.5f);
  CHECK(results[2].color.empty());
  CHECK(renderer.counters().passes == 3);
}

TEST_CASE("a transform that becomes mirrored reverses the winding") {
  Renderer renderer(device());
  RendererScene scene = scene_with_ambient(1);
  scene.add(rectangle(-1, -1, 1, 1), {}, at(0, 0, 1));
  CHECK(renderer.render(scene.list, wall_plan(false, true))[0].depth[5] > 0);
  scene.list.world_from_node[1][0].x = -1;
  ++scene.list.revisions.transforms;
  CHECK(renderer.render(scene.list, wall_plan(false, true))[0].depth[5] > 0);
}

TEST_CASE("each item shows its own texture, and removed textures leave nothing behind") {
  Renderer renderer(device());
  std::uint64_t objects = 0;
  for (int round = 0; round < 40; ++round) {
    RendererScene scene = scene_with_ambient(1);
    for (int i = 0; i < 4; ++i) {
      auto texture = std::make_shared<Texture>();
      texture->name = "grey";
      texture->width = texture->height = 1;
      const std::uint8_t grey = i % 2 ? 255 : 0;
      texture->rgba = {grey, grey, grey, 255};
      Material material;
      material.base_color_texture = texture;
      const float left = -1 + 0.5f * static_cast<float>(i);
      scene.add(rectangle(left, -1, left + 0.5f, 1), material, at(0, 0, 1));
    }
    const auto color = renderer.render(scene.list, wall_plan(true, false))[0].color;
    for (int i = 0; i < 4; ++i) CHECK(color[4 + i].r == i % 2);
    if (round == 1) objects = device().impl().live_objects();
  }
  CHECK(device().impl().live_objects() == objects);
}

TEST_SUITE_END();
