// Materials of a mesh file as material nodes.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>

#include <simvis/content_pool.h>
#include <simvis/node.h>
#include "scenegraph/import/mesh/assimp_file.h"

namespace simvis {

/// One node per material of the file. Diffuse colour, opacity, emission and the diffuse picture are taken; colours are
/// read as sRGB, which is how programs that show these formats have always treated them. Every material is
/// double-sided: the formats do not say which side of a face is the outside, and files with faces turned over are
/// common.
class AssimpMaterials {
 public:
  /// `fallback` is the material of whatever has none in the file.
  AssimpMaterials(AssimpFile& file, ContentPool& pool, std::shared_ptr<const Material> fallback)
      : file_(file), pool_(pool), fallback_(std::move(fallback)) {}

  /// Surfaces are shaded; lines and points without normals are shown as if unlit.
  /// Throws InputError: colours that are negative or not finite, an opacity outside 0 to 1, a picture that is missing
  /// or broken.
  NodePtr get(unsigned material, bool shaded);

 private:
  Material convert(const aiMaterial& source);
  void set_picture(const aiMaterial& source, Material& material);
  std::shared_ptr<const Texture> picture(const std::string& name, const Sampler& sampler);

  AssimpFile& file_;
  ContentPool& pool_;
  std::shared_ptr<const Material> fallback_;
  std::map<std::pair<unsigned, bool>, NodePtr> nodes_;
};

}  // namespace simvis
