// Makes material nodes from the materials of a glTF file.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include <simvis/content_pool.h>
#include <simvis/node.h>
#include "import/gltf/gltf_document.h"
#include "import/gltf/gltf_textures.h"

namespace simvis {

/// Makes one node for each glTF material. All users of the material share the node.
class GltfMaterials {
 public:
  GltfMaterials(GltfDocument& document, ContentPool& pool)
      : document_(document), pool_(pool), textures_(document, pool) {}

  /// `material` -1 is glTF's default material. glTF draws lines and points without normals as unlit; for these `shaded`
  /// is false. A material that shaded surfaces use as well gets a second node.
  NodePtr get(int material, bool shaded);

 private:
  Material convert(int material);
  void set_surface(const tinygltf::Material& source, Material& material);
  // Without a texture if it cannot be shown.
  template <typename TextureInfo>
  SurfaceMap map_of(const TextureInfo& info, PictureUse use = PictureUse::color);

  GltfDocument& document_;
  ContentPool& pool_;
  GltfTextures textures_;
  std::map<std::pair<int, bool>, NodePtr> nodes_;
};

}  // namespace simvis
