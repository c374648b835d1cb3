// Makes textures from the pictures of a glTF file.
#pragma once

#include <map>
#include <memory>
#include <utility>

#include <simvis/content_pool.h>
#include <simvis/mesh.h>
#include "import/gltf/gltf_document.h"

namespace simvis {

/// Decodes pictures to RGBA8, each requested texture once.
class GltfTextures {
 public:
  GltfTextures(GltfDocument& document, ContentPool& pool) : document_(document), pool_(pool) {}

  /// Returns null and adds a warning if the texture has no picture, or one that is missing or cannot be decoded.
  /// A picture for colour may be postponed, see ContentPool. Throws InputError if a sampler value does not exist in
  /// glTF.
  std::shared_ptr<const Texture> get(int texture, PictureUse use);

 private:
  GltfDocument& document_;
  ContentPool& pool_;
  std::map<std::pair<int, PictureUse>, std::shared_ptr<const Texture>> known_;
};

}  // namespace simvis
