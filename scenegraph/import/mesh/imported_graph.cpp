#include "scenegraph/import/mesh/imported_graph.h"

#include <memory>
#include <utility>
#include <vector>

#include "scenegraph/import/mesh/picture_file.h"

namespace simvis {
namespace {

Texture read_pixels(ImportedTexture&& source, const std::filesystem::path& folder) {
  if (source.file.empty()) return std::move(source.texture);
  Texture texture = read_picture_file(folder / source.file);
  texture.name = std::move(source.texture.name);
  texture.sampler = source.texture.sampler;
  return texture;
}

std::shared_ptr<MaterialNode> material_node(ImportedMaterial&& source,
                                            const std::vector<std::shared_ptr<const Texture>>& textures,
                                            const Material& fallback, ContentPool& pool) {
  const bool is_named = source.is_fallback || !source.material.name.empty();
  Material material;
  if (source.is_fallback) {
    material = fallback;
    material.unlit = material.unlit || source.material.unlit;
  } else {
    material = std::move(source.material);
    if (source.texture != kNoTexture) material.base_color_texture = textures[source.texture];
  }
  auto node = std::make_shared<MaterialNode>(pool.intern(std::move(material)));
  if (is_named) node->name = node->material()->name;
  return node;
}

std::shared_ptr<Shape> shape_node(Mesh&& mesh, ContentPool& pool) {
  std::string name = mesh.name;
  compute_bounds(mesh);
  auto node = std::make_shared<Shape>(pool.intern(std::move(mesh)));
  node->name = std::move(name);
  return node;
}

}  // namespace

void add_imported_scene(ImportedScene&& scene, const std::filesystem::path& file, const Material& fallback,
                        ContentPool& pool, Group& root) {
  std::vector<std::shared_ptr<const Texture>> textures;
  for (ImportedTexture& texture : scene.textures) {
    textures.push_back(pool.intern(read_pixels(std::move(texture), file.parent_path())));
  }
  std::vector<NodePtr> materials, shapes;
  for (ImportedMaterial& material : scene.materials) {
    materials.push_back(material_node(std::move(material), textures, fallback, pool));
  }
  for (Mesh& mesh : scene.meshes) shapes.push_back(shape_node(std::move(mesh), pool));
  std::vector<std::shared_ptr<Separator>> separators;
  for (const ImportedNode& node : scene.nodes) {
    const auto separator = separators.emplace_back(std::make_shared<Separator>());
    separator->name = node.name;
    if (node.parent_from_node != glm::dmat4(1)) separator->add(std::make_shared<Transform>(node.parent_from_node));
    if (node.light) separator->add(std::make_shared<LightNode>(*node.light));
    for (const ImportedShape& shape : node.shapes) {
      separator->add(materials[shape.material]);
      separator->add(shapes[shape.mesh]);
    }
    Group& parent = node.parent == kNoParent ? root : *separators[node.parent];
    parent.add(separator);
  }
}

}  // namespace simvis
