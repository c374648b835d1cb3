// A mesh has a copy on the device only if a frame draws from it: strips, and views of a CPU device of large meshes,
// select their triangles on the host.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/gtc/matrix_transform.hpp>
#include <string>
#include <vector>

#include <simvis/device.h>
#include <simvis/simulation.h>
#include "engine/render/draw_cache.h"
#include "engine/render/renderer.h"
#include "scenegraph/height_map.h"
#include "tests/support/random_room.h"
#include "tests/support/renderer_scene.h"
#include "tests/support/wall_scene.h"

TEST_SUITE_BEGIN("engine");

namespace simvis {
namespace {

using namespace test;

constexpr std::uint32_t kWidth_px = 256, kStrip_px = 2, kPicture_px = 80;

FramePlan depth_plan(std::uint32_t height_px) {
  FramePlan plan = plan_of(kWidth_px, height_px, kWidth_px / 2.0, false, true);
  view_of(plan).sees_back_faces = true;
  return plan;
}

std::vector<float> depth_of(Renderer& renderer, const DrawList& list, const FramePlan& plan) {
  return copy(renderer.render(list, plan)[0].depth);
}

DrawList room() { return random_room(7, 12, 24); }

std::uint64_t bytes_of(const DrawList& list) {
  std::uint64_t bytes = 0;
  for (const auto& mesh : list.meshes) {
    bytes += mesh->positions.size() * sizeof(glm::vec3) + mesh->indices.size() * sizeof(std::uint32_t);
  }
  return bytes;
}

bool names_meshes(const FramePlan& plan) {
  return std::ranges::any_of(plan.memory, [](const auto& memory) { return memory.name.starts_with("mesh "); });
}

TEST_CASE("a mesh that only strips see has no copy on the device until another view draws it, and then one") {
  const DrawList list = room();
  Renderer renderer(device());
  FramePlan strip = depth_plan(kStrip_px), picture = depth_plan(kPicture_px);

  const std::vector<float> seen = depth_of(renderer, list, strip);
  CHECK(std::ranges::count(seen, 0.0f) < std::ssize(seen));
  CHECK(renderer.counters().meshes_held == 0);
  CHECK(renderer.counters().mesh_bytes == 0);
  renderer.complete(strip);
  CHECK(!names_meshes(strip));

  Renderer fresh(device());
  const std::vector<float> expected = depth_of(fresh, list, picture);
  CHECK(depth_of(renderer, list, picture) == expected);
  CHECK(renderer.counters().meshes_held == list.meshes.size());
  CHECK(renderer.counters().mesh_bytes == bytes_of(list));
  CHECK(renderer.counters().bytes_uploaded >= bytes_of(list));
  renderer.complete(picture);
  CHECK(names_meshes(picture));

  CHECK(depth_of(renderer, list, strip) == seen);
  CHECK(depth_of(renderer, list, picture) == expected);
  CHECK(renderer.counters().bytes_uploaded < bytes_of(list));  // not once more
}

TEST_CASE("strips that draw from the device have the same bytes") {
  const DrawList list = room();
  Renderer renderer(device());
  const std::vector<float> cpu_selected = depth_of(renderer, list, depth_plan(kStrip_px));
  CHECK(renderer.counters().meshes_held == 0);
  FramePlan whole = depth_plan(kStrip_px);
  view_of(whole).culled = false;
  CHECK(depth_of(renderer, list, whole) == cpu_selected);
  CHECK(renderer.counters().meshes_held == list.meshes.size());
  // The device culls back faces.
  Renderer other(device());
  FramePlan fronts = depth_plan(kStrip_px);
  view_of(fronts).sees_back_faces = false;
  other.render(list, fronts);
  CHECK(other.counters().meshes_held == list.meshes.size());
}

TEST_CASE("only meshes with holes and their attributes are on the device for the scene of a strip") {
  RendererScene scene;
  Material holes;
  holes.alpha_mode = AlphaMode::mask;
  holes.base_color_texture = four_texels();
  const Mesh far = rectangle(-9, -9, 9, 9), near = rectangle(-1, -1, 1, 1);
  scene.add(far, Material{}, at(0, 0, 5));
  scene.add(near, holes, at(0, 0, 2));
  Renderer renderer(device());
  FramePlan plan = depth_plan(kStrip_px);
  const std::vector<float> seen = depth_of(renderer, scene.list, plan);
  CHECK(renderer.counters().meshes_held == 1);
  constexpr std::uint64_t kPackedAttributes = 32;
  CHECK(renderer.counters().mesh_bytes ==
        near.positions.size() * (sizeof(glm::vec3) + kPackedAttributes) + near.indices.size() * sizeof(std::uint32_t));
  view_of(plan).culled = false;
  CHECK(depth_of(renderer, scene.list, plan) == seen);
}

TEST_CASE("meshes that are added and removed for strips and pictures keep separate places on the device") {
  DrawList list = room();
  Renderer renderer(device());
  depth_of(renderer, list, depth_plan(kPicture_px));
  for (int i = 0; i < 3; ++i) {
    // A mesh seen only by strips lies between present and future ones.
    add_item(list, sphere_mesh(0.3 + 0.1 * i, 40), glm::translate(glm::dmat4(1.0), {0.4 * i, 0.3, 2}));
    const std::size_t held = list.meshes.size() - 1;
    depth_of(renderer, list, depth_plan(kStrip_px));
    CHECK(renderer.counters().meshes_held == held);
    Renderer fresh(device());
    CHECK(depth_of(renderer, list, depth_plan(kPicture_px)) == depth_of(fresh, list, depth_plan(kPicture_px)));
    CHECK(renderer.counters().meshes_held == held + 1);
    CHECK(renderer.counters().mesh_bytes == bytes_of(list));
  }
}

// A bumpy square of 4 m, 3 m in front of the eye, with as few vertices as a large mesh has.
RendererScene large_scene() {
  constexpr std::uint32_t kSide = 1024;
  static_assert(kSide * kSide == kMinLargeVertices);
  HeightPicture picture{.width = kSide, .height = kSide, .values = {}};
  for (std::uint32_t i = 0; i < kSide * kSide; ++i) picture.values.push_back(static_cast<float>(i * 37 % 101) / 101);
  Mesh mesh = mesh_in_place(height_map(picture, {4, 4}, 0, 0.05));
  for (std::size_t i = 0; i < mesh.attributes.size(); ++i) mesh.attributes[i].color.r = static_cast<float>(i % 9) / 9;
  RendererScene scene = scene_with_ambient(0.2);
  Material material = colored({0.9, 0.8, 0.7, 1});
  material.base_color_texture = four_texels();
  scene.add(std::move(mesh), material, glm::rotate(at(0.2, 0.1, 3), 3.0, {1, 0.1, 0.05}));
  scene.add_light({.kind = LightKind::directional}, glm::dmat4(1));
  return scene;
}

struct Drawn {
  std::vector<float> depth;
  std::vector<glm::vec4> color;
  std::vector<std::uint32_t> items;

