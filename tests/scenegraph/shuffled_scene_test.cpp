// A scene whose items, lights and tables are in random order: pictures, depth and rays are the same to the bit, also
// where surfaces lie in one plane.
#include <doctest/doctest.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <numeric>
#include <string>

#include <simvis/ray_caster.h>
#include <simvis/surface_point.h>
#include "tests/support/random_numbers.h"
#include "tests/support/random_room.h"
#include "tests/support/renderer_scene.h"

TEST_SUITE_BEGIN("scenegraph");

using namespace simvis;
using namespace simvis::test;

namespace {

using Order = std::vector<std::uint32_t>;

Order random_order(std::size_t size, Random& random) {
  Order order(size);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = size; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

/// The entry at order[i] moves to i.
template <typename T>
std::vector<T> ordered(const std::vector<T>& values, const Order& order) {
  std::vector<T> result;
  for (const std::uint32_t i : order) result.push_back(values[i]);
  return result;
}

Order inverse(const Order& order) {
  Order places(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) places[order[i]] = i;
  return places;
}

/// The same world, its tables in another order.
DrawList shuffled(const DrawList& list, Random& random) {
  const Order meshes = random_order(list.meshes.size(), random),
              materials = random_order(list.materials.size(), random);
  const Order lights = random_order(list.lights.size(), random), items = random_order(list.items.size(), random);
  Order places = random_order(list.world_from_node.size(), random);
  std::swap(places[0], *std::ranges::find(places, 0u));  // the identity stays first
  DrawList result = list;
  result.meshes = ordered(list.meshes, meshes);
  result.materials = ordered(list.materials, materials);
  result.world_from_node = ordered(list.world_from_node, places);
  result.lights = ordered(list.lights, lights);
  result.items = ordered(list.items, items);
  const Order mesh_at = inverse(meshes), material_at = inverse(materials), place_at = inverse(places);
  for (DrawItem& item : result.items) {
    item = {mesh_at[item.mesh], material_at[item.material], place_at[item.transform]};
  }
  for (LightItem& light : result.lights) light.transform = place_at[light.transform];
  return result;
}

Material named(const std::string& name, const glm::vec4& color, AlphaMode mode = AlphaMode::opaque) {
  Material material = colored(color);
  material.name = name;
  material.alpha_mode = mode;
  material.double_sided = true;
  return material;
}

/// A room with boxes whose faces lie in the plane of its floor and of each other, masked and transparent panes that
/// cross, two of one mesh and material side by side and overlapping, and lights of all kinds.
RendererScene crowded_room() {
  RendererScene scene;
  scene.list = random_room(7, 10, 12);
  scene.list.environment.ambient = glm::vec3(0.1f);
  Material leaf = named("leaf", {1, 1, 1, 1}, AlphaMode::mask);
  leaf.base_color_texture = four_texels();
  Material faded = named("faded", {0.9f, 0.8f, 0.1f, 1});
  faded.opacity = 0.6f;
  Material picture = named("picture", {0.7f, 0.9f, 1, 1});
  picture.base_color_texture = four_texels();
  picture.roughness = 0.4f;
  const Material kinds[] = {named("red", {0.9f, 0.1f, 0.1f, 1}),
                            named("blue", {0.1f, 0.1f, 0.9f, 1}),
                            leaf,
                            faded,
                            picture,
                            named("glass", {0.2f, 0.6f, 0.4f, 0.5f}, AlphaMode::blend),
                            named("tint", {0.6f, 0.1f, 0.5f, 0.25f}, AlphaMode::blend)};
  const std::uint32_t box = scene.add_mesh([] {
    Mesh mesh = half_box_mesh({0.5f, 0.5f, 0.25f});
    mesh.attributes.resize(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.attributes.size(); ++i) {
      mesh.attributes[i].normal = glm::normalize(mesh.positions[i]);
      mesh.attributes[i].uv[0] = glm::vec2(mesh.positions[i]);
    }
    compute_bounds(mesh);
    return mesh;
  }());
  const std::uint32_t pane = scene.add_mesh(rectangle(-0.8f, -0.8f, 0.8f, 0.8f));
  int number = 0;
  for (const Material& kind : kinds) {
    const std::uint32_t material = scene.add_material(kind);
    // Tops in one plane, sides in one plane, each overlapping the next; each twice.
    scene.add(box, material, at(1.5 + 0.25 * number, 0.5, 0.25));
    scene.add(box, material, at(1.75 + 0.25 * number, 0.5, 0.25));
    scene.add(pane, material, glm::rotate(at(2, -1, 1), 0.4 * number, glm::dvec3(0.2, 0.3, 1)));
    scene.add(pane, material, at(0.1 * number, 1, 2));
    ++number;
  }
  for (int i = 0; i < 5; ++i) {
    const glm::vec3 color(0.3f + 0.1f * static_cast<float>(i), 0.7f, 1.0f / static_cast<float>(3 + i));
    scene.add_light({.kind = LightKind::point, .color = color, .intensity = 3.3 + i}, at(0.3 * i, 1 - 0.4 * i, 2.5));
    scene.add_light({.kind = LightKind::point, .color = color, .intensity = 3.3}, at(-0.3 * i, 0.2, 2.1));
  }
  scene.add_light({.kind = LightKind::directional, .intensity = 0.7, .direction = {0.6, 0, -0.8}}, glm::dmat4(1));
  scene.add_light({.kind = LightKind::spot, .intensity = 9, .direction = {0, 0, -1}}, at(2, 0, 2.8));
  return scene;
}

const glm::dmat4 kEye = glm::rotate(at(-1, 0, 1.6), 0.2, glm::dvec3(0, 1, 0));  // of a sensor: along +x, z up

FramePlan pictures() {
  FramePlan plan = plan_of(64, 48, 40, true, true);
  const glm::dmat4 sensor_from_view(glm::dvec4(0, -1, 0, 0), glm::dvec4(0, 0, -1, 0), glm::dvec4(1, 0, 0, 0),
                                    glm::dvec4(0, 0, 0, 1));
  view_of(plan).view_from_world = glm::inverse(kEye * sensor_from_view);
  plan.passes.push_back(plan.passes[0]);
  plan.passes[1].depth = false;
  plan.passes[1].supersampling = 2;
  plan.passes[1].msaa = device().target_limits().msaa.back() >= 4 ? 4 : 1;
  return plan;
}

/// The hit of a ray, by content.
struct Met {
  double range_m = 0, error_bound_m = 0;
  std::string material{};
  glm::dvec3 normal{0};
  glm::vec4 color{0};
  bool operator==(const Met&) const = default;
};

std::vector<Met> cast(RayCaster& caster, const DrawList& list) {
  std::vector<glm::dvec3> directions;
  // Along the planes that contain faces, and in all directions.
  for (int i = 0; i < 1200; ++i) {
    const double azimuth = 0.01 * (i % 120 - 60), elevation = -0.08 * (i / 120);
    directions.emplace_back(std::cos(azimuth) * std::cos(elevation), std::sin(azimuth) * std::cos(elevation),
                            std::sin(elevation));
  }
  std::vector<RayHit> hits(directions.size());
  caster.set_world(list);
  caster.cast(kEye, directions, hits);
  std::vector<Met> met;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].range_m > 1e9) {
      met.push_back({.range_m = hits[i].range_m});
      continue;
    }
    const SurfacePoint point = surface_point(list, kEye, directions[i], hits[i]);
    met.push_back({point.range_m, point.error_bound_m, point.material->name, point.normal, point.base_color});
  }
  return met;
}

}  // namespace

