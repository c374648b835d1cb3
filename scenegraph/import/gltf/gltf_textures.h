// Pictures of a glTF file as textures.
#pragma once

#include <map>
#include <memory>

#include <simvis/content_pool.h>
#include <simvis/mesh.h>
#include "scenegraph/import/gltf/gltf_document.h"

namespace simvis {

/// Decodes PNG and JPEG to RGBA8, each texture once and just those asked for.
class GltfTextures {
 public:
  GltfTextures(GltfDocument& document, ContentPool& pool) : document_(document), pool_(pool) {}

  /// Null, with a warning, when the texture names no picture that glTF itself defines.
  /// Throws InputError: no PNG or JPEG, broken, more than 16384 pixels on a side, sampler values that glTF lacks.
  std::shared_ptr<const Texture> get(int texture);

 private:
  GltfDocument& document_;
  ContentPool& pool_;
  std::map<int, std::shared_ptr<const Texture>> known_;
};

}  // namespace simvis