  bool operator==(const Drawn&) const = default;
};

// What the last pass shows.
Drawn drawn(Renderer& renderer, const DrawList& list, const FramePlan& plan) {
  const PassResult& result = renderer.render(list, plan).back();
  return {copy(result.depth), copy(result.color), copy(result.items)};
}

TEST_CASE(
    "views of a CPU device copy what they see of a large mesh, with the same bytes as from its copy on the device") {
  RendererScene scene = large_scene();
  scene.add(0, 0, glm::rotate(at(-0.5, 0.3, 3.5), 2.9, {1, 0, 0.1}));
  const std::uint64_t others = device().is_cpu() ? 0 : 1;
  struct Outputs {
    bool color, depth, items;
    std::uint32_t msaa;
  };
  for (const Outputs& outputs : {Outputs{true, true, false, 1}, {false, true, true, 1}, {true, false, false, 4}}) {
    CAPTURE(outputs.color);
    CAPTURE(outputs.msaa);
    FramePlan plan = plan_of(30, 20, 15, outputs.color, outputs.depth);
    plan.passes[0].items = outputs.items;
    plan.passes[0].msaa = outputs.msaa;
    plan.passes.push_back(plan.passes[0]);
    view_of(plan).view_from_world = at(0.1, 0.2, 0.3);
    FramePlan whole = plan;
    view_of(whole).culled = false;
    Renderer renderer(device());
    const Drawn seen = drawn(renderer, scene.list, plan);
    CHECK(renderer.counters().triangles > 1000);
    CHECK(renderer.counters().meshes_held == others);
    CHECK(drawn(renderer, scene.list, plan) == seen);
    drawn(renderer, scene.list, whole);
    CHECK(renderer.counters().meshes_held == 1);
    CHECK(drawn(renderer, scene.list, plan) == seen);
  }
}

TEST_CASE("a few triangles of many vertices are drawn from the device, which has another mesh too") {
  RendererScene scene = large_scene();
  auto few = std::make_shared<Mesh>(*scene.list.meshes[0]);
  const Mesh square = rectangle(-0.5, -0.5, 0.5, 0.5);
  std::ranges::copy(square.positions, few->positions.begin());
  few->indices = square.indices;
  std::ranges::reverse(few->indices);  // the scene shows the mesh from behind
  compute_bounds(*few);
  scene.list.meshes[0] = few;
  scene.add(rectangle(-9, -9, 9, 9), Material{}, at(0, 0, 5));
  Renderer renderer(device());
  FramePlan plan = plan_of(60, 40, 30, true, true);
  const Drawn seen = drawn(renderer, scene.list, plan);
  CHECK(renderer.counters().meshes_held == 2);
  view_of(plan).culled = false;
  CHECK(drawn(renderer, scene.list, plan) == seen);
  // The square is before the wall.
  CHECK(std::ranges::max(seen.depth) > std::ranges::min(seen.depth));
}

TEST_CASE("a large mesh is on the device where copies of what views see would take more") {
  RendererScene scene = large_scene();
  Renderer renderer(device());
  const FramePlan far = plan_of(120, kPicture_px, 60, true, false);
  FramePlan near = plan_of(1200, 1200, 900, true, false), whole = near;
  view_of(whole).culled = false;
  SUBCASE("since a picture has many pixels") {
    const Drawn seen = drawn(renderer, scene.list, near);
    CHECK(renderer.counters().meshes_held == 1);
    Renderer other(device());
    drawn(other, scene.list, whole);
    CHECK(drawn(other, scene.list, near) == seen);
  }
  SUBCASE("since a part of it has holes, or the list has changed after it was drawn for depth alone") {
    FramePlan depth = depth_plan(kPicture_px);
    view_of(depth).culled = false;
    drawn(renderer, scene.list, depth);
    CHECK(renderer.counters().meshes_held == 1);
    scene.add(rectangle(-9, -9, 9, 9), Material{}, at(0, 0, 5));
    Renderer fresh(device());
    CHECK(drawn(renderer, scene.list, far) == drawn(fresh, scene.list, far));
    Material holes;
    holes.alpha_mode = AlphaMode::mask;
    holes.base_color_texture = four_texels();
    scene.add(0, scene.add_material(holes), at(0, 0, 4));
    Renderer fresh_too(device());
    CHECK(drawn(renderer, scene.list, far) == drawn(fresh_too, scene.list, far));
    CHECK(renderer.counters().meshes_held == 2);
  }
}

TEST_CASE("planar scanners alone keep no mesh on the device; with a camera it is there, and the ranges are the same") {
  const auto scan_of = [](const std::string& camera, std::uint64_t meshes) {
    const TemporaryFolder folder;
    const std::filesystem::path scene = write_wall_scene(
        folder.path(), camera + R"(<sensor type="laser_scanner" name="SCANNER" insert_at="ROOT" method="planar"/>)");
    Simulation simulation = Simulation::load(scene);
    simulation.step();
    CHECK(simulation.diagnostics().counters().meshes_held == meshes);
    CHECK(names_meshes(simulation.diagnostics().frame_plan()) == (meshes > 0));
    const Scan& scan = simulation.scan("SCANNER");
    CHECK(std::ranges::any_of(scan.range_m, [](float range_m) { return std::isfinite(range_m); }));
    return std::vector<float>(scan.range_m.begin(), scan.range_m.end());
  };
  const std::vector<float> alone = scan_of("", 0);
  CHECK(scan_of(R"(<sensor type="camera" name="CAM" insert_at="ROOT"/>)", 1) == alone);
}

}  // namespace
}  // namespace simvis

TEST_SUITE_END();