TEST_CASE("a scene in any order gives the same pictures, depth and hits, to the bit") {
  const RendererScene scene = crowded_room();
  const FramePlan plan = pictures();
  Renderer renderer(device());
  const auto frame = [&](const DrawList& list) {
    const std::span<const PassResult> results = renderer.render(list, plan);
    return std::tuple(copy(results[0].color), copy(results[0].depth), copy(results[1].color));
  };
  const auto first = frame(scene.list);
  const std::unique_ptr<RayCaster> on_device = make_device_ray_caster(device()), on_host = make_host_ray_caster();
  const std::vector<Met> met = cast(*on_device, scene.list);
  // The picture contains blended layers and faces in one plane.
  CHECK(renderer.counters().layers > 1000);
  Random random(5);
  for (int order = 0; order < 5; ++order) {
    CAPTURE(order);
    const DrawList list = shuffled(scene.list, random);
    const auto again = frame(list);
    CHECK(same_bytes<glm::vec4>(std::get<0>(first), std::get<0>(again)));
    CHECK(same_bytes<float>(std::get<1>(first), std::get<1>(again)));
    CHECK(same_bytes<glm::vec4>(std::get<2>(first), std::get<2>(again)));
    CHECK(cast(*on_device, list) == met);
    if (on_host) CHECK(cast(*on_host, list) == met);
  }
}

// Moved or repainted items must not keep the order of the frame before.
TEST_CASE("a changed scene looks as if it had been built that way") {
  const RendererScene before = crowded_room();
  RendererScene after = before;
  for (std::size_t i = 5; i < after.list.items.size(); i += 2) {
    after.list.world_from_node[after.list.items[i].transform][3].x += 0.25;
  }
  for (std::size_t m = 1; m < after.list.materials.size(); ++m) {
    Material material = *after.list.materials[m];
    std::swap(material.base_color.r, material.base_color.b);
    after.list.materials[m] = std::make_shared<const Material>(material);
    ++after.list.material_revision[m];
  }
  const FramePlan plan = pictures();
  Renderer fresh(device()), used(device());
  used.render(before.list, plan);
  const std::vector<glm::vec4> changed = copy(used.render(after.list, plan)[0].color);
  CHECK(same_bytes<glm::vec4>(changed, fresh.render(after.list, plan)[0].color));
}

TEST_SUITE_END();
