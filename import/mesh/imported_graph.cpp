#include "import/mesh/imported_graph.h"

#include <algorithm>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "import/mesh/picture_file.h"
#include "import/mesh/shape_node.h"

namespace simvis {
namespace {

// One picture may be used with several samplers; a missing picture gives one warning.
std::shared_ptr<const Texture> pooled_texture(ImportedTexture&& source, PictureUse use,
                                              const std::filesystem::path& file, ContentPool& pool,
                                              std::vector<std::string>& warnings) {
  if (source.file.empty()) return pool.intern(std::move(source.texture));
  const auto read = [source = std::move(source), file](std::vector<std::string>& found) {
    std::vector<std::string> own;
    std::optional<Texture> texture = find_and_read_picture(source.file, file, own);
    for (std::string& warning : own) {
      if (std::ranges::count(found, warning) == 0) found.push_back(std::move(warning));
    }
    if (!texture) return texture;
    texture->name = source.texture.name;
    texture->sampler = source.texture.sampler;
    return texture;
  };
  return pool.picture({.read = read, .use = use}, warnings);
}

std::vector<PictureUse> uses_of_textures(const ImportedScene& scene) {
  std::vector<PictureUse> uses(scene.textures.size(), PictureUse::color);
  for (const ImportedMaterial& material : scene.materials) {
    const bool has_alpha = material.material.alpha_mode != AlphaMode::opaque;
    if (has_alpha && material.texture != kNoTexture) uses[material.texture] = PictureUse::alpha;
  }
  return uses;
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
    if (source.textured_emission) {
      material.map(MapKind::emissive) = {material.base_color_texture, material.uv_set, material.uv_transform};
    }
  }
  // Materials that look the same are shared, whatever their names are.
  std::string name = is_named ? material.name : "";
  auto node = std::make_shared<MaterialNode>(pool.intern(std::move(material)));
  node->name = std::move(name);
  return node;
}

}  // namespace

std::vector<std::string> add_imported_scene(ImportedScene&& scene, const std::filesystem::path& file,
                                            const Material& fallback, ContentPool& pool, Group& root) {
  std::vector<std::string> warnings;
  std::vector<std::shared_ptr<const Texture>> textures;
  const std::vector<PictureUse> uses = uses_of_textures(scene);
  for (std::size_t i = 0; i < scene.textures.size(); ++i) {
    textures.push_back(pooled_texture(std::move(scene.textures[i]), uses[i], file, pool, warnings));
  }
  std::vector<NodePtr> materials, shapes;
  for (ImportedMaterial& material : scene.materials) {
    materials.push_back(material_node(std::move(material), textures, fallback, pool));
  }
  for (Mesh& mesh : scene.meshes) {
    compute_bounds(mesh);
    shapes.push_back(shape_node(std::move(mesh), pool));
  }
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
  return warnings;
}

}  // namespace simvis
