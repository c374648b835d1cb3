// Materials of a glTF file as material nodes.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include <simvis/content_pool.h>
#include <simvis/node.h>
#include "scenegraph/import/gltf/gltf_document.h"
#include "scenegraph/import/gltf/gltf_textures.h"

namespace simvis {

/// One node per glTF material, used wherever the material is.
class GltfMaterials {
 public:
  GltfMaterials(GltfDocument& document, ContentPool& pool)
      : document_(document), pool_(pool), textures_(document, pool) {}

  /// `material` -1 is glTF's default material. glTF shades lines and points without normals as if unlit: for these
  /// `shaded` is false, and such a material gets a second node if shaded surfaces use it as well.
  NodePtr get(int material, bool shaded);

 private:
  Material convert(int material);
  void set_surface(const tinygltf::Material& source, Material& material);
  template <typename TextureInfo>
  SurfaceMap map_of(const TextureInfo& info);  // without a texture where it cannot be shown

  GltfDocument& document_;
  ContentPool& pool_;
  GltfTextures textures_;
  std::map<std::pair<int, bool>, NodePtr> nodes_;
};

}  // namespace simvis
