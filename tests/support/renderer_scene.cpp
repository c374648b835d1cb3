#include "tests/support/renderer_scene.h"

#include <utility>

namespace simvis::test {

Mesh rectangle(float x0, float y0, float x1, float y1) {
  Mesh mesh;
  mesh.name = "rectangle";
  mesh.positions = {{x0, y0, 0}, {x1, y0, 0}, {x1, y1, 0}, {x0, y1, 0}};
  mesh.attributes.resize(4);
  for (VertexAttributes& a : mesh.attributes) a.normal = {0, 0, -1};
  for (int set = 0; set < 2; ++set) {
    mesh.attributes[0].uv[set] = {0, 0};
    mesh.attributes[1].uv[set] = {1, 0};
    mesh.attributes[2].uv[set] = {1, 1};
    mesh.attributes[3].uv[set] = {0, 1};
  }
  // Counter-clockwise as seen from -z with x right and y down.
  mesh.indices = {0, 2, 1, 0, 3, 2};
  compute_bounds(mesh);
  return mesh;
}

FramePlan plan_of(std::uint32_t width, std::uint32_t height, double f_px, bool color, bool depth) {
  View view;
  view.name = "view";
  view.reason = "test";
  view.pinhole = {f_px, f_px, width / 2.0, height / 2.0};
  view.width_px = width;
  view.height_px = height;
  Pass pass;
  pass.name = "pass";
  pass.width_px = width;
  pass.height_px = height;
  pass.color = color;
  pass.depth = depth;
  pass.views = {view};
  return {{pass}};
}

RendererScene scene_with_ambient(double ambient) {
  RendererScene scene;
  scene.list.environment.ambient = glm::vec3(static_cast<float>(ambient));
  scene.list.environment.background = glm::vec3(kBackground);
  return scene;
}

Material colored(glm::vec4 base) {
  Material material;
  material.base_color = base;
  return material;
}

std::shared_ptr<Texture> four_texels() {
  auto texture = std::make_shared<Texture>();
  texture->name = "four";
  texture->width = 4;
  texture->height = 1;
  for (int i = 0; i < 4; ++i) {
    for (int c = 0; c < 3; ++c) texture->rgba.push_back(static_cast<std::uint8_t>(kGrey[i]));
    texture->rgba.push_back(static_cast<std::uint8_t>(kAlpha[i]));
  }
  texture->sampler = {
      .magnify = Filter::nearest, .minify = Filter::nearest, .between_mips = Filter::nearest, .mipmapped = false};
  return texture;
}

RendererScene textured_wall(Material material) {
  RendererScene scene = scene_with_ambient(1);
  scene.add(rectangle(-1, -1, 1, 1), material, at(0, 0, 1));
  return scene;
}

RendererScene::RendererScene() { list.world_from_node = {glm::dmat4(1)}; }

std::uint32_t RendererScene::add_mesh(Mesh mesh) {
  list.meshes.push_back(std::make_shared<const Mesh>(std::move(mesh)));
  return static_cast<std::uint32_t>(list.meshes.size() - 1);
}

std::uint32_t RendererScene::add_material(Material material) {
  list.materials.push_back(std::make_shared<const Material>(std::move(material)));
  list.material_revision.push_back(0);
  return static_cast<std::uint32_t>(list.materials.size() - 1);
}

std::uint32_t RendererScene::add_transform(const glm::dmat4& m) {
  list.world_from_node.push_back(m);
  return static_cast<std::uint32_t>(list.world_from_node.size() - 1);
}

void RendererScene::add(std::uint32_t mesh, std::uint32_t material, const glm::dmat4& m) {
  list.items.push_back({mesh, material, add_transform(m)});
}

void RendererScene::add(Mesh mesh, Material material, const glm::dmat4& m) {
  add(add_mesh(std::move(mesh)), add_material(std::move(material)), m);
}

void RendererScene::add_light(const Light& light, const glm::dmat4& m) {
  list.lights.push_back({light, add_transform(m)});
}

}  // namespace simvis::test
